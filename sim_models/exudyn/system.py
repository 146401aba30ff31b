"""A scene as an Exudyn system: rigid bodies, joints, the drive.

Every moving body is a RigidBody2D whose node is its centre of mass, with the coordinates x, y (m) and the angle of its
x axis (rad). What joints and the drive do on the coordinates is -C_q^T lambda.
"""

from collections.abc import Collection, Mapping
from dataclasses import replace
from importlib import import_module
from typing import Any, ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.joints import Guide, Joint, Pin
from scenes.scene import GROUND

from .bodies import force_unit, linkage_size, rigid_body
from .drive import ExudynDrive
from .joints import RULES, TURN, ExudynDriveJoint, ExudynJoint

Array: TypeAlias = NDArray[np.float64]
Chosen: TypeAlias = slice | NDArray[np.intp]

exudyn: Any = import_module("exudyn")  # whose own types refuse much that it takes
exudyn.config.printToConsole = False
items = exudyn.itemInterface


class ExudynSystem:
    """One scene as an assembled Exudyn system, at first without loads; a point of the plane is a complex number."""

    items = items
    rules: ClassVar[Mapping[type[Joint], ExudynJoint]] = RULES
    node_size = 3  # coordinates of a body
    in_plane = (0, 1, 2)  # which of them are x, y and the angle
    coordinates: Chosen = slice(None)  # x, y and angle of every body in turn, among all coordinates
    multipliers: Chosen = slice(None)  # two of every pin, two of every slide and the drive's, among all multipliers
    reduced: Collection[str] = frozenset()  # bodies with one coordinate, whose joint with the ground is no constraint

    def __init__(self, scene: Scene, drive: ExudynDrive, *, si: bool = False) -> None:
        """Build the system with a drive, in a unit of force of its own, or in SI."""
        self.scene, self.driven_by, self.prescribed = scene, drive, scene.drive
        bodies = {name: rigid_body(scene, body) for name, body in scene.bodies.items()}
        self.size = linkage_size(scene, bodies)  # m
        self.units = np.tile([self.size, self.size, 1.0], len(bodies))  # of x, y and angle of every body
        unit = self.force_unit = 1.0 if si else force_unit(scene, bodies, self.size)  # N, and with it of masses
        self.bodies = {n: replace(b, mass=b.mass / unit, inertia=b.inertia / unit) for n, b in bodies.items()}
        self._container = exudyn.SystemContainer()  # it owns the system
        self.mbs: Any = self._container.AddSystem()
        self.state: Any = self.mbs.systemData
        self._ground_node = self.mbs.AddNode(items.NodePointGround())
        self._ground = self.mbs.AddObject(items.ObjectGround())
        self.nodes: dict[str, Any] = {}
        self.objects = {name: self._add_body(name) for name in self.bodies}
        self.joints = {joint: self.add(joint) for joint in scene.joints if not self._in_coordinates(joint)}
        self.mbs.Assemble()
        self.settings: Any = exudyn.SimulationSettings()
        self.settings.solution.file.write = False  # else a folder of results appears in the working folder

    def narrowed(self, q: Array) -> Array:
        """The system's coordinates from x, y and angle of every body, or their rates."""
        return q

    def counts(self) -> dict[str, int]:
        """How large the system is: bodies, coordinates, constraint equations and sensors."""
        coordinates, constraints = len(self.state.GetODE2Coordinates()), len(self.state.GetAECoordinates())
        sizes = {"bodies": len(self.bodies), "coordinates": coordinates, "constraints": constraints}
        return sizes | {"sensors": int(self.state.NumberOfSensors())}

    def pose_of(self, body: str, q: Array) -> tuple[Any, Any]:
        """A body's centre of mass and angle, or their rates, from coordinates or their rates, shape (..., 3 bodies)."""
        if body == GROUND:
            return 0j, 0.0
        first = 3 * list(self.bodies).index(body)
        return q[..., first] + 1j * q[..., first + 1], q[..., first + 2]

    def along(self, body: str) -> complex:
        """The direction of a body's guide, in the frame of the guide."""
        return complex(*self.scene.slides[body].along)

    def lever(self, body: str) -> complex:
        """The first point of a body, from its centre of mass along its own axes, m."""
        return self.bodies[body].points[self.scene.bodies[body].points[0]]

    def displacement(self, body: str, q: Array) -> Any:
        """The displacement of a slider, m, from coordinates, shape (..., 3 bodies)."""
        (com, angle), (carrier, turn) = self.pose_of(body, q), self.pose_of(self.scene.slides[body].on, q)
        first = (com + self.lever(body) * np.exp(1j * angle) - carrier) * np.exp(-1j * turn) - self.through(body)
        return (self.along(body).conjugate() * first).real

    def driven(self, q: Array) -> Any:
        """The position of the drive, rad or m, from coordinates, shape (..., 3 bodies)."""
        joint = self.scene.joints[-1]
        rule = self.rules[type(joint)]
        assert isinstance(rule, ExudynDriveJoint)
        return rule.position(joint, self, q)

    def placed(self, body: str, place: complex) -> tuple[Any, list[float]]:
        """A body's object, and a place of it, or the ground's."""
        return self._ground if body == GROUND else self.objects[body], [place.real, place.imag, 0]

    def marker(self, body: str, place: complex, kind: str = "Position") -> Any:
        """A marker at a place, m: from a body's centre of mass along its own axes, or of the ground."""
        create, (number, position) = getattr(items, f"MarkerBody{kind}"), self.placed(body, place)
        return self.mbs.AddMarker(create(bodyNumber=number, localPosition=position))

    def at(self, body: str, point: str) -> Any:
        """A marker at a point of a body or of the ground."""
        ground = body == GROUND
        return self.marker(body, complex(*self.scene.ground[point]) if ground else self.bodies[body].points[point])

    def through(self, body: str) -> complex:
        """Where a slider's guide goes through, m: from the centre of mass of what has it, or on the ground."""
        slide = self.scene.slides[body]
        return complex(*slide.through) - (0j if slide.on == GROUND else self.bodies[slide.on].com)

    def gauge(self, body: str) -> Any:
        """A marker whose coordinate is a slider's displacement, m.

        Its Jacobian takes the slider's first point to be on the guide, where a turning guide does not move it along.
        """
        slide = self.scene.slides[body]
        carrier, zero = self.placed(slide.on, self.through(body))
        slider, first = self.placed(body, self.lever(body))
        places = {"localPosition0": zero, "localPosition1": first, "axis0": [*slide.along, 0]}
        create = items.MarkerBodiesRelativeTranslationCoordinate
        return self.mbs.AddMarker(create(bodyNumbers=[carrier, slider], **places))

    def columns(self, constraint: Any) -> list[int]:
        """The indices of a constraint's multipliers among all."""
        return list(self.state.GetObjectLTGAE(constraint))

    def add(self, joint: Joint) -> Any:
        """Add a joint or a drive, and return its object."""
        return self.rules[type(joint)].add(joint, self)

    def _in_coordinates(self, joint: Joint) -> bool:
        first, second = joint.between
        return isinstance(joint, Pin | Guide) and first == GROUND and second in self.reduced

    def _add_body(self, name: str) -> Any:
        body = self.bodies[name]
        node = self.nodes[name] = self.mbs.AddNode(items.NodeRigidBody2D())
        return self.mbs.AddObject(items.RigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node))

    def coordinate(self, body: str, number: int) -> Any:
        """A marker on x, y or the angle of a body, or on the ground's zero."""
        node, place = (self._ground_node, 0) if body == GROUND else (self.nodes[body], self.in_plane[number])
        return self.mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=place))

    def angle_of(self, body: str) -> Any:
        """A marker on the angle of a body, or on the ground's zero."""
        return self.coordinate(body, TURN)

    @staticmethod
    def coordinate_at(mbs: Any, marker: Any) -> float:
        """The coordinate of a marker as a system is now."""
        value: float = mbs.GetMarkerOutput(marker, exudyn.OutputVariableType.Coordinates)[0]
        return value

    def hold(self, name: str, rows: Array, values: list[float]) -> Any:
        """Hold linear combinations of a body's coordinates, shape (values, coordinates), at values."""
        nodes = (self._ground_node, self.nodes[name])
        markers = [self.mbs.AddMarker(items.MarkerNodeCoordinates(nodeNumber=node)) for node in nodes]
        held = items.CoordinateVectorConstraint(markerNumbers=markers, scalingMarker1=rows, offset=values)
        return self.mbs.AddObject(held)

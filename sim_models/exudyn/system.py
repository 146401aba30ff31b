"""A scene as an Exudyn system: rigid bodies, joints, the drive.

Every moving body is a RigidBody2D whose node is its centre of mass, with the coordinates x, y (m) and the angle of its
x axis (rad). A pin is a RevoluteJoint2D, a slide on a moving body a PrismaticJoint2D; a slide on the ground and the
drive are constraints on coordinates. All hold at position level. What acts on the coordinates is -C_q^T lambda.
"""

from collections.abc import Collection
from dataclasses import replace
from importlib import import_module
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.scene import GROUND, Slide

from .bodies import force_unit, linkage_size, rigid_body
from .drive import ExudynDrive

TURN = 2  # of x, y and the angle

Array: TypeAlias = NDArray[np.float64]
Chosen: TypeAlias = slice | NDArray[np.intp]

exudyn: Any = import_module("exudyn")  # whose own types refuse much that it takes
exudyn.config.printToConsole = False
items = exudyn.itemInterface


class ExudynSystem:
    """One scene as an assembled Exudyn system, at first without loads; a point of the plane is a complex number."""

    items = items
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
        self.pins = {
            pin.channel: self._add_pin(pin.point, pin.first, pin.second)
            for pin in scene.pins
            if not (pin.first == GROUND and pin.second in self.reduced)
        }
        self.slides = {
            name: self._add_guide(name, slide) if slide.on == GROUND else self._add_slot(name, slide)
            for name, slide in scene.slides.items()
            if not (slide.on == GROUND and name in self.reduced)
        }
        self.drive = self._add_drive(drive)
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
        name = self.prescribed.body
        if self.prescribed.slide is not None:
            return self.displacement(name, q)
        return self.pose_of(name, q)[1] - self.pose_of(self.prescribed.on, q)[1]

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

    def _add_pin(self, point: str, first: str, second: str) -> Any:
        """Hold P2 - P1 at zero, for the point of each body."""
        return self.mbs.AddObject(items.RevoluteJoint2D(markerNumbers=[self.at(first, point), self.at(second, point)]))

    def _add_guide(self, name: str, slide: Slide) -> Any:
        """Hold normal . (x, y) on the line of the ground's guide, and the angle at zero."""
        normal = 1j * self.along(name)
        com = complex(*slide.through) - self.lever(name)
        rows = np.zeros((2, self.node_size))
        rows[:, self.in_plane] = (normal.real, normal.imag, 0), (0, 0, 1)
        return self._hold(name, rows, [(normal.conjugate() * com).real, 0.0])

    def _hold(self, name: str, rows: Array, values: list[float]) -> Any:
        """Hold linear combinations of a body's coordinates, shape (values, coordinates), at values."""
        nodes = (self._ground_node, self.nodes[name])
        markers = [self.mbs.AddMarker(items.MarkerNodeCoordinates(nodeNumber=node)) for node in nodes]
        held = items.CoordinateVectorConstraint(markerNumbers=markers, scalingMarker1=rows, offset=values)
        return self.mbs.AddObject(held)

    def _add_slot(self, name: str, slide: Slide) -> Any:
        """Hold normal . (through - P) at zero, and the sine of the slider's angle less the carrier's.

        The joint's normal belongs to its second marker's body, here the carrier, so that the force acts at the slider's
        first point P.
        """
        along = self.along(name)
        # Roles of the markers decide where the reaction acts: the first marker's point is held on a line of the second
        # marker's body, and the force is at that point.
        first = self.marker(name, self.lever(name), "Rigid")
        second = self.marker(slide.on, self.through(name), "Rigid")
        axes = {"axisMarker0": [along.real, along.imag, 0], "normalMarker1": [-along.imag, along.real, 0]}
        return self.mbs.AddObject(items.PrismaticJoint2D(markerNumbers=[first, second], **axes))

    def _add_drive(self, drive: ExudynDrive) -> Any:
        """Hold the position, the angle of a crank or the displacement of a slider, less the drive's at zero."""
        name, carrier = self.prescribed.body, self.prescribed.on
        if self.prescribed.slide is None:
            first, second = self.coordinate(carrier, TURN), self.coordinate(name, TURN)
        else:
            first, second = self.coordinate(GROUND, 0), self.gauge(name)
        # The functions hold no reference to self: through it, they and the system would keep each other alive.
        held = items.CoordinateConstraint(
            markerNumbers=[first, second],
            offsetUserFunction=lambda _mbs, clock, _item, _offset: drive.position(clock),
            offsetUserFunction_t=lambda _mbs, clock, _item, _offset: drive.rate(clock),
        )
        return self.mbs.AddObject(held)

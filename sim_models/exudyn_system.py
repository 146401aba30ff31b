"""A scene as an Exudyn system: rigid bodies, joints, the drive, loads.

Every moving body is a RigidBody2D whose node is its centre of mass, with the coordinates x, y (m) and the angle of its
x axis (rad). A pin is a RevoluteJoint2D; a slide and the drive are constraints on coordinates. All hold at position
level, and all say "marker 1 minus marker 0 is zero", so that -lambda is what acts on marker 1.
"""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import degrees, sqrt
from types import ModuleType
from typing import Any

import numpy as np

from scenes import Scene
from scenes.scene import GROUND, Body


def engine() -> ModuleType:
    """Return Exudyn, silent, and without the settings that its user may keep for interactive work."""
    os.environ["EXUDYN_NO_USER_SETTINGS"] = "1"  # read on import
    import exudyn  # late: importing takes longer than most runs

    exudyn.config.printToConsole = False
    return exudyn


# --- bodies; a point of the plane is a complex number, x + iy --------------------------------------------------------


@dataclass(frozen=True)
class RigidBody:
    """A body with its points measured from its centre of mass, along its own axes."""

    points: Mapping[str, complex]  # m
    mass: float  # kg
    inertia: float  # kg m^2, about the centre of mass


def rigid_body(scene: Scene, body: Body) -> RigidBody:
    """Return a body of the scene; without a mass it gets 1 kg, since a driven motion does not depend on it."""
    points = _local_points(scene, body)
    mass = 1.0 if body.mass is None else body.mass
    if body.com is None or body.inertia is None:
        com, inertia = _uniform(mass, list(points.values()))
    else:
        com, inertia = complex(*body.com), body.inertia
    return RigidBody({name: point - com for name, point in points.items()}, mass, inertia)


def _local_points(scene: Scene, body: Body) -> dict[str, complex]:
    if body.local is not None:
        return {name: complex(*point) for name, point in body.local.items()}
    assert body.lengths is not None
    first, second, *third = body.points
    base = body.lengths[frozenset((first, second))]
    points = {first: 0j, second: complex(base)}
    for apex in third:
        a, b = (body.lengths[frozenset((corner, apex))] for corner in (first, second))
        x = (base**2 + a**2 - b**2) / (2 * base)
        p, q, r = (sketched(scene)[name] for name in body.points)
        side = ((q - p).conjugate() * (r - p)).imag
        points[apex] = complex(x, np.copysign(sqrt(a**2 - x**2), side))
    return points


def _uniform(mass: float, points: list[complex]) -> tuple[complex, float]:
    """Return centre and inertia of a point mass, a bar (m l^2 / 12) or a triangle (m (a^2 + b^2 + c^2) / 36)."""
    squares = sum(abs(p - q) ** 2 for i, p in enumerate(points) for q in points[:i])
    return sum(points) / len(points), mass * squares / {1: 1, 2: 12, 3: 36}[len(points)]


def sketched(scene: Scene) -> dict[str, complex]:
    """Return where the points are, roughly: name -> m, for those that the scene says."""
    return {name: complex(*point) for name, point in (*scene.ground.items(), *scene.sketch.points.items())}


# --- the system ------------------------------------------------------------------------------------------------------


class System:
    """One scene as an assembled Exudyn system.

    Exudyn's clock cannot start below zero, so it runs ahead of the scene's by `lead`, s.
    """

    def __init__(self, scene: Scene, lead: float) -> None:
        self.scene, self.lead = scene, lead
        exudyn = engine()
        self._items: Any = exudyn.itemInterface
        self.bodies = {name: rigid_body(scene, body) for name, body in scene.bodies.items()}
        self._container = exudyn.SystemContainer()  # it owns the system
        self.mbs: Any = self._container.AddSystem()
        self._add_bodies()
        self.pins = {pin.channel: self._add_pin(pin.point, pin.first, pin.second) for pin in scene.pins}
        self.slides = {name: self._add_slide(body) for name, body in scene.bodies.items() if body.slide is not None}
        self.drive = self._add_drive()
        self._add_loads()
        self.mbs.Assemble()
        self.state: Any = self.mbs.systemData
        self.settings: Any = exudyn.SimulationSettings()
        self.settings.solution.file.write = False  # else a folder of results appears in the working folder

    @cached_property
    def size(self) -> float:
        """The linkage's size, m: its longest distance from a centre of mass to a point, or between ground points."""
        arms = [abs(point) for body in self.bodies.values() for point in body.points.values()]
        ground = [complex(*point) for point in self.scene.ground.values()]
        return max(*arms, *(abs(p - q) for p in ground for q in ground))

    def crank_angle(self, time: float) -> float:
        """Return the angle that the drive asks for at a time of Exudyn's clock, rad."""
        return self.scene.drive.start + self.scene.drive.speed * (time - self.lead)

    def degrees(self, time: float) -> str:
        """Return that angle as messages say it, within one turn."""
        return f"{degrees(self.crank_angle(time)) % 360:.6g} deg"

    @staticmethod
    def normal(body: Body) -> complex:
        """Return the unit normal of a slide, `along` turned +90 degrees."""
        assert body.slide is not None
        return 1j * complex(*body.slide.along)

    def columns(self, constraint: Any) -> list[int]:
        """Return where the multipliers of a constraint stand among all."""
        return list(self.mbs.systemData.GetObjectLTGAE(constraint))

    def _add_bodies(self) -> None:
        self._nodes = {GROUND: self.mbs.AddNode(self._items.NodePointGround())}
        self._objects = {GROUND: self.mbs.AddObject(self._items.ObjectGround())}
        for name, body in self.bodies.items():
            node = self.mbs.AddNode(self._items.NodeRigidBody2D())
            self._nodes[name] = node
            self._objects[name] = self.mbs.AddObject(
                self._items.RigidBody2D(mass=body.mass, inertia=body.inertia, nodeNumber=node)
            )

    def _at(self, body: str, point: str) -> Any:
        """Return a marker at a point of a body or of the ground."""
        place = complex(*self.scene.ground[point]) if body == GROUND else self.bodies[body].points[point]
        return self.mbs.AddMarker(
            self._items.MarkerBodyPosition(bodyNumber=self._objects[body], localPosition=[place.real, place.imag, 0])
        )

    def _add_pin(self, point: str, first: str, second: str) -> Any:
        return self.mbs.AddObject(
            self._items.RevoluteJoint2D(markerNumbers=[self._at(first, point), self._at(second, point)])
        )

    def _add_slide(self, body: Body) -> Any:
        """Hold normal . (x, y) at what the guide gives it, and the angle at zero."""
        assert body.slide is not None
        normal = self.normal(body)
        com = complex(*body.slide.through) - self.bodies[body.name].points[body.points[0]]
        return self.mbs.AddObject(
            self._items.CoordinateVectorConstraint(
                markerNumbers=[
                    self.mbs.AddMarker(self._items.MarkerNodeCoordinates(nodeNumber=self._nodes[name]))
                    for name in (GROUND, body.name)
                ],
                scalingMarker1=[[normal.real, normal.imag, 0], [0, 0, 1]],
                offset=[(normal.conjugate() * com).real, 0],
            )
        )

    def _add_drive(self) -> Any:
        drive, zero = self.scene.drive, self.crank_angle(0.0)
        # The functions hold no reference to self: through it, they and the system would keep each other alive.
        return self.mbs.AddObject(
            self._items.CoordinateConstraint(
                markerNumbers=[
                    self.mbs.AddMarker(
                        self._items.MarkerNodeCoordinate(nodeNumber=self._nodes[name], coordinate=coordinate)
                    )
                    for name, coordinate in ((GROUND, 0), (drive.body, 2))
                ],
                offsetUserFunction=lambda _mbs, time, _item, _offset: zero + drive.speed * time,
                offsetUserFunction_t=lambda _mbs, _time, _item, _offset: drive.speed,
            )
        )

    def _add_loads(self) -> None:
        for load in self.scene.loads:
            self.mbs.AddLoad(self._items.Force(markerNumber=self._at(load.body, load.at), loadVector=[*load.force, 0]))
        if self.scene.gravity is not None:
            for name in self.bodies:
                mass = self.mbs.AddMarker(self._items.MarkerBodyMass(bodyNumber=self._objects[name]))
                self.mbs.AddLoad(self._items.Gravity(markerNumber=mass, loadVector=[*self.scene.gravity, 0]))

"""The scene: everything the models share about a mechanism, in SI, and nothing they could share by mistake.

A scene holds what was written in its file: lengths, points, masses, joints by shared point names. It has no pose, no
branch solver and no derived lengths or inertias; each model works those out by its own means, because a mistake shared
by two models is one the comparison cannot see.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import pi

from .drive import ConstantSpeed, Drive, MotionLaw
from .loads import Force, ForceTable, Load, PressForce, Spring, Vector
from .variations import Variation

__all__ = [
    "GROUND",
    "Body",
    "ConstantSpeed",
    "Drive",
    "Force",
    "ForceTable",
    "Load",
    "MotionLaw",
    "Pin",
    "PressForce",
    "Scene",
    "Sketch",
    "Slide",
    "Spring",
    "Variation",
    "Vector",
]

GROUND = "ground"
SI = {"length": ("m", 1.0), "mass": ("kg", 1.0), "force": ("N", 1.0), "angle": ("rad", 1.0), "speed": ("rad/s", 1.0)}


@dataclass(frozen=True)
class Slide:
    """A straight guide in the frame of the body `on`, which may be the ground.

    The sliding body's first point moves along the line, and its frame stays parallel to that of `on`.
    """

    on: str
    through: Vector  # a point of the line, m
    along: Vector  # unit vector
    drawn: float = 1.0  # how long `along` is in the file


@dataclass(frozen=True)
class Body:
    """A rigid body, its points given either in its own frame (`local`) or by their distances (`lengths`).

    The frame of a body given by lengths has its origin at the first point and x towards the second; every further
    point is given by its distances from two earlier ones, and lies on the side of their line where the sketch shows it.
    Unless both `com` and `inertia` are given, it is uniform between its corners: one is a point mass, two are the ends
    of a bar, three the corners of a triangular plate; see `scenes.corners`.
    """

    name: str
    points: tuple[str, ...]
    local: Mapping[str, Vector] | None  # m, body frame
    lengths: Mapping[frozenset[str], float] | None  # m, by pair of points
    corners: tuple[str, ...]  # which points span it, where it is uniform
    mass: float | None  # kg; None in a kinematic scene
    com: Vector | None  # m, body frame
    inertia: float | None  # kg m^2, about the centre of mass
    slide: Slide | None

    def bases(self, point: str) -> tuple[str, ...]:
        """Return the earlier points from which a point of a body given by lengths has a distance: two, or fewer."""
        return self._bases.get(point, ())

    @cached_property
    def _bases(self) -> Mapping[str, tuple[str, ...]]:
        order = {point: number for number, point in enumerate(self.points)}
        pairs = sorted(sorted(map(order.__getitem__, pair)) for pair in self.lengths or ())
        found: dict[str, tuple[str, ...]] = {}
        for earlier, *later in pairs:
            for number in later:
                point = self.points[number]
                found[point] = (*found.get(point, ()), self.points[earlier])
        return found


@dataclass(frozen=True)
class Sketch:
    """Rough positions of the moving points at one position of the drive; they pick the branch and nothing else."""

    drive: float  # rad of a crank, m of a driven slider
    points: Mapping[str, Vector]  # m


@dataclass(frozen=True)
class Pin:
    """A pin between two bodies at a point they both name; `first` comes first in the file, the ground before all."""

    point: str
    first: str
    second: str
    channel: str  # its channels are `<channel>.fx`, `<channel>.fy`: the force of `first` on `second`


@dataclass(frozen=True)
class Scene:
    """One mechanism. Built by `scenes.load`; SI units throughout."""

    name: str
    title: str
    source: str
    file: str  # where it was read from, for messages
    ground: Mapping[str, Vector]  # m
    bodies: Mapping[str, Body]  # the moving bodies, in file order
    drive: Drive
    loads: tuple[Load, ...]
    springs: tuple[Spring, ...]
    gravity: Vector | None  # m/s^2
    sketch: Sketch
    output: str  # the point that the report is about
    tolerances: Mapping[str, Mapping[str, float]]  # engine -> channel group -> largest relative error
    units: Mapping[str, tuple[str, float]] = field(default_factory=lambda: SI)  # of the file: name, and size in SI
    variations: tuple[Variation, ...] = ()  # what the workshop may deviate, in the units of the file

    def __hash__(self) -> int:
        """Return the hash of its name: what an engine finds once a scene is known by the scene."""
        return hash((self.name, self.file))

    @property
    def has_masses(self) -> bool:
        """Whether forces are asked for; a scene without masses is kinematic."""
        return all(body.mass is not None for body in self.bodies.values())

    @cached_property
    def owners(self) -> Mapping[str, tuple[str, ...]]:
        """The bodies that name each point, in file order, the ground first."""
        named = {GROUND: tuple(self.ground)} | {name: body.points for name, body in self.bodies.items()}
        owners: dict[str, list[str]] = {}
        for body, points in named.items():
            for point in points:
                owners.setdefault(point, []).append(body)
        return {point: tuple(bodies) for point, bodies in owners.items()}

    @cached_property
    def pins(self) -> tuple[Pin, ...]:
        """Every pin: at each point the first body that names it, with each of the others."""
        return tuple(
            Pin(point, owners[0], other, point if number == 0 else f"{point}/{other}")
            for point, owners in self.owners.items()
            for number, other in enumerate(owners[1:])
        )

    @cached_property
    def aligned(self) -> Mapping[str, frozenset[str]]:
        """For each body and the ground: those whose frames slides keep parallel to its own, itself included."""
        groups = {name: frozenset((name,)) for name in (GROUND, *self.bodies)}
        for body in self.bodies.values():
            if body.slide is not None:
                joined = groups[body.name] | groups[body.slide.on]
                groups |= dict.fromkeys(joined, joined)
        return groups

    @cached_property
    def turning(self) -> tuple[str, ...]:
        """The bodies that can turn: all but those that slides keep parallel to the ground."""
        return tuple(name for name in self.bodies if name not in self.aligned[GROUND])

    @property
    def driven_slide(self) -> Slide | None:
        """The guide of the driven body; None where that is a crank."""
        return self.bodies[self.drive.body].slide

    def guided(self, point: str) -> tuple[str, Slide] | None:
        """Return the body at a point that slides on the ground, and its guide; None where none does."""
        for name in self.owners[point]:
            slide = None if name == GROUND else self.bodies[name].slide
            if slide is not None and slide.on == GROUND:
                return name, slide
        return None

    @property
    def drive_channel(self) -> str:
        """The channel of the drive's position: `crank_angle`, or `drive.displacement` of a driven slider."""
        return "crank_angle" if self.driven_slide is None else "drive.displacement"

    @property
    def length_unit(self) -> tuple[str, float]:
        """The unit of length of the file: its name, and what it is in m."""
        return self.units["length"]

    def length(self, metres: float, digits: int = 4) -> str:
        """Return a length in the unit of the file, as messages name it: `12.41 mm`."""
        return self.amount("length", metres, digits)

    def amount(self, quantity: str, value: float, digits: int = 4) -> str:
        """Return a length, mass, force, angle or speed, SI, in the unit of the file, as messages name it."""
        unit, size = self.units[quantity]
        return f"{value / size:.{digits}g} {unit}"

    def position(self, position: float) -> str:
        """Return a position of the drive, rad or m, in the unit of the file: `30.0000 deg`, `560 mm`."""
        if self.driven_slide is not None:
            return self.length(position, 6)
        unit, size = self.units["angle"]
        return f"{position / size:z.{4 if size <= pi / 180 else 6}f} {unit}"

    def between(self, ends: tuple[float, float]) -> str:
        """Return a range of positions of the drive, rad or m, in the unit of the file."""
        return " to ".join(map(self.position, ends))

    def where(self, position: float) -> str:
        """Return what messages call a position of the drive, rad or m: `crank angle 30.0000 deg`, `table at 560 mm`."""
        name = "crank angle" if self.driven_slide is None else f"{self.drive.body} at"
        return f"{name} {self.position(position)}"

    @cached_property
    def moving_points(self) -> tuple[str, ...]:
        """The points that are not on the ground."""
        return tuple(point for point, owners in self.owners.items() if owners[0] != GROUND)

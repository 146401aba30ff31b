"""The scene: everything the models share about a mechanism, in SI, and nothing they could share by mistake.

A scene says what was written in its file: lengths, points, masses, joints by shared point names. It has no pose, no
branch solver and no derived lengths or inertias; each model works those out by its own means, because a mistake shared
by two models is one the comparison cannot see.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

Vector: TypeAlias = tuple[float, float]

GROUND = "ground"


@dataclass(frozen=True)
class Slide:
    """A straight guide on the ground: the body's first point moves along the line, and the body does not turn."""

    through: Vector  # a point of the line, m
    along: Vector  # unit vector


@dataclass(frozen=True)
class Body:
    """A rigid body, its points given either in its own frame (`local`) or by their distances (`lengths`).

    The frame of a body given by lengths has its origin at the first point and x towards the second; a third point
    lies on the side where the sketch shows it. Unless both `com` and `inertia` are given, one point is a point mass,
    two are a uniform bar, three are a uniform triangular plate. The frame of a body that slides stays parallel to the
    ground's.
    """

    name: str
    points: tuple[str, ...]
    local: Mapping[str, Vector] | None  # m, body frame
    lengths: Mapping[frozenset[str], float] | None  # m, by pair of points
    mass: float | None  # kg; None in a kinematic scene
    com: Vector | None  # m, body frame
    inertia: float | None  # kg m^2, about the centre of mass
    slide: Slide | None


@dataclass(frozen=True)
class Drive:
    """The crank: a body pinned to the ground that turns at constant speed, at angle `start` when time is zero."""

    body: str
    speed: float  # rad/s, positive counter-clockwise, never zero
    start: float  # rad, of the body's x axis


@dataclass(frozen=True)
class Load:
    """A constant force on a point of a body."""

    body: str
    at: str
    force: Vector  # N, ground frame


@dataclass(frozen=True)
class Sketch:
    """Rough positions of the moving points at one crank angle; they pick the assembly branch and nothing else."""

    angle: float  # rad
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
    gravity: Vector | None  # m/s^2
    sketch: Sketch
    output: str  # the point that the report is about
    tolerances: Mapping[str, Mapping[str, float]]  # engine -> channel group -> largest relative error

    @property
    def has_masses(self) -> bool:
        """Whether forces are asked for; a scene without masses is kinematic."""
        return all(body.mass is not None for body in self.bodies.values())

    @cached_property
    def owners(self) -> Mapping[str, tuple[str, ...]]:
        """The bodies that name each point, in file order, the ground first."""
        named = {GROUND: tuple(self.ground)} | {name: body.points for name, body in self.bodies.items()}
        points = dict.fromkeys(point for body_points in named.values() for point in body_points)
        return {point: tuple(body for body in named if point in named[body]) for point in points}

    @cached_property
    def pins(self) -> tuple[Pin, ...]:
        """Every pin: at each point the first body that names it, with each of the others."""
        return tuple(
            Pin(point, owners[0], other, point if number == 0 else f"{point}/{other}")
            for point, owners in self.owners.items()
            for number, other in enumerate(owners[1:])
        )

    @property
    def moving_points(self) -> tuple[str, ...]:
        """The points that are not on the ground."""
        return tuple(point for point, owners in self.owners.items() if owners[0] != GROUND)

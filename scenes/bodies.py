"""Rigid bodies, and the guides on which they slide."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import hypot, isfinite
from types import MappingProxyType
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from .corners import corners, on_one_line
from .errors import InputError
from .fields import Direction, FileTable, Inertia, Known, Length, Mass, Name, Place, PointPair

GROUND = "ground"
ROUNDING = 1e-15  # of a unit vector's length


@dataclass(frozen=True)
class Slide:
    """A straight guide in the frame of the body `on`, which may be the ground.

    The sliding body's first point moves along the line, and its frame stays parallel to that of `on`.
    """

    on: str
    through: Place  # a point of the line, m
    along: Direction  # unit vector, whatever the length of what it is made of
    drawn: float = 1.0  # how long `along` is in the file

    def __post_init__(self) -> None:
        """Make a unit vector of a direction, and keep its length."""
        x, y = self.along
        plain = isinstance(x, float | int) and isinstance(y, float | int)
        norm: Any = hypot(x, y) if plain else np.hypot(x, y)
        if plain and abs(norm - 1) <= ROUNDING:
            return
        if not plain or (norm > 0 and isfinite(1 / norm)):
            object.__setattr__(self, "along", (x * (1 / norm), y * (1 / norm)))
        object.__setattr__(self, "drawn", self.drawn * norm)


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
    local: Mapping[str, Place] | None = field(metadata={"path": "points"})  # m, body frame
    lengths: Mapping[frozenset[str], Length] | None  # m, by pair of points
    corners: tuple[str, ...]  # which points span it, where it is uniform
    mass: Mass | None  # kg; None in a kinematic scene
    com: Place | None  # m, body frame
    inertia: Inertia | None  # kg m^2, about the centre of mass
    slide: Slide | None = field(metadata={"path": "slides"})

    def bases(self, point: str) -> tuple[str, ...]:
        """The earlier points from which a point of a body given by lengths has a distance: two, or fewer."""
        return self._bases.get(point, ())

    @cached_property
    def _bases(self) -> Mapping[str, tuple[str, ...]]:
        bases: dict[str, tuple[str, ...]] = {}
        for pair in sorted(sorted(map(self.points.index, pair)) for pair in self.lengths or ()):
            earlier, *later = (self.points[number] for number in pair)
            bases |= {point: (*bases.get(point, ()), earlier) for point in later}
        return bases


class SlideTable(FileTable):
    """A straight guide, along which the body's first point moves; the body does not turn against what it slides on."""

    on: Known = Field(GROUND, description="The body that has the guide.")
    through: Place = Field(description="A point of the guide, in the frame of what has it.")
    along: Direction = Field(description="The direction of the guide, in the frame of what has it; of any length.")


class BodyTable(FileTable):
    """A rigid body: its points in its own frame, or its lengths."""

    points: Annotated[dict[Name, Place], Field(min_length=1)] | None = Field(
        None, description="By name: [x, y] in its own frame. A point that two bodies name is a pin."
    )
    lengths: Annotated[dict[PointPair, Length], Field(min_length=1)] | None = Field(
        None,
        description='Instead of `points`, as "A-B" = 200; each point after the second needs those to two before it.',
    )
    mass: Mass | None = Field(None, description="Its mass; without any in the file there are no forces.")
    com: Place | None = Field(
        None,
        description="Its centre of mass, own frame; not of a point, a uniform bar (points on one line too) or plate.",
    )
    inertia: Inertia | None = Field(None, description="Its moment of inertia about the centre of mass.")
    slides: SlideTable | None = Field(None, description="The guide on which it slides, if any.")

    def body(self, name: str) -> Body:
        """The body of this name, its numbers as they are; InputError where the keys do not go together."""
        if (self.points is None) == (self.lengths is None):
            raise InputError(f"bodies.{name}: expected either 'points' or 'lengths'")
        if (self.com is None) != (self.inertia is None):
            raise InputError(f"bodies.{name}: expected both 'com' and 'inertia', or neither")
        local, lengths = self.points, None
        if self.lengths is not None:
            lengths = {frozenset(pair.split("-")): length for pair, length in self.lengths.items()}
            if len(lengths) != len(self.lengths):
                raise InputError(f"bodies.{name}.lengths: a distance is given twice")
        names = tuple(local or dict.fromkeys(point for pair in self.lengths or () for point in pair.split("-")))
        if lengths and (on_line := on_one_line(names, lengths)):
            local, lengths = on_line, None  # which no triangles give: it is a matter of the last places
        given = local and MappingProxyType(local), lengths and MappingProxyType(lengths), corners(names, local, lengths)
        slide = None if self.slides is None else Slide(self.slides.on, self.slides.through, self.slides.along)
        return Body(name, names, *given, self.mass, self.com, self.inertia, slide)

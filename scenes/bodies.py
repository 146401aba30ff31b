"""Rigid bodies, and the guides on which they slide.

Where no centre of mass and inertia are given, a body is taken for the uniform one that some of its points span.
One point is a point mass, two are the ends of a bar, three the corners of a triangular plate; points on one line,
however many, are on a bar between the outermost two. Which of these a body is follows here from its numbers as drawn;
centre and inertia each model works out by itself. Those of a body as drawn, by its outline, or its width as a bar, are
input of the scene; see `outline`.

The inertia of a plate does not tend to that of a bar as the plate gets flatter: with a third corner in the middle it is
half of it. So there is a limit between the two, a height of 1e-3 of the longest side. General tolerances of places (ISO
2768-1, medium: 0.3 mm on 120 to 400 mm) leave the pins of a straight lever below it, so that machines drawn from a
lever's tolerances are bars as well; nobody cuts a plate so flat, and doubles leave far less of a height.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property, partial
from math import hypot, inf, isfinite
from types import MappingProxyType
from typing import Annotated, Any, TypeAlias

import numpy as np
from pydantic import Field, Strict

from .errors import InputError
from .fields import Density, Direction, FileTable, Inertia, Known, Length, Mass, Name, Place, PointPair
from .limits import CORNERS, POINTS
from .outline import of_bar, of_plate

Places: TypeAlias = Mapping[str, tuple[Any, Any]]  # m; numbers, or arrays of one shape
Lengths: TypeAlias = Mapping[frozenset[str], Any]  # m, of pairs of points; likewise

GROUND = "ground"
ROUNDING = 1e-15  # of a unit vector's length
LINE = 1e-3  # of the longest side: at most so high is a triangle whose corners are on one line
CLOSED = 1e-12  # of two lengths: what their sum is off a third one by rounding, where the points are on one line


def corners(points: Sequence[str], local: Places | None, lengths: Lengths | None) -> tuple[str, ...]:
    """The points that span a uniform body: all, or of three and more on one line the outermost two."""
    # By lengths, without places, no more than three points are on one line here.
    if len(points) < 3 or (local is None and len(points) > 3):
        return tuple(points)
    # Of points on one line, the one farthest from any of them is an end, and the one farthest from that end is the
    # other end. Of points that are not on one line the heights over these two show it.
    end = max(points, key=partial(_length, local, lengths, points[0]))
    other = max((point for point in points if point != end), key=partial(_length, local, lengths, end))
    ends = tuple(point for point in points if point in (end, other))
    return ends if all(height <= LINE for height in heights(ends, points, local, lengths)) else tuple(points)


def heights(
    corners: Sequence[str], points: Sequence[str], local: Places | None, lengths: Lengths | None
) -> Iterator[Any]:
    """Yield how high the triangles of two corners and another point are over their longest side, as a share of it."""
    p, q, *_ = corners
    for r in points:
        if r not in (p, q):
            sides = np.broadcast_arrays(*(_length(local, lengths, *ends) for ends in ((p, q), (q, r), (r, p))))
            with np.errstate(all="ignore"):  # of numbers that no file may have
                a, b, c = sides / np.maximum.reduce(sides)
                # Heron's formula with the longest side as the unit: the square root of the product is four times the
                # area, and the height over a side of length one is twice the area. Of a flat triangle the product loses
                # half of its digits, which is a noise of 1e-8 of the side, far below the limit of 1e-3; sides that
                # cannot close give a negative product, taken for zero.
                heron = (a + b + c) * (a + b - c) * (a - b + c) * (b + c - a)
                yield np.sqrt(np.maximum(heron, 0)) / 2


def on_one_line(points: Sequence[str], lengths: Lengths) -> dict[str, tuple[float, float]]:
    """Where points are, m, whose lengths close on one line alone: on x, which goes from the first to the second.

    Each point after the second has lengths to two before it. Nothing where there are not three points, all on the line.
    """
    if not 2 < len(points) <= POINTS:
        return {}
    first, second, *others = points
    places = {first: 0.0, second: lengths.get(frozenset((first, second)), inf)}
    for point in others:
        bases = [(x, lengths[pair]) for p, x in places.items() if (pair := frozenset((p, point))) in lengths]
        if len(bases) != 2:
            return {}
        (x, a), (y, b) = bases
        # A point at the distance a from x and b from y is at x - a or x + a. That with the smaller misfit of b is on
        # the line, if any is. As a triangle such a point has a height of the square root of a rounding, 1e-8 of its
        # sides, on either side.
        off, place = min((abs(abs(place - y) - b), place) for place in (x - a, x + a))
        if not off <= CLOSED * (a + b):
            return {}
        places[point] = place
    return {point: (place, 0.0) for point, place in places.items()}


def _length(local: Places | None, lengths: Lengths | None, p: str, q: str) -> Any:
    """The distance of two points, m; infinite where it is not known."""
    if local is None:
        return 0.0 if p == q else (lengths or {}).get(frozenset((p, q)), inf)
    (x, y), (u, v) = local[p], local[q]
    return np.hypot(x - u, y - v)


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
        # A direction that is a unit vector already is kept to the last bit, so that a body may be copied again and
        # again. One of no length, or of so little that its inverse is infinite, is left as it is, for the check of
        # sizes to refuse.
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
    of a bar, three the corners of a triangular plate; see above.
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

    @cached_property
    def bases(self) -> Mapping[str, tuple[str, ...]]:
        """The earlier points from which each point of a body given by lengths has a distance: two, or fewer."""
        bases: dict[str, tuple[str, ...]] = dict.fromkeys(self.points, ())
        for pair in sorted(sorted(map(self.points.index, pair)) for pair in self.lengths or ()):
            earlier, *later = (self.points[number] for number in pair)
            bases |= {point: (*bases[point], earlier) for point in later}
        return bases

    @property
    def heights(self) -> Sequence[Any]:
        """How high the triangles of its first two corners and each other point are, over their longest side."""
        return [*heights(self.corners, self.points, self.local, self.lengths)]

    @property
    def weighed(self) -> "Body":
        """The same body with numbers of its own for mass, centre of mass and inertia, however it was drawn."""
        return Body(**{own.name: getattr(self, own.name) for own in fields(Body)})


@dataclass(frozen=True)
class DrawnBody(Body):
    """A body by its outline, in either sense, or a bar that ends at its two corners; also with other numbers put."""

    mass: float = field(init=False)
    com: tuple[float, float] = field(init=False)
    inertia: float = field(init=False)
    outline: tuple[Place, ...]  # m, body frame; of a bar none
    width: Length | None  # m, of a bar
    thickness: Length  # m
    density: Density  # kg/m^3

    def __post_init__(self) -> None:
        """Weigh it."""
        density = self.density * self.thickness
        if self.width is None:
            weight = of_plate(self.outline, density)
        else:
            first, second = self.corners
            at = self.local or {first: (0, 0), second: (_length(None, self.lengths, first, second), 0)}
            weight = of_bar(at[first], at[second], self.width, density)
        for name, value in zip(("mass", "com", "inertia"), weight, strict=True):
            object.__setattr__(self, name, value)


class SlideTable(FileTable):
    """A straight guide, along which the body's first point moves; the body does not turn against what it slides on."""

    on: Known = Field(GROUND, description="The body that has the guide.")
    through: Place = Field(description="A point of the guide, in the frame of what has it.")
    along: Direction = Field(description="The direction of the guide, in the frame of what has it; of any length.")


class BodyTable(FileTable):
    """A rigid body: its points in its own frame, or its lengths.

    With a mass alone it is uniform: a point mass, a bar, or a plate of three points. Points on one line are a bar, to a
    height of 1e-3 of the longest side.
    """

    points: Annotated[dict[Name, Place], Field(min_length=1)] | None = Field(
        None,
        description="By name: [x, y] in its own frame. A point that two bodies name is a pin.",
        examples=[{"A": [0, 0], "B": [100, 0]}],
    )
    lengths: Annotated[dict[PointPair, Length], Field(min_length=1)] | None = Field(
        None,
        description='Instead of `points`, as "A-B" = 200; each point after the second needs those to two before it.',
        examples=[{"A-B": 200}],
    )
    mass: Mass | None = Field(None, description="Its mass; without any in the file there are no forces.")
    com: Place | None = Field(
        None,
        description="Its centre of mass, own frame; not of a point, a uniform bar or plate.",
    )
    inertia: Inertia | None = Field(None, description="Its moment of inertia about the centre of mass.")
    outline: Annotated[tuple[Place, ...], Strict(False), Field(min_length=3, max_length=CORNERS)] | None = Field(
        None, description="As drawn, instead of `mass`, `com` and `inertia`: its corners [x, y] in its own frame."
    )
    width: Length | None = Field(
        None, description="Instead of `outline`, of two points or `points` on one line: a bar that ends at these."
    )
    thickness: Length | None = Field(None, description="With `outline` or `width`.")
    density: Density | None = Field(None, description="With `outline` or `width`: in kg/m^3, whatever the units.")
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
        keys = ("outline", "width", "thickness", "density", "mass", "com", "inertia")
        found = [key for key in keys if getattr(self, key) is not None]
        if not {*found} & {*keys[:4]}:
            return Body(name, names, *given, self.mass, self.com, self.inertia, slide)
        if found[1:] != ["thickness", "density"]:
            expected = "expected 'thickness' and 'density' with one of 'outline' and 'width', instead of 'mass'"
            raise InputError(f"bodies.{name}: {expected}, found {', '.join(map(repr, found))}")
        if self.width is not None and (len(given[-1]) != 2 or (lengths and len(names) > 2)):
            raise InputError(f"bodies.{name}.width: expected a body of two points, or of 'points' on one line")
        material: Any = self.thickness, self.density
        return DrawnBody(name, names, *given, slide, self.outline or (), self.width, *material)

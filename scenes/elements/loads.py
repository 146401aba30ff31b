"""Loads: forces on points of bodies, and moments, as functions of where those are. They are the scene's input.

What a load depends on, a slider's displacement and velocity or the drive's position, each model finds by its own means.
A slider's displacement is that of its body's first point along its guide from `through`, in the frame of the guide.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..bodies import Slide
from ..demand import Demand, of_size
from ..fields import Direction, ForceVector, Length, NewtonMetres, Newtons
from .element import Element, End
from .tables import LoadCurve

if TYPE_CHECKING:
    from ..scene import Scene

Frame: TypeAlias = Literal["ground", "body"]


class Framed:
    """What is given in the frame of the ground, unless a subclass is in that of its body."""

    frame: Frame = "ground"


@dataclass(frozen=True)
class Load(Element, Framed):
    """A force on a point of a body, or a moment."""

    body_key = "body"
    point_key = "at"
    is_moment: ClassVar[bool] = False

    body: str
    at: str

    @property
    def turned(self) -> "Load | None":
        """The same numbers in the other frame, that of the body or of the ground; None of one without frames."""
        return None

    @property
    def always(self) -> "Load":
        """The same load where nothing switches it off."""
        return self

    def largest_along(self, slide: Slide) -> Any:  # noqa: ARG002
        """Its largest part along a guide on the ground, N."""
        return 0.0

    @property
    def ends(self) -> tuple[End]:
        """The body and its point."""
        return ((self.body, self.at),)

    @property
    def named(self) -> str:
        """What a sentence calls it, with a gap for its spot."""
        return "the load at {place}"

    def bodies(self, scene: "Scene") -> frozenset[str]:
        """Its body, and what that slides on."""
        slide = scene.slides.get(self.body)
        return frozenset((self.body,) if slide is None else (self.body, slide.on))

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield what of its names does not fit the scene, and what of its table."""
        if self.table is not None:
            yield from self.table.problems(scene, f"{place}.table")
        yield from super().problems(scene, place)


@dataclass(frozen=True)
class Force(Load):
    """A constant force."""

    kind = "forces"
    plain = True
    steady = True

    force: ForceVector  # N

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """Its larger part."""
        return float(np.abs(self.force).max())

    @property
    def turned(self) -> "Force":
        """The same numbers in the frame of its body."""
        return TurningForce(self.body, self.at, self.force)

    def largest_along(self, slide: Slide) -> Any:
        """Its part along the guide."""
        return push(self.force, slide)


@dataclass(frozen=True)
class TurningForce(Force):
    """A constant force in the frame of its body, with which it turns."""

    kind = "forces that turn with their body"
    plain = False
    frame = "body"

    @property
    def turned(self) -> Force:
        """The same numbers in the frame of the ground."""
        return Force(self.body, self.at, self.force)


@dataclass(frozen=True)
class PressForce(Load):
    """A constant force that resists a slider in the last part of its closing stroke, and only there.

    The slider closes while it moves against the force. Its stroke ends where a cycle of the drive takes it furthest
    against the force; from `last` before that end it meets the force, and on the way back it does not.
    """

    kind = "press forces"
    plain = True

    force: ForceVector  # N, ground frame; its body slides on the ground
    last: Length  # m
    closing: int  # the sign of the displacement's rate while the slider closes

    def acts(self, displacement: Any, velocity: Any, end: float) -> NDArray[np.bool_]:
        """Where the force acts: displacements, m, velocities, m/s, of one shape; the stroke ends at `end`, m."""
        before_end = (end - displacement) * self.closing
        acts: NDArray[np.bool_] = (before_end <= self.last) & (velocity * self.closing > 0)
        return acts

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """Its larger part."""
        return float(np.abs(self.force).max())

    @property
    def always(self) -> Force:
        """A constant force."""
        return Force(self.body, self.at, self.force)

    def largest_along(self, slide: Slide) -> Any:
        """Its part along the guide."""
        return push(self.force, slide)

    def settled(self, scene: "Scene") -> "PressForce":
        """The force with the sense of closing that its numbers now have."""
        return replace(self, closing=closing_sense(self.force, scene.slides[self.body]))

    def demands(self, scene: "Scene", place: str) -> Iterator[Demand]:
        """Yield the demand of a part along the guide."""
        if slide := scene.bodies[self.body].slide:
            text = f"{place}.force: expected a part along the guide, which the slider closes against, found {{:g}}"
            yield Demand(text, (part := push(self.force, slide)) != 0, (part,))


def push(force: tuple[Any, Any], slide: Slide) -> Any:
    """The part of a force along a guide."""
    return force[0] * slide.along[0] + force[1] * slide.along[1]


def closing_sense(force: tuple[Any, Any], slide: Slide) -> Any:
    """The sign of the rate of a slider's displacement while it closes against a force; of many machines an array."""
    against = push(force, slide) > 0
    return np.where(against, -1, 1) if np.ndim(against) else -1 if against else 1


@dataclass(frozen=True)
class GuideForce(Load):
    """A force along the guide of a sliding body, whose reaction acts on what has the guide, at the same place."""

    kind = "forces along guides"

    force: Newtons | None = None  # N, along `along`; or a table
    table: LoadCurve | None = None

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """The largest entry of its table, or its own size."""
        return float(np.abs(self.table.values if self.table else self.force or 0.0).max())

    def largest_along(self, slide: Slide) -> Any:  # noqa: ARG002
        """Its largest size."""
        return self.table.largest if self.table else self.force


@dataclass(frozen=True)
class ForceTable(GuideForce):
    """A force along a guide on the ground, by a table against the displacement, constant beyond it."""

    kind = "force tables"
    plain = True


@dataclass(frozen=True)
class TableForce(Load):
    """A force of one direction whose size follows a table; in its body's frame it turns with the body."""

    kind = "forces by tables"

    along: Direction  # of any length
    table: LoadCurve
    frame: Frame = "ground"

    @property
    def turned(self) -> "TableForce":
        """The same numbers in the other frame."""
        return replace(self, frame="body" if self.frame == "ground" else "ground")

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """The largest entry of its table."""
        return float(np.abs(self.table.values).max())

    def largest_along(self, slide: Slide) -> Any:
        """Its largest part."""
        return push(self.direction, slide) * self.table.largest

    def demands(self, scene: "Scene", place: str) -> Iterator[Demand]:
        """Yield the demands on the length of its direction and on its table."""
        yield of_size(f"{place}.along: expected a direction of a size", np.hypot(*self.along))
        yield from super().demands(scene, place)

    @property
    def direction(self) -> tuple[Any, Any]:
        """The unit vector along it."""
        x, y = self.along
        length = np.sqrt(x * x + y * y)
        return x / length, y / length


@dataclass(frozen=True)
class Moment(Load):
    """A moment on a body, counter-clockwise positive, constant or by a table.

    It turns the body alike wherever it acts, and is drawn at its point.
    """

    kind = "moments"
    is_moment = True

    moment: NewtonMetres | None = None  # N m; or a table
    table: LoadCurve | None = None

    @property
    def spot(self) -> str:
        """Its body, which all of it turns."""
        return self.body

    @property
    def named(self) -> str:
        """What a sentence calls it, with a gap for its spot."""
        return "the moment on {place}"

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002
        """The force, N, that has the moment on an arm as long as the linkage."""
        return float(np.abs(self.table.values if self.table else self.moment or 0.0).max()) / size


TabledLoad: TypeAlias = GuideForce | TableForce | Moment  # whose size may be by a table

"""What every kind of load, spring and friction knows of itself, and its table in a scene file."""

from abc import abstractmethod
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

from ..bodies import GROUND, Body
from ..demand import Demand
from ..errors import nearest
from ..fields import FileTable
from .tables import LoadCurve

if TYPE_CHECKING:
    from ..scene import Scene

End: TypeAlias = tuple[str, str]  # a body, or the ground, and a point of it


class Element:
    """Something that acts on the bodies besides their weight; a frozen dataclass, whose numbers have quantities.

    Models find by its type what it does. Here is what they need not agree on: names, and which numbers fit together.
    """

    kind: ClassVar[str]  # what it is, as an engine names what it knows: "it knows no ..."
    plain: ClassVar[bool] = False  # whether an engine knows it that does not tell which kinds it knows
    steady: ClassVar[bool] = False  # whether it is the same at all times, but for how its body is turned
    by_joints: ClassVar[bool] = False  # whether it follows from what the joints carry, as friction does
    body_key: ClassVar[str] = "between"  # of its table, that names its bodies
    point_key: ClassVar[str] = "between"  # and its points
    noun: ClassVar[str] = "load"  # what sentences call it
    table: LoadCurve | None = None  # that its size follows, if any

    @property
    @abstractmethod
    def ends(self) -> tuple[End, ...]:
        """Where it acts: one end on a body, or two, either of which may be on the ground."""

    @property
    def needs_direction(self) -> bool:
        """Whether it has no force where its two ends meet."""
        return False

    @property
    def spot(self) -> str:
        """A name of where it acts, as sentences have it."""
        return "-".join(dict.fromkeys(point for _, point in self.ends))

    @property
    def named(self) -> str:
        """What a sentence calls it, with a gap for its spot."""
        return f"the {self.noun} {{place}}"

    @property
    def label(self) -> str:
        """Its name among all that acts."""
        return self.named.format(place=self.spot)

    @property
    def least_above_zero(self) -> Mapping[str, str]:
        """By number that cannot be zero, though its quantity may, what the element lacks where it is."""
        return {}

    def bodies(self, _: "Scene") -> frozenset[str]:
        """The bodies whose motion it depends on, or on which it acts, the ground among them."""
        return frozenset(body for body, _ in self.ends)

    def strength(self, size: float, rate: float) -> float:  # noqa: ARG002 - of those that depend on them
        """About its largest force, N, in a linkage of a size, m, that moves at a rate, rad/s."""
        return 0.0

    def settled(self, _: "Scene") -> "Element":
        """The element with what follows from its own and others' numbers, where these have changed."""
        return self

    def problems(self, scene: "Scene", place: str) -> Iterator[str]:
        """Yield what of its names does not fit the scene; `place` is its own in the file."""
        known = scene.bodies if len(self.ends) == 1 else (GROUND, *scene.bodies)
        for body, point in self.ends:
            if body not in known:
                yield f"{place}.{self.body_key}: no body '{body}'{nearest(body, known)}"
            points = scene.ground if body == GROUND else scene.bodies[body].points
            if point not in points:
                yield f"{place}.{self.point_key}: '{body}' has no point '{point}'{nearest(point, points)}"
        if len(self.ends) > len({body for body, _ in self.ends}):
            yield f"{place}.between: expected two bodies, found '{self.ends[0][0]}' twice"

    def demands(self, scene: "Scene", place: str) -> Iterator[Demand]:
        """Yield what its numbers have to be together; `place` is its own in the file."""
        if self.table is not None:
            yield from self.table.demands(scene, f"{place}.table")


class ElementTable(FileTable):
    """A table of a list in a scene file; each of its subclasses is found by being one, and has its list by `key`."""

    key: ClassVar[str]  # of the list in the file, and of its elements in a scene
    about: ClassVar[str]  # what the list is, for the reference
    kinds: ClassVar[tuple[type[Element], ...]]  # what its tables may become
    rank: ClassVar[int] = 9  # of the list among all, and of its numbers: those of the first files come first
    zeros: ClassVar[tuple[str, ...]] = ()  # keys that are zero where they may be left out

    @abstractmethod
    def element(self, place: str, bodies: Mapping[str, Body]) -> Any:
        """What the table describes, its numbers as they are; InputError where its keys do not go together."""

"""What the fields of a scene, and of the tables of its file, may hold: names, and numbers of some quantity.

A quantity is declared once, in the type of its fields, as `mass: Mass`. In a table pydantic holds numbers to its sign;
`walk` finds it in the annotations of the scene, for whatever else asks what the numbers of a scene are.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any, NamedTuple, TypeAlias, get_args, get_origin, get_type_hints

from annotated_types import Ge, GroupedMetadata, Gt
from pydantic import AllowInfNan, BaseModel, ConfigDict, Strict, StringConstraints

from . import limits

NAME = r"^[A-Za-z][A-Za-z0-9_]*$"
ENGINE = r"[A-Za-z0-9][A-Za-z0-9_.-]{0,39}"  # it is part of file names, and of lists with commas
_PAIR, _POINT = (rf"{NAME[:-1]}{between}{NAME[1:]}" for between in ("-", r"\."))
_ENGINE = rf"^{ENGINE}(@[A-Za-z0-9_.-]+)?$"
_TWO = 2 * limits.NAME + 1  # characters of two names and what joins them
PATTERNS = {
    NAME: "letters, digits and '_', starting with a letter",
    _PAIR: "two point names joined by '-', as \"A-B\"",
    _POINT: "a point of a body, as 'body.point'",
    _ENGINE: "an engine's, of letters, digits, '_', '.' and '-'",
}
Name = Annotated[str, StringConstraints(pattern=NAME, max_length=limits.NAME)]
EngineName = Annotated[str, StringConstraints(pattern=_ENGINE, max_length=_TWO)]
Known = Annotated[str, StringConstraints(max_length=limits.NAME)]  # a name that is looked up
PointPair = Annotated[str, StringConstraints(pattern=_PAIR, max_length=_TWO)]
BodyPoint = Annotated[str, StringConstraints(pattern=_POINT, max_length=_TWO)]


class FileTable(BaseModel):
    """A TOML table: no unknown keys, no silent conversion of types."""

    # A file's tables are built together when the first one is read, not each by itself on import.
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, defer_build=True)


@dataclass(frozen=True)
class Quantity(GroupedMetadata):
    """A kind of number: of what dimension, sign and size it is."""

    dimension: str  # by which `Scene.all_units` has its unit
    smallest: float = 0.0  # SI, of what is not zero; products of such numbers stay far within what a double holds
    largest: float = 1e15
    negative: bool = True  # whether it may be
    zero: bool = True

    def __iter__(self) -> Iterator[object]:
        """Yield what pydantic is to hold a number of a table to."""
        yield from (Strict(), AllowInfNan(False))
        if not self.negative:
            yield Ge(0) if self.zero else Gt(0)

    @property
    def sign(self) -> str:
        """What is expected of its sign, as messages name it."""
        return "a number other than zero" if self.negative else "zero or more" if self.zero else "more than zero"

    def has_sign(self, value: Any) -> Any:
        """Whether a number, or each of an array, has a sign that it may have."""
        return (self.negative or value >= 0) & (self.zero or value != 0)

    def fits(self, value: Any) -> Any:
        """Whether a number in SI, or each of an array, is of a size that all models can take."""
        size = abs(value)
        return (value == 0) | ((self.smallest <= size) & (size <= self.largest))


Vector: TypeAlias = tuple[float, float]
At: TypeAlias = tuple[str | int | frozenset[str], ...]  # where in a scene: names of fields, keys, numbers of entries

Finite = Annotated[float, Strict(), AllowInfNan(False)]  # of a file, but of no scene
Positive = Annotated[Finite, Gt(0)]
Pair = Annotated[tuple[Finite, Finite], Strict(False)]  # TOML has arrays, not tuples; the numbers stay strict

Coordinate = Annotated[float, Quantity("length")]
Length = Annotated[float, Quantity("length", 1e-15, negative=False, zero=False)]
RestLength = Annotated[float, Quantity("length", 1e-15, negative=False)]
Mass = Annotated[float, Quantity("mass", 1e-15, negative=False)]
Inertia = Annotated[float, Quantity("inertia", 1e-45, 1e45, negative=False)]
Density = Annotated[float, Quantity("density", 1e-15, negative=False, zero=False)]
Stiffness = Annotated[float, Quantity("stiffness", 1e-15, negative=False)]
Damping = Annotated[float, Quantity("damping", 1e-15, negative=False)]
Newtons = Annotated[float, Quantity("force")]
NewtonMetres = Annotated[float, Quantity("moment")]
TwistStiffness = Annotated[float, Quantity("torsion_stiffness", 1e-15, negative=False)]
TwistDamping = Annotated[float, Quantity("torsion_damping", 1e-15, negative=False)]
TurningDamping = Annotated[float, Quantity("turning_damping", 1e-15, negative=False)]
TurningRate = Annotated[float, Quantity("turning_rate", 1e-15, negative=False, zero=False)]
SlidingRate = Annotated[float, Quantity("sliding_rate", 1e-15, negative=False, zero=False)]
Coefficient = Annotated[float, Quantity("coefficient", 1e-15, 1e3, negative=False)]
Component = Annotated[float, Quantity("direction")]  # of a direction, whose length is of no matter
Gravity = Annotated[float, Quantity("gravity")]
Time = Annotated[float, Quantity("time", 1e-15)]
Duration = Annotated[float, Quantity("time", 1e-15, negative=False, zero=False)]
Frequency = Annotated[float, Quantity("frequency", 1e-15, negative=False, zero=False)]
Angle = Annotated[float, Quantity("angle")]
Position = Annotated[float, Quantity("position")]  # of the drive: an angle, or a displacement
Speed = Annotated[float, Quantity("speed", 1e-15, zero=False)]  # of the drive too

Place = Annotated[tuple[Coordinate, Coordinate], Strict(False)]
Direction = Annotated[tuple[Component, Component], Strict(False)]
ForceVector = Annotated[tuple[Newtons, Newtons], Strict(False)]


class Number(NamedTuple):
    """A number of a scene."""

    path: str  # in its file
    at: At  # in the scene
    quantity: Quantity
    value: Any  # SI; of many machines an array of shape (m, 1)


class Declared(NamedTuple):
    """A field of a dataclass that holds numbers, or other dataclasses that do."""

    name: str
    path: str  # in the file's table: the name, or the `path` of its metadata; empty where its keys are the table's own
    lone: str  # the path of an only entry, where its metadata have that
    quantity: Quantity | None  # of a field that holds numbers
    kinds: tuple[type, ...]  # of what it holds otherwise
    several: bool  # whether it holds these by keys


def walk(whole: Any, path: str = "", at: At = (), quantity: Quantity | None = None) -> Iterator[Number]:
    """Yield all numbers of a scene, or of a part of one, in the order of its fields.

    A `*` in the path of the part in the file is where the next key belongs: at the end unless there is one. `at` is its
    place in the scene, and `quantity` that of what it holds, if it is no table.
    """
    if is_dataclass(whole):
        kind: type = type(whole)
        for field in declared(kind):
            part, own, place = getattr(whole, field.name), field.path, (*at, field.name)
            if field.lone and len(part) == 1:
                (part,), own, place = part, field.lone, (*place, 0)
            yield from walk(part, ".".join(filter(None, (path, own))), place, field.quantity)
    elif isinstance(whole, Mapping | tuple):
        for key, value in whole.items() if isinstance(whole, Mapping) else enumerate(whole):
            name = "-".join(sorted(key)) if isinstance(key, frozenset) else str(key)
            inner = path.replace("*", name, 1) if "*" in path else f"{path}.{name}"
            yield from walk(value, inner, (*at, key), quantity)
    elif quantity is not None and whole is not None:
        yield Number(path, at, quantity, whole)


def quantity_at(kind: type, at: Sequence[object]) -> Quantity | None:
    """The quantity that numbers at a place in a scene are of, which need not be there; None where there are none."""
    kinds: tuple[type, ...] = (kind,)
    while at:
        name, *at = at
        field = next((field for kind in kinds for field in declared(kind) if field.name == name), None)
        if field is None or field.quantity is not None:
            return field and field.quantity
        kinds, at = field.kinds, at[field.several :]
    return None


@cache
def declared(kind: type) -> tuple[Declared, ...]:
    """The fields of a dataclass that hold numbers of the file; those whose `path` is None hold them once more."""
    hints, wanted = get_type_hints(kind, include_extras=True), []
    for field in fields(kind):
        of = [*parts(hints[field.name])]
        quantity = next((part for part in of if isinstance(part, Quantity)), None)
        kinds = tuple(part for part in of if isinstance(part, type) and is_dataclass(part))
        path = field.metadata.get("path", field.name)
        if (quantity or kinds) and path is not None:
            several = any(get_origin(part) in (Mapping, tuple) for part in of)
            wanted.append(Declared(field.name, path, field.metadata.get("lone", ""), quantity, kinds, several))
    return tuple(wanted)


def parts(hint: Any) -> Iterator[Any]:
    """Yield an annotation and all that it is made of."""
    yield hint
    for part in get_args(hint):
        yield from parts(part)


def put(whole: Any, values: Mapping[At, Any]) -> Any:
    """A scene, or a part of one, with other values at some places."""
    if () in values:
        return values[()]
    # The inverse of `walk`: places are sorted by their first key, and each part of the scene is rebuilt from its own;
    # what no place leads to is shared with the old scene.
    inner: dict[Any, dict[At, Any]] = {}
    for (key, *rest), value in values.items():
        inner.setdefault(key, {})[tuple(rest)] = value
    if isinstance(whole, Mapping):
        return MappingProxyType({**whole, **{key: put(whole[key], own) for key, own in inner.items()}})
    if isinstance(whole, tuple):
        return tuple(put(value, inner[key]) if key in inner else value for key, value in enumerate(whole))
    return replace(whole, **{key: put(getattr(whole, key), own) for key, own in inner.items()})

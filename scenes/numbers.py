"""One walk over the numbers of a scene, as their quantities are declared in the annotations of its fields."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias, get_args, get_origin, get_type_hints

from .fields import Quantity

Key: TypeAlias = str | int | frozenset[str]
At: TypeAlias = tuple[Key, ...]  # where in a scene: names of fields, keys of what they hold, numbers of entries


class Number(NamedTuple):
    """A number of a scene."""

    path: str  # in its file
    at: At  # in the scene
    quantity: Quantity
    value: Any  # SI; of many machines an array of shape (m, 1)


class Declared(NamedTuple):
    """A field of a dataclass that holds numbers, or other dataclasses that do."""

    name: str
    path: str  # in the file's table: the name, unless the field's metadata have a `path`
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
            inner = f"{path}.{field.path}" if path else field.path
            yield from walk(getattr(whole, field.name), inner, (*at, field.name), field.quantity)
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
    """The fields of a dataclass that hold numbers."""
    hints, wanted = get_type_hints(kind, include_extras=True), []
    for field in fields(kind):
        of = [*parts(hints[field.name])]
        quantity = next((part for part in of if isinstance(part, Quantity)), None)
        kinds = tuple(part for part in of if isinstance(part, type) and is_dataclass(part))
        if quantity or kinds:
            several = any(get_origin(part) in (Mapping, tuple) for part in of)
            wanted.append(Declared(field.name, field.metadata.get("path", field.name), quantity, kinds, several))
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
    inner: dict[Any, dict[At, Any]] = {}
    for (key, *rest), value in values.items():
        inner.setdefault(key, {})[tuple(rest)] = value
    if isinstance(whole, Mapping):
        return MappingProxyType({**whole, **{key: put(whole[key], own) for key, own in inner.items()}})
    if isinstance(whole, tuple):
        return tuple(put(value, inner[key]) if key in inner else value for key, value in enumerate(whole))
    return replace(whole, **{key: put(getattr(whole, key), own) for key, own in inner.items()})

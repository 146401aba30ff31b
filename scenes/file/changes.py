"""Values in a scene file by path, as `bodies.rocker.lengths.O-P3`: read and changed before they are checked."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

from ..errors import InputError, at_place, nearest
from ..scene import Scene
from .machines import one_form

Value: TypeAlias = float | str
ONCE = "expected each number once, and a path before leads to this one too"
VARIED = ("ground", "bodies", "drive.speed", "loads", "springs", "gravity")  # what machines of one drive may differ in


def numbers(tables: Mapping[str, Any], paths: Sequence[str]) -> list[float]:
    """The numbers at these paths, in the units of the file; InputError where one has none, or leads to an earlier's."""
    values: dict[tuple[int, str | int], float] = {}
    for path in paths:
        table, key = _place(tables, path, 0.0)
        if (id(table), key) in values:
            raise InputError(f"{path}: {ONCE}")
        values[id(table), key] = float(table[key])
    return [*values.values()]


def change(tables: Mapping[str, Any], changes: Mapping[str, Value]) -> None:
    """Put other numbers and texts at some paths, in place; InputError where one is not of the kind that it replaces."""
    for path, value in changes.items():
        table, key = _place(tables, path, value)
        table[key] = value


def check_variations(tables: Mapping[str, Any], scene: Scene) -> None:
    """Raise InputError for the first variation that is of no number of the linkage, or of the same as another."""
    seen: set[str] = set()
    for number, path in enumerate(variation.path for variation in scene.variations):
        with at_place(f"variations.{number}.path"):
            if not path.startswith(VARIED):
                raise InputError(f"{path}: expected a number of the linkage{nearest(path, VARIED)}")
            numbers(tables, [path])
            if (form := one_form(scene, path)) in seen:
                raise InputError(f"{path}: {ONCE}")
            seen.add(form)


def label(file: object, changes: Mapping[str, Value]) -> str:
    """The name of a scene in messages: its file, and what was changed in it."""
    return ", ".join([str(file), *(f"{path} = {as_text(value)}" for path, value in changes.items())])


def as_text(value: Value) -> str:
    """A value as messages show it; in full, since the rungs of a ladder may differ by very little."""
    return value if isinstance(value, str) else f"{value:.15g}"


def _place(tables: Mapping[str, Any], path: str, like: Value) -> tuple[Any, str | int]:
    """The table or list that holds a number, or a text, at this path, as `like` is one; and its key there."""
    table: Any = None
    key: str | int = ""
    value: Any = tables
    for part in path.split("."):
        if not isinstance(value, dict | list):
            raise InputError(f"{path}: the path goes on after a number or a text, at '{part}'")
        table, key = value, _key(value, part, path)
        value = table[key]
    kind, kinds = ("text", str) if isinstance(like, str) else ("number", int | float)
    if isinstance(value, bool) or not isinstance(value, kinds):
        inside = _keys(value) if isinstance(value, dict | list) else ()
        raise InputError(f"{path}: expected the path of a {kind}{nearest('', inside)}")
    return table, key


def _key(table: dict[str, Any] | list[Any], part: str, path: str) -> str | int:
    turned = "-".join(reversed(part.split("-")))  # a length has no direction
    for name in (part, turned):
        if name in _keys(table):
            return int(name) if isinstance(table, list) else name
    raise InputError(f"{path}: the file has no '{part}' there{nearest(part, _keys(table))}")


def _keys(table: dict[str, Any] | list[Any]) -> tuple[str, ...]:
    return tuple(table) if isinstance(table, dict) else tuple(map(str, range(len(table))))

"""Numbers of a scene file by their paths, as `bodies.rocker.lengths.O-P3`: read and changed before it is checked."""

from collections.abc import Mapping, Sequence
from typing import Any

from .errors import InputError, nearest


def numbers(tables: Mapping[str, Any], paths: Sequence[str]) -> list[float]:
    """Return the numbers at these paths, in the units of the file.

    Raises:
        InputError: there is no number at one of them, or two of them lead to the same one.
    """
    places = [_place(tables, path) for path in paths]
    for number, (path, (table, key)) in enumerate(zip(paths, places, strict=True)):
        if any(table is other and key == other_key for other, other_key in places[:number]):
            raise InputError(f"{path}: expected each number once, and a path before leads to this one too")
    return [float(table[key]) for table, key in places]


def change(tables: Mapping[str, Any], changes: Mapping[str, float]) -> None:
    """Put other numbers at some paths, in place.

    Raises:
        InputError: there is no number at one of the paths.
    """
    for path, value in changes.items():
        table, key = _place(tables, path)
        table[key] = value


def named(file: object, changes: Mapping[str, float]) -> str:
    """Return what messages call a scene: its file, and what was changed in it."""
    return ", ".join([str(file), *(f"{path} = {value:g}" for path, value in changes.items())])


def _place(tables: Mapping[str, Any], path: str) -> tuple[Any, str | int]:
    """Return the table or list that holds the number at this path, and its key there."""
    table: Any = None
    key: str | int = ""
    value: Any = tables
    for part in path.split("."):
        if not isinstance(value, dict | list):
            raise InputError(f"{path}: the path goes on after a number or a text, at '{part}'")
        table, key = value, _key(value, part, path)
        value = table[key]
    if isinstance(value, bool) or not isinstance(value, int | float):
        inside = _keys(value) if isinstance(value, dict | list) else ()
        raise InputError(f"{path}: expected the path of a number{nearest('', inside)}")
    return table, key


def _key(table: dict[str, Any] | list[Any], part: str, path: str) -> str | int:
    turned = "-".join(reversed(part.split("-")))  # a length has no direction
    for name in (part, turned):
        if name in _keys(table):
            return int(name) if isinstance(table, list) else name
    raise InputError(f"{path}: the file has no '{part}' there{nearest(part, _keys(table))}")


def _keys(table: dict[str, Any] | list[Any]) -> tuple[str, ...]:
    return tuple(table) if isinstance(table, dict) else tuple(map(str, range(len(table))))

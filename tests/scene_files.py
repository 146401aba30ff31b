"""The tests' scenes, `tests/scenes/*.toml`, and the shipped ones: by name, with whatever a test changes in them."""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

import scenes
from scenes import InputError, Scene

FOLDER = Path(__file__).parent / "scenes"
# Small scenes that between them have every joint, drive and load; the shipped scenes have the rest.
MECHANISMS = (
    *("shaper", "swinging_block", "scotch_yoke", "tangent", "carried_block", "driven_toggle", "slotted_class_iii"),
    *("swinging_law", "turning_law", "swinging_segments"),
)
Changes = dict[str, Any]  # by path, as `bodies.rod.mass`: what is there instead, or None for nothing
NONE: Changes = {}


def path(name: str) -> Path:
    """The file of a scene."""
    own = FOLDER / f"{name}.toml"
    return own if own.exists() else scenes.shipped()[name]


def text(name: str) -> str:
    return path(name).read_text(encoding="utf-8")


def load(name: str, changes: Changes = NONE) -> Scene:
    """A scene with some numbers, texts, tables or lists changed, added or gone."""
    return scenes.from_tables(_changed(name, changes), f"{name}.toml") if changes else scenes.load(path(name))


def refused(call: Callable[[], object], most: int = 1000) -> str:
    """The line of so many characters at most, all harmless, with which a call is refused."""
    with pytest.raises(InputError) as caught:
        call()
    line = str(caught.value)
    assert line.isprintable()
    assert len(line) <= most
    return line


def in_order(name: str, order: Sequence[int], changes: Changes = NONE) -> Scene:
    """A scene whose bodies come in another order in the file."""
    bodies = list(_tables(name)["bodies"].items())
    return load(name, {**changes, "bodies": dict(bodies[number] for number in order)})


def free(scene: Scene) -> list[str]:
    """The paths of its numbers that each may be another: not those of a periodic table's ends, which go together."""
    tables = ((number, getattr(load, "table", None)) for number, load in enumerate(scene.loads))
    rows = ((number, row) for number, table in tables if table and table.periodic for row in (0, len(table.values) - 1))
    ends = {f"loads.{number}.table.{row}.{column}" for number, row in rows for column in (0, 1)}
    return [path for path in scene.numbers if path not in ends]


def without_masses(name: str) -> Changes:
    """What makes a scene a kinematic one."""
    tables, weights = _tables(name), ("mass", "com", "inertia")
    bodies = {n: {k: v for k, v in body.items() if k not in weights} for n, body in tables["bodies"].items()}
    return {"bodies": bodies} | {name: None for name in ("loads", "springs", "variations") if name in tables}


def write(folder: Path, name: str, changes: Changes = NONE) -> Path:
    """Write the file of a changed scene, and return its path."""
    file = folder / f"{name}.toml"
    file.write_text(toml(_changed(name, changes)), encoding="utf-8")
    return file


def _changed(name: str, changes: Changes) -> dict[str, Any]:
    tables = _tables(name)
    for place, value in changes.items():
        *way, last = place.split(".")
        parent: Any = tables
        for key in way:
            parent = parent[int(key)] if isinstance(parent, list) else parent.setdefault(key, {})
        if value is None:
            del parent[last]
        else:
            parent[int(last) if isinstance(parent, list) else last] = deepcopy(value)  # a later change may be within
    return tables


def _tables(name: str) -> dict[str, Any]:
    return tomllib.loads(text(name))


def toml(tables: Mapping[str, Any]) -> str:
    """The text of a scene file."""
    return "\n".join(f'"{key}" = {_value(value)}' for key, value in tables.items())


def _value(value: Any) -> str:
    match value:
        case Mapping():
            return "{ " + ", ".join(f'"{key}" = {_value(item)}' for key, item in value.items()) + " }"
        case list() | tuple():
            return "[" + ", ".join(map(_value, value)) + "]"
        case bool():
            return str(value).lower()
        case str():
            return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
        case _:
            return repr(value)

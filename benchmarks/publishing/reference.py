"""`python -m benchmarks.publishing.reference`: docs/reference.md from the code, which a test holds against it.

Scene file, limits, channels, statuses, options and exit statuses stand in the code once.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from types import ModuleType
from typing import get_args

import pandas as pd
from pydantic import BaseModel
from pydantic.fields import FieldInfo

from compare.cli import arguments
from compare.cli import command as command_line
from compare.measure.many import grid
from compare.results.mapping import MappingFile
from scenes import Status, channels, limits, quantities
from scenes.file.format import SceneFile

PAGE = Path(__file__).parents[2] / "docs" / "reference.md"
HEAD = """# Reference

Made from the code by `python -m benchmarks.publishing.reference`."""
TYPES = {"integer": "whole number", "number": "number", "boolean": "true or false", "string": "text", "object": "table"}
LIMITS = (
    ("bytes of a file, in UTF-8", limits.FILE_BYTES),
    ("bodies", limits.BODIES),
    ("points of all bodies and the ground, counted for each that names them", limits.POINTS),
    ("loads, and springs", limits.LOADS),
    ("rows of a force table or a motion law", limits.ROWS),
    ("segments of a motion, and harmonics", limits.SEGMENTS),
    ("periods of the fastest harmonic in a cycle", limits.WAVES),
    ("turns of a crank from end to end of a cycle", limits.TURNS),
    ("numbers that the workshop may deviate from", limits.VARIATIONS),
    ("characters of a name", limits.NAME),
    ("samples times channels of a run", limits.VALUES),
    ("machines of `--monte-carlo`", arguments.MAX_MACHINES),
    ("members of a family", grid.MAX_MEMBERS),
)


def page() -> str:
    """Return the text of the page."""
    return "\n\n".join(_parts()) + "\n"


def _parts() -> Iterator[str]:
    yield HEAD
    yield "## Scene file\n\nNumbers are in the units of the file. A key that is not needed may be left out."
    yield from _file(SceneFile)
    yield "## Mapping of a result\n\nThe file beside a table, for `--result`; numbers are in its own units."
    yield from _file(MappingFile)
    yield "## Limits\n\n" + _table(("of", "at most"), ((what, f"{most:,}") for what, most in LIMITS))
    yield "## Channels\n\n" + _docstring(channels)
    units = {f"`{quantity.name}`": quantity.unit for quantity in quantities.QUANTITIES}.items()
    yield "CSV files have the unit in the heading, as `P5.y [m]`.\n\n" + _table(("quantity", "unit"), units)
    yield "## Statuses\n\n" + _table(("status", "meaning"), ((f"`{each.name}`", each.value) for each in Status))
    yield "## Command line\n\n" + _table(("option", "meaning"), _options())
    commands = ((f"`{words}`", meaning) for words, meaning in arguments.COMMANDS.items())
    yield "Other commands, in the place of a scene's name.\n\n" + _table(("command", "meaning"), commands)
    yield "## Exit statuses\n\n" + _docstring(command_line)


def _file(model: type[BaseModel]) -> Iterator[str]:
    for name, table in _tables("", model):
        if name:
            yield f"### `{name}`\n\n{_sentence(table)}"
        yield _keys(table)


def _tables(path: str, model: type[BaseModel]) -> Iterator[tuple[str, type[BaseModel]]]:
    """Yield every table of a file with where it stands, as `[bodies.NAME.slides]`, in the order of the file."""
    yield path, model
    for key, field in model.model_fields.items():
        for inner, many in _models(field.annotation):
            place = f"{path.strip('[]')}.{key}".strip(".") + (".NAME" if many is dict else "")
            yield from _tables(f"[[{place}]]" if many is list else f"[{place}]", inner)


def _models(annotation: object, many: object = None) -> Iterator[tuple[type[BaseModel], object]]:
    """Yield the tables that a key may hold, and whether a list or a dictionary holds them."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, many
    for argument in get_args(annotation):
        yield from _models(argument, getattr(annotation, "__origin__", None) or many)


def _keys(model: type[BaseModel]) -> str:
    """Return a row a key: what it takes, what it is where absent, what it means."""
    types = model.model_json_schema()["properties"]
    rows = (
        (f"`{name}`", _type(types[name]), _default(field), field.description)
        for name, field in model.model_fields.items()
    )
    return _table(("key", "takes", "default", "meaning"), rows)


def _type(key: dict[str, object]) -> str:
    """Return what a key of a JSON schema takes, in a few words."""
    match key:
        case {"anyOf": list(kinds)}:
            return " or ".join(_type(kind) for kind in kinds if kind != {"type": "null"})
        case {"const": value}:
            return f"`{value}`"
        case {"enum": list(values)}:
            return " or ".join(f'`"{value}"`' for value in values)
        case {"type": "array", "prefixItems": list(items)}:
            return f"list of {len(items)}"
        case {"type": "array", "items": {"prefixItems": list(items)}}:
            return f"lists of {len(items)}"
        case {"type": "array"}:
            return "tables"
        case {"exclusiveMinimum": _}:
            return "number above 0"
        case {"minimum": _}:
            return "number, 0 or above"
        case {"type": str(kind)}:
            return TYPES[kind]
    return "table"


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "needed"
    return f"`{field.default}`" if isinstance(field.default, int | float | str) and field.default != "" else ""


def _options() -> Iterator[tuple[str, str | None]]:
    for action in arguments.parser()._actions[1:]:  # the first is `--help`
        value = "" if action.nargs == 0 else str(action.metavar or action.dest.upper())
        yield f"`{' '.join((*action.option_strings, value)).strip()}`", action.help


def _sentence(model: type[BaseModel]) -> str:
    return " ".join((model.__doc__ or "").split())


def _docstring(module: ModuleType) -> str:
    """Return a docstring without its first line, which is about the module."""
    return (module.__doc__ or "").partition("\n\n")[2].strip()


def markdown(table: pd.DataFrame) -> str:
    """Return a table as Markdown."""
    lines = [table.columns, ["---"] * len(table.columns), *table.to_numpy(str)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def _table(header: Iterable[str], rows: Iterable[Iterable[object]]) -> str:
    return markdown(pd.DataFrame([*rows], columns=[*header]))


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")

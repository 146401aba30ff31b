"""What does not fit in a file: one line with its place, what was expected there, in which unit, and what was found.

All of it follows from how the tables are declared: their keys, what each is for, and of what quantity its numbers are.
"""

import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, TypeAlias, TypeVar, get_args, get_origin, get_type_hints

from pydantic import BaseModel, StringConstraints, ValidationError

from ..errors import InputError, one_line, path_in_file
from ..fields import PATTERNS, FileTable, Quantity, parts
from .unknown import unknown

File = TypeVar("File", bound=FileTable)
Location: TypeAlias = Sequence[int | str]
UnitOf: TypeAlias = Callable[[str], str]  # the name of a file's unit, by dimension
MAX_FOUND = 40  # characters of what was found
MAX_KEYS = 6  # keys of a table: of more, only the first are listed
COUNTS = {2: "two", 3: "three"}
NUMBER = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"


class ExpectedForm(NamedTuple):
    """What is declared of a place in a file."""

    table: type[BaseModel]  # the innermost one
    hint: Any  # the annotation of its key


def validated(file: type[File], given: object, unit: UnitOf = lambda _: "") -> File:
    """What the tables of a file hold.

    Raises:
        InputError: `<path in the file>: <what was expected>`, where they do not fit.
    """
    try:
        return file.model_validate(given)
    except ValidationError as error:
        raise InputError(_explained(error, file, unit)) from None


def _explained(error: ValidationError, file: type[FileTable], unit: UnitOf) -> str:
    """A line on the first of the errors in a file; the rest is counted, since one slip often causes several."""
    # A misspelt key is two errors, an unknown key and a missing one; the unknown one shows the slip, so it comes first.
    first, *rest = sorted(error.errors(include_url=False), key=lambda e: e["type"] != "extra_forbidden")
    location = [part for part in first["loc"] if part not in ("[key]", "vector", "number")]
    given, bounds, kind = first["input"], first.get("ctx", {}), first["type"]
    declared = table, hint = _declared(file, location)
    of_list = isinstance(location[-1], int)
    if kind == "missing" and of_list:  # a number: what was found is the list without it
        kind, _ = "tuple_type", location.pop()
    expected, found = "", f", found {as_written(given)}"
    match kind:
        case "extra_forbidden":
            expected, found = unknown(file, table, location, given), ""
        case "missing":
            expected, found = f"missing; {_meaning(table, str(location[-1]))}", ""
        case "float_type" if location[:-1] == ["sketch"] and isinstance(given, list):
            expected, found = "expected a number, since it is where the drive is; a point needs another name", ""
        case "float_type":
            expected = f"expected {_number(hint, given, unit)}"
        case "tuple_type" if location[:-1] == ["sketch"] and location[-1] in file.model_fields:
            expected = f"expected a point; '{location[-1]}' belongs to the top of the file, above its first [table]"
        case "tuple_type" | "list_type":
            expected = f"expected {_list(location, hint, unit)}"
        case "too_long" if (row := _row(hint, unit)) and (of_list or not _several(hint)):
            expected = f"expected {row}"
        case "too_short":
            expected = f"expected {bounds['min_length']} or more entries"
            found = f", found {bounds['actual_length']}"
        case "too_long" | "string_too_long":
            what = "entries" if kind == "too_long" else "characters"
            expected, found = f"expected {bounds['max_length']} {what} at most", f", found {len(given)}"
        case "string_pattern_mismatch":
            expected, found = f"not a name: expected {PATTERNS[bounds['pattern']]}", ""
        case "model_type" | "dict_type":
            expected = f"expected a table{_table(location, declared, given)}"
        case "less_than_equal":
            expected, found = f"expected {bounds['le']:g} at most", f", found {given:g}"
        case _:
            expected = first["msg"].replace("Input should be", "expected")
    return f"{path_in_file(location)}: {expected}{found}" + (f" (and {len(rest)} more)" if rest else "")


def _declared(file: type[BaseModel], location: Location) -> ExpectedForm:
    """The innermost declared table of a place in a file, and the annotation of its key."""
    table, hint, named = file, None, False
    for part in location:
        if isinstance(part, int) or named:  # an entry of a list, or of a table by names that the user gives
            named = False
            continue
        table = _model(hint) or table
        hints = get_type_hints(table, include_extras=True)
        free = hints["__pydantic_extra__"] if table.model_config.get("extra") == "allow" else None
        hint = hints[part] if part in table.model_fields else free
        named = part in table.model_fields and any(get_origin(kind) is dict for kind in parts(hint))
    return ExpectedForm(table, hint)


def _model(hint: Any) -> type[BaseModel] | None:
    """The table that an annotation is of, if any."""
    kinds = (kind for kind in parts(hint) if isinstance(kind, type))
    return next((kind for kind in kinds if issubclass(kind, BaseModel)), None)


def _meaning(table: type[BaseModel], key: str) -> str:
    """What a key is for, as its declaration has it."""
    field = table.model_fields.get(key)
    description = (field and field.description) or "the file needs it"
    return description[0].lower() + description[1:].rstrip(".")


def _several(hint: Any) -> bool:
    """Whether a key takes a list of any length."""
    lists = (part for part in parts(hint) if get_origin(part) in (list, tuple))
    return any(get_origin(part) is list or ... in get_args(part) for part in lists)


def _list(location: Location, hint: Any, unit: UnitOf) -> str:
    """What is expected of a key that takes a list."""
    row = _row(hint, unit)
    if row and (isinstance(location[-1], int) or not _several(hint)):
        return row
    if _model(hint):
        heading = ".".join(str(part) for part in location if isinstance(part, str))
        return f"a list of tables, as [[{heading}]] in double brackets"
    return f"a list, each entry {row}" if row else "a list"


def _row(hint: Any, unit: UnitOf) -> str:
    """What is expected of a list of a fixed length, as `two numbers, [x, y] in mm`; nothing of others."""
    rows = [part for part in parts(hint) if get_origin(part) is tuple and ... not in get_args(part)]
    if not rows:
        return ""
    entries = get_args(rows[-1])
    count, kinds = COUNTS[len(entries)], [[*parts(entry)] for entry in entries]
    if str in kinds[0]:
        is_point = any(isinstance(part, StringConstraints) and part.pattern for part in kinds[0])
        return f"{count} points, each as 'body.point'" if is_point else f"{count} bodies"
    dimensions = [part.dimension for kind in kinds for part in kind if isinstance(part, Quantity)]
    if len(dimensions) != len(entries):
        return f"{count} numbers"
    units = [f" in {name}" if (name := unit(dimension)) else "" for dimension in dimensions]
    if {*dimensions} == {dimensions[0]}:
        return f"{count} numbers, [x, y]{units[0]}"
    named = (f"{dimension}{of}" for dimension, of in zip(dimensions, units, strict=True))
    return f"{count} numbers, [{', '.join(named)}]"


def _number(hint: Any, given: object, unit: UnitOf) -> str:
    """What is expected of a number; of a text that has one, what is in its way."""
    quantity = next((part for part in parts(hint) if isinstance(part, Quantity)), None)
    name = unit(quantity.dimension) if quantity and not _row(hint, unit) else ""
    expected = f"a number in {name}" if name else "a number"
    text = given.strip() if isinstance(given, str) else ""
    if re.fullmatch(r"[-+]?\d+,\d+", text):
        return f"{expected}, its decimals after a '.', as {text.replace(',', '.')}"
    if re.fullmatch(NUMBER, text):
        return f"{expected}, without quotation marks"
    if re.match(NUMBER, text):
        return f"{expected}, without a unit, which [units] has"
    return expected


def _table(location: Location, declared: ExpectedForm, given: object) -> str:
    """What the table has that is expected at a place."""
    *_, key = location
    headed = all(isinstance(part, str) for part in location)
    if headed and isinstance(given, list) and all(isinstance(entry, dict) for entry in given):
        return f", [{'.'.join(map(str, location))}] in single brackets"
    if key in declared.table.model_fields and (examples := declared.table.model_fields[str(key)].examples):
        return f", as {as_written(examples[0])}"
    model = _model(declared.hint)
    if model is None:
        return ""
    if key in declared.table.model_fields and any(get_origin(part) is dict for part in parts(declared.hint)):
        return f" of tables, as [{path_in_file(location)}.NAME]"
    keys = [*model.model_fields.items()]
    needed = [name for name, field in keys if field.is_required()] or [name for name, _ in keys]
    listed = ", ".join(map(repr, needed if len(needed) <= MAX_KEYS else needed[: MAX_KEYS // 2]))
    return f" of {listed}{' and so on' if len(needed) > MAX_KEYS else ''}"


def as_written(value: object) -> str:
    """A value as a TOML file may have it, cut where it is long."""
    return f"'{one_line(value, MAX_FOUND)}'" if isinstance(value, str) else one_line(_toml(value), MAX_FOUND)


def _toml(value: object) -> str:
    match value:
        case bool():
            return str(value).lower()
        case str():
            return f'"{value}"'
        case list() | tuple():
            return f"[{', '.join(map(_toml, value))}]"
        case dict():
            keys = (key if re.fullmatch(r"\w+", key) else f'"{key}"' for key in map(str, value))
            entries = (f"{key} = {_toml(entry)}" for key, entry in zip(keys, value.values(), strict=True))
            return f"{{ {', '.join(entries)} }}"
    return str(value)

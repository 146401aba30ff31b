"""Values as JSON has them: what is not finite becomes null, a pair of points `A-B`, a status its name."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from math import isfinite
from typing import Any

from scenes.fields import FileTable


def json_text(value: Any) -> str:
    """A value as indented JSON."""
    return json.dumps(plain(value), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def plain(value: Any) -> Any:
    """Numbers, texts, data classes, tables of files, mappings, sequences, arrays, in each other, in JSON's types."""
    if isinstance(value, float):
        return float(value) if isfinite(value) else None
    if type(value) in (str, int, bool):  # nearly all that is left
        return value
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, FileTable):
        value = dict(value)
    if isinstance(value, Mapping):
        return {
            "-".join(sorted(key)) if isinstance(key, frozenset) else str(key): plain(part)
            for key, part in value.items()
        }
    if isinstance(value, frozenset):
        return sorted(value)
    if isinstance(value, Enum):
        return value.name
    if isinstance(value, Iterable) and not isinstance(value, str):
        return [plain(item) for item in value]
    return value.item() if hasattr(value, "item") else value

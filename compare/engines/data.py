"""Results as JSON and back: numbers, texts, arrays, and the project's own records of them; reading runs no code.

A record is a data class, a named tuple or a member of an enumeration, of this project's packages. Settings of an engine
from outside stand as what is known of them without it.
"""

from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib import import_module
from typing import Any

import numpy as np

from scenes import Settings

from .kept import PACKAGES
from .offer import StandIn, stand_in, standing

KINDS = {kind.__name__: kind for kind in (dict, frozenset, tuple)}
ARRAYS = "biufc"  # kinds of NumPy's types that are numbers


def encoded(value: Any) -> Any:
    """Return a value as what JSON has: a list as itself, all else that JSON lacks as one word and what is in it.

    Raises:
        TypeError: it is or holds what is no data.
    """
    kind = type(value)
    if value is None or (isinstance(value, int | str) and not isinstance(value, Enum)):
        return value
    if isinstance(value, float):
        return float(value)
    if isinstance(value, list):
        return [*map(encoded, value)]
    if isinstance(value, np.ndarray) and value.dtype.kind in ARRAYS:
        return {"array": [value.dtype.str, value.shape, b64encode(value.tobytes()).decode()]}
    if isinstance(value, Mapping):
        return {"dict": [[encoded(key), encoded(each)] for key, each in value.items()]}
    if kind in KINDS.values():
        return {kind.__name__: [*map(encoded, value)]}
    if isinstance(value, StandIn) or (isinstance(value, Settings) and not _own(kind.__module__)):
        known: Any = stand_in(value)
        return {"settings": [encoded(known.meanings), encoded(vars(known))]}
    if isinstance(value, Enum):
        made_of = {"value": value.value}
    elif isinstance(value, tuple):
        made_of = value._asdict()  # type: ignore[attr-defined]
    elif is_dataclass(value):
        made_of = {each.name: getattr(value, each.name) for each in fields(value)}
    else:
        raise TypeError(f"{kind.__name__} is no data")
    return {f"{kind.__module__}:{kind.__qualname__}": {name: encoded(each) for name, each in made_of.items()}}


def decoded(data: Any) -> Any:
    """Return the value that was encoded.

    Raises:
        Exception: the data are of no value, whatever is wrong with them.
    """
    if isinstance(data, list):
        return [*map(decoded, data)]
    if not isinstance(data, dict):
        return data
    ((kind, of),) = data.items()
    if kind in KINDS:
        return KINDS[kind](decoded(of))
    if kind == "settings":
        return standing(b"", *decoded(of))
    if kind == "array" and np.dtype(of[0]).kind in ARRAYS:
        return np.frombuffer(b64decode(of[2]), of[0]).reshape(of[1]).copy()
    return _record(*kind.split(":"))(**{name: decoded(each) for name, each in of.items()})


def _own(module: str) -> bool:
    return module.partition(".")[0] in PACKAGES


def _record(module: str, name: str) -> Any:
    """Return the class of a record."""
    of = getattr(import_module(module), name) if _own(module) else object
    if not (is_dataclass(of) or issubclass(of, (Enum, tuple))):
        raise ValueError(f"{name} of {module} is no record")
    return of

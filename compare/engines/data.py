"""Results as JSON and back: numbers, texts, arrays, and the project's own records of them; reading runs no code.

A record is a data class, a named tuple or a member of an enumeration, of this project's packages. Settings of an engine
from outside stand as what is known of them without it.
"""

from base64 import b64decode, b64encode
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib import import_module
from typing import Any

import numpy as np

from scenes import Settings

from .kept import PACKAGES
from .offer import Offer, again, offer

ARRAYS = "biufc"  # kinds of NumPy's types that are numbers


def encoded(value: Any) -> Any:
    """Return a value as what JSON has: a list as itself, all else that JSON lacks as one word and what is in it.

    Raises:
        TypeError: it is or holds what is no data.
    """
    match value:
        case Enum():
            return {"member": [_name(value), value.name]}
        case None | bool() | int() | str():
            return value
        case float():
            return float(value)
        case complex():
            return {"complex": [value.real, value.imag]}
        case np.ndarray() if value.dtype.kind in ARRAYS:
            return {"array": [value.dtype.str, value.shape, b64encode(value.tobytes()).decode()]}
        case Settings() if not _own(type(value).__module__) or hasattr(value, "offered"):
            known = getattr(value, "offered", None) or offer(value)
            return {"settings": [encoded(known.values), encoded(known.meanings), value.promise]}
        case Mapping():
            return {"mapping": [[encoded(key), encoded(each)] for key, each in value.items()]}
        case frozenset():
            return {"set": [*map(encoded, value)]}
        case tuple() if hasattr(value, "_fields"):
            return {"row": [_name(value), [*map(encoded, value)]]}
        case tuple():
            return {"tuple": [*map(encoded, value)]}
        case list():
            return [*map(encoded, value)]
    if not is_dataclass(value):
        raise TypeError(f"{type(value).__name__} is no data")
    return {"record": [_name(value), {each.name: encoded(getattr(value, each.name)) for each in fields(value)}]}


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
    match kind:
        case "complex":
            return complex(*of)
        case "array" if np.dtype(of[0]).kind in ARRAYS:
            return np.frombuffer(b64decode(of[2]), of[0]).reshape(of[1]).copy()
        case "settings":
            return again(Offer(b"", *map(decoded, of[:2])), of[2])
        case "mapping":
            return {decoded(key): decoded(each) for key, each in of}
        case "set" | "tuple":
            return (frozenset if kind == "set" else tuple)(map(decoded, of))
        case "member":
            return _class(of[0], Enum)[of[1]]
        case "row":
            return _class(of[0], tuple)(*map(decoded, of[1]))
        case "record" if is_dataclass(_class(of[0], object)):
            return _class(of[0], object)(**{name: decoded(each) for name, each in of[1].items()})
    raise ValueError(f"{kind} is no kind of data")


def _name(value: object) -> Sequence[str]:
    return type(value).__module__, type(value).__qualname__


def _own(module: str) -> bool:
    return module.partition(".")[0] in PACKAGES


def _class(name: Sequence[str], base: type) -> Any:
    module, kept = name
    if not _own(module) or not issubclass(of := getattr(import_module(module), kept), base):
        raise ValueError(f"{kept} of {module} is no record")
    return of

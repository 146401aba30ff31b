"""Append-only checkpoint: one line a result, from which a run that was stopped resumes.

Each line starts with a digest of itself and of the very same code, scenes and engines; any other line does not count.
Several runs may add to the file at the same time. Where it cannot be written, the run goes on without it.

A result is what JSON has, or `encoded` as that: numbers, texts, arrays, and the project's own records of them: data
classes, named tuples, members of enumerations. Settings of an engine from outside stand as what is known of them
without it. Reading runs no code.
"""

import json
import os
import platform
from base64 import b64decode, b64encode
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import fields, is_dataclass
from enum import Enum
from errno import EEXIST
from functools import cache
from hashlib import sha256
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from scenes import Settings

from . import registry
from .installed import version as version_of
from .outside import StandIn, stand_in, standing

PACKAGES = ("analytic", "compare", "scenes", "sim_models")
REPORTED = ("linkage-crosscheck", "numpy", "scipy", "pandas", "uplot-python")  # besides what the engines name
KINDS = {kind.__name__: kind for kind in (dict, frozenset, tuple)}
ARRAYS = "biufc"  # kinds of NumPy's types that are numbers
MAX_BYTES = 2**26  # of a line: a member of a family has 2**20 at 360 samples


# One line a result, appended in a single write: `digest JSON`, the digest over the version stamp and the text. The
# format is its own recovery. A line cut short by a stop, two lines mixed by concurrent writers, or a line of another
# version fails its digest and is passed over, and the result is computed again. Nothing is ever rewritten in place.
class Kept:
    """A file of results, by name."""

    def __init__(self, file: Path, key: object) -> None:
        self._file = file
        self._stamp = f"{version()} {environment()['system']} {key} ".encode()
        self.trouble = ""  # why results are not kept
        with self._trouble():
            if file.exists() and not file.is_file():
                raise OSError(EEXIST, "it is not a file")

    def read(self) -> Iterator[tuple[str, Any]]:
        """Yield every name with its result; a name that was added twice comes twice."""
        if self.trouble or not self._file.exists():
            return
        with self._trouble(), self._file.open("rb") as file:
            while line := file.readline(MAX_BYTES):
                digest, _, text = line.rstrip(b"\n").partition(b" ")
                if digest == self._digest(text):
                    yield from [json.loads(text)]

    def add(self, name: str, result: object) -> None:
        """Keep a result, of what JSON has."""
        if self.trouble:
            return
        text = json.dumps([name, result]).encode()
        with self._trouble():
            self._file.parent.mkdir(parents=True, exist_ok=True)
            with self._file.open("ab", buffering=0) as file:  # on a new line: the last may have been cut short
                file.write(b"\n" + self._digest(text) + b" " + text)

    def forget(self) -> None:
        """Drop the file: a command that came to its end starts anew the next time."""
        with suppress(OSError):
            self._file.unlink()

    def _digest(self, text: bytes) -> bytes:
        return sha256(self._stamp + text).hexdigest().encode()

    @contextmanager
    def _trouble(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.trouble = f"nothing is kept for another run in {self._file}: {error.strerror}"


@cache
def environment() -> dict[str, str]:
    """Return the machine's and the packages' versions."""
    system = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores"
    known = {"python": platform.python_version(), "system": system}
    return known | {package: version_of(package) for package in REPORTED}


# The code is identified by the contents of its files rather than by a version number: a changed line of source, or of a
# scene, invalidates all that was kept.
@cache
def version() -> str:
    """Return a digest of the code, the scenes, and the versions of all that is installed for them, on any machine."""
    versions = environment() | {name: entry.version for name, entry in registry.ENTRIES.items()}
    del versions["system"]
    digest = sha256(json.dumps(versions, sort_keys=True).encode())
    outside = (entry.package for entry in registry.ENTRIES.values() if entry.outside and not entry.missing)
    for package in (*PACKAGES, *outside):
        spec = find_spec(package)  # of a package, or of a module, that is not imported for it
        places = [Path(place) for place in (spec and (spec.submodule_search_locations or [spec.origin or ""])) or ()]
        files = (path for place in places for path in (place.rglob("*") if place.is_dir() else [place]))
        for path in sorted(path for path in files if path.suffix in (".py", ".toml")):
            digest.update(path.read_bytes())
    return digest.hexdigest()


# Data as tagged JSON instead of pickles, which run code when they are read. Only this project's own records are made
# again: `_record` refuses any other class by name.
def encoded(value: Any) -> Any:
    """Return a value in JSON's types: lists as they are, any type that JSON lacks as {its name: its content}."""
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
    """Return the value that was encoded, or raise whatever is wrong with the data."""
    if isinstance(data, list):
        return [*map(decoded, data)]
    if not isinstance(data, dict):
        return data
    ((kind, content),) = data.items()
    if kind in KINDS:
        return KINDS[kind](decoded(content))
    if kind == "settings":
        return standing(b"", *decoded(content))
    if kind == "array" and np.dtype(content[0]).kind in ARRAYS:
        return np.frombuffer(b64decode(content[2]), content[0]).reshape(content[1]).copy()
    return _record(*kind.split(":"))(**{name: decoded(each) for name, each in content.items()})


def _own(module: str) -> bool:
    return module.partition(".")[0] in PACKAGES


def _record(module: str, name: str) -> Any:
    record = getattr(import_module(module), name) if _own(module) else object
    if not (is_dataclass(record) or issubclass(record, (Enum, tuple))):
        raise ValueError(f"{name} of {module} is no record")
    return record

"""Results kept as they come, one line each, so that a run that was stopped goes on where it was.

Each line starts with a digest of itself and of the very same code, scenes and engines; any other line does not count.
Several runs may add to the file at the same time. Where nothing can be kept, nothing is, and the run goes on.
"""

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from errno import EEXIST
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from . import registry
from .environment import environment

PACKAGES = ("analytic", "compare", "scenes", "sim_models")
MOST = 2**26  # bytes of a line: a member of a family has 2**20 at 360 samples


class Kept:
    """A file of results, by name."""

    def __init__(self, file: Path, key: object) -> None:
        """Take what is there of this version of everything, and `key`."""
        self._file = file
        self._stamp = f"{version()} {environment()['system']} {key} ".encode()
        self.trouble = ""  # why results are not kept
        with self._trouble():
            if file.exists() and not file.is_file():
                raise OSError(EEXIST, "it is not a file")

    def read(self) -> Iterator[tuple[str, Any]]:
        """Yield every name with its result, of one that is there twice both."""
        if self.trouble or not self._file.exists():
            return
        with self._trouble(), self._file.open("rb") as file:
            while line := file.readline(MOST):
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
def version() -> str:
    """Return a digest of the code, the scenes, and the versions of all that is installed for them, on any machine."""
    versions = environment() | {name: entry.version for name, entry in registry.ENTRIES.items()}
    del versions["system"]
    digest = sha256(json.dumps(versions, sort_keys=True).encode())
    outside = (entry.package for entry in registry.ENTRIES.values() if entry.outside and not entry.missing)
    for package in (*PACKAGES, *outside):
        for path in _sources(package):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _sources(package: str) -> Iterable[Path]:
    """Return the files of a package, or of a module, that is not imported for it."""
    spec = find_spec(package)
    places = [Path(place) for place in (spec and (spec.submodule_search_locations or [spec.origin or ""])) or ()]
    found = (path for place in places for path in (place.rglob("*") if place.is_dir() else [place]))
    return sorted(path for path in found if path.suffix in (".py", ".toml"))

"""Results kept as they come, one line each, so that a run that was stopped goes on where it was.

Each line starts with a digest of itself and of the very same code, scenes and engines; any other line does not count.
Several runs may add to the file at the same time. Where nothing can be kept, nothing is, and the run goes on.
"""

import json
from collections.abc import Iterable
from errno import EEXIST
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..engines import registry
from ..engines.environment import environment

PACKAGES = ("analytic", "compare", "scenes", "sim_models")
MOST = 2**26  # bytes: a file of 1000 cases has 2**20

Rows = list[dict[str, Any]]


class Kept:
    """A file of results, by key."""

    def __init__(self, file: Path, key: object) -> None:
        """Read what is there for this version of everything, and `key`."""
        self._file = file
        self._stamp = f"{_version()} {key} "
        self.trouble = ""  # why results are not kept
        self.rows: dict[str, Rows] = {}
        try:
            self.rows |= map(json.loads, filter(None, map(self._text, self._lines())))
        except OSError as error:
            self._give_up(error)

    def add(self, name: str, rows: Rows) -> None:
        """Keep results."""
        self.rows[name] = rows
        if self.trouble:
            return
        text = json.dumps([name, rows])
        try:
            self._file.parent.mkdir(parents=True, exist_ok=True)
            with self._file.open("a", encoding="utf-8") as file:  # on a new line: the last may have been cut short
                file.write(f"\n{self._digest(text)} {text}")
        except OSError as error:
            self._give_up(error)

    def _lines(self) -> list[str]:
        """Return the file's lines, whatever they are; of a file that is too large for a file of results, none."""
        if not self._file.exists():
            return []
        if not self._file.is_file():
            raise OSError(EEXIST, "it is not a file")
        if self._file.stat().st_size > MOST:
            self._file.unlink()
            return []
        return self._file.read_text(encoding="utf-8", errors="replace").split("\n")

    def _text(self, line: str) -> str:
        """Return what a line has of a result of this version, or nothing."""
        digest, _, text = line.partition(" ")
        return text if digest == self._digest(text) else ""

    def _digest(self, text: str) -> str:
        return sha256((self._stamp + text).encode()).hexdigest()

    def _give_up(self, error: OSError) -> None:
        self.trouble = f"no hard case is kept for another run in {self._file}: {error.strerror}"


def _version() -> str:
    """Return a digest of the code, the scenes and the versions of all that is installed for them."""
    versions = environment() | {name: entry.version for name, entry in registry.ENTRIES.items()}
    digest = sha256(json.dumps(versions, sort_keys=True).encode())
    for package in PACKAGES:
        for path in _below(Path(str(files(package)))):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _below(folder: Path) -> Iterable[Path]:
    return sorted(path for path in folder.rglob("*") if path.suffix in (".py", ".toml"))

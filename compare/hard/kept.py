"""Results kept as they come, one line each, so that a run that was stopped goes on where it was.

They count only for the very same code, scenes and engines, named in the first line of the file.
"""

import json
from collections.abc import Iterable
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..engines import registry
from ..engines.environment import environment

PACKAGES = ("analytic", "compare", "scenes", "sim_models")

Rows = list[dict[str, Any]]


class Kept:
    """A file of results, by key."""

    def __init__(self, file: Path, key: object) -> None:
        """Read what is there for this version of everything, and `key`; anything else is dropped."""
        self._file = file
        self.rows: dict[str, Rows] = {}
        stamp = json.dumps({"of": _version(), "key": str(key)})
        lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
        whole = [line for line in lines[1:] if _is_whole(line)] if lines[:1] == [stamp] else []
        self.rows |= map(json.loads, whole)
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("".join(f"{line}\n" for line in (stamp, *whole)), encoding="utf-8")

    def add(self, name: str, rows: Rows) -> None:
        """Keep results."""
        self.rows[name] = rows
        with self._file.open("a", encoding="utf-8") as file:
            file.write(json.dumps([name, rows]) + "\n")


def _is_whole(line: str) -> bool:
    """Return whether the line was written to its end before the run was."""
    try:
        json.loads(line)
    except ValueError:
        return False
    return True


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

"""Lines of a scene file."""

import re
from collections.abc import Sequence
from pathlib import Path

_KEY = r"""(?:"[^"\n]*"|'[^'\n]*'|[\w-]+)"""
_PATH = rf"{_KEY}(?:\s*\.\s*{_KEY})*"
_LINE = re.compile(rf"\s*(?:\[\[?\s*(?P<table>{_PATH})\s*\]|(?P<key>{_PATH})\s*=)")


def line_of(file: Path, path: Sequence[str]) -> int | None:
    """The line, from 1, of the part of a path that a TOML file has, or None where it has not even the first.

    Args:
        file: the file; None is returned of one that cannot be read.
        path: as `("tolerances", "exudyn", "reaction")`.
    """
    try:
        text = file.read_text(encoding="utf-8-sig")
    except (OSError, ValueError):
        return None
    table, known, at = (), 0, None
    for number, line in enumerate(text.split("\n"), start=1):
        if not (match := _LINE.match(line)):
            continue
        here = tuple(key.strip("\"'") for key in re.findall(_KEY, match["table"] or match["key"]))
        if match["table"]:
            table = here
        else:
            here = (*table, *here)
        if len(here) > known and here == tuple(path[: len(here)]):
            known, at = len(here), number
    return at

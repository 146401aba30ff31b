"""What is installed, by the folders of metadata on the path, as `importlib.metadata` finds it.

To import that takes as long as to import half of NumPy, since it parses metadata as e-mails. Here a version is the line
that has it, and a group of entry points is in a file or is not. What is laid out in another way, as in an archive, is
asked of the library.
"""

import re
import sys
from collections.abc import Iterator
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

INFOS = (".dist-info", ".egg-info")
VERSION = re.compile(r"^Version: *(\S+)", re.MULTILINE)


def version(distribution: str) -> str:
    """The version of a distribution that is installed; `importlib.metadata.PackageNotFoundError` of another."""
    wanted = _plain(distribution)
    for folder in _infos():
        if _plain(folder.name.removesuffix(folder.suffix).partition("-")[0]) == wanted:
            with suppress(OSError, ValueError):  # it is no folder, or nobody's text
                head = (folder / "METADATA").read_text("utf-8").partition("\n\n")[0]
                if found := VERSION.search(head):
                    return found[1]
    from importlib.metadata import version  # late, see above

    return version(distribution)


def may_offer(group: str) -> bool:
    """Whether a distribution may have entry points of a group: false where the library would find none."""
    elsewhere = [place for place in sys.path if place.endswith(".egg") or Path(place).is_file()]
    finders = [finder for finder in sys.meta_path if hasattr(finder, "find_distributions")]
    if elsewhere or len(finders) > 1:  # the one is Python's own, of folders
        return True
    for folder in _infos():
        with suppress(OSError):  # nearly all have none
            if group.encode() in (folder / "entry_points.txt").read_bytes():
                return True
    return False


def _infos() -> Iterator[Path]:
    """Yield the folders of metadata, those first that are found first when a module is imported."""
    for place in dict.fromkeys(sys.path):
        with suppress(OSError):  # there is no such folder, or it may not be read
            folder = Path(place or ".").absolute()
            yield from _in_folder(folder, folder.stat().st_mtime_ns)


@lru_cache(100)
def _in_folder(folder: Path, _changed: int) -> list[Path]:
    return [each for each in folder.iterdir() if each.suffix.lower() in INFOS]


def _plain(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()

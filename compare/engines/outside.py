"""Engines of other distributions, by entry points of the group `linkage_crosscheck.engines`.

An entry point names a module: `mine = "my_package.engine"`. Only metadata are read before an engine is asked for.
An engine whose name another has as well is called NAME@DISTRIBUTION.
"""

import re
from collections import Counter
from collections.abc import Collection
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution, entry_points
from importlib.util import find_spec
from multiprocessing import current_process
from multiprocessing.reduction import ForkingPickler
from types import SimpleNamespace
from typing import Any

from scenes import Engine, Settings
from scenes.engine import completed
from scenes.errors import one_line

from .entry import Entry
from .isolation import Ended, Limits, isolated

GROUP = "linkage_crosscheck.engines"
NAME = r"[A-Za-z0-9][A-Za-z0-9_.-]{0,39}"  # it is part of file names, and of lists with commas
LIMITS = Limits(20.0)  # of an import


def entries(taken: Collection[str]) -> dict[str, Entry]:
    """Return the entries of all engines that installed distributions offer, by name.

    Args:
        taken: names that other engines have.
    """
    points = sorted(entry_points(group=GROUP), key=lambda point: point.name)
    count = Counter([*taken, *(point.name for point in points)])
    found = {point.name: _entry(point) for point in points if count[point.name] == 1}
    again = [(point.name, _entry(point)) for point in points if count[point.name] > 1]
    return found | {f"{name}@{entry.distribution}": entry for name, entry in again}


def _entry(point: EntryPoint) -> Entry:
    """Return the entry of an engine, with what keeps it from running."""
    assert point.dist is not None
    known = {key: one_line(point.dist.metadata[key], 80) for key in point.dist.metadata}
    name, module = known.get("Name", "a nameless distribution"), point.value.strip()
    package = module.partition(".")[0]
    needs = [need[0] for each in point.dist.requires or () if ";" not in each and (need := re.match(r"[\w.-]+", each))]
    lacking = next((need for need in needs if not _installed(need)), "")
    trouble = ""
    if not re.fullmatch(NAME, point.name):
        trouble = "its name is expected to be letters, digits, '_', '.' and '-', 40 at most"
    elif not all(part.isidentifier() for part in module.split(".")):
        trouble = f"its entry point is expected to name a module, found {module}"
    elif lacking:
        trouble = f"it needs {lacking}, which is not installed: pip install {name}"
    elif package == "__main__" or not find_spec(package):
        trouble = f"{name} lacks its module {package}: pip install {name}"
    version, purpose = f"{name} {known.get('Version', '')}".strip(), known.get("Summary") or f"an engine of {name}"
    return Entry(purpose, module, package, name, f"pip install {name}", outside=version, trouble=one_line(trouble))


def _installed(name: str) -> bool:
    try:
        return bool(distribution(name))
    except PackageNotFoundError:
        return False


# --- when an engine is asked for --------------------------------------------------------------------------------------


@cache
def loaded(entry: Entry) -> Engine[Any]:
    """Return an engine, imported now; one that cannot be, as an engine of which every run fails for that reason.

    The first import is in a process of its own, since it may crash or hang; so is what nobody can send to another.
    """
    if current_process().daemon:  # which may have no processes, and is one of an engine's own
        ForkingPickler.dumps(_settings(entry))
        return _completed(entry)
    ((_, outcome),) = isolated(_settings, [entry], LIMITS, lambda: None)
    return _failing(outcome.reason) if isinstance(outcome, Ended) else _completed(entry)


def _settings(entry: Entry) -> list[Settings]:
    """Return all settings of an engine, as they can be sent."""
    engine = _completed(entry)
    ladders = (*engine.WORK_PRECISION, *engine.LONG_WORK_PRECISION, *engine.ABLATIONS)
    return list(dict.fromkeys((engine.DEFAULT, engine.FAST, engine.EXACT, *ladders)))


def _completed(entry: Entry) -> Engine[Any]:
    return completed(import_module(entry.module), entry.version)


def _failing(reason: str) -> Engine[Any]:
    def version() -> str:
        raise ImportError(reason)

    return completed(SimpleNamespace(DEFAULT=Settings("default"), version=version, build=None), "")

"""Engines of other distributions, by entry points of the group `linkage_crosscheck.engines`.

An entry point names a module: `mine = "my_package.engine"`. Only metadata are read before an engine is asked for.
An engine whose name another has as well is called NAME@DISTRIBUTION.
"""

import os
import re
from collections import Counter
from collections.abc import Collection, Iterator
from contextlib import ExitStack, chdir, contextmanager, redirect_stderr, redirect_stdout, suppress
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution, distributions
from importlib.util import find_spec
from multiprocessing import current_process
from multiprocessing.reduction import ForkingPickler
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from warnings import catch_warnings

import numpy as np

from scenes import Engine, Settings
from scenes.engine import completed
from scenes.errors import one_line
from scenes.format import ENGINE

from .entry import Entry
from .isolation import Ended, Limits, isolated

GROUP = "linkage_crosscheck.engines"
LIMITS = Limits(20.0)  # of an import


def entries(taken: Collection[str]) -> dict[str, Entry]:
    """Return the entries of all engines that installed distributions offer, by name.

    Args:
        taken: names that other engines have.
    """
    points = sorted(_points(), key=lambda point: point.name)
    count = Counter([*taken, *(point.name for point in points)])
    found = {point.name: _entry(point) for point in points if count[point.name] == 1}
    again = [(point.name, _entry(point)) for point in points if count[point.name] > 1]
    return found | {f"{name}@{entry.distribution}": entry for name, entry in again}


def _points() -> list[EntryPoint]:
    """Return the entry points of engines: of a distribution that is found twice the first, of a broken one none."""
    found: dict[str, tuple[EntryPoint, ...]] = {}
    for each in distributions():
        with suppress(Exception):  # of anybody's files: not UTF-8, or a line that is no entry point
            if points := tuple(each.entry_points.select(group=GROUP)):
                found.setdefault(each.name, points)
    return [point for points in found.values() for point in points]


def _entry(point: EntryPoint) -> Entry:
    """Return the entry of an engine, with what keeps it from running."""
    assert point.dist is not None
    known = {key: one_line(point.dist.metadata[key], 80) for key in point.dist.metadata}
    name, module = known.get("Name", "a nameless distribution"), point.value.strip()
    package = module.partition(".")[0]
    needs = [need[0] for each in point.dist.requires or () if ";" not in each and (need := re.match(r"[\w.-]+", each))]
    lacking = next((need for need in needs if not _installed(need)), "")
    trouble = ""
    if not re.fullmatch(ENGINE, point.name):
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
    """Return all settings of an engine, as they can be sent.

    Raises:
        TypeError: what it offers is not what the protocol asks for.
        ValueError: two settings have one label.
    """
    engine = _completed(entry)
    tiers, ladders = (engine.DEFAULT, engine.FAST, engine.EXACT), (engine.WORK_PRECISION, engine.LONG_WORK_PRECISION)
    offered = [*tiers, *(each for ladder in (*ladders, engine.ABLATIONS) for each in _tuple(ladder))]
    stepped = [engine.at_steps(24)] if engine.at_steps else []
    for settings in (*offered, *stepped):
        check_settings(settings)
    labels = Counter(settings.label for settings in dict.fromkeys(offered))
    if again := next((label for label, number in labels.items() if number > 1), None):
        raise ValueError(f"expected a label of its own for each of its settings, found two of {again}")
    return offered + stepped


def _tuple(ladder: object) -> tuple[Any, ...]:
    if not isinstance(ladder, tuple):
        raise TypeError(f"expected a tuple of settings, found {type(ladder).__name__}")
    return ladder


def check_settings(settings: object) -> None:
    """Refuse what an engine offers as settings and nothing else could take for them.

    Raises:
        TypeError: the settings, their label, steps or promises are not what the protocol asks for.
    """
    if not isinstance(settings, Settings):
        raise TypeError(f"expected scenes.Settings, found {type(settings).__name__}")
    if not (isinstance(settings.label, str) and settings.label == one_line(settings.label, 60) != ""):
        raise TypeError(f"expected a label of one line, 60 characters at most, found {settings.label!r}")
    if not isinstance(steps := getattr(settings, "steps", None), int | None):
        raise TypeError(f"{settings.label}: expected steps that are a whole number, found {steps!r}")
    for promise in (settings.promise, settings.drive_promise):
        if not (isinstance(promise, float) and 0 < promise < 1):
            raise TypeError(f"{settings.label}: expected a promise between 0 and 1, found {promise!r}")


def _completed(entry: Entry) -> Engine[Any]:
    with _unchanged():
        return completed(import_module(entry.module), entry.version)


@contextmanager
def _unchanged() -> Iterator[None]:
    """Have the process as it was when an import is done: its output, folder, environment, warnings and rounding."""
    with ExitStack() as stack, Path(os.devnull).open("w", encoding="utf-8") as nowhere:
        stack.callback(os.environ.update, {**os.environ})
        stack.callback(os.environ.clear)
        for kept in (redirect_stdout(nowhere), redirect_stderr(nowhere), chdir("."), catch_warnings(), np.errstate()):
            stack.enter_context(kept)
        yield


def _failing(reason: str) -> Engine[Any]:
    def version() -> str:
        raise ImportError(reason)

    return completed(SimpleNamespace(DEFAULT=Settings("default"), version=version, build=None), "")

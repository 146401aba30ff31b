"""Engines of other distributions, by entry points of the group `linkage_crosscheck.engines`.

An entry point names a module: `mine = "my_package.engine"`. Only metadata are read before an engine is asked for.
An engine whose name another has as well is called NAME@DISTRIBUTION.
"""

import re
import sys
from collections import Counter
from collections.abc import Collection, Mapping
from contextlib import suppress
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution, distributions
from importlib.util import find_spec
from multiprocessing import current_process
from types import SimpleNamespace
from typing import Any, NoReturn

from scenes import Engine, Settings, Status
from scenes.engine import completed
from scenes.errors import one_line
from scenes.format import ENGINE

from .entry import Entry
from .isolation import Ended, Limits, isolated
from .offer import Offer, offer, stand_in
from .reasons import described

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
def imported(entry: Entry) -> Engine[Any]:
    """Return an engine, imported in this process.

    Raises:
        Exception: it cannot be, or offers what is not what the protocol asks for.
    """
    engine = completed(import_module(entry.module), entry.version)
    _offers(engine)
    return engine


def offered(entry: Entry) -> Engine[Any]:
    """Return what an engine offers, of which none can be called where it is not imported; nothing where it cannot be.

    Unless it is already in this process, it is imported in one of its own.
    """
    outcome = _outcome(entry)
    if _is_here(entry) and not isinstance(outcome, Ended):
        return imported(entry)
    names = {} if isinstance(outcome, Ended) else {name: _stand_ins(of) for name, of in outcome.items()}
    return completed(SimpleNamespace(**{"DEFAULT": Settings("default"), "build": _elsewhere} | names), entry.version)


def refused(entry: Entry) -> Ended | None:
    """Return how the import of an engine ended that offers nothing."""
    outcome = _outcome(entry)
    return outcome if isinstance(outcome, Ended) else None


def _is_here(entry: Entry) -> bool:
    return entry.module in sys.modules or current_process().daemon  # which may have no processes


@cache
def _outcome(entry: Entry) -> Mapping[str, Any] | Ended:
    if not _is_here(entry):
        ((_, outcome),) = isolated(_described, [entry], LIMITS, lambda: None)
        return outcome
    try:
        return _described(entry)
    except Exception as error:
        return Ended(Status.crashed, described(error))


def _described(entry: Entry) -> dict[str, Any]:
    return _offers(imported(entry))


def _stand_ins(offers: Any) -> Any:
    if isinstance(offers, tuple):
        return tuple(map(stand_in, offers))
    return stand_in(offers) if isinstance(offers, Offer) else _elsewhere if offers else None


def _elsewhere(*_: object) -> NoReturn:
    raise ImportError("the engine is not imported in this process")


def _offers(engine: Engine[Any]) -> dict[str, Any]:
    """Return what an engine offers as plain data: by name settings, and whether it has some functions.

    Raises:
        TypeError: it is not what the protocol asks for.
        ValueError: two settings have one label.
    """
    tiers = {name: getattr(engine, name) for name in ("DEFAULT", "FAST", "EXACT")}
    ladders = {name: _tuple(getattr(engine, name)) for name in ("WORK_PRECISION", "LONG_WORK_PRECISION", "ABLATIONS")}
    settings = [*tiers.values(), *(each for ladder in ladders.values() for each in ladder)]
    for each in (*settings, *([engine.at_steps(24)] if engine.at_steps else [])):
        check_settings(each)
    labels = Counter(each.label for each in dict.fromkeys(settings))
    if again := next((label for label, number in labels.items() if number > 1), None):
        raise ValueError(f"expected a label of its own for each of its settings, found two of {again}")
    functions = {name: getattr(engine, name) is not None for name in ("at_steps", "iterations_needed")}
    in_data = {name: tuple(map(offer, ladder)) for name, ladder in ladders.items()}
    return {name: offer(each) for name, each in tiers.items()} | in_data | functions


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
    if not (isinstance(settings.order, float | int | None) and {str} == {type(settings.family), type(settings.note)}):
        raise TypeError(f"{settings.label}: expected an order that is a number or None, and family and note as text")
    for promise in (settings.promise, settings.drive_promise):
        if not (isinstance(promise, float) and 0 < promise < 1):
            raise TypeError(f"{settings.label}: expected a promise between 0 and 1, found {promise!r}")

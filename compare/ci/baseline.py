"""What changed since an earlier run of the same scene, by its `summary.json`.

Worse is an engine that was ok and is not. Where the linkage and the sampling are the baseline's, worse is also a
channel that an engine returns no more, an error of more than twice its size, and a peak that moved.
"""

import re
from collections.abc import Iterator, Sequence
from math import inf, isclose, prod
from statistics import median
from typing import Any, TypeAlias

from scenes import Scene
from scenes.errors import one_line, path_in_file
from scenes.fields import quantity_at
from scenes.units import units_of_all

from ..mechanics.quantities import spelled
from ..report.output.earlier import Change, Json, Summary, SummaryError

FACTOR = 2.0  # of errors and times: more than another processor's rounding, or another program on it, makes of them
ROUNDING = 1e-12  # relative, over thousands of steps: what the reference itself promises
ABOVE_FLOOR = 10.0  # times the reference's floor: there the floor is a tenth of the error at most
MIN_CHANGE = 1e-8  # relative, of a peak: less is made by its interpolation between the samples
MAX_SHOWN = 3  # changes of a kind that a line names
EPS = 1e-15  # in SI: what is left of a zero where a unit's conversion rounds
LEFT_OUT = ("file", "title", "source", "units")  # of a scene: they change no number of a result in SI
BASE = {"m": "length", "kg": "mass", "N": "force", "rad": "angle"}  # what the scene's file names a unit of

Place: TypeAlias = tuple[Any, ...]  # as ("scene", "bodies", "rod", "mass")


def changes(old: Summary, new: Summary) -> list[Change]:
    """What changed, the worse first; where one of the two could not run at all, only that and what was asked for."""
    before, after = (summary.model_dump(include={"scene", "sampling", "environment"}) for summary in (old, new))
    inputs = [each for each in _differences(before, after, new.scene) if each[0][1] not in LEFT_OUT]
    alike = all(path[0] == "environment" or path[1] == "tolerances" for path, _ in inputs)
    given = [Change(_few([text for _, text in inputs]))] if inputs else []
    if not (old.engines and new.engines):
        became = Change("it runs" if new.engines else "it does not run", worse=not new.engines)
        return [became, *given] if old.engines or new.engines else given
    changed = [*given, *_engines(old, new), *_errors(old, new, alike), *_peaks(old, new, alike), *_times(old, new)]
    return sorted(changed, key=lambda change: not change.worse)


def _few(texts: Sequence[str]) -> str:
    more = len(texts) - MAX_SHOWN
    return "; ".join(texts[:MAX_SHOWN]) + (f"; and {more} more" if more > 0 else "")


def _differences(old: Json, new: Json, scene: Json | None = None) -> Iterator[tuple[Place, str]]:
    """What differs by more than round-off, and a text, with numbers of the scene in the units of its file."""
    # Both summaries flattened to leaves by path: a table or list that one of the two lacks shows as its single leaves.
    before, after = dict(_leaves(old)), dict(_leaves(new))
    for path in dict.fromkeys((*before, *after)):
        was, now = before.get(path, "none"), after.get(path, "none")
        numbers = all(type(value) in (int, float) for value in (was, now))
        if was != now and not (numbers and isclose(was, now, rel_tol=ROUNDING, abs_tol=EPS)):
            unit = unit_of(path, scene) if scene and path[0] == "scene" else ("", 1.0)
            yield path, f"{path_in_file(path)} {_shown(now, *unit)}, was {_shown(was, *unit)}"


def _shown(value: Any, unit: str, size: float) -> str:
    if type(value) not in (int, float):
        return one_line(str(value), 60)
    return re.sub("^-", "−", f"{value / size:.12g} {spelled(unit)}".strip())


def _leaves(value: Any, path: Place = ()) -> Iterator[tuple[Place, Any]]:  # what is nothing or empty has none
    if isinstance(value, dict | list):
        for key, child in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _leaves(child, (*path, key))
    elif value is not None:
        yield path, value


def _engines(old: Summary, new: Summary) -> Iterator[Change]:
    for name in dict.fromkeys((*old.engines, *new.engines)):
        was, now = old.engines.get(name), new.engines.get(name)
        if was is None or now is None:
            yield Change(f"{name}: {'not in it' if was is None else 'in it alone'}")
            continue
        if was.status != now.status:
            yield Change(f"{name}: {now.status}, was {was.status}", worse=was.status == "ok")
        if was.version != now.version:
            yield Change(f"{name}: {now.version}, was {was.version}")
        differ = [text for _, text in _differences(was.settings or {}, now.settings or {})]
        if was.settings and now.settings and differ:
            yield Change(f"{name}: run at {_few(differ)}")


def _errors(old: Summary, new: Summary, alike: bool) -> Iterator[Change]:
    after = {(error.engine, error.channel): error for error in new.errors}
    compared = {error.engine for error in new.errors}
    grouped: dict[tuple[str, str, str, bool], list[tuple[float, str]]] = {}
    for was in old.errors:
        now = after.get((was.engine, was.channel))
        if was.engine not in compared or (now is None and not alike):
            continue
        ratio = _ratio(was, now) if now else inf
        if 1 / FACTOR <= ratio <= FACTOR:
            continue
        kind, text = "not returned any more:", was.channel
        if now:
            kind = "error in" if ratio > 1 else "smaller error in"
            text = f"{was.channel} {_size(now)}, was {_size(was)}"
        grouped.setdefault((was.engine, was.group, kind, ratio > 1), []).append((-abs(ratio - 1), text))
    for (engine, group, kind, larger), texts in grouped.items():
        yield Change(f"{engine} {group}: {kind} {_few([text for _, text in sorted(texts)])}", worse=alike and larger)


def _ratio(was: SummaryError, now: SummaryError) -> float:
    """How many times as large an error is, of what is above rounding, as it was in the baseline."""
    # Errors below what the reference itself can tell are noise from run to run: both are raised to that level before
    # their ratio is taken, so that noise has the ratio one.
    least = max(ABOVE_FLOOR * (was.floor or 0.0), was.explained or 0.0, ROUNDING)
    before, after = (inf if error.max is None else max(error.max, least) for error in (was, now))
    return 1.0 if before == after else after / before


def _size(error: SummaryError) -> str:
    return "unknown" if error.max is None else f"{error.max:.1e}"


def _peaks(old: Summary, new: Summary, alike: bool) -> Iterator[Change]:
    before, after = ({(peak.name, peak.of): peak for peak in summary.peaks} for summary in (old, new))
    size: dict[tuple[str, str], float] = {}  # the largest of the same place and unit, as the stroke of a dead point
    largest = dict.fromkeys(("m", "N"), 0.0)  # of a unit
    for peak in (*old.peaks, *new.peaks):
        size[peak.of, peak.unit] = max(size.get((peak.of, peak.unit), MIN_CHANGE), abs(peak.value))
        largest[peak.unit] = max(largest.get(peak.unit, 0.0), abs(peak.value))
    # A moment or work of zero by symmetry is a difference of products of forces and arms. Its round-off goes with these
    # products, not with the value.
    for unit in ("N*m", "J"):  # of moments that are zero by symmetry, what is left of forces at their arms
        largest[unit] = max(largest.get(unit, 0.0), largest["N"] * largest["m"])
    moves: list[tuple[float, str]] = []
    for (name, of), was in before.items():
        now = after.get((name, of))
        if now is None:
            moves.append((0.0, f"{name} ({of}) in it alone"))
            continue
        by = abs(now.value - was.value)
        moved, rounding = by / size[of, was.unit], by <= ROUNDING * largest[was.unit]
        differ = [differs for peak in (was, now) for differs in peak.differs.values() if differs is not None]
        if not (rounding or moved <= max(MIN_CHANGE, *differ, 0.0)):
            unit, own = in_file(now.unit, new.scene)
            digits = 6 if moved > 1e-5 else 12
            values = [re.sub("^-", "−", f"{peak.value / own:.{digits}g}") for peak in (now, was)]
            moves.append((-moved, f"{name} ({of}) {values[0]} {spelled(unit)}".rstrip() + f", was {values[1]}"))
    if moves:
        yield Change(f"peaks: {_few([text for _, text in sorted(moves)])}", worse=alike)
    if more := [f"{name} ({of})" for name, of in after if (name, of) not in before]:
        yield Change(f"peaks not in it: {_few(more)}")


def _times(old: Summary, new: Summary) -> Iterator[Change]:
    """How an engine's times changed, each relative to the fastest engine of its own run; never worse."""
    before, after = (
        {(c.engine, c.group, c.level, c.note, c.setting): c.ratio for c in summary.cheapest if c.ratio}
        for summary in (old, new)
    )
    for engine in new.engines:
        # Absolute times differ from machine to machine. The ratio to the fastest engine of the same run does not, and
        # the median over settings is not moved by one disturbed measurement.
        times = median([after[key] / before[key] for key in after if key[0] == engine and key in before] or [1.0])
        if not 1 / FACTOR <= times <= FACTOR:
            yield Change(f"{engine}: {times:.2g} times the time, each relative to the fastest engine of its run")


def unit_of(path: Place, scene: Json) -> tuple[str, float]:
    """The unit that a number of the scene has in its file, and what that is in SI."""
    of_law = path[1:2] == ("drive",)  # in whose table a summary has its numbers
    quantity = quantity_at(Scene, ("drives", 0, "law", *path[2:]) if of_law else path[1:])
    if quantity is None:
        return "", 1.0
    slides = scene["bodies"][scene["drive"]["body"]]["slide"] is not None
    return units_of_all(scene["units"], slides=slides)[quantity.dimension]


def in_file(si: str, scene: Json) -> tuple[str, float]:
    """A unit of SI, such as N*m, in those of the scene's file, and what that is in SI."""
    names, sizes = ({base: scene["units"][quantity][k] for base, quantity in BASE.items()} for k in (0, 1))
    parts = re.findall(r"(/?)([A-Za-z]+)(?:\^(\d))?", si)
    size = prod(sizes[base] ** (int(power or 1) * (-1) ** bool(over)) for over, base, power in parts if base in sizes)
    return re.sub("[A-Za-z]+", lambda base: names.get(base[0], base[0]), si), float(size)

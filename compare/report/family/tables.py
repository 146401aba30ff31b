"""A family's tables and sentences: one row per member, for the terminal, the page and `family.csv`."""

from collections.abc import Callable, Iterator
from math import degrees, floor, isnan, log10, nan

import numpy as np
import pandas as pd

from scenes import Status

from ...engines.axis import prefixed
from ...engines.registry import REFERENCE
from ...family.family import Family, Member
from ...judge.agreement import Agreement, Word, within, worst_error
from ...judge.peaks.peaks import Peak
from ..tables import floors

DIGITS = 5  # significant ones, of the largest number in a column
OVERVIEW = (
    *("stroke", "closed dead point", "closed end", "dwell within 1 % of the stroke", "quick return", "peak speed"),
    *("peak acceleration", "largest force", "peak driving torque", "peak braking torque", "peak driving force"),
    *("peak braking force", "least transmission angle"),
)
AT_JOINTS = ("largest", "least", "distance")  # how the names of numbers begin that are of the worst joint
ON_A_LINE = ("stroke", "quick return", "peak driving torque", "peak driving force")


def names(family: Family) -> list[str]:
    """Return short names of the varied numbers."""
    return short_names([variation.path for variation in family.variations])


def short_names(paths: list[str]) -> list[str]:
    """Return short names of paths: `O-P3` for `bodies.rocker.lengths.O-P3`, as far as that is unique."""
    short = [path.partition(".lengths.")[2] or path.removeprefix("bodies.") for path in paths]
    return short if len(set(short)) == len(short) else paths


def label(family: Family, member: Member) -> str:
    """Return the name of a member: `O-P3 = 300`."""
    changes = zip(names(family), member.changes.values(), strict=True)
    return ", ".join(f"{name} = {value:.6g}" for name, value in changes)


def in_si(family: Family) -> pd.DataFrame:
    """Return one row per member with everything that is known about it, quantities in SI."""
    return pd.DataFrame([_row(family, member) for member in family.members])


def _row(family: Family, member: Member) -> dict[str, object]:
    row: dict[str, object] = dict(member.changes) | {"status": member.status, "reason": member.reason}
    if member.cycle is not None:
        for name, peak in member.cycle.numbers.items():
            row[_header(name, peak.unit)] = peak.value
            if name.startswith(AT_JOINTS):
                row[f"{name} at"] = peak.of
    for m in member.measurements:
        worst = worst_error(family.scene, m)
        results = {"status": m.run.status.name, "error": worst.size if worst else nan}
        results["worst channel"] = worst.channel if worst else ""
        row |= {f"{m.run.engine} {result}": value for result, value in results.items()}
    return row


def _header(name: str, unit: str) -> str:
    return f"{name} [{unit}]" if unit else name


def overview(family: Family) -> pd.DataFrame:
    """Return one row per member as a reader wants it: units with prefixes, as many digits as set the members apart."""
    hyphenated = (name.replace("-", "\u2011") for name in names(family))  # so that names do not break into lines
    changes = zip(hyphenated, zip(*(m.changes.values() for m in family.members), strict=True), strict=True)
    columns = {name: [f"{value:.6g}" for value in values] for name, values in changes}
    columns["status"] = [member.status for member in family.members]
    for name in OVERVIEW:
        peaks = [_number(member, name) for member in family.members]
        if found := [peak for peak in peaks if peak is not None]:
            sizes = [abs(peak.value) for peak in found]
            if name.startswith("closed"):  # as finely as the stroke
                sizes = [abs(peak.value) for member in family.members if (peak := _number(member, "stroke"))]
            unit, written = _writer(found[0].unit, max((size for size in sizes if size > 0), default=1.0))
            joint = name.startswith(AT_JOINTS)
            columns[_header(name, unit)] = [
                f"{written(peak.value)} {peak.of if joint else ''}".strip() if peak else "–" for peak in peaks
            ]
    for number, engine in enumerate(family.engines):
        columns[f"{engine} error"] = [_error(family, member, number) for member in family.members]
    return pd.DataFrame(columns)


def _number(member: Member, name: str) -> Peak | None:
    return member.cycle.numbers.get(name) if member.cycle else None


def _error(family: Family, member: Member, number: int) -> str:
    """Return the largest error of an engine by its number, or why there is none."""
    if not member.measurements:
        return "–"
    m = member.measurements[number]
    if m.run.status is not Status.ok:
        return m.run.status.name
    worst = worst_error(family.scene, m)
    error = worst.size if worst else nan
    return "not certified" if isnan(error) and m.run.engine == REFERENCE else f"{error:.1e}"


def _writer(si: str, scale: float) -> tuple[str, Callable[[float], str]]:
    """Return the unit that suits the scale of a quantity, and a function that writes its values in it."""
    factor, unit = (1.0, "") if not si else prefixed(scale, si.replace("*", " ").replace("^2", "²"))
    if si == "rad":
        factor, unit = degrees(1), "deg"
    decimals = min(max(DIGITS - 1 - floor(log10(scale * factor)), 0), 9)
    return unit, lambda value: f"{value * factor:.{decimals}f}"


def on_a_line(family: Family, member: Member) -> str:
    """Return a member in one line for the terminal."""
    if member.cycle is None:
        return "  ".join((label(family, member), member.status, member.reason))
    parts = [label(family, member), member.status]
    for name in ON_A_LINE:
        if peak := _number(member, name):
            unit, written = _writer(peak.unit, abs(peak.value) or 1.0)
            parts.append(f"{name} {written(peak.value)} {unit}".strip())
    parts += [f"{m.run.engine} {_error(family, member, number)}" for number, m in enumerate(member.measurements)]
    return "  ".join(parts)


# --- sentences -------------------------------------------------------------------------------------------------------


def setup(family: Family) -> str:
    """Return what is varied, in one sentence."""
    spans = (
        f"{v.path} from {v.values[0]:.6g} to {v.values[-1]:.6g}, {len(v.values)} values" for v in family.variations
    )
    return f"Varied, in the units of the file: {'; '.join(spans)}."


def verdict(family: Family) -> str:
    """Return how many members run, and how far each engine is from the reference in the worst of them."""
    sentences = [_ran(family)]
    for engine, solved, worst in _worst(family):
        near = f", and is within {worst:.1e} of the reference" if solved and not isnan(worst) else ""
        sentences.append(f"{engine} solved {solved} of those that run{near}.")
    return " ".join(sentences)


def _ran(family: Family) -> str:
    stopped = "" if family.complete else f"Stopped after {len(family.members)} of {family.asked} members. "
    failed = [m for m in family.members if m.cycle is None]
    if not failed:
        return f"{stopped}All {len(family.members)} members run."
    first = f"{label(family, failed[0])} ({failed[0].status})"
    return f"{stopped}Members that do not run: {len(failed)} of {len(family.members)}, first {first}."


def _worst(family: Family) -> Iterator[tuple[str, int, float]]:
    """Yield by engine how many members it solved, and its largest error on them."""
    for number, engine in enumerate(family.engines):
        if engine != REFERENCE:
            own = [member.measurements[number] for member in family.members if member.measurements]
            solved = [m for m in own if m.run.status is Status.ok]
            found = [worst_error(family.scene, m) for m in solved]
            yield engine, len(solved), np.max([error.size for error in found if error], initial=0.0)  # NaN: the largest


def agreement(family: Family) -> Agreement:
    """Return whether the models agree on all members that run, and on which they do so the least."""
    order = (Word.agrees, Word.in_part, Word.not_solved, Word.disagrees)
    found = [(label(family, m), m.judgement.agreement) for m in family.members if m.judgement is not None]
    if not found:
        return Agreement(Word.not_solved, _ran(family))
    name, worst = max(found, key=lambda member: order.index(member[1].word))
    if worst.word is Word.agrees:
        engine, _, size = max(_worst(family), key=lambda engine: engine[2])
        to = f"with the reference to {within(size)}; {engine} is the farthest"
        word = Word.agrees if len(found) == len(family.members) else Word.in_part
        return Agreement(word, f"{_ran(family)} On all that run the engines agree {to}.")
    alike = [own.word for _, own in found].count(worst.word)
    word = Word.in_part if worst.word is Word.not_solved and alike < len(found) else worst.word
    which = f"Of the {len(found)} that run {alike}: {worst.word}; the first is {name}" if len(found) > 1 else name
    return Agreement(word, f"{_ran(family)} {which}: {worst.sentence}")


def notes(family: Family) -> list[str]:
    """Return how far the reference may be off, which members cannot run, and which engines fail on which; and why."""
    sentences = [*floors(m.judgement.reference.floor for m in family.members if m.judgement is not None)]
    sentences += [f"{label(family, m)}: {m.status}: {m.reason}" for m in family.members if m.cycle is None]
    for member in family.members:
        failed = (m.run for m in member.measurements if m.run.status is not Status.ok)
        sentences += [f"{label(family, member)}: {run.engine}: {run.status.name}: {run.reason}" for run in failed]
    return sentences

"""A family's tables and sentences: a row a member, for the terminal, the page and `family.csv`."""

from collections.abc import Callable, Iterable, Sequence
from math import floor, isnan, log10, nan
from operator import itemgetter

from scenes import Status
from scenes.channels import named
from scenes.scene import VariationTable

from ...engines.registry import REFERENCE
from ...judge.agreement import Agreement, Word, WorstError, worst_error
from ...judge.measure import Measurement
from ...judge.peaks.numbers import CLOSED, DWELL, STROKE
from ...judge.peaks.peaks import Peak
from ...judge.verdict import within
from ...measure.many.family import Family, Member
from ...measure.many.grid import VariedNumber
from ...mechanics.axis import fixed, prefixed
from ..numbers import Units, suited, written
from . import TableRows
from .study import floors

DIGITS = 5  # significant ones, of the largest number in a column
EFFORTS = ("peak driving torque", "peak braking torque", "peak driving force", "peak braking force")
MOTION = (STROKE, CLOSED, DWELL, "quick return", "peak speed", "peak acceleration")
OVERVIEW = (*MOTION, "largest force", *EFFORTS, "least transmission angle")  # kinds of numbers
ON_A_LINE = (STROKE, "quick return", "peak driving torque", "peak driving force")
AT_JOINTS = ("fx", "guide_force", "guide_moment", "transmission", "to_lock")  # quantities of which the worst is shown
WORST_LAST = (Word.agrees, Word.in_part, Word.not_solved, Word.disagrees)


def names(variations: Iterable[VariedNumber | VariationTable]) -> list[str]:
    """Short names of what varies: `O-P3` for `bodies.rocker.lengths.O-P3`, as far as that is unique."""
    paths = [variation.path for variation in variations]
    short = [path.partition(".lengths.")[2] or path.removeprefix("bodies.") for path in paths]
    return short if len(set(short)) == len(short) else paths


def label(family: Family, member: Member) -> str:
    """The name of a member: `O-P3 = 300`."""
    changes = zip(names(family.variations), member.changes.values(), strict=True)
    return ", ".join(f"{name} = {value:.6g}" for name, value in changes)


def in_si(family: Family) -> TableRows:
    """Yield a row a member with everything that is known about it, quantities in SI."""
    for member in family.members:
        row: dict[str, object] = {**member.changes, "status": member.status, "reason": member.reason}
        for peak in member.numbers.values():
            row[_header(peak, peak.unit)] = peak.value
            if _at_a_joint(peak):
                row[f"{peak.kind} at"] = peak.of
        for m in member.measurements:
            worst = worst_error(family.scene, m) or WorstError(nan, "", nan)
            row |= {f"{m.run.engine} status": m.run.status.name, f"{m.run.engine} error": worst.size}
            row |= {f"{m.run.engine} worst channel": worst.channel}
        yield row


def overview(family: Family) -> TableRows:
    """Yield a row a member as a reader wants it: units with prefixes, as many digits as set the members apart."""
    varied = [name.replace("-", "\u2011") for name in names(family.variations)]  # which do not break into lines
    known = [member.numbers for member in family.members]
    kinds = (kind for kind in OVERVIEW if any(kind in numbers for numbers in known))
    columns = [(kind, *_column(kind, known, shown_units(family))) for kind in kinds]
    for member, numbers in zip(family.members, known, strict=True):
        changes = (f"{value:.6g}" for value in member.changes.values())
        row: dict[str, object] = {**dict(zip(varied, changes, strict=True)), "status": member.status}
        row |= {header: text(numbers[kind]) if kind in numbers else "–" for kind, header, text in columns}
        errors = [*map(_error, member.measurements)] or ["–"] * len(family.engines)
        yield row | {f"{engine} error": error for engine, error in zip(family.engines, errors, strict=True)}


def shown_units(family: Family) -> Units:
    """Units of the page: one for each kind of quantity, by the numbers of all members that run."""
    judged = [member.judgement for member in family.members if member.judgement is not None]
    return suited(family.scene.units, ((peak.unit, peak.value) for each in judged for peak in each.peaks))


def _column(kind: str, members: Sequence[dict[str, Peak]], named: Units) -> tuple[str, Callable[[Peak], str]]:
    """The header of a column of numbers, and a function that writes one: all in one unit, as finely; zero as `0`."""
    scaled_by = STROKE if kind == CLOSED else kind
    largest = max((abs(numbers[scaled_by].value) for numbers in members if scaled_by in numbers), default=0.0) or 1.0
    first = next(numbers[kind] for numbers in members if kind in numbers)
    factor, unit = named.get(first.unit) or prefixed(largest, first.unit)
    # All numbers of a column have the same number of decimals, by which its largest has five significant digits:
    # smaller ones are then as fine in absolute terms, and members can be compared down the column.
    decimals, joint = min(max(DIGITS - 1 - floor(log10(largest * factor)), 0), 9), _at_a_joint(first)

    def text(peak: Peak) -> str:
        return f"{fixed(peak.value * factor, decimals)} {peak.of if joint else ''}".strip()

    return _header(first, unit), text


def _header(peak: Peak, unit: str) -> str:
    name = peak.kind if _at_a_joint(peak) else peak.name
    return f"{name} [{unit}]" if unit else name


def _at_a_joint(peak: Peak) -> bool:
    return named(peak.channel).name in AT_JOINTS


def _error(m: Measurement) -> str:
    if m.run.status is not Status.ok:
        return m.run.status.name
    return "not certified" if m.run.engine == REFERENCE and isnan(m.largest) else f"{m.largest:.1e}"


def on_a_line(family: Family, member: Member) -> str:
    """A member in one line for the terminal."""
    parts, numbers = [label(family, member), member.status], member.numbers
    shown = (numbers[kind] for kind in ON_A_LINE if kind in numbers)
    parts += [f"{peak.kind} {written(peak.value, peak.unit, shown_units(family), digits=DIGITS)}" for peak in shown]
    parts += [f"{m.run.engine} {_error(m)}" for m in member.measurements]
    return "  ".join(parts if member.cycle else [*parts, member.reason])


# --- sentences -------------------------------------------------------------------------------------------------------


def setup(family: Family) -> str:
    """What is varied, in one sentence."""
    varied = family.variations
    spans = (f"{v.path} from {v.values[0]:.6g} to {v.values[-1]:.6g}, {len(v.values)} values" for v in varied)
    return f"Varied, in the units of the file: {'; '.join(spans)}."


def _ran(family: Family) -> str:
    stopped = "" if family.complete else f"Stopped after {len(family.members)} of {family.asked} members. "
    failed = [m for m in family.members if m.cycle is None]
    if not failed:
        return f"{stopped}All {len(family.members)} members run."
    first = f"{label(family, failed[0])} ({failed[0].status})"
    return f"{stopped}Members that do not run: {len(failed)} of {len(family.members)}, first {first}."


def agreement(family: Family) -> Agreement:
    """Whether the models agree on all members that run, and on which they do so the least."""
    judged = [(label(family, m), m.judgement.agreement) for m in family.members if m.judgement is not None]
    if not judged:
        return Agreement(Word.not_solved, _ran(family))
    name, worst = max(judged, key=lambda member: WORST_LAST.index(member[1].word))
    if worst.word is Word.agrees:
        solved = [m for member in family.members for m in member.measurements if m.run.status is Status.ok]
        size, engine = max(((m.largest, m.run.engine) for m in solved if m.run.engine != REFERENCE), key=itemgetter(0))
        closeness = f"with the reference to {within(size)}; {engine} is the farthest"
        word = Word.agrees if len(judged) == len(family.members) else Word.in_part
        return Agreement(word, f"{_ran(family)} On all that run the engines agree {closeness}.")
    alike = [found.word for _, found in judged].count(worst.word)
    word = Word.in_part if worst.word is Word.not_solved and alike < len(judged) else worst.word
    counted = f"Of the {len(judged)} that run {alike}: {worst.word}; the first is {name}" if len(judged) > 1 else name
    return Agreement(word, f"{_ran(family)} {counted}: {worst.sentence}")


def failures(family: Family) -> list[str]:
    """Which members cannot run, and why."""
    return [f"{label(family, m)}: {m.status}: {m.reason}" for m in family.members if m.cycle is None]


def notes(family: Family) -> list[str]:
    """How far the reference may be off, which members cannot run, and which engines fail on which; and why."""
    sentences = [*floors(m.judgement.reference.floor for m in family.members if m.judgement), *failures(family)]
    failed = [
        (member, m.run) for member in family.members for m in member.measurements if m.run.status is not Status.ok
    ]
    return sentences + [
        f"{label(family, member)}: {run.engine}: {run.status.name}: {run.reason}" for member, run in failed
    ]

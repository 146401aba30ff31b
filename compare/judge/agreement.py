"""Whether the models agree, in a word, and in a plain sentence how well, or which of them does not and why."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import ceil, floor, isfinite, log10
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from scenes import Scene, Status
from scenes.request import FEWEST

from ..engines import registry
from ..engines.axis import axis
from ..engines.registry import REFERENCE
from .errors import SHOWN_GROUPS, worst_of
from .floor import FLOOR_SAMPLES
from .measure import Measurement

if TYPE_CHECKING:
    from .judgement import Judgement

CONTRADICTS = (Status.wrong_branch, Status.inconsistent, Status.inaccurate)  # with a motion, but another one
FAILED = {
    Status.unsupported: "cannot model this scene",
    Status.cannot_assemble: "could not put the bodies together",
    Status.diverged: "ran away",
    Status.not_converged: "did not converge",
    Status.nonfinite: "returned values that are not finite",
    Status.timed_out: "ran out of time",
    Status.crashed: "crashed",
}  # why there is nothing to compare
PER_CENT = 1e-6  # relative: less is given in digits
EQUAL = 1e-6  # of a cycle: instants are written at decimals


class Word(StrEnum):
    """The verdict in a word."""

    agrees = "agrees"
    in_part = "agrees in part"
    disagrees = "disagrees"
    not_solved = "not solved"


@dataclass(frozen=True)
class Agreement:
    """The verdict on all models of a scene."""

    word: Word
    sentence: str


class WorstError(NamedTuple):
    """The largest error of an engine over all channels."""

    size: float  # relative, none below the reference's floor; NaN of the reference without one
    channel: str
    position: float  # on the axis of curves and tables, SI: rad, m, or s under a law; NaN of the floor, found nowhere


def worst_error(scene: Scene, measurement: Measurement, groups: Sequence[str] = ()) -> WorstError | None:
    """Return the largest error of an engine, a NaN counting as the largest; None where nothing was compared.

    Args:
        scene: the linkage.
        measurement: of the engine.
        groups: the channel groups to look at; all where none is named.
    """
    rows = [row for row in measurement.errors if not groups or row.group in groups]
    if not rows:
        return None
    row = worst_of(rows)
    at = np.nan if row.max <= row.floor else row.max_at / axis(scene).factor
    return WorstError(row.max, row.channel, at)


def agreement(judged: "Judgement") -> Agreement:
    """Return whether the models agree.

    They agree where the judgement is ok, and other engines confirm every channel of the reference; in part, where no
    model contradicts another and some of them, or arbitrary precision, confirm the reference.
    """
    others = [m for m in judged.measurements if m.run.engine != REFERENCE]
    confirming = [m for m in others if m.run.status is Status.ok]
    contradiction = _contradiction(judged, others)
    unsolved = [f"{m.run.engine} {_why(m)}" for m in others if m.run.status is not Status.ok]
    if contradiction:
        return Agreement(Word.disagrees, contradiction)
    if not confirming:
        alone = f"{_listed(unsolved)}; nothing else checks it" if unsolved else "No other engine was asked"
        certified = judged.reference.floor.by_channel and not unsolved
        sentence = f"{alone}; {_certified(judged)}."
        return Agreement(Word.in_part if certified else Word.not_solved, sentence)
    sentence = f"{_confirmed(judged, confirming)}; {_certified(judged)}."
    whole = [m for m in confirming if _whole_cycle(judged.scene, m)]
    given = {channel for m in whole if m.run.motion for channel in m.run.motion.samples}
    given |= {"time", judged.scene.drive_channel}  # inputs
    unchecked = [channel for channel in judged.sampling.wanted(judged.scene) if channel not in given]
    if unchecked:
        where = " over a whole cycle" * (len(whole) < len(confirming)) + ", among others" * (len(unchecked) > 1)
        sentence += f" No other engine that is ok gives {unchecked[0]}{where}."
    if judged.ok and not unchecked:
        count = len(judged.held)
        met = {0: "", 1: " The tolerance is met."}.get(count, f" All {count} tolerances are met.")
        return Agreement(Word.agrees, sentence + met)
    besides = [f"{_listed(unsolved)}."] if unsolved else []
    if judged.let_through:
        besides.append("The comparison let through faults that were put into copies of these runs.")
    return Agreement(Word.in_part, " ".join([sentence, *besides]))


def _whole_cycle(scene: Scene, measurement: Measurement) -> bool:
    """Return whether a model was compared over a whole cycle, as engines are; a result is where it has rows.

    Its longest step is no longer than that of the fewest samples that engines are asked for.
    """
    if measurement.own is None:
        return True
    times, cycle = measurement.own.times(scene), scene.drive.cycle
    step = float(np.diff(times).max(initial=0.0))  # to the first row of the next cycle too
    return bool(FEWEST * step <= (1 + EQUAL) * cycle and times[-1] - times[0] + step >= (1 - EQUAL) * cycle)


def _contradiction(judged: "Judgement", others: Sequence[Measurement]) -> str:
    """Return which model contradicts the rest, in what, by how much, and the likely cause; or nothing."""
    core = next((m.run for m in judged.measurements if m.run.engine == REFERENCE), None)
    if doubt := judged.reference.floor.doubt:
        return f"{_capital(_name(judged))} is not to be believed: {doubt.partition(': ')[0]}."
    if core is not None and core.status is not Status.ok:
        return f"{_capital(_name(judged))} {FAILED.get(core.status, 'contradicts itself')}."
    off = [m for m in others if m.run.status in CONTRADICTS]
    if off:
        worst = max(off, key=lambda m: _size(judged, m))
        names, verb = _listed([m.run.engine for m in off]), "disagrees" if len(off) == 1 else "disagree"
        which = "" if len(off) == 1 else f", most of all {worst.run.engine}"
        return f"{names} {verb} with {_name(judged)}{which}{_by(judged, worst)}{_cause(judged, worst)}."
    missed = [gate for gate in judged.held if gate.missed]
    ok = {m.run.engine: m for m in others if m.run.status is Status.ok}
    for gate in missed:
        if gate.engine in ok or gate.engine == REFERENCE:
            size = f"off by {sized(gate.error)} in {gate.worst}" if isfinite(gate.error) else gate.worst
            cause = _cause(judged, ok[gate.engine]) if gate.engine in ok else ""
            return f"{gate.engine} misses its {gate.group} tolerance: {size}{cause}."
    return ""


def _confirmed(judged: "Judgement", confirming: Sequence[Measurement]) -> str:
    size = max(_size(judged, m) for m in confirming)
    verb = "agrees" if len(confirming) == 1 else "agree"
    channels = "every channel" if judged.sampling.channels is None else "every channel asked for"
    engines = _listed([m.run.engine for m in confirming])
    if any(m.own or (m.run.motion and m.run.motion.unsupported) for m in confirming):
        channels += " that it gives" if len(confirming) == 1 else " that each gives"
    to = f" to {within(size)}" if isfinite(size) else ""  # nothing but the drive may have been asked for
    return f"{engines} {verb} with {_name(judged)}{to} in {channels}"


def _size(judged: "Judgement", measurement: Measurement) -> float:
    """Return the largest error of an engine for comparison: infinite where it is no number."""
    worst = worst_error(judged.scene, measurement, SHOWN_GROUPS)
    return worst.size if worst is not None and isfinite(worst.size) else np.inf


def _by(judged: "Judgement", measurement: Measurement) -> str:
    worst = worst_error(judged.scene, measurement)
    if worst is None:
        return ""
    return f" by {sized(worst.size)} in {worst.channel}" if isfinite(worst.size) else f" in {worst.channel}"


def _cause(judged: "Judgement", measurement: Measurement) -> str:
    """Return the likely cause where one is known and every number in it reads plainly."""
    engine = measurement.run.engine
    cause = judged.causes.get(engine, "").removeprefix(f"{engine}: ")
    plain = not any(part in cause for part in ("e-", "e+", "nan", "inf"))
    return f"; likely cause: {cause}" if cause and plain else ""


def _why(measurement: Measurement) -> str:
    run, entry = measurement.run, registry.ENTRIES.get(measurement.run.engine)
    if entry is not None and entry.missing:
        return "cannot be run" if entry.trouble else "is not installed"
    return FAILED.get(run.status, "contradicts itself")


def _name(judged: "Judgement") -> str:
    return "the closed form" if registry.route(judged.scene).startswith("closed form") else "the reference"


def _certified(judged: "Judgement") -> str:
    floor = judged.reference.floor
    if floor.by_channel:
        there = f"{digits(max(floor.by_channel.values()))} digits at {FLOOR_SAMPLES} positions of the drive"
        return f"a calculation with 50 digits confirms {_name(judged)} to {there}{floor.limit}"
    return f"no calculation with 50 digits confirms {_name(judged)}"


def _listed(names: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


# --- figures that read plainly ---------------------------------------------------------------------------------------


def within(size: float) -> str:
    """Return a relative error as a bound: `0.0004 %`, rounded up, or `9 digits`."""
    if size < PER_CENT:
        return f"{digits(size)} digits"
    return _per_cent(size, ceil, 1)


def sized(size: float) -> str:
    """Return a relative error as a size: `3.1 %`, or between two bounds."""
    if size < PER_CENT:
        return "less than 0.0001 %"
    return _per_cent(size, round, 2) if size < 10 else "more than 1000 %"


def digits(size: float) -> int:
    """Return how many digits a relative error leaves, 15 at most."""
    return min(floor(-log10(size)), 15) if size > 0 else 15


def _per_cent(size: float, rounded: Callable[[float], int], figures: int) -> str:
    """Return a size in per cent, rounded to so many figures."""
    last = floor(log10(100 * size)) - figures + 1  # the power of ten of the last figure
    text = f"{rounded(100 * size / 10.0**last) * 10.0**last:.{max(-last, 0)}f}"
    return f"{text.rstrip('0').rstrip('.') if '.' in text else text} %"

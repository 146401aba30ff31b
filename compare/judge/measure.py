"""One engine, one setting: run, compare, check, judge it; other settings where it fails; and what stops a CI run."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import nan
from typing import NamedTuple

import numpy as np

from scenes import Failure, Instants, Motion, Rows, Sampling, Scene, Settings, Status
from scenes.channels import Role

from ..engines.registry import REFERENCE, tiers
from ..engines.runner import HERE, Run, Runs, complete
from ..mechanics.mechanics import Mechanics
from ..mechanics.reference import Reference
from ..mechanics.round_off import Explained, explain
from ..mechanics.scales import travels
from .checks import Check, checks
from .errors import ChannelError, Comparison, by_group, compare, error_table, worst_of
from .verdict import compared, doubted_core, judged, share

# Which no other settings change; unsupported they may: fictitious masses do without the mass that a body lacks.
FINAL = {Status.ok, Status.cannot_assemble, Status.jammed, Status.undetermined, Status.timed_out, Status.crashed}


@dataclass(frozen=True)
class Measurement:
    """A judged run and what is known about it; nothing but the run where it gave no motion."""

    run: Run
    comparison: Comparison | None
    checks: list[Check]
    errors: Sequence[ChannelError] = ()
    finer: str = ""  # settings that fail too, and what they leave of the error, where that is hardly any
    asked: Rows = field(default_factory=Sampling)  # what was asked for: of a result of another program its own instants

    @property
    def foreign(self) -> bool:
        """Whether it is a result of another program."""
        return isinstance(self.asked, Instants)

    def worst(self, figure: str = "max") -> dict[str, float]:
        """The largest of a figure of the errors by channel group; a NaN counts as the largest."""
        return {group: getattr(worst_of(rows, figure), figure) for group, rows in sorted(by_group(self.errors).items())}

    @property
    def largest(self) -> float:
        """The largest error of all channels, not a number where none is known."""
        return worst_of(self.errors).max if self.errors else nan


class Standard(NamedTuple):
    """What runs of the same samples are held against."""

    reference: Reference
    sampling: Rows
    explained: Explained  # the errors there that need no other explanation

    @classmethod
    def of(cls, reference: Reference, sampling: Rows) -> "Standard":
        """That of a reference; a `Failure` where it has no motion at the samples."""
        return cls(reference, sampling, explain(reference, sampling))

    def measure(self, engine: str, settings: Settings | None = None, runs: Runs = HERE) -> "Measurement":
        """Run an engine at these samples, at its default settings or others, then assess the result."""
        assert not isinstance(self.sampling, Instants)  # which no engine is asked for
        return assess(self, runs.run(engine, self.reference.scene, self.sampling, settings))


def measure(
    reference: Reference, engine: str, sampling: Sampling, settings: Settings | None = None, runs: Runs = HERE
) -> Measurement:
    """Run an engine, at its default settings or others, then assess the result."""
    return Standard.of(reference, sampling).measure(engine, settings, runs)


@np.errstate(all="ignore")  # of whatever numbers an engine gives; what is not finite is so in the result
def assess(standard: Standard, outcome: Run, find: Callable[[Motion], list[Check]] | None = None) -> Measurement:
    """Hold a run against what was asked for, its own output, the reference, and what its settings promise.

    A reference that is in doubt is not held against another engine. `find` is what the checks of its own output find in
    a motion that it has no excuse for; None for all.
    """
    reference, sampling, explained = standard
    scene = reference.scene
    outcome = complete(outcome, scene, sampling)
    if outcome.motion is None:
        return Measurement(outcome, None, [], asked=sampling)
    promise = (outcome.settings or Settings("")).promise
    find_checks = find or (lambda motion: checks(reference.mechanics, motion, reference.travel, promise))
    # Order of judgement: completeness, checks of the run's own output, the reference. A later step cannot excuse what
    # an earlier one found.
    checked = find_checks(outcome.motion)
    verdict = judged(outcome, checked)
    try:
        comparison = compare(reference, sampling, outcome.motion)
    except Failure as failure:
        reason = f"its drive is where no reference is: {failure.reason}"
        if verdict.status is Status.ok and not reference.floor.doubt:
            verdict = replace(verdict, status=Status.diverged, reason=reason, found_by="reference")
        return Measurement(verdict, None, checked, asked=sampling)
    table = [*error_table(outcome.engine, comparison, reference, explained)]
    unexplained = explained.left_over(comparison.commanded)
    doubt, given = reference.floor.doubt, {*scene.channels.names(Role.time, Role.input)}
    if verdict.status is Status.ok and outcome.motion.samples.keys() <= given < {*sampling.wanted(scene)}:
        reason = "it gives nothing but the time and the drive's position, so that there is nothing to compare"
        verdict = replace(verdict, status=Status.unsupported, reason=reason, found_by="checks")
    elif not doubt:
        verdict = compared(verdict, scene, comparison, unexplained)
    elif outcome.engine == REFERENCE and verdict.status is Status.ok:
        verdict = doubted_core(verdict, doubt)
    return Measurement(verdict, comparison, checked, table, asked=sampling)


@np.errstate(all="ignore")
def checked_run(
    engine: str, scene: Scene, sampling: Sampling, settings: Settings | None = None, runs: Runs = HERE
) -> Run:
    """Run an engine where there is no reference, and judge the result by itself."""
    outcome = complete(runs.run(engine, scene, sampling, settings), scene, sampling)
    if outcome.motion is None:
        return outcome
    promise, travel = (outcome.settings or Settings("")).promise, travels(scene, outcome.motion)
    return judged(outcome, checks(Mechanics(scene), outcome.motion, travel, promise))


# Where an engine fails, or breaks its promise, at the settings asked for, others that it offers are tried: first the
# more accurate ones, by smaller steps, more sweeps, another integrator; then the cheaper ones, which hold at times when
# those do not. All are held to the promise that was asked for.


def offers(engine: str, tier: str) -> list[Settings]:
    """The settings of that name, then the more accurate ones, then the cheaper ones, all of one promise."""
    offered, asked = [*tiers(engine).values()], tiers(engine)[tier]
    first = offered.index(asked)
    return promising(asked.promise, (*offered[first:], *reversed(offered[:first])))


def promising(promise: float, settings: Iterable[Settings]) -> list[Settings]:
    """Settings with another promise, each once."""
    return list(dict.fromkeys(replace(each, promise=promise) for each in settings))


def attempts(measure: Callable[[Settings], Measurement], offered: Sequence[Settings]) -> Iterator[Measurement]:
    """Yield the measurement asked for, and further ones until one does not fail, or is not to be helped."""
    for settings in offered:
        measured = measure(settings)
        yield measured
        if measured.run.status in FINAL:
            return


def escalated(measure: Callable[[Settings], Measurement], offered: Sequence[Settings]) -> tuple[Measurement, str]:
    """The first measurement that is ok, or else the one asked for; and in a sentence what was tried."""
    first, *further = tried = [*attempts(measure, offered)]
    if not further:
        return first, ""
    taken = tried[-1].run
    failed = tried if taken.status is not Status.ok else tried[:-1]
    ended = "; ".join(f"{_label(m.run)} ended {m.run.status.name}, {m.run.reason}" for m in failed)
    if taken.status is not Status.ok:
        return replace(first, finer=_finer(first, further)), f"{taken.engine}: {ended}"
    note = f": {taken.settings.note}" if taken.settings and taken.settings.note else ""
    return tried[-1], f"{taken.engine}: {ended}; so {_label(taken)} was taken{note}"


def _finer(first: Measurement, further: Iterable[Measurement]) -> str:
    """Which settings leave hardly any of the error over, and how much, or nothing."""
    from .causes.evidence import MAX_REST  # late, as what a run that is right needs none of

    error = first.largest
    left = min(((m.largest / error, _label(m.run)) for m in further if m.largest < MAX_REST * error), default=None)
    return f"{left[1]} leave {share(left[0])}" if left else ""


def _label(run: Run) -> str:
    return run.settings.label if run.settings else ""


# What a CI run is stopped by: the tolerances of the scene, engine by engine and group by group.


@dataclass(frozen=True)
class Gate:
    """One tolerance and whether it was met."""

    engine: str
    group: str
    tolerance: float
    error: float  # NaN where there is none
    worst: str  # the channel, or why there is no error
    unexplained: float = nan  # the part of the largest errors that doubles do not explain
    held: bool = True  # whether there is a reference to hold the engine against, one that is not in doubt

    @property
    def missed(self) -> bool:
        """Whether it is held, and what doubles do not explain is not shown to be within the tolerance; NaN is not."""
        return self.held and not (self.unexplained <= self.tolerance)

    @property
    def met(self) -> str:
        """Whether it was met, in a word or two."""
        if not self.held:
            return "not held"
        if self.missed:
            return "missed"
        return "met" if self.error <= self.tolerance else "met: round-off explains the error"

    def __str__(self) -> str:
        """It in one line."""
        if not self.held:
            return f"{self.engine} {self.group}: a tolerance of {self.tolerance:.0e}; {self.worst}"
        error = f"{self.error:.2e} against a tolerance of {self.tolerance:.0e}"
        return f"{self.engine} {self.group}: {error} ({self.worst})"


class Miss(NamedTuple):
    """What a CI run is stopped by."""

    engine: str  # empty where it is the comparison itself
    group: str  # of channels; empty where it is all of them
    text: str  # in one line


def gates(
    scene: Scene, measurements: Iterable[Measurement], wanted: frozenset[str] | None = None, doubt: str = ""
) -> Iterator[Gate]:
    """Yield every tolerance of the engines that ran, in the wanted channels or all; in a doubt none is held."""
    groups = {scene.channels[name].group for name in wanted or ()}
    for measurement in measurements:
        run, errors = measurement.run, by_group(measurement.errors)
        for group, tolerance in scene.tolerances.get(run.engine, {}).items():
            if wanted is not None and group not in groups:
                continue
            gate = partial(Gate, run.engine, group, tolerance)
            if doubt:
                yield gate(nan, "the reference is in doubt", held=False)
            elif run.status is not Status.ok:
                yield gate(nan, f"{run.status.name}: {run.reason}")
            elif group not in errors:
                yield gate(nan, "no such channel was returned")
            else:
                unexplained = worst_of(errors[group], "unexplained").unexplained
                shown = "max" if unexplained <= tolerance else "unexplained"  # of a tolerance missed, what misses it
                worst = worst_of(errors[group], shown)
                yield gate(getattr(worst, shown), worst.channel, unexplained)


def missed(measurements: Iterable[Measurement], held: Iterable[Gate]) -> list[Miss]:
    """What stops a CI run: every tolerance missed, and engines that are not ok and have none."""
    gated = list(held)
    named = {gate.engine for gate in gated if gate.held}
    runs = [m.run for m in measurements if m.run.status is not Status.ok and m.run.engine not in named]
    tolerances = [Miss(gate.engine, gate.group, str(gate)) for gate in gated if gate.missed]
    return tolerances + [Miss(r.engine, "", f"{r.engine}: {r.status.name}: {r.reason}") for r in runs]

"""One engine, one setting: run it, compare it, check it, judge it; and other settings where it fails."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from scenes import Failure, Instants, Motion, Rows, Sampling, Scene, Settings, Status

from ..engines.registry import REFERENCE, tiers
from ..engines.runner import HERE, Run, Runs, complete
from ..mechanics.mechanics import SHOWN_GROUPS, Mechanics
from ..mechanics.reference import Reference
from ..mechanics.round_off import Explained, explain
from ..mechanics.scales import travels
from .causes.evidence import NEARLY_ALL
from .checks import Check, checks
from .errors import ChannelError, Comparison, by_group, compare, error_table, worst_of
from .verdict import compared, doubted_core, judged, share

HELPED = {  # by other settings, at times
    Status.wrong_branch,
    Status.diverged,
    Status.not_converged,
    Status.inconsistent,
    Status.inaccurate,
    Status.nonfinite,
    Status.unsupported,  # a body without mass, which fictitious masses do without
}


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
        groups = sorted(by_group(self.errors).items())
        return {group: getattr(worst_of(rows, figure), figure) for group, rows in groups}

    @property
    def largest(self) -> float:
        """The largest error of all channels, not a number where none is known."""
        return worst_of(self.errors).max if self.errors else np.nan

    @property
    def estimate(self) -> float:
        """The largest relative error that is known without a reference; zero where too few channels are there."""
        return float(np.max([check.worst for check in self.checks if check.check in SHOWN_GROUPS], initial=0.0))


def measure(
    reference: Reference,
    engine: str,
    sampling: Sampling,
    settings: Settings | None = None,
    explained: Explained | None = None,
    runs: Runs = HERE,
) -> Measurement:
    """Run an engine, at its default settings or others, then assess the result."""
    outcome = runs.run(engine, reference.scene, sampling, settings)
    return assess(reference, sampling, outcome, explained or explain(reference, sampling))


def assess(
    reference: Reference,
    sampling: Rows,
    outcome: Run,
    explained: Explained,
    find: Callable[[Motion], list[Check]] | None = None,
) -> Measurement:
    """Hold a run against what was asked for, its own output, the reference, and what its settings promise.

    A reference that is in doubt is not held against another engine. `find` is what the checks of its own output find in
    a motion that it has no excuse for; None for all.
    """
    scene = reference.scene
    outcome = complete(outcome, scene, sampling)
    if outcome.motion is None:
        return Measurement(outcome, None, [], asked=sampling)
    checked = find(outcome.motion) if find else checks(reference.mechanics, outcome.motion, reference.travel)
    verdict = judged(outcome, checked)
    try:
        comparison = compare(reference, sampling, outcome.motion)
    except Failure as failure:
        reason = f"its drive is where no reference is: {failure.reason}"
        if verdict.status is Status.ok and not reference.floor.doubt:
            verdict = replace(verdict, status=Status.diverged, reason=reason, found_by="reference")
        return Measurement(verdict, None, checked, asked=sampling)
    table = error_table(outcome.engine, comparison, reference, explained)
    unexplained = explained.left_over(comparison.commanded)
    doubt = reference.floor.doubt
    if not doubt:
        verdict = compared(verdict, scene, comparison, unexplained)
    elif outcome.engine == REFERENCE and verdict.status is Status.ok:
        verdict = doubted_core(verdict, doubt)
    return Measurement(verdict, comparison, checked, table, asked=sampling)


def checked_run(
    engine: str, scene: Scene, sampling: Sampling, settings: Settings | None = None, runs: Runs = HERE
) -> Run:
    """Run an engine where there is no reference, and judge the result by itself."""
    outcome = complete(runs.run(engine, scene, sampling, settings), scene, sampling)
    if outcome.motion is None:
        return outcome
    return judged(outcome, checks(Mechanics(scene), outcome.motion, travels(scene, outcome.motion)))


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
        if measured.run.status not in HELPED:
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
    off = first.largest
    left = min(((m.largest / off, _label(m.run)) for m in further if m.largest < NEARLY_ALL * off), default=None)
    return f"{left[1]} leave {share(left[0])}" if left else ""


def _label(run: Run) -> str:
    return run.settings.label if run.settings else ""

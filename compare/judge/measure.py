"""One engine, one setting: run it, compare it, check it, judge it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from scenes import Failure, Instants, Motion, Rows, Sampling, Scene, Settings, Status

from ..engines import runner
from ..engines.reference import Reference
from ..engines.registry import REFERENCE
from ..engines.runner import Run, Runs, complete
from ..engines.travel import travels
from .checks import Check, checks
from .errors import SHOWN_GROUPS, ChannelError, Comparison, by_group, compare, error_table, worst_of
from .round_off import Explained, explain
from .verdict import compared, judged


@dataclass(frozen=True)
class Measurement:
    """A judged run and what is known about it; nothing but the run where it gave no motion."""

    run: Run
    comparison: Comparison | None
    checks: list[Check]
    errors: Sequence[ChannelError] = ()
    finer: str = ""  # settings that fail too, and what they leave of the error, where that is hardly any
    own: Instants | None = None  # what was asked of a result of another program

    def worst(self, figure: str = "max") -> dict[str, float]:
        """Return the largest of a figure of the errors by channel group; a NaN counts as the largest."""
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
    runs: Runs = runner,
) -> Measurement:
    """Run an engine, at its default settings or others, then assess the result."""
    return assess(reference, sampling, runs.run(engine, reference.scene, sampling, settings), explained)


def assess(
    reference: Reference,
    sampling: Rows,
    outcome: Run,
    explained: Explained | None = None,
    find: Callable[[Motion], list[Check]] | None = None,
) -> Measurement:
    """Hold a run against what was asked for, its own output, the reference, and what its settings promise.

    A reference that is in doubt is not held against another engine.

    Args:
        reference: of the scene.
        sampling: what was asked for.
        outcome: the run.
        explained: errors that need no other explanation; None for those of round-off.
        find: what the checks of its own output find in a motion that it has no excuse for; None for all.
    """
    scene = reference.scene
    outcome = complete(outcome, scene, sampling)
    if outcome.motion is None:
        return Measurement(outcome, None, [])
    found = find(outcome.motion) if find else checks(scene, outcome.motion, reference.travel)
    verdict = judged(outcome, found)
    try:
        explained = explained or explain(reference, sampling)
        comparison = compare(reference, sampling, outcome.motion)
    except Failure as failure:
        reason = f"its drive is where no reference is: {failure.reason}"
        if verdict.status is Status.ok and not reference.floor.doubt:
            verdict = replace(verdict, status=Status.diverged, reason=reason, found_by="reference")
        return Measurement(verdict, None, found)
    table = error_table(outcome.engine, comparison, reference, explained)
    doubt = reference.floor.doubt
    if not doubt:
        verdict = compared(verdict, scene, comparison, explained.left_over(comparison.commanded))
    elif outcome.engine == REFERENCE and verdict.status is Status.ok:
        verdict = replace(verdict, status=Status.inaccurate, reason=doubt, found_by="reference")
    return Measurement(verdict, comparison, found, table)


def checked_run(
    engine: str, scene: Scene, sampling: Sampling, settings: Settings | None = None, runs: Runs = runner
) -> Run:
    """Run an engine where there is no reference, and judge the result by itself."""
    outcome = complete(runs.run(engine, scene, sampling, settings), scene, sampling)
    if outcome.motion is None:
        return outcome
    return judged(outcome, checks(scene, outcome.motion, travels(scene, outcome.motion)))

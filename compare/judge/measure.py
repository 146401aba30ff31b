"""One engine, one setting: run it, compare it, check it, judge it."""

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from scenes import Failure, Sampling, Scene, Settings, Status

from ..engines.reference import Reference, stroke
from ..engines.runner import Run, run
from .checks import Check, checks
from .errors import SHOWN_GROUPS, Comparison, compare, error_table
from .round_off import Explained
from .verdict import compared, judged


@dataclass(frozen=True)
class Measurement:
    """A judged run and what is known about it; nothing but the run where it gave no motion."""

    run: Run
    comparison: Comparison | None
    checks: list[Check]
    errors: pd.DataFrame  # one row a channel

    def worst(self, figure: str = "max") -> dict[str, float]:
        """Return the largest of a column of the errors by channel group; a NaN counts as the largest."""
        if self.errors.empty:
            return {}
        return {str(group): worst for group, worst in self.errors.groupby("group")[figure].max(skipna=False).items()}

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
) -> Measurement:
    """Run an engine, at its default settings or others, then compare, check and judge the result."""
    scene = reference.scene
    outcome = run(engine, scene, sampling, settings)
    if outcome.motion is None:
        return Measurement(outcome, None, [], pd.DataFrame())
    found = checks(scene, outcome.motion, reference.stroke)
    verdict = judged(outcome, found)
    try:
        comparison = compare(reference, sampling, outcome.motion)
    except Failure as failure:
        reason = f"its drive is where no reference is: {failure.reason}"
        strayed = replace(verdict, status=Status.diverged, reason=reason, found_by="reference")
        return Measurement(verdict if verdict.status is not Status.ok else strayed, None, found, pd.DataFrame())
    verdict = compared(verdict, scene, found, comparison)
    return Measurement(verdict, comparison, found, error_table(engine, comparison, reference, explained))


def checked_run(engine: str, scene: Scene, sampling: Sampling, settings: Settings | None = None) -> Run:
    """Run an engine where there is no reference, and judge the result by itself."""
    outcome = run(engine, scene, sampling, settings)
    if outcome.motion is None:
        return outcome
    return judged(outcome, checks(scene, outcome.motion, stroke(scene, outcome.motion)))

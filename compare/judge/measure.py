"""One engine, one setting: run it, compare it, check it, judge it."""

from dataclasses import dataclass, replace

import pandas as pd

from scenes import Failure, Sampling, Settings, Status

from ..engines.reference import Reference
from ..engines.runner import Run, run
from .checks import Check, checks
from .errors import Comparison, compare, error_table
from .round_off import Explained
from .verdict import judged


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


def measure(
    reference: Reference,
    engine: str,
    sampling: Sampling,
    settings: Settings | None = None,
    explained: Explained | None = None,
) -> Measurement:
    """Run an engine, at its default settings unless told otherwise, and find out all about the result."""
    outcome = run(engine, reference.scene, sampling, settings)
    if outcome.motion is None:
        return Measurement(outcome, None, [], pd.DataFrame())
    try:
        comparison = compare(reference, sampling, outcome.motion)
    except Failure as failure:
        strayed = replace(
            outcome, status=Status.diverged, reason=f"its drive is where no reference is: {failure.reason}"
        )
        return Measurement(strayed, None, [], pd.DataFrame())
    found = checks(reference.scene, outcome.motion, reference.stroke)
    verdict = judged(outcome, reference.scene, found, comparison)
    return Measurement(verdict, comparison, found, error_table(engine, comparison, reference, explained))

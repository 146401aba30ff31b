"""What is tried when an engine fails at the settings asked for: its next more accurate ones, and the report says so.

The engines order their named settings by accuracy: smaller steps, more sweeps, another integrator.
"""

from collections.abc import Callable

from scenes import Settings, Status

from .measure import Measurement
from .runner import Run
from .speed import tiers

HELPED = {Status.wrong_branch, Status.diverged, Status.not_converged, Status.nonfinite}  # by more accuracy, at times


def escalated(measure: Callable[[Settings], Measurement], engine: str, settings: Settings) -> tuple[Measurement, str]:
    """Return the first measurement that did not fail, or else the one asked for; and in a sentence what was tried."""
    offered = list(tiers(engine).values())
    further = offered[offered.index(settings) + 1 :] if settings in offered else offered[-1:]
    first = measure(settings)
    failed = [first.run]
    for more in dict.fromkeys(further):
        if failed[-1].status not in HELPED:
            break
        better = measure(more)
        if better.run.status is Status.ok:
            return better, f"{engine}: {_said(failed)}; so {more.label} was taken"
        failed.append(better.run)
    return first, f"{engine}: {_said(failed)}" if len(failed) > 1 else ""


def _said(runs: list[Run]) -> str:
    return "; ".join(
        f"{run.settings.label if run.settings else ''} ended {run.status.name}, {run.reason}" for run in runs
    )

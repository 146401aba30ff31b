"""What is tried when an engine fails at the settings asked for: its next more accurate ones, as reported.

The engines order their named settings by accuracy: smaller steps, more sweeps, another integrator.
"""

from collections.abc import Callable, Iterator

from scenes import Settings, Status

from ..engines.runner import Run
from ..engines.settings import tiers
from .measure import Measurement

HELPED = {Status.wrong_branch, Status.diverged, Status.not_converged, Status.nonfinite}  # by more accuracy, at times


def attempts(measure: Callable[[Settings], Measurement], engine: str, settings: Settings) -> Iterator[Measurement]:
    """Yield the measurement asked for, and further ones until one does not fail, or is not to be helped."""
    offered = list(tiers(engine).values())
    further = offered[offered.index(settings) + 1 :] if settings in offered else offered[-1:]
    for tried in dict.fromkeys((settings, *further)):
        measured = measure(tried)
        yield measured
        if measured.run.status not in HELPED:
            return


def escalated(measure: Callable[[Settings], Measurement], engine: str, settings: Settings) -> tuple[Measurement, str]:
    """Return the first measurement that is ok, or else the one asked for; and in a sentence what was tried."""
    first, *further = attempts(measure, engine, settings)
    if not further:
        return first, ""
    if further[-1].run.status is not Status.ok:
        return first, f"{engine}: {_said(first, *further)}"
    return further[-1], f"{engine}: {_said(first, *further[:-1])}; so {_label(further[-1].run)} was taken"


def _said(*failed: Measurement) -> str:
    return "; ".join(f"{_label(m.run)} ended {m.run.status.name}, {m.run.reason}" for m in failed)


def _label(run: Run) -> str:
    return run.settings.label if run.settings else ""

"""What is tried when an engine fails, or breaks its promise, at the settings asked for: others that it offers.

First come its more accurate ones, by smaller steps, more sweeps, another integrator; then its cheaper ones, which hold
at times where the others do not. All are held to the promise that was asked for.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace

from scenes import Settings, Status

from ..engines.runner import Run
from ..engines.settings import tiers
from .causes.evidence import NEARLY_ALL
from .measure import Measurement
from .verdict import share

HELPED = {  # by other settings, at times
    Status.wrong_branch,
    Status.diverged,
    Status.not_converged,
    Status.inconsistent,
    Status.inaccurate,
    Status.nonfinite,
    Status.unsupported,  # a body without mass, which fictitious masses do without
}


def offers(engine: str, tier: str) -> list[Settings]:
    """Return the settings of that name, then the more accurate ones, then the cheaper ones, all of one promise."""
    offered = [*tiers(engine).values()]
    asked = tiers(engine)[tier]
    first = offered.index(asked)
    return promising(asked.promise, (*offered[first:], *reversed(offered[:first])))


def promising(promise: float, settings: Iterable[Settings]) -> list[Settings]:
    """Return settings with another promise, each once."""
    return list(dict.fromkeys(replace(each, promise=promise) for each in settings))


def attempts(measure: Callable[[Settings], Measurement], offered: Sequence[Settings]) -> Iterator[Measurement]:
    """Yield the measurement asked for, and further ones until one does not fail, or is not to be helped."""
    for settings in offered:
        measured = measure(settings)
        yield measured
        if measured.run.status not in HELPED:
            return


def escalated(measure: Callable[[Settings], Measurement], offered: Sequence[Settings]) -> tuple[Measurement, str]:
    """Return the first measurement that is ok, or else the one asked for; and in a sentence what was tried."""
    first, *further = attempts(measure, offered)
    if not further:
        return first, ""
    engine = first.run.engine
    if further[-1].run.status is not Status.ok:
        return replace(first, finer=_finer(first, further)), f"{engine}: {_ended(first, *further)}"
    taken = further[-1].run
    note = f": {taken.settings.note}" if taken.settings and taken.settings.note else ""
    return further[-1], f"{engine}: {_ended(first, *further[:-1])}; so {_label(taken)} was taken{note}"


def _finer(first: Measurement, further: Iterable[Measurement]) -> str:
    """Return which settings leave hardly any of the error over, and how much, or nothing."""
    off = first.largest
    left = min(((m.largest / off, _label(m.run)) for m in further if m.largest < NEARLY_ALL * off), default=None)
    return f"{left[1]} leave {share(left[0])}" if left else ""


def _ended(*failed: Measurement) -> str:
    return "; ".join(f"{_label(m.run)} ended {m.run.status.name}, {m.run.reason}" for m in failed)


def _label(run: Run) -> str:
    return run.settings.label if run.settings else ""

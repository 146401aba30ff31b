"""What a CI run is stopped by: the scene's tolerances, engine by engine and group by group."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from math import nan
from typing import NamedTuple

from scenes import Scene, Status
from scenes.model.motion import quantity

from ..mechanics.mechanics import GROUPS
from .errors import by_group, worst_of
from .measure import Measurement


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
    """Yield every tolerance of the scene for the engines that ran, in the channels that are wanted, or all.

    None is held where there is a doubt about the reference.
    """
    groups = {GROUPS[quantity(channel)] for channel in wanted or ()}
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

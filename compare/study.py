"""One scene through the whole comparison."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial

import pandas as pd

from scenes import Motion, Sampling, Scene, Settings

from .asked import Accuracy
from .engines import registry
from .engines.reference import Reference, establish
from .engines.settings import settings_of, tiers
from .engines.stopping import kept
from .judge.escalation import escalated
from .judge.gates import Gate, gates
from .judge.measure import Measurement, measure
from .judge.round_off import Explained, explain
from .speed.ladders import speed_table
from .speed.timing import Budget
from .speed.work_precision import cheapest_within


@dataclass(frozen=True)
class Study:
    """Everything that the report says about one scene."""

    scene: Scene
    sampling: Sampling
    reference: Reference
    explained: Explained  # of errors, by doubles
    motion: Motion  # the reference's, as commanded
    measurements: list[Measurement]  # one an engine, in the order asked for
    gates: list[Gate]
    speed: pd.DataFrame  # one row a setting
    reasons: list[str]  # why engines run at the settings that they do, where there is something to say
    maps: pd.DataFrame = field(default_factory=pd.DataFrame)  # of stability, one row a cell
    hard: pd.DataFrame = field(default_factory=pd.DataFrame)  # one row an attempt at a hard case

    @property
    def errors(self) -> pd.DataFrame:
        """Return every engine's error table, one below the other."""
        return pd.concat([m.errors for m in self.measurements], ignore_index=True)


def study(
    scene: Scene,
    engines: Sequence[str],
    sampling: Sampling,
    budget: Budget,
    progress: Callable[[str], None],
    accuracy: Accuracy = "balanced",
) -> Study:
    """Solve a scene by every engine named, measure, gate, and time. A stop leaves what is done.

    Where the accuracy is a number, the settings that the engines offer are measured before one of them is chosen.

    Raises:
        InputError: the reference cannot solve the scene.
    """
    progress("solving and certifying the reference")
    reference = establish(scene, sampling.channels)
    explained = explain(reference, sampling)
    able = [engine for engine in engines if not registry.ENTRIES[engine].missing]
    reasons: list[str] = []

    def main_runs(settings: Callable[[str], tuple[Settings, str]]) -> Iterator[Measurement]:
        for engine in engines:
            progress(f"running {engine}")
            if engine not in able:
                yield measure(reference, engine, sampling)
                continue
            chosen, why = settings(engine)
            at = partial(measure, reference, engine, sampling, explained=explained)
            measured, tried = escalated(at, engine, chosen)
            reasons.extend(filter(None, (why, tried)))
            yield measured

    measurements: list[Measurement] = []
    if isinstance(accuracy, str):  # first, so that a stop leaves them
        measurements += kept(main_runs(lambda engine: settings_by_name(engine, accuracy)))
    speed = speed_table(reference, able, budget, progress, sampling.channels)
    if not isinstance(accuracy, str):
        measurements += kept(main_runs(lambda engine: settings_by_error(engine, accuracy, speed)))
    reasons += _left_out(engines, measurements, able, speed, budget)
    motion = reference.at(sampling.commanded(scene), sampling.times(scene))
    judged = list(gates(scene, measurements, sampling.channels))
    return Study(scene, sampling, reference, explained, motion, measurements, judged, speed, reasons)


def settings_by_name(engine: str, tier: str) -> tuple[Settings, str]:
    """Return an engine's settings of that name, with their note for the reader."""
    settings = tiers(engine)[tier]
    return settings, f"{engine}, {settings.label}: {settings.note}" if settings.note else ""


def settings_by_error(engine: str, accuracy: float, speed: pd.DataFrame) -> tuple[Settings, str]:
    """Return the cheapest settings measured to be accurate enough, or else the most accurate ones; and the reason."""
    found = cheapest_within(engine, accuracy, speed)
    if found is not None:
        return found, f"{engine}: {found.label} is the cheapest measured to be within {accuracy:g} in every group"
    settings, note = settings_by_name(engine, "exact")
    why = f"{engine}: no setting was measured to be within {accuracy:g} in every group; run at its most accurate one"
    return settings, f"{why}; {note}" if note else why


def _left_out(
    engines: Sequence[str], measurements: list[Measurement], able: list[str], speed: pd.DataFrame, budget: Budget
) -> Iterator[str]:
    """Yield what is not there because the user stopped."""
    if left := engines[len(measurements) :]:
        yield f"stopped before running {', '.join(left)}"
    settings = sum(len(settings_of(engine, long_ladders=budget.long_ladders)) for engine in able)
    if len(speed) < settings:
        yield f"stopped when {len(speed)} of {settings} settings had been measured, and none timed"

"""One scene through the whole comparison."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, fields
from functools import partial

import pandas as pd

from scenes import Motion, Sampling, Scene, Settings

from .engines import registry
from .engines.reference import Reference, establish
from .engines.settings import Accuracy, settings_of, tiers
from .engines.stopping import kept
from .judge.escalation import escalated
from .judge.gates import Gate, gate_table, gates, missed
from .judge.measure import Measurement, measure
from .judge.round_off import Explained, explain
from .speed.speed_table import speed_table
from .speed.timing import NO_CLOCK, Budget
from .speed.work_precision import cheapest_within


@dataclass(frozen=True)
class Judgement:
    """Every engine's run on one scene, held against its own output, the reference and the scene's tolerances."""

    scene: Scene
    sampling: Sampling
    reference: Reference
    explained: Explained  # of errors, by doubles
    measurements: list[Measurement]  # one an engine, in the order asked for
    held: list[Gate]  # the scene's tolerances
    reasons: list[str]  # why engines run at the settings that they do, where there is a reason to name

    @property
    def ok(self) -> bool:
        """Whether every engine is ok and no tolerance is missed."""
        return not missed(self.measurements, self.held)

    @property
    def verdicts(self) -> dict[str, tuple[str, str]]:
        """By engine the name of its status, and the reason where it is not ok."""
        return {m.run.engine: (m.run.status.name, m.run.reason) for m in self.measurements}

    @property
    def motions(self) -> dict[str, Motion]:
        """By engine its motion, where it returned one, be it ok or not."""
        return {m.run.engine: m.run.motion for m in self.measurements if m.run.motion is not None}

    @property
    def errors(self) -> pd.DataFrame:
        """One row per engine and channel: its errors against the reference."""
        return pd.concat([m.errors for m in self.measurements], ignore_index=True)

    @property
    def gates(self) -> pd.DataFrame:
        """One row per tolerance of the scene: the error measured, and whether it was met."""
        return gate_table(self.held)


@dataclass(frozen=True)
class Study(Judgement):
    """Everything that is reported about one scene."""

    motion: Motion  # the reference's, as commanded
    speed: pd.DataFrame  # one row per setting
    maps: pd.DataFrame = field(default_factory=pd.DataFrame)  # of stability, one row per cell
    hard: pd.DataFrame = field(default_factory=pd.DataFrame)  # one row per attempt at a hard case


def judged(scene: Scene, engines: Sequence[str], sampling: Sampling, accuracy: Accuracy = "balanced") -> Judgement:
    """Solve a scene by every engine named, measure, and gate; nothing is timed and nothing written.

    Raises:
        InputError: the reference cannot solve the scene.
    """
    reference = establish(scene, sampling.channels)
    speed = pd.DataFrame()
    if not isinstance(accuracy, str):
        speed = speed_table(reference, _able(engines), NO_CLOCK, lambda _: None, sampling.channels)
    return _judged(reference, engines, sampling, _chooser(accuracy, speed), lambda _: None)


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
    able = _able(engines)
    if isinstance(accuracy, str):  # the main runs first, so that a stop leaves them
        judgement = _judged(reference, engines, sampling, _chooser(accuracy, pd.DataFrame()), progress)
        speed = speed_table(reference, able, budget, progress, sampling.channels)
    else:
        speed = speed_table(reference, able, budget, progress, sampling.channels)
        judgement = _judged(reference, engines, sampling, _chooser(accuracy, speed), progress)
    judgement.reasons.extend(_left_out(engines, judgement.measurements, able, speed, budget))
    motion = reference.at(sampling.commanded(scene), sampling.times(scene))
    known = {field.name: getattr(judgement, field.name) for field in fields(judgement)}
    return Study(**known, motion=motion, speed=speed)


def _able(engines: Sequence[str]) -> list[str]:
    return [engine for engine in engines if not registry.ENTRIES[engine].missing]


def _judged(
    reference: Reference,
    engines: Sequence[str],
    sampling: Sampling,
    choose: Callable[[str], tuple[Settings, str]],
    progress: Callable[[str], None],
) -> Judgement:
    """Run every engine at the settings chosen for it, and at more accurate ones if it fails."""
    scene, explained = reference.scene, explain(reference, sampling)
    reasons: list[str] = []

    def main_runs() -> Iterator[Measurement]:
        for engine in engines:
            progress(f"running {engine}")
            if registry.ENTRIES[engine].missing:
                yield measure(reference, engine, sampling)
                continue
            chosen, why = choose(engine)
            at = partial(measure, reference, engine, sampling, explained=explained)
            measured, tried = escalated(at, engine, chosen)
            reasons.extend(filter(None, (why, tried)))
            yield measured

    measurements = list(kept(main_runs()))
    held = list(gates(scene, measurements, sampling.channels))
    return Judgement(scene, sampling, reference, explained, measurements, held, reasons)


def _chooser(accuracy: Accuracy, speed: pd.DataFrame) -> Callable[[str], tuple[Settings, str]]:
    """Return how to choose an engine's settings: by name, or by the errors and times of a speed table."""
    if isinstance(accuracy, str):
        return lambda engine: settings_by_name(engine, accuracy)
    return lambda engine: settings_by_error(engine, accuracy, speed)


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
    settings = sum(len(settings_of(engine, full=budget.full)) for engine in able)
    if len(speed) < settings:
        yield f"stopped when {len(speed)} of {settings} settings had been measured, and none timed"

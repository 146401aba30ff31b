"""One scene through the whole comparison."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import pandas as pd

from scenes import Motion, Sampling, Scene

from . import registry
from .asked import Accuracy
from .choice import chosen
from .gates import Gate, gates
from .measure import Measurement, measure
from .reference import Reference, establish
from .speed import speed_table
from .timing import Budget


@dataclass(frozen=True)
class Study:
    """Everything that the report says about one scene."""

    scene: Scene
    sampling: Sampling
    reference: Reference
    motion: Motion  # the reference's, as commanded
    measurements: list[Measurement]  # one an engine, in the order asked for
    gates: list[Gate]
    speed: pd.DataFrame  # one row a setting
    reasons: list[str]  # why engines run at the settings that they do, where there is something to say

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
    """Solve a scene by every engine named, measure, gate, and time.

    The settings that the engines offer are measured first, so that an accuracy can be asked for.

    Raises:
        InputError: the reference cannot solve the scene.
    """
    progress("solving and certifying the reference")
    reference = establish(scene)
    able = [engine for engine in engines if not registry.ENTRIES[engine].missing]
    speed = speed_table(reference, able, budget, progress)
    choices = {engine: chosen(engine, accuracy, speed) for engine in able}
    measurements = []
    for engine in engines:
        progress(f"running {engine}")
        settings = choices[engine][0] if engine in choices else None
        measurements.append(measure(reference, engine, sampling, settings))
    motion = reference.at(sampling.commanded(scene), sampling.times(scene))
    judged = list(gates(scene, measurements))
    reasons = [why for _, why in choices.values() if why]
    return Study(scene, sampling, reference, motion, measurements, judged, speed, reasons)

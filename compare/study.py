"""One scene through the whole comparison."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import pandas as pd

from scenes import Motion, Sampling, Scene, Status

from .gates import Gate, gates
from .measure import Measurement, measure
from .reference import Reference, establish
from .speed import Budget, speed_table


@dataclass(frozen=True)
class Study:
    """Everything that the report says about one scene."""

    scene: Scene
    sampling: Sampling
    reference: Reference
    motion: Motion  # the reference's, at the commanded angles
    measurements: list[Measurement]  # one an engine, in the order asked for
    gates: list[Gate]
    speed: pd.DataFrame

    @property
    def errors(self) -> pd.DataFrame:
        """Return every engine's error table, one below the other."""
        return pd.concat([m.errors for m in self.measurements], ignore_index=True)


def study(
    scene: Scene, engines: Iterable[str], sampling: Sampling, budget: Budget, progress: Callable[[str], None]
) -> Study:
    """Solve a scene by every engine named, measure, gate, and time.

    Raises:
        InputError: the reference cannot solve the scene.
    """
    progress("solving and certifying the reference")
    reference = establish(scene)
    measurements = []
    for engine in engines:
        progress(f"running {engine}")
        measurements.append(measure(reference, engine, sampling))
    able = [m.run.engine for m in measurements if m.run.status is not Status.unsupported]
    speed = speed_table(reference, able, budget, progress)
    motion = reference.at(sampling.commanded(scene))
    return Study(scene, sampling, reference, motion, measurements, list(gates(scene, measurements)), speed)

"""What the tests of tolerances share: a scene's machines, and one of them alone."""

from collections.abc import Mapping
from functools import cache
from pathlib import Path

import scenes
from compare.engines.reference import Reference, found
from compare.judge.peaks.peaks import Peak, peaks
from compare.monte_carlo.machines import Machines, machines
from scenes import Sampling
from scenes.motion import Samples
from tests import scene_files


def many(name: str, changes: Mapping[str, Samples]) -> Machines:
    return machines(reference(name), changes)


@cache
def reference(name: str) -> Reference:
    return found(scenes.load(file(name)))


def file(name: str) -> Path:
    """Return the file of a scene, given by its name or as a path."""
    return Path(name) if name.endswith(".toml") else scene_files.path(name)


def alone(name: str, changes: Mapping[str, Samples], machine: int) -> dict[str, Peak]:
    """Return the numbers of one machine by itself, from its own file."""
    scene = scenes.load(file(name), {path: float(values[machine]) for path, values in changes.items()})
    return {peak.name: peak for peak in peaks(found(scene), Sampling(72), [])}

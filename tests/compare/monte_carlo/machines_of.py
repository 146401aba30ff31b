"""What the tests of tolerances share: a scene's machines, and one of them alone."""

from collections.abc import Mapping
from functools import cache

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
    return found(scene_files.load(name))


def alone(name: str, changes: Mapping[str, Samples], machine: int) -> dict[str, Peak]:
    """Return the numbers of one machine by itself, from its own file."""
    scene = scenes.load(scene_files.path(name), {path: float(values[machine]) for path, values in changes.items()})
    return {peak.name: peak for peak in peaks(found(scene), Sampling(72), [])}

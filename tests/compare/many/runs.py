"""What the tests of many linkages share: runs of a family, a scene's machines, and one of them alone."""

from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path

import scenes
from compare.judge.peaks.peaks import Peak, peaks
from compare.measure.many.family import Asked, Cycle, Member, members
from compare.measure.many.grid import grid, variation
from compare.measure.many.machines import SolvedMachines, machines
from compare.mechanics.reference import Reference, uncertified
from scenes import Sampling
from scenes.model.motion import Samples
from tests import scene_files

ROCKER = "bodies.rocker.lengths.O-P3"
CRANK_SLIDER = scene_files.path("offset_slider_crank")


def run(file: str | Path, vary: Sequence[str], engines: Sequence[str] = ()) -> list[Member]:
    changes = grid([variation(text) for text in vary])
    return list(members(Asked(scenes.load(file), engines, Sampling(72)), changes, lambda _: None))


def one(file: str | Path, changes: Mapping[str, float]) -> tuple[Mapping[str, Peak], Cycle]:
    """The numbers and the cycle of a single member."""
    (member,) = members(Asked(scenes.load(file), (), Sampling(72)), [changes], lambda _: None)
    assert member.cycle is not None, member.reason
    return member.numbers, member.cycle


def many(name: str, changes: Mapping[str, Samples]) -> SolvedMachines:
    return machines(reference(name), changes)


@cache
def reference(name: str) -> Reference:
    return uncertified(scenes.load(file(name)))


def file(name: str) -> Path:
    """The file of a scene, given by its name or as a path."""
    return Path(name) if name.endswith(".toml") else scene_files.path(name)


def alone(name: str, changes: Mapping[str, Samples], machine: int) -> dict[str, Peak]:
    """The numbers of one machine by itself, from its own file."""
    scene = scenes.load(file(name), {path: float(values[machine]) for path, values in changes.items()})
    return {peak.name: peak for peak in peaks(uncertified(scene), Sampling(72), [])}

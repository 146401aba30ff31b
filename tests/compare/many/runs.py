"""What the tests of families share: runs of a family."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from compare.measure.many.family import Asked, Cycle, Member, members
from compare.measure.many.grid import grid, variation
from scenes import Sampling
from tests import scene_files

ROCKER = "bodies.rocker.lengths.O-P3"
CRANK_SLIDER = scene_files.path("offset_slider_crank")


def run(file: str | Path, vary: Sequence[str], engines: Sequence[str] = ()) -> list[Member]:
    changes = grid([variation(text) for text in vary])
    return list(members(Asked(file, engines, Sampling(72)), changes, lambda _: None))


def one(file: str | Path, changes: Mapping[str, float]) -> Cycle:
    """The cycle of a single member."""
    (member,) = members(Asked(file, (), Sampling(72)), [changes], lambda _: None)
    return solved(member)


def solved(member: Member) -> Cycle:
    assert member.cycle is not None, member.reason
    return member.cycle

"""What the tests of families share: runs of a family."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from compare.family.cycle import Cycle
from compare.family.family import Member, members
from compare.family.grid import grid, variation
from scenes import Sampling
from tests import scene_files

ROCKER = "bodies.rocker.lengths.O-P3"
CRANK_SLIDER = scene_files.path("offset_slider_crank")


def run(file: str | Path, vary: Sequence[str], engines: Sequence[str] = ()) -> list[Member]:
    changes = grid([variation(text) for text in vary])
    return list(members(file, changes, engines, Sampling(72), lambda _: None))


def one(file: str | Path, changes: Mapping[str, float]) -> Cycle:
    """Return the cycle of a single member."""
    (member,) = members(file, [changes], (), Sampling(72), lambda _: None)
    return solved(member)


def solved(member: Member) -> Cycle:
    assert member.cycle is not None, member.reason
    return member.cycle

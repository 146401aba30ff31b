"""Where a linkage locks: enclosures of the angle, which is known by hand, and by 50 digits on either side of it."""

from math import acos, asin, hypot, pi

import pytest

import analytic
from scenes import Failure
from scenes.model.motion import Positions
from tests import scene_files
from tests.agreement import exact
from tests.comparisons import SLOW, sampled

RRR, HALF, GUIDE = acos((2**2 + 3**2 - (1.5 + 1.2) ** 2) / (2 * 2 * 3)), acos(0.75), asin(0.2 / hypot(1, 0.2))
BESIDE = 1e-4  # rad, of a lock: between parallel guides 50 digits are too few for much less
LOCKS: dict[str, tuple[str, scene_files.Changes, float]] = {  # see `test_motion_range`
    "a rod too short": ("slider_crank", {"bodies.rod.lengths.A-B": 0.5}, pi / 6),
    "a coupler too short": ("triple_rocker", {}, RRR),
    "a guide that passes its pin": ("slotted_lever", {"drive.start": 1.0}, 2 * pi - HALF),
    "parallel guides": ("slotted_crank", {"drive.start": 1.0}, GUIDE + pi),
}


@sampled(1)
@pytest.mark.parametrize("case", LOCKS)
def test_where_it_locks(case: str) -> None:
    """An angle by the law of cosines; 50 digits assemble on this side of it, and not on the other."""
    name, changes, angle = LOCKS[case]
    scene = scene_files.load(name, changes)
    found = analytic.enclose(scene)
    assert found.rows == ()
    assert found.open_at is not None
    low, high = found.open_at
    assert low <= angle <= high
    assert high - low <= 1e-9
    exact(scene, Positions((scene.drive.law.start, angle - BESIDE)))
    with pytest.raises(Failure):
        exact(scene, Positions((scene.drive.law.start, angle + BESIDE)))


@SLOW
def test_where_a_larger_group_locks() -> None:
    scene = scene_files.load("jumps")
    low, high = analytic.enclose(scene).open_at or (0.0, 0.0)
    exact(scene, Positions((scene.drive.law.start, low)))
    assert low < high
    with pytest.raises(Failure):
        exact(scene, Positions((scene.drive.law.start, high + 1e-3)))

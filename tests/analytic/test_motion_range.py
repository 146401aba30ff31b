"""How far the drive moves until a dyad locks: by hand for each kind, to the last digits, and in words."""

from dataclasses import replace
from math import acos, asin, degrees, hypot, pi

import numpy as np
import pytest

import analytic
from analytic.decomposition import decompose
from analytic.kinematics import followed
from analytic.motion_range import Interval, motion_range
from scenes import Failure, Scene, Status
from scenes.scene import ConstantSpeed
from tests.conftest import SceneFrom

from .test_solve import SLIDER_CRANK

TURN = np.linspace(0, 2 * pi, 3601)

TRIPLE_ROCKER = """
format = 1
name = "triple_rocker"
ground.points = { O = [0, 0], C = [3, 0] }
bodies.crank.points = { O = [0, 0], A = [2, 0] }
bodies.coupler.lengths = { "A-B" = 1.5 }
bodies.rocker.lengths = { "C-B" = 1.2 }
drive = { body = "crank", speed = 1 }
sketch = { angle = 0.7, A = [1.5, 1.3], B = [2.6, 1.6] }
output = { point = "B" }
"""
SLOTTED_LEVER = """
format = 1
name = "slotted_lever"
ground.points = { O = [0, 0], C = [1.5, 0] }
bodies.crank.lengths = { "O-A" = 1 }
bodies.block.points = { A = [0, 0] }
bodies.block.slides = { on = "lever", through = [0, 1], along = [1, 0] }
bodies.lever.points = { C = [0, 0], T = [2, 0] }
drive = { body = "crank", speed = 1 }
sketch = { angle = 3.14, A = [-1, 0], T = [-0.3, 0.8] }
output = { point = "T" }
"""
SLOTTED_CRANK = """
format = 1
name = "slotted_crank"
ground.points = { O = [0, 0] }
bodies.crank.points = { O = [0, 0], T = [2, 0] }
bodies.block.points = { P = [0, 0] }
bodies.block.slides = { on = "crank", through = [0, 0.1], along = [1, 0] }
bodies.slider.points = { P = [0, 0] }
bodies.slider.slides = { through = [0, 1], along = [1, 0.2] }
drive = { body = "crank", speed = 1 }
sketch = { angle = 1.5, P = [0, 1], T = [0, 2] }
output = { slider = "P" }
"""
SCOTCH_YOKE = """
format = 1
name = "scotch_yoke"
ground.points = { O = [0, 0] }
bodies.crank.lengths = { "O-A" = 1 }
bodies.block.points = { A = [0, 0] }
bodies.block.slides = { on = "yoke", through = [0, 0], along = [0.1, 1] }
bodies.yoke.points = { Y = [0, 0] }
bodies.yoke.slides = { through = [0, 0], along = [1, 0] }
drive = { body = "crank", speed = 1 }
sketch = { A = [1, 0] }
output = { slider = "Y" }
"""


def intervals(scene: Scene) -> list[Interval]:
    return motion_range(scene, followed(scene, decompose(scene)))


def reason(scene: Scene) -> str:
    with pytest.raises(Failure) as caught:
        analytic.solve(scene, TURN)
    assert caught.value.status is Status.cannot_assemble
    return caught.value.reason


def assert_ends(found: list[Interval], *by_hand: tuple[float, float]) -> None:
    """Compare ends, rad or m, to the few roundings of a turn that bisection leaves."""
    assert np.array([(interval.start, interval.end) for interval in found]) == pytest.approx(
        np.array(by_hand), abs=1e-13
    )


def test_rrp(scene_from: SceneFrom) -> None:
    """A rod of 0.5 under a crank of 1 stops reaching the guide where sin(theta) passes one half: at 30 degrees."""
    scene = scene_from(SLIDER_CRANK.replace('"A-B" = 3', '"A-B" = 0.5'))
    assert_ends(intervals(scene), (5 * pi / 6, 7 * pi / 6), (11 * pi / 6, 13 * pi / 6))
    assert reason(scene) == (
        "B cannot be reached at crank angle 30.1000 deg; the crank turns only"
        " from 150.0000 deg (rod square to the guide of slider) to 210.0000 deg (rod square to the guide of slider) and"
        " from 330.0000 deg (rod square to the guide of slider) to 390.0000 deg (rod square to the guide of slider);"
        " drive.start and drive.end can limit a run"
    )


def test_rrp_on_a_guide_off_the_pivot(scene_from: SceneFrom) -> None:
    """The guide lies 0.6 above: it is out of reach where sin(theta) is under 0.1, or over 1.1, which is nowhere."""
    scene = scene_from(
        SLIDER_CRANK.replace('"A-B" = 3', '"A-B" = 0.5').replace("through = [0, 0]", "through = [9, 0.6]")
    )
    assert_ends(intervals(scene), (asin(0.1), pi - asin(0.1)))


def test_rrr(scene_from: SceneFrom) -> None:
    """Where coupler and rocker are in line, the crank follows from the cosine law: its tip is their sum from C."""
    scene = scene_from(TRIPLE_ROCKER)
    limit = acos((2**2 + 3**2 - (1.5 + 1.2) ** 2) / (2 * 2 * 3))
    found = intervals(scene)
    assert_ends(found, (2 * pi - limit, 2 * pi + limit))
    assert found[0].start_lock == found[0].end_lock == "B"
    assert "(coupler and rocker in line at B)" in reason(scene)


def test_rrr_folded(scene_from: SceneFrom) -> None:
    """A coupler of 2.5 cannot fold: the crank's tip must stay 1.3 away from C, and 3.7 is too far at the other side."""
    scene = scene_from(TRIPLE_ROCKER.replace('"A-B" = 1.5', '"A-B" = 2.5'))
    near, far = (acos((13 - r**2) / 12) for r in (1.3, 3.7))
    assert_ends(intervals(scene), (near, far), (2 * pi - far, 2 * pi - near))


def test_rpr(scene_from: SceneFrom) -> None:
    """The guide passes C at 1, so that A must be that far away: 1 + 1.5^2 - 2 1.5 cos(theta) = 1."""
    limit = acos(0.75)
    scene = scene_from(SLOTTED_LEVER)
    assert_ends(intervals(scene), (limit, 2 * pi - limit))
    wanted = "the pins of block and lever square to the guide of block"
    assert f"from {degrees(limit):.4f} deg ({wanted}) to {degrees(2 * pi - limit):.4f} deg ({wanted})" in reason(scene)


def test_rpr_from_the_other_side(scene_from: SceneFrom) -> None:
    text = SLOTTED_LEVER.replace(
        'bodies.block.slides = { on = "lever", through = [0, 1], along = [1, 0] }', ""
    ).replace("T = [2, 0] }", 'T = [2, 0] }\nbodies.lever.slides = { on = "block", through = [7, -1], along = [1, 0] }')
    scene = scene_from(text)
    assert_ends(intervals(scene), (acos(0.75), 2 * pi - acos(0.75)))
    assert "square to the guide of lever" in reason(scene)


def test_prp(scene_from: SceneFrom) -> None:
    """The block in the crank's slot and the slider's guide are parallel at the guide's own angle and half a turn on."""
    scene = scene_from(SLOTTED_CRANK)
    own = asin(0.2 / hypot(1, 0.2))
    assert_ends(intervals(scene), (own, own + pi))
    assert "(the guides of block and slider parallel)" in reason(scene)


def test_rpp_never_locks(scene_from: SceneFrom) -> None:
    scene = scene_from(SCOTCH_YOKE)
    assert intervals(scene) == []
    motion = analytic.solve(scene, TURN)
    assert np.abs(motion["Y.x"] - np.cos(TURN) + 0.1 * np.sin(TURN)).max() <= 1e-15  # by hand; one rounding


# --- a driven slider --------------------------------------------------------------------------------------------------

DRIVEN = (
    SLIDER_CRANK[: SLIDER_CRANK.index("[[loads]]")]
    .replace('body = "crank"\nspeed = 10', 'body = "slider"\nspeed = 1\nstart = START\nend = END')
    .replace("mass", "# mass")
    + '[sketch]\ndisplacement = 3.5\nA = [0.79, 0.61]\nB = [3.5, 0]\n[output]\nslider = "B"\n'
)


@pytest.mark.parametrize(
    ("start", "end", "least", "most"), [(1, 5, 2, 4), (3, 5, 3, 4), (1, 3.75, 2, 3.75), (3, -1.5, 2, 3)]
)
def test_driven_slider(scene_from: SceneFrom, start: float, end: float, least: float, most: float) -> None:
    """Crank and rod are in line at 3 - 1 and at 3 + 1; between them the way may end."""
    text = DRIVEN.replace("START", str(start)).replace("END", str(end))
    scene = scene_from(text if end > start else text.replace("speed = 1", "speed = -1"))
    found = intervals(scene)
    assert_ends(found, (least, most))
    assert found[0].start_lock == ("A" if least == 2 else "")
    assert found[0].end_lock == ("A" if most == 4 else "")


def test_driven_slider_in_words(scene_from: SceneFrom) -> None:
    scene = scene_from(DRIVEN.replace("START", "3").replace("END", "5"))
    with pytest.raises(Failure) as caught:
        analytic.solve(scene, [3.2, 4.25])
    assert caught.value.reason == (
        "A cannot be reached at slider at 4.25 m; the slider slides only from 3 m (the end of its way) to 4 m"
        " (crank and rod in line at A); drive.start and drive.end can limit a run"
    )


def test_beyond_its_way_a_driven_slider_may_lock(scene_from: SceneFrom) -> None:
    """Its whole way is free, and the sentence says so: only what was asked for lies beyond it."""
    scene = scene_from(DRIVEN.replace("START", "2.5").replace("END", "3.5"))
    assert intervals(scene) == []
    with pytest.raises(Failure) as caught:
        analytic.solve(scene, [4.25])
    assert caught.value.reason == (
        "A cannot be reached at slider at 4.25 m; the slider slides freely all its way, from 2.5 m to 3.5 m"
    )


def test_a_driven_slider_that_never_closes(scene_from: SceneFrom) -> None:
    scene = scene_from(DRIVEN.replace("START", "5").replace("END", "7"))
    with pytest.raises(Failure, match="cannot be assembled with the slider at any place of its way"):
        analytic.solve(scene, [5.0])


# --- never, and part of a turn ----------------------------------------------------------------------------------------


def test_a_linkage_that_never_closes_says_so(scene_from: SceneFrom) -> None:
    scene = scene_from(SLIDER_CRANK.replace('"A-B" = 3', '"A-B" = 0.5').replace("through = [0, 0]", "through = [0, 9]"))
    with pytest.raises(Failure, match="cannot be assembled with the crank at any angle"):
        analytic.solve(scene, TURN)


def test_a_gap_narrower_than_the_grid(scene_from: SceneFrom) -> None:
    """A rod a billionth shorter than the crank's rise: no end of the range is seen, and the sentence says so."""
    scene = scene_from(SLIDER_CRANK.replace('"A-B" = 3', '"A-B" = 0.999999999').replace("[0.9, 0.5]", "[0.9, 0.4]"))
    position = np.radians([10.0, 90.0])
    assert intervals(scene) != []  # the grid, of tenths of a degree, happens to meet 90 degrees
    with pytest.raises(Failure, match="the crank turns only from 90"):
        analytic.solve(scene, position)
    off = replace(scene, drive=ConstantSpeed("crank", 10.0, 1e-4, None))  # which moves the grid
    assert intervals(off) == []
    with pytest.raises(Failure, match=r"the crank turns freely but for gaps narrower than 0\.1 deg"):
        analytic.solve(off, position)


def test_part_of_a_turn_keeps_clear_of_the_lock(scene_from: SceneFrom) -> None:
    """What the drive never reaches is nobody's trouble, and the range is that of the linkage, not of the drive."""
    text = TRIPLE_ROCKER.replace("speed = 1", "speed = 1, start = -0.5, end = 0.5")
    scene = scene_from(text)
    analytic.solve(scene, np.linspace(-0.5, 0.5, 11))
    limit = acos((2**2 + 3**2 - (1.5 + 1.2) ** 2) / (2 * 2 * 3))
    (interval,) = intervals(scene)
    assert interval.end - interval.start == pytest.approx(2 * limit, abs=1e-12)


def test_the_first_position_that_fails_is_named(scene_from: SceneFrom) -> None:
    """In the order asked for, whichever block it falls in."""
    scene = scene_from(TRIPLE_ROCKER)
    asked = np.concatenate([np.zeros(20_000), np.radians([100.0, 90.0])])
    with pytest.raises(Failure, match=r"B cannot be reached at crank angle 100\.0000 deg"):
        analytic.solve(scene, asked)

"""How far the drive moves until a dyad locks: by hand for each kind, to the last digits, and in words."""

from dataclasses import replace
from math import acos, asin, degrees, hypot, pi, radians, sin

import numpy as np
import pytest

import analytic
from analytic.decomposition import decompose
from analytic.kinematics import followed
from analytic.motion_range import Interval, motion_range
from scenes import Failure, Scene, Status
from scenes.scene import ConstantSpeed
from tests import scene_files

TURN = np.linspace(0, 2 * pi, 3601)

SHORT_ROD = {"bodies.rod.lengths.A-B": 0.5}


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


def test_rrp() -> None:
    """A rod of 0.5 under a crank of 1 stops reaching the guide where sin(theta) passes one half: at 30 degrees."""
    scene = scene_files.load("slider_crank", SHORT_ROD)
    assert_ends(intervals(scene), (-pi / 6, pi / 6), (5 * pi / 6, 7 * pi / 6))
    assert reason(scene) == (
        f"B cannot be reached at crank angle 0.525344 rad: rod and slider end {sin(radians(30.1)) - 0.5:.4g} m apart;"
        " the crank turns only"
        " from -0.523599 rad (rod square to the guide of slider) to 0.523599 rad (rod square to the guide of slider)"
        " and from 2.617994 rad (rod square to the guide of slider) to 3.665191 rad (rod square to the guide of slider)"
        "; drive.start and drive.end can limit a run"
    )


def test_rrp_on_a_guide_off_the_pivot() -> None:
    """The guide lies 0.6 above: it is out of reach where sin(theta) is under 0.1, or over 1.1, which is nowhere."""
    scene = scene_files.load("slider_crank", {**SHORT_ROD, "bodies.slider.slides.through": [9, 0.6]})
    assert_ends(intervals(scene), (asin(0.1), pi - asin(0.1)))


def test_rrr() -> None:
    """Where coupler and rocker are in line, the crank follows from the cosine law: its tip is their sum from C."""
    scene = scene_files.load("triple_rocker")
    limit = acos((2**2 + 3**2 - (1.5 + 1.2) ** 2) / (2 * 2 * 3))
    found = intervals(scene)
    assert_ends(found, (-limit, limit))
    assert found[0].start_joint == found[0].end_joint == "B"
    assert "(coupler and rocker in line at B)" in reason(scene)


@pytest.mark.parametrize(("start", "speed"), [(0, 10), (0, -10), (70, 10), (-300, 10), (360, -10)])
def test_a_range_holds_the_start_and_is_in_the_units_of_the_file(start: float, speed: float) -> None:
    """The crank turns 61.5864 degrees to either side of zero, or of the whole turns from there where it starts."""
    units = {"angle": "deg", "length": "mm"}
    scene = scene_files.load("triple_rocker", {"units": units, "drive.start": start, "drive.speed": speed})
    limit = degrees(acos((2**2 + 3**2 - (1.5 + 1.2) ** 2) / (2 * 2 * 3)))
    turn = 360 if start == 360 else -360 if start == -300 else 0
    (found,) = intervals(scene)
    assert np.degrees([found.start, found.end]) == pytest.approx([turn - limit, turn + limit], abs=1e-11)
    wanted = "coupler and rocker in line at B"
    assert f"from {turn - limit:.4f} deg ({wanted}) to {turn + limit:.4f} deg ({wanted})" in reason(scene)


def test_rrr_folded() -> None:
    """A coupler of 2.5 cannot fold: the crank's tip must stay 1.3 away from C, and 3.7 is too far at the other side."""
    scene = scene_files.load("triple_rocker", {"bodies.coupler.lengths.A-B": 2.5})
    near, far = (acos((13 - r**2) / 12) for r in (1.3, 3.7))
    assert_ends(intervals(scene), (near, far), (2 * pi - far, 2 * pi - near))


def test_rpr() -> None:
    """The guide passes C at 1, so that A must be that far away: 1 + 1.5^2 - 2 1.5 cos(theta) = 1."""
    limit = acos(0.75)
    scene = scene_files.load("slotted_lever")
    assert_ends(intervals(scene), (limit, 2 * pi - limit))
    wanted = "the pins of block and lever square to the guide of block"
    assert f"from {limit:.6f} rad ({wanted}) to {2 * pi - limit:.6f} rad ({wanted})" in reason(scene)


def test_rpr_from_the_other_side() -> None:
    slides = {"on": "block", "through": [7, -1], "along": [1, 0]}
    scene = scene_files.load("slotted_lever", {"bodies.block.slides": None, "bodies.lever.slides": slides})
    assert_ends(intervals(scene), (acos(0.75), 2 * pi - acos(0.75)))
    assert "square to the guide of lever" in reason(scene)


def test_prp() -> None:
    """The block in the crank's slot and the slider's guide are parallel at the guide's own angle and half a turn on."""
    scene = scene_files.load("slotted_crank")
    own = asin(0.2 / hypot(1, 0.2))
    assert_ends(intervals(scene), (own, own + pi))
    assert "(the guides of block and slider parallel)" in reason(scene)


def test_rpp_never_locks() -> None:
    scene = scene_files.load("scotch_yoke")
    assert intervals(scene) == []
    by_hand = 0.1 * np.cos(TURN) - 0.2 * (0.1 * np.sin(TURN) - 0.03)
    assert np.abs(analytic.solve(scene, TURN)["Y.x"] - by_hand).max() <= 1e-15  # m, rounding


# --- a driven slider --------------------------------------------------------------------------------------------------


def driven(start: float, end: float) -> Scene:
    """Return the slider-crank driven by its slider, without masses."""
    drive = {"body": "slider", "speed": 1 if end > start else -1, "start": start, "end": end}
    sketch = {"displacement": 3.5, "A": [0.79, 0.61], "B": [3.5, 0]}
    massless = {f"bodies.{body}.mass": None for body in ("crank", "rod", "slider")}
    return scene_files.load("slider_crank", {"drive": drive, "sketch": sketch, "loads": None, **massless})


@pytest.mark.parametrize(
    ("start", "end", "least", "most"), [(1, 5, 2, 4), (3, 5, 3, 4), (1, 3.75, 2, 3.75), (3, -1.5, 2, 3)]
)
def test_driven_slider(start: float, end: float, least: float, most: float) -> None:
    """Crank and rod are in line at 3 - 1 and at 3 + 1; between them the way may end."""
    found = intervals(driven(start, end))
    assert_ends(found, (least, most))
    assert found[0].start_joint == ("A" if least == 2 else "")
    assert found[0].end_joint == ("A" if most == 4 else "")


def test_driven_slider_in_words() -> None:
    scene = driven(3, 5)
    with pytest.raises(Failure) as caught:
        analytic.solve(scene, [3.2, 4.25])
    assert caught.value.reason == (
        "A cannot be reached at slider at 4.25 m: crank and rod end 0.25 m apart; "
        "the slider slides only from 3 m (the end of its way) to 4 m"
        " (crank and rod in line at A); drive.start and drive.end can limit a run"
    )


def test_beyond_its_way_a_driven_slider_may_lock() -> None:
    """Its whole way is free, and the sentence says so: only what was asked for lies beyond it."""
    scene = driven(2.5, 3.5)
    assert intervals(scene) == []
    with pytest.raises(Failure) as caught:
        analytic.solve(scene, [4.25])
    assert caught.value.reason == (
        "A cannot be reached at slider at 4.25 m: crank and rod end 0.25 m apart; "
        "the slider slides freely all its way, from 2.5 m to 3.5 m"
    )


def test_a_driven_slider_that_never_closes() -> None:
    scene = driven(5, 7)
    with pytest.raises(Failure, match="cannot be assembled with the slider at any place of its way"):
        analytic.solve(scene, [5.0])


# --- never, and part of a turn ----------------------------------------------------------------------------------------


def test_a_linkage_that_never_closes_says_so() -> None:
    scene = scene_files.load("slider_crank", {**SHORT_ROD, "bodies.slider.slides.through": [0, 9]})
    with pytest.raises(Failure, match="cannot be assembled with the crank at any angle"):
        analytic.solve(scene, TURN)


def test_a_gap_narrower_than_the_grid() -> None:
    """A rod a billionth shorter than the crank's rise: no end of the range is seen, and the sentence says so."""
    scene = scene_files.load("slider_crank", {"bodies.rod.lengths.A-B": 0.999999999, "sketch.A": [0.9, 0.4]})
    position = np.radians([10.0, 90.0])
    assert intervals(scene) != []  # the grid, of tenths of a degree, happens to meet 90 degrees
    with pytest.raises(Failure, match=r"and from 1\.5708\d\d rad"):
        analytic.solve(scene, position)
    off = replace(scene, drive=ConstantSpeed("crank", 10.0, 1e-4, None))  # which moves the grid
    assert intervals(off) == []
    with pytest.raises(Failure, match=r"the crank turns freely but for gaps narrower than 0\.001745 rad"):
        analytic.solve(off, position)


def test_part_of_a_turn_keeps_clear_of_the_lock() -> None:
    """What the drive never reaches is nobody's trouble, and the range is that of the linkage, not of the drive."""
    scene = scene_files.load("triple_rocker", {"drive.start": -0.5, "drive.end": 0.5})
    analytic.solve(scene, np.linspace(-0.5, 0.5, 11))
    limit = acos((2**2 + 3**2 - (1.5 + 1.2) ** 2) / (2 * 2 * 3))
    (interval,) = intervals(scene)
    assert interval.end - interval.start == pytest.approx(2 * limit, abs=1e-12)


def test_the_first_position_that_fails_is_named() -> None:
    """In the order asked for, whichever block it falls in."""
    scene = scene_files.load("triple_rocker")
    asked = np.concatenate([np.zeros(20_000), np.radians([100.0, 90.0])])
    with pytest.raises(Failure, match=r"B cannot be reached at crank angle 1\.745329 rad"):
        analytic.solve(scene, asked)

"""Limits of angles: they go on over whole turns from the drive's start, and are held where they violate least."""

from math import degrees, pi

import numpy as np
import pytest

import analytic
from compare.judge.proof import held, met, whole_turns
from scenes import Motion, Sampling
from scenes.scene import LimitTable
from tests import scene_files
from tests.comparisons import sampled

# The slider-crank's rod, 3 m, seen from its far end: it swings about 180 degrees by asin(1/3), 19.4712 degrees.
SWING = degrees(np.arcsin(1 / 3))
DEGREES = {"units": {"angle": "deg"}}
REVERSED = {**DEGREES, "bodies.rod.lengths": {"B-A": 3}, "sketch.angle": 28.6}
FEW = Sampling(samples=8)
TURN = 2 * pi


@pytest.mark.parametrize(("start", "middle"), [(0, 180), (90, 180), (180, 180), (270, -180)])
def test_an_angle_goes_on_over_the_half_turn(start: float, middle: float) -> None:
    """From -180 to 180 degrees at the drive's start, where it is 180 itself, or 160.5, or -160.5."""
    scene = scene_files.load("slider_crank", {**REVERSED, "drive.start": start})
    least, most = analytic.enclose(scene, {"rod.angle"}).rows
    off = 1e-4  # degrees: bounds are a millionth of the swing apart
    assert (degrees(least.low), degrees(most.high)) == pytest.approx((middle - SWING, middle + SWING), abs=off)


@sampled(12)
@pytest.mark.parametrize("start", [0, 90, 180, 270])
@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        ({"least": 100, "most": 200}, ["met", "met"]),
        ({"least": 100, "most": 190}, ["met", "missed"]),
        ({"least": 170, "most": 200}, ["missed", "met"]),
        ({"least": -260, "most": -160}, ["met", "met"]),
        ({"most": 190}, ["missed"]),
        ({"most": 200}, ["met"]),
        ({"least": 100}, ["met"]),
        ({"least": 170}, ["missed"]),
        ({"most": -170}, ["missed"]),
    ],
)
def test_a_limit_is_held_on_one_turn(start: float, limit: dict[str, float], expected: list[str]) -> None:
    scene = scene_files.load("slider_crank", {**REVERSED, "drive.start": start, "limits": {"rod.angle": limit}})
    found = [*held(scene, FEW, analytic.enclose(scene, {"rod.angle"}))]
    assert [one.outcome for one in found] == expected
    angles = np.linspace(0, TURN, 37) + np.radians(start)  # the machines' samples say the same, modulo a turn
    rod = (np.pi - np.arcsin(np.sin(angles) / 3) + np.pi) % TURN - np.pi
    motion = Motion({"time": angles[np.newaxis], "rod.angle": rod[np.newaxis]})
    assert met(scene, motion).tolist() == [expected.count("met") == len(expected)]


@pytest.mark.parametrize(("most", "expected"), [(700, "missed"), (1115, "met")])
def test_a_crank_that_goes_round_is_held_over_all_its_turns(most: float, expected: str) -> None:
    """From 30 degrees on three turns end at 1110."""
    scene = scene_files.load(
        "slider_crank", {**DEGREES, "sketch.angle": 28.6, "drive.start": 30, "limits": {"crank.angle": {"most": most}}}
    )
    run = Sampling(samples=8, turns=3)
    (limit,) = held(scene, run, analytic.enclose(scene, {"crank.angle"}, turns=3))
    assert limit.outcome == expected
    assert "1110.0°" in limit.text


@pytest.mark.parametrize(
    ("first", "last", "limit", "turns"),
    [
        (-20, 40, {"most": 0}, 0),  # passed where it is
        (-20, 40, {"most": -100}, 0),  # nearest where it is, and missed
        (-20, 40, {"most": 300}, 0),  # met where it is, and never passed
        (-20, 40, {"least": -300}, 0),
        (0, 200, {"most": 30}, 0),
        (-195, -146, {"most": 200}, 1),  # passed, as 200 is -160
        (-195, -146, {"least": 100}, 1),  # missed by 64 a turn on, by 246 where it is
        (164, 213, {"least": -260, "most": -160}, -1),
        (-195, -146, {"least": 0, "most": 360}, 1),
        (-20, 40, {"least": -400, "most": 400}, 0),  # met where it is
        (30, 390, {"most": 300}, 0),  # all directions are passed: as it goes on
        (30, 390, {"most": 400}, 0),
        (30, 390, {"least": 0, "most": 360}, 0),
        (-150, 210, {"least": 200, "most": 570}, 1),
        (float("-inf"), float("inf"), {"most": 10}, 0),
    ],
)
def test_by_how_many_turns(first: float, last: float, limit: dict[str, float], turns: int) -> None:
    limits = LimitTable(**{end: float(np.radians(value)) for end, value in limit.items()})
    assert whole_turns(float(np.radians(first)), float(np.radians(last)), limits) == turns

"""How far the drive moves until a dyad locks: by hand for each kind, to the last digits, and in words."""

from math import acos, asin, degrees, hypot, pi, radians, sin

import numpy as np
import pytest
from numpy.typing import ArrayLike

import analytic
from scenes import Failure, Scene, Status
from scenes.scene import ConstantSpeed
from tests import scene_files

from .newton import Interval, intervals

TURN = np.linspace(0, 2 * pi, 3601)

SHORT_ROD = {"bodies.rod.lengths.A-B": 0.5}


def reason(scene: Scene, position: ArrayLike = TURN) -> str:
    with pytest.raises(Failure) as caught:
        analytic.solve(scene, position)
    assert caught.value.status is Status.cannot_assemble
    return caught.value.reason


def assert_ends(found: list[Interval], *by_hand: tuple[float, float]) -> None:
    """Compare ends, rad or m, to the few roundings of a turn that bisection leaves."""
    assert np.array([(interval.start, interval.end) for interval in found]) == pytest.approx(
        np.array(by_hand), abs=1e-13
    )


HALF, RRR = acos(0.75), acos((2**2 + 3**2 - (1.5 + 1.2) ** 2) / (2 * 2 * 3))
NEAR, FAR = (acos((13 - r**2) / 12) for r in (1.3, 3.7))
GUIDE = asin(0.2 / hypot(1, 0.2))
ON_BLOCK = {"on": "block", "through": [7, -1], "along": [1, 0]}
BY_HAND: dict[str, tuple[str, scene_files.Changes, list[tuple[float, float]], str]] = {
    # A rod of 0.5 under a crank of 1 stops reaching the guide where sin(theta) passes one half: at 30 degrees.
    "RRP": (
        *("slider_crank", SHORT_ROD, [(-pi / 6, pi / 6), (5 * pi / 6, 7 * pi / 6)]),
        f"B cannot be reached at crank angle 0.525344 rad: rod and slider end {sin(radians(30.1)) - 0.5:.4g} m apart;"
        " the crank turns only"
        " from -0.523599 rad (rod square to the guide of slider) to 0.523599 rad (rod square to the guide of slider)"
        " and from 2.617994 rad (rod square to the guide of slider) to 3.665191 rad (rod square to the guide of slider)"
        "; drive.start and drive.end can limit a run",
    ),
    # The guide lies 0.6 above: it is out of reach where sin(theta) is under 0.1, or over 1.1, which is nowhere.
    "RRP on a guide off the pivot": (
        *("slider_crank", {**SHORT_ROD, "bodies.slider.slides.through": [9, 0.6]}, [(asin(0.1), pi - asin(0.1))]),
        "(rod square to the guide of slider)",
    ),
    # Where coupler and rocker are in line, the crank follows from the cosine law: its tip is their sum from C.
    "RRR": ("triple_rocker", {}, [(-RRR, RRR)], "(coupler and rocker in line at B)"),
    # A coupler of 2.5 cannot fold: the crank's tip must stay 1.3 away from C, and 3.7 is too far at the other side.
    "RRR folded": (
        *("triple_rocker", {"bodies.coupler.lengths.A-B": 2.5}, [(NEAR, FAR), (2 * pi - FAR, 2 * pi - NEAR)]),
        "(coupler and rocker in line at B)",
    ),
    # The guide passes C at 1, so that A must be that far away: 1 + 1.5^2 - 2 1.5 cos(theta) = 1.
    "RPR": (
        *("slotted_lever", {}, [(HALF, 2 * pi - HALF)]),
        f"from {HALF:.6f} rad (the pins of block and lever square to the guide of block)"
        f" to {2 * pi - HALF:.6f} rad (the pins of block and lever square to the guide of block)",
    ),
    "RPR from the other side": (
        *("slotted_lever", {"bodies.block.slides": None, "bodies.lever.slides": ON_BLOCK}, [(HALF, 2 * pi - HALF)]),
        "square to the guide of lever",
    ),
    # The block in the crank's slot and the slider's guide are parallel at the guide's own angle and half a turn on.
    "PRP": ("slotted_crank", {}, [(GUIDE, GUIDE + pi)], "(the guides of block and slider parallel)"),
}


@pytest.mark.parametrize("case", BY_HAND)
def test_by_hand_and_in_words(case: str) -> None:
    name, changes, ends, words = BY_HAND[case]
    scene = scene_files.load(name, changes)
    assert_ends(intervals(scene), *ends)
    assert words in reason(scene)


@pytest.mark.parametrize(("start", "speed"), [(0, 10), (0, -10), (70, 10), (-300, 10), (360, -10)])
def test_a_range_holds_the_start_and_is_in_the_units_of_the_file(start: float, speed: float) -> None:
    """The crank turns 61.5864 degrees to either side of zero, or of the whole turns from there where it starts."""
    units = {"angle": "deg", "length": "mm"}
    scene = scene_files.load("triple_rocker", {"units": units, "drive.start": start, "drive.speed": speed})
    limit = degrees(RRR)
    turn = 360 if start == 360 else -360 if start == -300 else 0
    (found,) = intervals(scene)
    assert np.degrees([found.start, found.end]) == pytest.approx([turn - limit, turn + limit], abs=1e-11)
    wanted = "coupler and rocker in line at B"
    assert f"from {turn - limit:.4f} deg ({wanted}) to {turn + limit:.4f} deg ({wanted})" in reason(scene)


def test_rpp_never_locks() -> None:
    scene = scene_files.load("scotch_yoke")
    assert intervals(scene) == []
    by_hand = 0.1 * np.cos(TURN) - 0.2 * (0.1 * np.sin(TURN) - 0.03)
    assert np.abs(analytic.solve(scene, TURN)["Y.x"] - by_hand).max() <= 1e-15  # m, rounding


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


APART = "A cannot be reached at slider at 4.25 m: crank and rod end 0.25 m apart; the slider slides "
OF_SLIDERS = {
    (3, 5): APART + "only from 3 m (the end of its way) to 4 m (crank and rod in line at A);"
    " drive.start and drive.end can limit a run",
    (2.5, 3.5): APART + "freely all its way, from 2.5 m to 3.5 m",  # only what was asked for lies beyond it
}


@pytest.mark.parametrize("ends", OF_SLIDERS)
def test_driven_slider_in_words(ends: tuple[float, float]) -> None:
    scene = driven(*ends)
    assert len(intervals(scene)) == (ends == (3, 5))
    assert reason(scene, [3.2, 4.25]) == OF_SLIDERS[ends]


HIGH_GUIDE = {**SHORT_ROD, "bodies.slider.slides.through": [0, 9]}


@pytest.mark.parametrize(
    ("scene", "where"),
    [
        (scene_files.load("slider_crank", HIGH_GUIDE), "the crank at any angle"),
        (driven(5, 7), "the slider at any place of its way"),
    ],
    ids=["crank", "slider"],
)
def test_a_linkage_that_never_closes_says_so(scene: Scene, where: str) -> None:
    assert f"cannot be assembled with {where}" in reason(scene, [6.0])


def test_a_gap_narrower_than_the_grid() -> None:
    """A rod a billionth shorter than the crank's rise: no end of the range is seen, and the sentence says so."""
    scene = scene_files.load("slider_crank", {"bodies.rod.lengths.A-B": 0.999999999, "sketch.A": [0.9, 0.4]})
    position = np.radians([10.0, 90.0])
    assert intervals(scene) != []  # the grid, of tenths of a degree, happens to meet 90 degrees
    assert "and from 1.5708" in reason(scene, position)
    off = scene.with_law(ConstantSpeed(10.0, 1e-4, None))  # which moves the grid
    assert intervals(off) == []
    assert "the crank turns freely but for gaps narrower than 0.001745 rad" in reason(off, position)


def test_part_of_a_turn_keeps_clear_of_the_lock() -> None:
    """What the drive never reaches is nobody's trouble, and the range is that of the linkage, not of the drive."""
    scene = scene_files.load("triple_rocker", {"drive.start": -0.5, "drive.end": 0.5})
    analytic.solve(scene, np.linspace(-0.5, 0.5, 11))
    (interval,) = intervals(scene)
    assert interval.end - interval.start == pytest.approx(2 * RRR, abs=1e-12)


def test_the_first_position_that_fails_is_named() -> None:
    """In the order asked for, whichever block it falls in."""
    scene = scene_files.load("triple_rocker")
    asked = np.concatenate([np.zeros(20_000), np.radians([100.0, 90.0])])
    assert reason(scene, asked).startswith("B cannot be reached at crank angle 1.745329 rad")


B = 1 + 2j - 0.6 * np.exp(3.5j)  # of the loaded four-bar
IN_LINE = {
    "bodies.crank.points.A": [10, 0],
    "ground.points.F": [0, 3],
    "sketch": {"angle": pi, "A": [-10, 0], "B": [-2, 0.2], "C": [-1, 0.1], "D": [0, 0]},
}
MISFITS: dict[str, tuple[str, scene_files.Changes, float, str]] = {
    "a lock in the sketch": ("parallel_bars", {}, 0.0, ""),
    "a sketch that cannot close": (
        *("class_iii", {"bodies.lower.lengths.F-D": 23}, 0.0),
        "coupler, plate, upper, lower do not close near the sketch, at crank angle 60.0000 deg",
    ),
    # B is at 0.6 from A, C at 0.05 from D and at |2.1 + 0.3i| from B: too long a coupler.
    "RRR": (
        *("loaded_four_bar", {"bodies.rocker.lengths.C-D": 0.05}, 3.5),
        "C cannot be reached at crank angle 3.500000 rad: coupler and rocker end"
        f" {hypot(2.1, 0.3) - 0.05 - abs(3 + 2.5j - B):.4g} m apart;",
    ),
    # The guide passes the block's pin at 300 mm, which the pins of rod and block are not apart.
    "RPR": (
        *("swinging_block", {"bodies.rod.slides.through": [0, 300]}, -pi / 2),
        f"deg: rod and block end {300 - hypot(300 - 80, 50):.4g} mm apart;",
    ),
    # From A at -10 to E at 2 there are bars of 3, 1 and 3 in line; D is then 3 under F, as its bar is long.
    "larger group": (
        *("parallel_bars", IN_LINE, pi),
        "one, plate, two, three do not close near the sketch, at crank angle 3.141593 rad: with all",
    ),
}


@pytest.mark.parametrize("case", MISFITS)
def test_by_how_much_it_stays_open(case: str) -> None:
    name, changes, position, words = MISFITS[case]
    found = reason(scene_files.load(name, changes), [position])
    assert words in found
    assert case != "larger group" or found.endswith(" stays open by 5 m")

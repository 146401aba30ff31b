"""One unit for each kind of quantity, in which its peak reads between 1 and 10 000."""

import re

import numpy as np
import pytest

from compare.judge.peaks.peaks import peaks
from compare.mechanics.axis import THIN_SPACE, axis, fixed
from compare.mechanics.quantities import apart, named
from compare.mechanics.quantities import number as shown_number
from compare.mechanics.reference import uncertified
from compare.report.linkage.drawing import Drawing
from compare.report.numbers import percent, units, written
from compare.report.pages.html import shortened
from compare.report.tables import first_screen
from compare.report.tables.proof import sentences
from compare.report.tables.study import setup
from compare.study import Study
from scenes import Sampling
from tests import scene_files
from tests.comparisons import sampled, studied
from tests.scene_files import Changes

LIGHT = {f"bodies.{body}.mass": 1e-9 for body in ("crank", "coupler", "rocker")}
LARGE = {"units": {"length": "m", "mass": "kg", "force": "N", "angle": "deg", "speed": "rpm"}}
FAST = {"drive.speed": -6000}
FASTER_THAN_SCALED = {"drive.speed": -200}  # its errors are scaled by T w = 9850 mm/s, and it is faster than 10 000
NEXT_TO_NOTHING = LIGHT | {"drive.speed": -0.006}  # of which the power is less than a nanowatt
SCENES: dict[str, tuple[str, Changes]] = {
    "a press": ("toggle_press", {}),
    "a four-bar": ("four_bar", {}),
    "a clamp": ("double_toggle_clamp", {}),
    "of tiny masses": ("four_bar", LIGHT),
    "huge": ("four_bar", LARGE),
    "fast": ("four_bar", FAST),
    "faster than what scales its errors": ("four_bar", FASTER_THAN_SCALED),
    "of next to no power": ("four_bar", NEXT_TO_NOTHING),
}
QUANTITIES = ("m", "m/s", "m/s^2", "N", "N*m", "J", "W")


@sampled(3)
@pytest.mark.parametrize("case", SCENES)
def test_every_peak_reads_from_1_to_10000_in_one_unit(case: str) -> None:
    name, changes = SCENES[case]
    reference = uncertified(scene_files.load(name, changes))
    numbers = (reference.scene, peaks(reference, Sampling(72), []), units(reference))
    whole, joints = first_screen.answers(*numbers)
    texts: dict[str, list[str]] = {}
    for number in (*whole, *joints):
        if number.unit in QUANTITIES and number.value != 0:
            texts.setdefault(number.unit, []).append(number.text)
    assert {"m", "N", "W"} <= texts.keys()
    for unit, shown in texts.items():
        values, names = zip(*(re.fullmatch(r"([−\d.,]+) (\D.*)", text).groups() for text in shown), strict=True)  # type: ignore[union-attr]
        assert len(set(names)) == 1, (unit, names)
        largest = max(abs(float(value.replace(",", "").replace("−", "-"))) for value in values)
        assert 1 <= largest < 10_000, shown
        assert all(len(value) <= 10 for value in values), shown


def test_what_is_zero_is_written_so() -> None:
    reference = uncertified(scene_files.load("slider_crank"))
    numbers = (reference.scene, peaks(reference, Sampling(72), []), units(reference))
    whole, joints = first_screen.answers(*numbers)
    (moment,) = [joint for joint in joints if joint.name == "Largest guide moment at slider"]
    assert moment.text == "0"
    assert "Work a turn" not in [number.name for number in whole]
    assert not any(np.isnan(number.value) for number in whole)


def test_a_power_of_ten_is_written_as_elsewhere() -> None:
    assert written(-9.19e-8, "m", {"m": (1e3, "mm")}, digits=3) == "−9.19e-5 mm"


@pytest.mark.parametrize("name", ["four_bar", "double_toggle_clamp"])
def test_a_place_that_is_zero_within_round_off_is_zero(name: str) -> None:
    scene = scene_files.load(name)
    place = first_screen.pose_button(axis(scene), scene.channels["B.vx"], -1.4e-14)
    assert place is not None
    assert place.text.split("°")[0].split(" ")[0] == "0"


def test_units_without_prefixes_are_the_file_s_everywhere() -> None:
    """Of a lever in pounds-force and inches, whose forces are 75 lbf at the pin and 435 lbf in about it."""
    result = studied(scene_files.load("pounds"), ["analytic"])
    texts = {answer.name: answer.text for answers in _answers(result) for answer in answers}
    assert texts["Largest force at constructor"] == "75.00 lbf"
    assert texts["Peak braking torque"] == "−435.0 lbf in"
    assert texts["Peak braking power"] == "−15.184 lbf in/s"  # 435 at 2 degrees a second
    assert {text.split(" ", 1)[1] for text in texts.values() if " " in text} == {
        *("lbf", "in", "in/s", "in/s²", "lbf in", "lbf in/s"),
    }
    proven, limits = sentences(result)
    assert "no pin carries more than 75.00 lbf (constructor " in proven
    assert "constructor.force: at most 60 lbf missed: 75.00 lbf from −10.00 to 10.00°" in limits
    assert "drive.torque: at least −400 lbf in missed: −435.0 lbf in at 0°" in limits
    assert Drawing(result.scene, result.motion).scale_text == "50 lbf = 1.5 in"  # 75 lbf are a fifth of 11 in
    assert setup(result).startswith("The toString at 2 deg/s from −10.00 to 10.00°, one cycle")


def test_a_number_has_one_rounding() -> None:
    """Four digits, five after a leading 1; a bound that reads as its extreme is not rounded away from it."""
    cases = {
        382.012: "382.0",
        10004.23: f"10{THIN_SPACE}004",
        -1090.0004: "−1090.0",
        1.16284: "1.1628",
        2e-5: "2.000e-5",
        -0.331: "−0.3310",
        19.9999999: "20.00",
        0: "0",
    }
    assert {value: shown_number(value) for value in cases} == cases
    assert (fixed(-1e-14, 3), fixed(-0.0004, 3), fixed(-0.0006, 3)) == ("0", "0", "−0.001")
    assert (apart(10004.23, 10004), apart(75.0, 60.0), apart(4.0001, 4.0)) == (
        f"10{THIN_SPACE}004.2",
        "75.00",
        "4.0001",
    )
    assert (percent(8e-8), percent(2e-5), percent(0.0), percent(0.5)) == ("8e-8", "0.002 %", "0 %", "50 %")


def test_a_unit_is_named_without_signs_of_programs() -> None:
    names = ("N*m", "lbf*in", "kg*m^2", "m/s**2", "N*m/deg", "deg")
    assert [*map(named, names)] == ["N m", "lbf in", "kg m²", "m/s²", "N m/deg", "°"]
    assert shortened([{"inertia [kg*mm^2]": 1.0}])[0] == ["inertia [kg mm²]"]


def _answers(result: Study) -> tuple[list[first_screen.Answer], list[first_screen.Answer]]:
    return first_screen.answers(result.scene, result.peaks, units(result.reference))

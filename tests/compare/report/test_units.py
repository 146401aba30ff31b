"""One unit for each kind of quantity, in which its peak reads between 1 and 10,000."""

import re

import numpy as np
import pytest

from compare.judge.peaks.peaks import peaks
from compare.mechanics.axis import axis
from compare.mechanics.reference import uncertified
from compare.report.numbers import units, written
from compare.report.tables import first_screen
from scenes import Sampling
from tests import scene_files
from tests.scene_files import Changes

LIGHT = {f"bodies.{body}.mass": 1e-9 for body in ("crank", "coupler", "rocker")}
LARGE = {"units": {"length": "m", "mass": "kg", "force": "N", "angle": "deg", "speed": "rpm"}}
FAST = {"drive.speed": -6000}
FASTER_THAN_SCALED = {"drive.speed": -200}  # its errors are scaled by T w = 9,850 mm/s, and it is faster than 10,000
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
    place = first_screen.pose_button(axis(scene_files.load(name)), "B.vx", -1.4e-14)
    assert place is not None
    assert place.text.split("°")[0].split(" ")[0] == "0"

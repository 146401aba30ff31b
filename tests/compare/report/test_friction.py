"""Friction in a report: what is lost where, what reaches the loads, where it jams, against sums by hand."""

import re

import numpy as np
import pytest

from compare.report.linkage.drawing import Drawing
from compare.report.linkage.svg import picture
from compare.report.pages.report import page
from compare.report.tables.friction import by_joint, losses, sentences
from compare.study import Study, judged
from scenes import Sampling, load
from tests.comparisons import SLOW, only_few_settings


@pytest.fixture(scope="module")
def drawer() -> Study:
    with only_few_settings():
        return Study.of(judged(load("sticking_drawer"), ["analytic"], Sampling(36)))


@pytest.fixture(scope="module")
def press() -> Study:
    with only_few_settings():
        return Study.of(judged(load("toggle_press_friction"), ["analytic"], Sampling(72)))


def test_the_drawer_s_losses_are_those_of_a_constant_pull(drawer: Study) -> None:
    """Over 250 mm, of a pull of 8 N / (1 - 0.9), 8 N reach the load and 72 N are lost; 2 mu e is 0.9 of the length."""
    (row,) = by_joint(drawer)
    assert abs(row["work lost a cycle [J]"] - 72 * 0.25) < 1e-9  # rounding of a sum of 3600
    text = " ".join(sentences(drawer))
    assert "10 % of the drive's work, 20.00 J, reaches the loads; 18.000 J are lost" in text
    assert "largest force is 80.00 N, without friction 8.000 N" in text
    assert "up to 1.11 times its coefficients" in text
    assert "nowhere self-locking" in text  # drawn back by 8 N / (1 + 0.9)


def test_the_losses_of_a_press_are_the_power_of_its_friction(press: Study) -> None:
    """Joint by joint they are positive, and together what `friction.power` has; a constant load takes no net work."""
    each = losses(press.scene, press.motion)
    assert {*each} == {"O", "P1", "P2", "P3", "P4", "P5", "slider"}
    assert all((power >= 0).all() for power in each.values())
    off = abs(sum(each.values()) + press.motion["friction.power"]).max()
    assert not off > 1e-12 * abs(press.motion["friction.power"]).max()  # rounding of a sum of seven


@SLOW
def test_a_constant_load_takes_power_over_the_stroke_alone(press: Study) -> None:
    """Its work there is its 100 kN by the stroke, and the drive's that of its torque by the angle, as sums by hand."""
    text, cycle = " ".join(sentences(press)), press.reference.cycle
    assert "all of the drive's work, 14.164 kJ, is lost" in text
    closing = cycle["P5.vy"] < 0
    load = 1e5 * np.ptp(cycle["P5.y"])
    drive = float(cycle["drive.torque"][closing].mean() * closing.mean() * 2 * np.pi)
    found = re.search(r"take power, ([\d.]+) kJ, the drive gives ([\d.]+) kJ: ([\d.]+) %", text)
    assert found is not None
    off = np.abs(np.array([*map(float, found.groups())]) / [load / 1e3, drive / 1e3, 100 * load / drive] - 1)
    assert not off.max() > 3e-3  # of a share three digits are printed


@SLOW
def test_a_press_is_self_locking_next_to_its_dead_centres(press: Study) -> None:
    """There alone: the slider's lever on the crank, which goes to zero, is less than that of friction."""
    found = re.search(
        r"friction holds them: crank angle ([\d.]+) to ([\d.]+)°, ([\d.]+) to", " ".join(sentences(press))
    )
    assert found is not None
    low, high, other = map(float, found.groups())
    assert low < high < 12.8  # degrees, of the closed dead centre, as the slider has it
    assert abs(other - 208.6) < 1  # of the open one


def test_the_line_of_each_pin_s_force_touches_its_circle(press: Study) -> None:
    """At every sample, to scale, and on the side on which the moment of friction is; so does its arrow as drawn."""
    drawing, motion = Drawing(press.scene, press.motion), press.motion
    arm = 0.04 * np.sin(np.arctan(0.1))  # of a pin of 40 mm and 0.1
    lines = [arrow for arrow in drawing.arrows if arrow.moment]
    assert [arrow.point for arrow in lines] == ["O", "P1", "P2", "P3", "P4", "P5"]
    assert {point for point, _ in drawing.circles} == {arrow.point for arrow in lines}
    for arrow in lines:
        assert not np.abs(np.abs(arrow.aside) / arm - 1).max() > 1e-9  # rounding, next to a turning of the joint
        moment = (np.conj(arrow.aside) * arrow.force).imag
        assert not np.abs(moment - motion[arrow.moment]).max() > 1e-9 * np.abs(moment).max()  # of their products
    root = picture(drawing)[0]
    circles = [e for e in root.iter() if e.tag.endswith("circle")]
    assert len(circles) == len(lines)
    for circle in circles:
        radius = drawing.larger * drawing.per_metre * arm
        assert abs(float(circle.get("r", "nan")) - radius) < 0.01  # two decimals


def test_no_circles_without_friction(press: Study) -> None:
    drawing = Drawing(load("toggle_press"), press.motion)
    assert (drawing.circles, drawing.larger, any(arrow.moment for arrow in drawing.arrows)) == ([], 1, False)


def test_the_page_has_a_section_of_it(drawer: Study) -> None:
    html = page(drawer)
    assert 'id="friction"' in html
    assert "Losses by joint" in html

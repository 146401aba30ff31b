"""The arbitrary-precision model of the toggle press: its known figures."""

import numpy as np
import pytest

import scenes
from scenes import Motion
from scenes.model.motion import channels

from .runs import named, run


@pytest.fixture(scope="module")
def toggle() -> Motion:
    return named("toggle_press", 720)


def test_toggle_press_has_the_known_extremes(toggle: Motion) -> None:
    y, angle = toggle["P5.y"], np.degrees(toggle["crank_angle"])
    assert abs(np.ptp(y) - 183.6316e-3) <= 3e-6  # a sample misses a dead point by a quarter degree: a t^2 / 2, m
    assert abs(angle[y.argmin()] - 12.9) <= 0.5  # one sample
    assert abs(angle[y.argmax()] - 208.5) <= 0.5
    # Known to four or five digits; a sample may miss an extreme by the curvature over a quarter of a degree.
    np.testing.assert_allclose([toggle["P5.vy"].min(), toggle["P5.vy"].max()], [-0.7166, 0.8650], rtol=2e-4)
    np.testing.assert_allclose([toggle["P5.ay"].min(), toggle["P5.ay"].max()], [-10.328, 5.473], rtol=2e-4)
    assert abs(np.abs(toggle["drive.torque"]).max() / 13888 - 1) <= 2e-4


def test_doubles_do_not_change_with_more_digits() -> None:
    scene = scenes.load("toggle_press")
    fifty, eighty = run(scene), run(scene, digits=80)
    for channel in channels(scene):
        # Rounded to nearest both times: equal, unless true value is zero (P5.x) and only the last digits of 50 remain.
        assert np.abs(fifty[channel] - eighty[channel]).max() <= 1e-40

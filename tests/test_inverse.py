"""From the slider back to the crank: by hand on a slider-crank, and there and back on the toggle press."""

import numpy as np
import pytest

import analytic
from analytic.decomposition import decompose
from analytic.inverse import displacement
from scenes import Scene

from .conftest import SceneFrom
from .test_analytic import SLIDER_CRANK


def test_slider_crank_by_hand(scene_from: SceneFrom) -> None:
    """With x = r cos + sqrt(l^2 - r^2 sin^2), cos(theta) = (x^2 + r^2 - l^2) / (2 r x): one angle up, one down."""
    scene = scene_from(SLIDER_CRANK)
    x = np.array([2.1, 2.5, 3.0, 3.9])
    by_hand = np.arccos((x**2 + 1 - 9) / (2 * x))
    out, back = sorted(analytic.inverse(scene, x), key=lambda stroke: stroke.start % (2 * np.pi))
    # arccos amplifies roundings by 1 / sin(angle), 1 / 0.3 at most here
    assert np.abs(out.crank_angle % (2 * np.pi) - by_hand).max() <= 1e-14
    assert np.abs(back.crank_angle % (2 * np.pi) - (2 * np.pi - by_hand)).max() <= 1e-14


def test_there_and_back(toggle_press: Scene) -> None:
    """Where the crank is, how fast it turns and speeds up, from the slider's own motion: constant speed comes back."""
    angle = np.radians(np.arange(30, 190, 7.0))  # one stroke, upwards, away from both dead points
    motion = analytic.solve(toggle_press, angle)
    strokes = analytic.inverse(toggle_press, motion["P5.y"], motion["P5.vy"], motion["P5.ay"])
    assert len(strokes) == 2
    assert np.degrees([stroke.start for stroke in strokes]) == pytest.approx([12.8, 208.6], abs=0.05)
    up = strokes[0]
    slope = np.abs(
        displacement(toggle_press, decompose(toggle_press), angle)[1]
    ).min()  # m a radian: a rounding of s is this much angle
    assert np.abs(up.crank_angle - angle).max() <= 4 * 2.3e-16 / slope
    assert np.abs(up.omega - 2 * np.pi).max() <= 1e-10  # that angle error, times s'' / s'
    assert np.abs(up.alpha).max() <= 1e-8  # and once more
    down = strokes[1]
    assert np.abs(analytic.solve(toggle_press, down.crank_angle)["P5.y"] - motion["P5.y"]).max() <= 1e-15


def test_strokes_end_at_dead_points(toggle_press: Scene) -> None:
    for stroke in analytic.inverse(toggle_press, -1.0):
        _, slope, _ = displacement(toggle_press, decompose(toggle_press), np.array([stroke.start, stroke.end]))
        assert np.abs(slope).max() <= 1e-14


def test_out_of_reach_is_not_a_number(toggle_press: Scene) -> None:
    for stroke in analytic.inverse(toggle_press, [-1.2, -1.0, -0.9]):
        assert np.isnan(stroke.crank_angle).tolist() == [True, False, True]
        assert np.isnan(stroke.omega).tolist() == [True, False, True]


def test_a_point_that_does_not_slide(scene_from: SceneFrom) -> None:
    scene = scene_from(SLIDER_CRANK.replace('slider = "B"', 'point = "A"'))
    with pytest.raises(ValueError, match="A is on no body that slides"):
        analytic.inverse(scene, 1.0)

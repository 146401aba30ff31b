"""The arbitrary-precision model of the toggle press: its known figures, and natural coordinates."""

from math import pi

import numpy as np
import pytest

import scenes
from scenes import Motion
from scenes.motion import channels

from .runs import Array, named, run


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


def test_toggle_press_agrees_with_distances_between_points(toggle: Motion) -> None:
    """Natural coordinates: the points are the unknowns, the lengths the equations, and no body has an angle."""
    points = ("P2", "P3", "P4", "P5")
    lengths = {(0, 1): 0.49, (1, 2): 0.49, (0, 2): 0.76, (2, 3): 0.3}
    speed, P1 = 2 * pi, np.array([0.404709, -0.217661])

    def jacobian(p: Array) -> Array:
        """Return half the derivative of the squared lengths, of |P3|^2 and of 2 P5.x in the coordinates."""
        J = np.zeros((6, 8))
        for row, (i, j) in enumerate(lengths):
            J[row, 2 * i : 2 * i + 2], J[row, 2 * j : 2 * j + 2] = p[i] - p[j], p[j] - p[i]
        J[4, 2:4], J[5, 6] = p[1], 1
        return J

    def squares(p: Array) -> Array:
        return np.array([*(np.sum((p[i] - p[j]) ** 2) for i, j in lengths), p[1] @ p[1], 0])

    for k in range(0, 721, 60):
        mine = {
            q: np.array([[toggle[f"{point}.{q}{axis}"][k] for axis in "xy"] for point in points])
            for q in ("", "v", "a")
        }
        arm = 0.077 * np.array([np.cos(toggle["crank_angle"][k]), np.sin(toggle["crank_angle"][k])])
        p = mine[""] + 1e-3
        p[0] = P1 + arm
        for _ in range(6):
            error = squares(p) - np.square([*lengths.values(), 0.3, 0])
            error[5] = 2 * p[3, 0]
            p[1:] -= np.linalg.solve(jacobian(p)[:, 2:], error / 2).reshape(3, 2)
        J = jacobian(p)
        v, a = np.zeros((4, 2)), np.zeros((4, 2))
        v[0], a[0] = speed * np.array([-arm[1], arm[0]]), -(speed**2) * arm
        v[1:] = np.linalg.solve(J[:, 2:], -J[:, :2] @ v[0]).reshape(3, 2)
        a[1:] = np.linalg.solve(J[:, 2:], -J[:, :2] @ a[0] - squares(v)).reshape(3, 2)
        # Doubles times the condition of the linkage, some hundreds; once more for each derivative.
        assert np.abs(p - mine[""]).max() <= 1e-13
        assert np.abs(v - mine["v"]).max() <= 1e-12
        assert np.abs(a - mine["a"]).max() <= 1e-10


def test_doubles_do_not_change_with_more_digits() -> None:
    scene = scenes.load("toggle_press")
    fifty, eighty = run(scene), run(scene, digits=80)
    for channel in channels(scene):
        # Rounded to nearest both times: equal, unless true value is zero (P5.x) and only the last digits of 50 remain.
        assert np.abs(fifty[channel] - eighty[channel]).max() <= 1e-40

"""The machines drawn: distributed as the scene has it, the same whatever others are asked for."""

from math import sqrt

import numpy as np
import pytest

import scenes
from compare.measure.many.machines import draws

ROCKER, MASS = "bodies.rocker.lengths.O-P3", "bodies.toggle.mass"


def test_they_are_distributed_as_the_scene_has_it() -> None:
    """A Sobol sequence of 4096: each number is stratified, so that its moments are exact to about one in as many."""
    machines = draws(scenes.load("toggle_press"), 7, 0, 4096)
    rocker, mass = machines[ROCKER], machines[MASS]
    assert rocker.mean() == pytest.approx(300, abs=1e-5)
    assert rocker.std() == pytest.approx(0.05 / 3, rel=1e-3)  # the tail is cut at 3.7 deviations
    assert np.mean(np.abs(rocker - 300) < 0.05) == pytest.approx(0.9973, abs=5e-4)  # two of them more or less
    assert mass.mean() == pytest.approx(250, abs=1e-3)
    assert mass.std() == pytest.approx(5 / sqrt(3), rel=1e-3)
    assert 245 <= mass.min() < 245.01
    assert 254.99 < mass.max() <= 255
    table = np.corrcoef([*machines.values()])
    assert np.abs(table - np.eye(len(machines))).max() < 0.01  # independent: 1 / sqrt(4096) of random ones


def test_a_machine_is_the_same_whatever_others_are_asked_for() -> None:
    scene = scenes.load("toggle_press")
    whole, part, other = draws(scene, 3, 0, 300), draws(scene, 3, 123, 45), draws(scene, 4, 0, 300)
    for path, values in whole.items():
        assert (values[123:168] == part[path]).all()
        assert (values != other[path]).all()

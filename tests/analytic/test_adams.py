"""Torques that MSC Adams finds for a crank that swings by harmonics, from a table of a four-bar of its users."""

import numpy as np

import analytic
from tests import scene_files

TORQUES = {0.055: 65.77456, 0.805: 4.733286, 1.555: -57.14815, 2.305: 2.401347, 3.055: 65.40858}  # N m, at s


def test_torques_of_a_swinging_four_bar() -> None:
    scene = scene_files.load("adams_four_bar")
    time = np.array([*TORQUES])
    off = analytic.solve(scene, scene.drive.law.at(time).position, time)["drive.torque"] - [*TORQUES.values()]
    assert np.abs(off).max() <= 2e-5  # of its seven or eight digits

"""A table of MSC Adams: the torque on a crank that swings by harmonics."""

import numpy as np

import analytic
from tests import scene_files

TORQUES = (  # N m, from 0.055 s on every 0.075 s
    *(65.77456, 64.53364, 61.53852, 55.79689, 46.75967, 35.31922, 24.07179, 15.80887, 11.2405, 8.470771, 4.733286),
    *(-1.652772, -10.66967, -21.12751, -31.48916, -40.48791, -47.42382, -52.18557, -55.08361, -56.59875, -57.14815),
    *(-56.93033, -55.86272, -53.60676, -49.68372, -43.67969, -35.50059, -25.58799, -14.98843, -5.181704, 2.401347),
    *(7.150341, 10.02065, 13.49612, 20.11987, 30.37369, 42.11484, 52.38295, 59.50764, 63.54232, 65.40858),
)


def test_torques_of_a_swinging_four_bar() -> None:
    scene = scene_files.load("adams_four_bar")
    time = 0.055 + 0.075 * np.arange(len(TORQUES))
    off = analytic.solve(scene, scene.drive.at(time).position, time)["drive.torque"] - TORQUES
    assert np.abs(off).max() <= 2e-5  # of its seven or eight digits

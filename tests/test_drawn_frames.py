"""A linkage whose bodies have their points as the ground has them at one pose is the same linkage."""

import numpy as np

import analytic
import scenes
from tests import scene_files

CHANNELS = ("T.x", "T.ay", "coupler.omega", "A.fx", "B.fy", "drive.torque")
ROUNDING = 1e-13  # of the largest value: two ways to write the same numbers, a few operations apart


def test_places_of_one_pose_are_bodies_frames() -> None:
    scene, start, turn = scenes.load("four_bar"), 0.9, np.linspace(0, 2 * np.pi, 50)
    pose = analytic.solve(scene, np.array([start]))
    drawn = {p: [1e3 * x for x in xy] for p, xy in scene.ground.items()}
    drawn |= {p: [float(1e3 * pose[f"{p}.{axis}"][0]) for axis in "xy"] for p in scene.moving_points}
    changes: scene_files.Changes = {"sketch": {point: drawn[point] for point in scene.sketch.points}}
    for name, body in scene.bodies.items():
        changes[f"bodies.{name}"] = {"points": {p: drawn[p] for p in body.points}, "mass": body.mass}
    changes |= {"bodies.coupler.com": drawn["B"], "bodies.coupler.inertia": 52083}
    copied = analytic.solve(scene_files.load("four_bar", changes), turn)
    written = analytic.solve(scene, turn + start)
    for channel in CHANNELS:
        assert np.abs(copied[channel] - written[channel]).max() <= ROUNDING * np.abs(written[channel]).max()
    assert np.abs(copied["crank_angle"] - turn).max() == 0

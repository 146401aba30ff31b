"""The poses of an Exudyn system, found by Newton's method from one position of the drive to the next."""

import numpy as np
import pytest

from sim_models.exudyn import poses as exudyn_poses
from sim_models.exudyn.poses import PoseSolver
from sim_models.exudyn.start import start
from tests import scene_files


@pytest.mark.parametrize("knots", [exudyn_poses.KNOTS, 1])
def test_poses_found_together_are_those_found_one_by_one(knots: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From a single knot they are too far to be guessed, and each has to be followed."""
    monkeypatch.setattr(exudyn_poses, "KNOTS", knots)
    poses = PoseSolver(scene_files.load("loaded_four_bar"))
    first = start(poses)
    there, rest = np.linspace(2.0, -1.5, 80), np.full(5, -1.5)
    positions = np.concatenate([there, rest, there[::-1] + 0.01, [0.0, 0.3, 0.3]])  # it rests, turns back, and jumps
    together, state = poses.through(first, positions), first
    assert (together.position == positions).all()
    for row, position in enumerate(positions):
        state = poses.follow(state, float(position))
        assert np.abs(together.q[row] - state.q).max() <= 1e-13
        assert np.abs(together.tangent[row] - state.tangent).max() <= 1e-13
        assert np.abs(together.curvature[row] - state.curvature).max() <= 1e-9  # round-off over its difference of 1e-5


def test_curvature_is_the_change_of_the_tangent() -> None:
    poses = PoseSolver(scene_files.load("loaded_four_bar"))
    state, h = start(poses), 1e-4
    after, before = (poses.follow(state, float(state.position) + way) for way in (h, -h))
    assert np.abs((after.tangent - before.tangent) / (2 * h) - state.curvature).max() <= 1e-6  # h^2 times some hundred

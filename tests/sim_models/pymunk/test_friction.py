"""Friction in the pymunk model, against equations written in the tests, powers, statics and the engine's own motors."""

import numpy as np
import pytest

from scenes import Sampling
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk.settings import PymunkSettings
from tests import scene_files
from tests.comparisons import sampled
from tests.friction_scenes import everywhere

SAMPLING = Sampling(12)


@sampled(2)
@pytest.mark.parametrize("name", ["rocking_guide", "gas_spring", "four_bar", "crank_press"])
def test_the_engines_motors_resist_alike(name: str) -> None:
    """Told how large friction is, they find its sense and the joints' forces by themselves, to the second order."""
    mismatch = []
    for steps in (144, 288):
        settings = PymunkSettings("", steps, 1, 1000)
        simulation = pymunk_model.build(everywhere(scene_files.load(name)), settings, SAMPLING)
        simulation.solve()
        simulation.read()
        mismatch.append(simulation.residuals["friction"])
    # Measured: 1e-8 to 2e-6; with the other sense, or in the wrong joint, a part of the friction, 1e-3 or more.
    assert mismatch[1] <= 1e-5
    assert np.log2(mismatch[0] / mismatch[1]) == pytest.approx(2, abs=0.2)

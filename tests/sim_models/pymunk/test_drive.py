"""Motion laws: their acceleration has kinks, at the knots of the spline, which must cost no accuracy."""

import numpy as np
import pytest

from scenes import Sampling
from sim_models.pymunk.constraints import LinkageConstraints
from sim_models.pymunk.drive import with_rates_of_law
from sim_models.pymunk.engine import DEFAULT, EXACT, FAST
from sim_models.pymunk.masses import fictitious_masses
from sim_models.pymunk.settings import PymunkSettings
from sim_models.pymunk.start import start
from tests import scene_files
from tests.agreement import errors, worst

from .runs import reference, solve


# Measured: 2e-4, 3e-5 and 2e-7; by the mean accelerations of the steps 3e-3, 1e-3 and 3e-4.
@pytest.mark.parametrize(("settings", "largest"), [(FAST, 1e-3), (DEFAULT, 1e-4), (EXACT, 2e-6)])
@pytest.mark.parametrize("name", ["swinging_law", "turning_law"])
def test_knots_cost_no_accuracy(name: str, settings: PymunkSettings, largest: float) -> None:
    scene, sampling = scene_files.load(name), Sampling(72)
    found = worst(errors(solve(scene, settings, sampling), reference(scene, sampling)))
    assert max(found.values()) <= largest, found


@pytest.mark.parametrize("name", ["swinging_law", "turning_law"])
def test_the_driven_body_has_the_rates_of_the_law_and_the_joints_stay_closed(name: str) -> None:
    linkage = LinkageConstraints(scene_files.load(name), fictitious_masses)
    q, law = start(linkage), linkage.scene.drive.at(np.zeros(1))
    v, a = with_rates_of_law(linkage, np.zeros(1), q, np.zeros_like(q), np.zeros_like(q))
    opening = np.zeros(q.size - 1)
    for values, wanted in ((v, law.rate), (a, law.acceleration)):
        # Roundings, of rates up to some 100 1/s^2.
        assert linkage.jacobian(q)[0] @ values.ravel() == pytest.approx([*opening, wanted[0]], abs=1e-11)

"""The core's other ways to the same motion: as accurate as they claim, and as bad where they claim to be bad."""

import numpy as np
import pytest

from analytic.engine import AnalyticSettings
from compare.engines import registry
from compare.judge.floor import establish
from compare.judge.measure import measure
from scenes import Sampling, Scene
from tests import scene_files
from tests.agreement import errors, worst
from tests.comparisons import sampled

SCENES = ("shaper", "driven_toggle", "carried_block", "turning_law")


def off(name: str, settings: AnalyticSettings) -> dict[str, float]:
    """Return by kind of channel how far a variant is from the core."""
    scene, engine = scene_files.load(name), registry.engine(registry.REFERENCE)
    motions = []
    for variant in (settings, engine.DEFAULT):
        run = engine.build(scene, variant, Sampling(72))
        run.solve()
        motions.append(run.read())
    return worst(errors(motions[0], {channel: motions[1][channel] for channel in scene.channels.names()}))


@sampled(2)
@pytest.mark.parametrize("name", SCENES)
def test_the_other_ways(name: str) -> None:
    half_angles = max(off(name, AnalyticSettings("half angles", half_angles=True)).values())
    assert half_angles <= 1e-11  # thousands of roundings, where A + C cancels, and none where there is no RRR dyad
    assert (half_angles > 0) == (name in ("driven_toggle", "carried_block"))
    single = max(off(name, AnalyticSettings("single", single=True)).values())
    assert 1e-9 <= single <= 1e-5  # roundings of 6e-8, a hundred times larger at most; and not those of doubles
    # Half the step, a quarter of the error; positions have none.
    coarse, fine = (off(name, AnalyticSettings("differences", steps=steps)) for steps in (720, 1440))
    for group in ("vx", "omega", "ax", "alpha"):
        assert np.log2(coarse[group] / fine[group]) == pytest.approx(2, abs=0.1)  # the next order is h^2 smaller still
    assert coarse["x"] == coarse["angle"] == 0


def test_single_precision_is_told_from_the_reference(toggle_press: Scene) -> None:
    """Its channels are doubles, so that the reference is not evaluated in single precision too, and agrees."""
    found = measure(establish(toggle_press), "analytic", Sampling(72), AnalyticSettings("single", single=True))
    assert found.run.motion is not None
    assert all(samples.dtype == np.float64 for samples in found.run.motion.samples.values())
    worst = found.worst()
    assert 1e-8 <= worst["reaction"] <= 1e-5  # a rounding is 6e-8, a few dozen of them

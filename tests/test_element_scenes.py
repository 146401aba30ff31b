"""Random linkages with elements and drives of every kind: the core and 50 digits against absolute coordinates."""

from pathlib import Path

import pytest

import analytic
from scenes import Sampling
from scenes.elements import ALL_KINDS

from .agreement import errors, exact
from .clean_scenes import clean_scenes
from .true_errors import by_absolute

SAMPLING = Sampling(12)
CLOSE = 1e-12  # on the scale of `agreement`: of 200 scenes the worst is 4e-14, by round-off


def test_three_formulations_agree_on_every_element_and_drive(tmp_path: Path) -> None:
    pytest.importorskip("flint")
    drawn = clean_scenes(tmp_path, 16, elements=True)
    assert frozenset.union(*(scene.kinds for scene in drawn)) == ALL_KINDS - {"friction"}
    for scene in drawn:
        fifty, time = exact(scene, SAMPLING), SAMPLING.times(scene)
        core = analytic.solve(scene, fifty[scene.drive_channel], time)
        lightest = min((body.mass for body in scene.bodies.values() if body.mass), default=0.0)
        expected = by_absolute(scene, time)
        for motion in (fifty, core):
            for channel, error in errors(motion, expected, mass=lightest).items():
                assert error.max() <= CLOSE, (scene.name, channel)

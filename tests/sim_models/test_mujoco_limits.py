"""What MuJoCo's own limits leave out."""

import pytest

from compare.engines.runner import run
from scenes import Sampling, Status, hard


def test_a_body_that_is_too_light_is_unsupported() -> None:
    pytest.importorskip("mujoco")
    light = next(rung.scene() for rung in hard.ladder("mass_slider").rungs if rung.label == "1e-9")
    ended = run("mujoco", light, Sampling(24))
    assert ended.status is Status.unsupported
    assert ended.reason == "'slider' is too light for MuJoCo beside the heaviest body"

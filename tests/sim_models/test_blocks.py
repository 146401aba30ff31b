"""Engines take the Jacobians of a long run in blocks, and give the same numbers as with all of them at a time."""

import numpy as np
import pytest

from compare.engines.runner import run
from scenes import Sampling, load
from scenes.model import constraints
from tests.comparisons import sampled


@sampled(1)
@pytest.mark.parametrize("engine", ["exudyn", "pymunk"])
def test_blocks_change_nothing(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    at_once = run(engine, load("toggle_press"), Sampling(50)).motion
    monkeypatch.setattr(constraints, "BLOCK", 7 * 15**2)  # seven samples of five bodies
    in_blocks = run(engine, load("toggle_press"), Sampling(50)).motion
    assert at_once is not None
    assert in_blocks is not None
    for channel, samples in at_once.samples.items():
        assert np.array_equal(in_blocks[channel], samples), channel

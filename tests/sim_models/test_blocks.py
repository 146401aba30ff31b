"""Engines take the Jacobians of a long run in blocks, and give the same numbers as with all of them at a time."""

import numpy as np
import pytest

from compare.engines.runner import run
from scenes import Sampling, load
from sim_models.exudyn import equations
from sim_models.pymunk import constraints


@pytest.mark.parametrize(("engine", "module"), [("exudyn", equations), ("pymunk", constraints)])
def test_blocks_change_nothing(engine: str, module: object, monkeypatch: pytest.MonkeyPatch) -> None:
    at_once = run(engine, load("toggle_press"), Sampling(50)).motion
    monkeypatch.setattr(module, "BLOCK", 7 * 15**2)  # seven samples of five bodies
    in_blocks = run(engine, load("toggle_press"), Sampling(50)).motion
    assert at_once is not None
    assert in_blocks is not None
    for channel, samples in at_once.samples.items():
        assert np.array_equal(in_blocks[channel], samples), channel

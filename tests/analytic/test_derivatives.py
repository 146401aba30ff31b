"""Exact derivatives, against differences of what the 50-digit oracle finds along random directions of all numbers.

Differences at three steps, extrapolated (Richardson), are off by about 1e-11 of a channel's scale: the oracle's
channels are doubles, half a last place off, over steps of a 100,000th. Longer ones would do but for the clamps, whose
forces bend near their lock.
"""

import numpy as np
import pytest

import analytic
import scenes
from scenes import Sampling, Scene
from scenes.channels import Role
from sim_models.multiprecision.engine import DEFAULT, build
from tests import scene_files
from tests.comparisons import SLOW

QUICK = ("toggle_press",)
STEPS = 2.0 ** -np.arange(11, 14)  # of the direction, itself a share of each number
TOLERANCE = 1e-10  # of a channel's scale: its own peak, and that of its change
SAMPLES = 8  # not on the rows of the tables, where their lines bend


def oracle(scene: Scene) -> dict[str, np.ndarray]:
    """Return the oracle's channels."""
    simulation = build(scene, DEFAULT, Sampling(samples=SAMPLES - 1))
    simulation.solve()
    return dict(simulation.read().samples)


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else SLOW) for name in scenes.shipped()])
def test_along_a_direction(name: str) -> None:
    scene = scenes.load(name)
    paths = sorted(path for path in scene_files.free(scene) if not path.startswith("drive."))
    nominal = np.array(scenes.numbers_in(name, paths))
    near = min(np.abs(nominal).max() * 1e-3, np.median(np.abs(nominal[nominal != 0])))  # large inertias are no length
    size = np.where(nominal == 0, near, nominal)
    direction = size * np.random.default_rng(len(name)).uniform(-0.1, 0.1, len(nominal))

    def at(step: float) -> dict[str, np.ndarray]:
        return oracle(scenes.load(name, dict(zip(paths, (nominal + step * direction).tolist(), strict=True))))

    pairs = [(at(step), at(-step)) for step in STEPS]
    asked = Sampling(samples=SAMPLES - 1)
    found = analytic.derivatives(scene, paths, asked.commanded(scene), asked.times(scene))
    values, moving = pairs[0][0], np.ones(SAMPLES, np.bool_)
    for channel in scene.channels.names(Role.friction):  # where a joint turns round it has no derivative
        moving &= values[channel] * pairs[0][1][channel] > 0
    for channel in values.keys() & found.keys():
        first, second, third = (
            (ahead[channel] - back[channel]) / (2 * step) for (ahead, back), step in zip(pairs, STEPS, strict=True)
        )
        better = (4 * second - first) / 3, (4 * third - second) / 3
        exact = (16 * better[1] - better[0]) / 15
        off = np.abs(direction @ found[channel] - exact)[moving].max()
        assert off <= TOLERANCE * max(np.abs(exact).max(), np.abs(values[channel]).max(), 1e-9), channel

"""Models without a time step at inputs that no law of the scene has: each by its own mechanics, and all agree."""

from itertools import product

import numpy as np
import pytest

import analytic
import scenes
from compare.engines import registry
from compare.engines.runner import run
from scenes import AtInputs, Inputs, Positions, Scene, Status
from tests import agreement, scene_files
from tests.comparisons import sampled

SCENES = {
    "a slider-crank": lambda: scene_files.load("slider_crank"),
    "a toggle press": lambda: scenes.load("toggle_press"),
    "a motion law": lambda: scenes.load("servo_press"),
    "a larger group": lambda: scenes.load("class_iii"),
}
ENGINES = registry.ORACLE, "casadi", "pinocchio"
TOLERANCE = 1e-11  # of a kind's size: roundings of some hundred operations on doubles, times conditions of a hundred


def drawn(scene: Scene, count: int = 9) -> Inputs:
    """Instants that increase, positions within the range, and rates and accelerations of either sign."""
    chance, (least, most) = np.random.default_rng(7), scene.drive.law.extent
    margin, pace = 0.02 * (most - least), scene.drive.law.peak_rate
    position = chance.uniform(least + margin, most - margin, count)
    rate, acceleration = chance.uniform(-1, 1, (2, count)) * [[pace], [pace**2 / scene.drive.unit]]
    time = np.sort(chance.uniform(0, scene.cycle, count))
    return Inputs(time, np.stack([position, rate, acceleration])[..., np.newaxis])


@sampled(2)
@pytest.mark.parametrize(("engine", "name"), [*product(ENGINES, SCENES), (registry.ORACLE, "a cylinder")])
def test_the_core_agrees_with_others(engine: str, name: str) -> None:
    """At inputs that are given no law is asked, by none of them."""
    scene = scenes.load("excavator_bucket") if name == "a cylinder" else SCENES[name]()
    given = drawn(scene)
    ended = run(engine, scene, AtInputs(given))
    assert ended.motion is not None, ended.reason
    assert (ended.motion["time"] == given.time).all()
    core = analytic.solve(scene, inputs=given)
    found = agreement.errors(core, ended.motion.samples)
    assert found
    for channel, error in found.items():
        assert error.max() <= TOLERANCE, channel


def test_inputs_of_a_constant_speed_are_positions() -> None:
    scene = scenes.load("toggle_press")
    request = Positions((0.3, 0.9, 2.0))
    by_positions = agreement.exact(scene, request)
    by_inputs = agreement.exact(scene, AtInputs(request.inputs(scene)))
    for channel, samples in by_positions.samples.items():
        assert np.abs(by_inputs[channel] - samples).max() <= 1e-13 * max(np.abs(samples).max(), 1.0), channel


@pytest.mark.parametrize("engine", ["exudyn", "pymunk"])
def test_what_steps_through_the_time_refuses_them(engine: str) -> None:
    scene = scene_files.load("slider_crank")
    ended = run(engine, scene, AtInputs(drawn(scene)))
    assert ended.status is Status.unsupported
    assert "steps through the time" in ended.reason

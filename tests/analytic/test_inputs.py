"""The core at inputs of one's own: the chain rule, forces by hand, and instants alone."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import analytic
import scenes
from scenes import Inputs, Scene
from scenes.channels import named
from scenes.elements.friction import AT_REST
from scenes.model.inputs import inputs_of
from tests import scene_files

ROUNDED = 1e-12  # of a channel's peak: some fifty operations on doubles, times conditions of a hundred
MASS, LOAD, ROD = 2.0, 50.0, 3.0  # kg, N, m: as in the file, at a crank of 1 m


def inputs(position: Any, rate: Any, acceleration: Any) -> Inputs:
    """Of one drive, at instants that have nothing to do with them."""
    return Inputs(np.linspace(7, 9, len(position)), np.stack([position, rate, acceleration])[..., np.newaxis])


def drawn(scene: Scene, count: int = 25) -> tuple[Any, Any, Any]:
    """Positions within the range, in no order, and rates and accelerations of either sign, and zero."""
    chance, (least, most) = np.random.default_rng(43), scene.drive.law.extent
    position = chance.uniform(least + 0.02 * (most - least), most - 0.02 * (most - least), count)
    rate, acceleration = chance.uniform(-4, 4, count), chance.uniform(-9, 9, count)
    rate[:3] = acceleration[2:5] = 0.0
    return position, rate, acceleration


@pytest.mark.parametrize("name", ["four_bar", "toggle_press", "servo_press", "excavator_bucket", "class_iii"])
def test_velocities_and_accelerations_follow_by_the_chain_rule(name: str) -> None:
    """V = x' q' and a = x' q'' + x'' q'^2, whatever the law of the scene: x', x'' are those at a rate of one."""
    scene = scenes.load(name)
    q, dq, ddq = drawn(scene)
    unit = analytic.solve(scene, inputs=inputs(q, np.ones_like(q), np.zeros_like(q)))
    found = analytic.solve(scene, inputs=inputs(q, dq, ddq))
    pairs = {"vx": "ax", "vy": "ay", "omega": "alpha"}
    checked = [channel for channel in found.samples if named(channel).name in pairs]
    assert checked
    for channel in checked:
        second = f"{channel.rpartition('.')[0]}.{pairs[named(channel).name]}"
        for value, expected in (
            (found[channel], unit[channel] * dq),
            (found[second], unit[channel] * ddq + unit[second] * dq**2),
        ):
            assert np.abs(value - expected).max() <= ROUNDED * max(float(np.abs(expected).max()), 1e-9), channel
    assert (found[scene.channels.drive.position] == q).all()
    assert (found["time"] == np.linspace(7, 9, len(q))).all()


def test_forces_of_a_slider_crank_by_hand() -> None:
    """Of the slider alone, M a + 50 N along the guide: the rod's line has that, and the crank lifts it by virtual work.

    With sin b = sin q / 3 the slider is at x = cos q + 3 cos b, and x' = -sin q - cos q tan b. The rod pushes it by
    (M a + 50) / cos b, so that the guide has (M a + 50) tan b.
    """
    scene = scene_files.load("slider_crank")
    q, dq, ddq = drawn(scene)
    b = np.arcsin(np.sin(q) / ROD)
    first = -np.sin(q) - np.cos(q) * np.tan(b)
    db = np.cos(q) / (ROD * np.cos(b))  # by q
    second = -np.cos(q) + np.sin(q) * np.tan(b) - np.cos(q) * db / np.cos(b) ** 2
    needed = MASS * (first * ddq + second * dq**2) + LOAD
    found = analytic.solve(scene, inputs=inputs(q, dq, ddq))
    for channel, expected in (("drive.torque", first * needed), ("slider.guide_force", needed * np.tan(b))):
        assert np.abs(found[channel] - expected).max() <= ROUNDED * np.abs(expected).max(), channel


@pytest.mark.parametrize("compiled", [False, None])
@pytest.mark.parametrize("steady", [False, True])
def test_a_prepared_line_of_a_constant_speed_is_not_taken_at_other_rates(
    compiled: bool | None, *, steady: bool
) -> None:
    """In it the speed is the scene's, and there is no acceleration; these have one at any rate, or at that speed."""
    scene = scene_files.load("slider_crank")
    q, dq, ddq = drawn(scene)
    of_drive = inputs(q, np.full_like(q, scene.pace) if steady else dq, ddq)
    found = analytic.fast_solver(scene, compiled=compiled)(of_drive)
    expected = analytic.solve(scene, inputs=of_drive)
    assert np.abs(found["drive.torque"] - expected["drive.torque"]).max() <= 1e-9


def test_an_order_that_is_the_same_at_all_instants_is_given_once() -> None:
    """As a sequence of arrays, of which a rate and an acceleration have one number a drive."""
    scene = scene_files.load("slider_crank")
    q, *_ = drawn(scene)
    whole = analytic.solve(scene, inputs=inputs(q, np.full_like(q, 2.0), np.full_like(q, -3.0)))
    once = Inputs(np.linspace(7, 9, len(q)), [q[:, np.newaxis], np.array([2.0]), np.array([-3.0])])
    found = analytic.solve(scene, inputs=once)
    for channel, expected in whole.samples.items():
        assert np.abs(found[channel] - expected).max() <= ROUNDED * max(float(np.abs(expected).max()), 1e-9), channel


def test_friction_where_a_drive_of_constant_speed_rests() -> None:
    """At a rate that is round-off nothing rubs, as under a law; at a small one friction takes power."""
    scene = scenes.load("crank_press_friction")
    q, _, ddq = drawn(scene)
    channels, power = frozenset({"drive.torque", "friction.power"}), {}
    for share in (1e-3, 1e3):
        dq = np.full_like(q, share * AT_REST * scene.drive.law.peak_rate)
        power[share] = analytic.solve(scene, channels=channels, inputs=inputs(q, dq, ddq))["friction.power"]
    assert not power[1e-3].any()
    assert (power[1e3] < 0).all()


TIMES = np.linspace(0, 0.3, 31)
PLACES: dict[str, Callable[[Scene], Any]] = {
    "a constant speed": lambda scene: scene.drive.law.start + scene.drive.law.speed * TIMES,  # type: ignore[union-attr]
    "a cylinder": lambda scene: scene.drive.law.start + scene.drive.law.speed * TIMES,  # type: ignore[union-attr]
    "a motion law": lambda scene: scene.drive.law.at(TIMES).position,
}
SCENES = {"a constant speed": "toggle_press", "a cylinder": "excavator_bucket", "a motion law": "servo_press"}


@pytest.mark.parametrize("kind", PLACES)
def test_instants_alone(kind: str) -> None:
    """The drive is where its law has it then; as the laws' inputs have it too."""
    scene = scenes.load(SCENES[kind])
    found = analytic.solve(scene, time=TIMES)
    expected = analytic.solve(scene, PLACES[kind](scene), TIMES)
    by_laws = analytic.solve(scene, inputs=inputs_of(scene, TIMES))
    for channel in expected.samples:
        size = max(float(np.abs(expected[channel]).max()), 1e-9)
        assert np.abs(found[channel] - expected[channel]).max() <= ROUNDED * size, channel
        assert np.abs(by_laws[channel] - expected[channel]).max() <= ROUNDED * size, channel


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({}, "expected either inputs, or position, time or both"),
        ({"position": [0.1], "inputs": inputs([0.1], [1.0], [0.0])}, "expected either inputs"),
        ({"inputs": Inputs(np.zeros(2), np.zeros((2, 2, 1)))}, "each (n, 1)"),
        ({"inputs": Inputs(np.zeros(2), np.zeros((3, 2, 2)))}, "(2,) and (2, 2), (2, 2), (2, 2)"),
        ({"inputs": Inputs(np.zeros(2), [np.zeros(1)] * 3)}, "(2,) and (1,), (1,), (1,)"),
        ({"inputs": Inputs(np.zeros(3), np.zeros((3, 2, 1)))}, "(3,) and (2, 1)"),
        ({"inputs": Inputs(np.zeros((2, 1)), np.zeros((3, 2, 1)))}, "(2, 1) and"),
        ({"inputs": Inputs(np.zeros(2), np.full((3, 2, 1), np.nan))}, "inputs.derivatives"),
        ({"time": ["now"]}, "time: expected"),
    ],
)
def test_what_is_refused(given: dict[str, Any], text: str) -> None:
    assert text in scene_files.refused(lambda: analytic.solve(scenes.load("four_bar"), **given))

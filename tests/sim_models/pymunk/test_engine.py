"""The pymunk model: orders of convergence, repetition, mirror images; and that only what is asked for is worked out."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import scenes
from scenes import Motion, Sampling, Scene
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk import loads, start
from sim_models.pymunk.constraints import LinkageConstraints
from sim_models.pymunk.engine import DEFAULT, EXACT, FAST
from sim_models.pymunk.runs import simulation as pymunk_simulation
from sim_models.pymunk.settings import AnySettings, PymunkSettings, TextbookSettings
from sim_models.pymunk.start import DrivePlace

from .runs import off, reference, solve


@pytest.fixture(scope="module")
def press() -> Scene:
    return scenes.load("toggle_press")


@pytest.fixture(scope="module")
def pressed(press: Scene) -> Motion:
    return solve(press)


def test_second_order_at_one_level(press: Scene) -> None:
    limit = solve(press, PymunkSettings("", 144, 3, 2000), Sampling(72))
    motions = [solve(press, PymunkSettings("", steps, 1, 2000), Sampling(72)) for steps in (288, 576)]
    for channel in ("P5.y", "P5.vy", "P5.ay", "P4.fx", "P4.fy", "slider.guide_force", "drive.torque"):
        coarse, fine = (off(motion[channel], limit[channel]) for motion in motions)
        # Measured: within 0.01. Half a step of misalignment makes it 1.
        assert np.log2(coarse / fine) == pytest.approx(2, abs=0.05), channel


def test_extrapolation_removes_two_orders(press: Scene) -> None:
    true, wrong = reference(press, Sampling(72))["P5.y"], {}
    for levels in (1, 2, 3):
        motion = solve(press, PymunkSettings("", 72, levels, 2000), Sampling(72))
        wrong[levels] = np.abs(motion["P5.y"] - true).max()
    # Measured: 110 each time; smaller steps alone, without the extrapolation, would give 4.
    assert wrong[2] <= wrong[1] / 20
    assert wrong[3] <= wrong[2] / 20


def test_many_turns_repeat(press: Scene) -> None:
    motion = solve(press, PymunkSettings("", 360, 1, 2000), Sampling(72, turns=3))
    first, last = slice(0, 73), slice(144, 217)
    # Measured: 1e-12, since the steps before zero have warmed up the joints by the first turn.
    for channel in ("P5.y", "P4.fy", "drive.torque"):
        assert off(motion[channel][last], motion[channel][first]) <= 1e-10, channel
    assert motion["crank_angle"][-1] == pytest.approx(6 * np.pi, rel=1e-12)


def test_mirror_image_moves_and_pulls_mirrored(pressed: Motion) -> None:
    changes = {"ground.points.P1.0": -404.709, "drive.speed": -60, "drive.start": 180, "sketch.angle": 168.5}
    motion = solve(scenes.load("toggle_press", {**changes, "sketch.P2.0": -480}))
    # Both runs do the same sums on mirrored numbers; rounding, amplified by dt^-2, tells them apart.
    for channel, sign in (("P4.x", -1), ("P5.y", 1), ("P4.fx", -1), ("P4.fy", 1), ("drive.torque", -1)):
        assert off(motion[channel], sign * pressed[channel]) <= 1e-9, channel
    assert off(motion["slider.guide_force"], -pressed["slider.guide_force"]) <= 1e-9


SAMPLING = Sampling(72)


def test_no_force_asked_for_no_force_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def unwanted(*_: object) -> None:
        raise AssertionError("forces are worked out")

    scene = scenes.load("crank_press")
    whole = pymunk_model.build(scene, DEFAULT, SAMPLING).counters
    for name in ("joint_forces", "check_impulses"):
        monkeypatch.setattr(pymunk_simulation, name, unwanted)
    monkeypatch.setattr("sim_models.pymunk.channels.reaction_channels", unwanted)
    monkeypatch.setattr("sim_models.pymunk.runs.stepping.AppliedForces", unwanted)
    narrow = Sampling(72, channels=frozenset((f"{scene.output}.y",)))
    simulation = pymunk_model.build(scene, DEFAULT, narrow)
    simulation.solve()
    simulation.read()
    # Masses that are free to choose do with a tenth of the sweeps.
    assert simulation.counters["constraint_iterations"] == whole["constraint_iterations"] / 10


def test_ends_of_strokes_are_looked_for_once_a_scene_and_only_for_press_forces(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    walked = []

    def way(linkage: LinkageConstraints, *where: Any) -> Iterator[DrivePlace]:
        walked.append(linkage.scene.name)
        return start.way(linkage, *where)

    monkeypatch.setattr("sim_models.pymunk.loads.way", way)
    loads.stroke_ends.cache_clear()
    for settings in (FAST, DEFAULT, EXACT):
        for name in ("toggle_press", "crank_press"):
            pymunk_model.build(scenes.load(name), settings, SAMPLING)
    assert walked == ["crank_press"] * 2  # to either end of the drive's range


@pytest.mark.parametrize("settings", [FAST, TextbookSettings("", 4608)])
def test_reading_computes_no_channel(settings: AnySettings, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is timed as the solve is all that the channels take."""

    def late(*_: object) -> None:
        raise AssertionError("a channel is worked out outside the clock")

    simulation = pymunk_model.build(scenes.load("toggle_press"), settings, SAMPLING)
    simulation.solve()
    monkeypatch.setattr(pymunk_simulation, "wanted_channels", late)
    assert simulation.read()["P5.y"].shape == (73,)

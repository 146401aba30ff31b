"""The pymunk model: it repeats itself, and spares what a scene that asks for less does not need."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import scenes
from scenes import Sampling
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk import loads, start
from sim_models.pymunk.constraints import LinkageConstraints
from sim_models.pymunk.engine import DEFAULT, EXACT, FAST
from sim_models.pymunk.runs import simulation as pymunk_simulation
from sim_models.pymunk.settings import AnySettings, PymunkSettings, TextbookSettings
from sim_models.pymunk.start import DrivePlace

from .runs import off, solve


def test_many_turns_repeat() -> None:
    motion = solve(scenes.load("toggle_press"), PymunkSettings("", 360, 1, 2000), Sampling(72, turns=3))
    first, last = slice(0, 73), slice(144, 217)
    # Measured: 1e-12, since the steps before zero have warmed up the joints by the first turn.
    for channel in ("P5.y", "P4.fy", "drive.torque"):
        assert off(motion[channel][last], motion[channel][first]) <= 1e-10, channel
    assert motion["crank_angle"][-1] == pytest.approx(6 * np.pi, rel=1e-12)


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

"""Only what is asked for: pymunk spares what a scene that asks for less does not need."""

import pytest

import scenes
from scenes import Sampling
from scenes.scene import PressForce
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk import simulation as pymunk_simulation
from sim_models.pymunk.engine import DEFAULT, FAST
from sim_models.pymunk.settings import AnySettings, TextbookSettings

from .runs import off, solve

SAMPLING = Sampling(72)


@pytest.mark.parametrize("settings", [FAST, DEFAULT, TextbookSettings("", 4608)])
@pytest.mark.parametrize("asked", [("P5.y",), ("P4.ax", "toggle.omega"), ("P4.fx", "P5.vy"), ("drive.torque",)])
def test_exactly_the_channels_asked_for(settings: AnySettings, asked: tuple[str, ...]) -> None:
    scene = scenes.load("toggle_press")
    narrow = Sampling(72, channels=frozenset(asked))
    motion, whole = solve(scene, settings, narrow), solve(scene, settings, SAMPLING)
    assert set(motion.samples) == {"time", "crank_angle", *asked}
    for channel in asked:
        # Measured: 1e-7, which other sweeps over other masses leave where no forces are asked for; else nothing.
        assert off(motion[channel], whole[channel]) <= 2e-6, channel


def test_no_force_asked_for_no_force_found(monkeypatch: pytest.MonkeyPatch) -> None:
    def unwanted(*_: object) -> None:
        raise AssertionError("forces are worked out")

    scene = scenes.load("crank_press")
    whole = pymunk_model.build(scene, DEFAULT, SAMPLING).counters
    for name in ("joint_forces", "check_impulses"):
        monkeypatch.setattr(pymunk_simulation, name, unwanted)
    monkeypatch.setattr("sim_models.pymunk.channels.reaction_channels", unwanted)
    monkeypatch.setattr("sim_models.pymunk.stepping.AppliedForces", unwanted)
    narrow = Sampling(72, channels=frozenset((f"{scene.output}.y",)))
    simulation = pymunk_model.build(scene, DEFAULT, narrow)
    simulation.solve()
    simulation.read()
    # Masses that are free to choose do with a tenth of the sweeps.
    assert simulation.counters["constraint_iterations"] == whole["constraint_iterations"] / 10


def test_a_build_looks_for_ends_of_strokes_only_for_press_forces(monkeypatch: pytest.MonkeyPatch) -> None:
    def unwanted(*_: object) -> None:
        raise AssertionError("the drive's whole range is walked")

    monkeypatch.setattr("sim_models.pymunk.stroke.way", unwanted)
    for name in ("toggle_press", "crank_press"):
        scene = scenes.load(name)
        if any(isinstance(load, PressForce) for load in scene.loads):
            with pytest.raises(AssertionError):
                pymunk_model.build(scene, FAST, SAMPLING)
        else:
            pymunk_model.build(scene, FAST, SAMPLING)


@pytest.mark.parametrize("settings", [FAST, TextbookSettings("", 4608)])
def test_reading_computes_no_channel(settings: AnySettings, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is timed as the solve is all that the channels take."""

    def late(*_: object) -> None:
        raise AssertionError("a channel is worked out outside the clock")

    simulation = pymunk_model.build(scenes.load("toggle_press"), settings, SAMPLING)
    simulation.solve()
    for module in ("simulation", "textbook"):
        monkeypatch.setattr(f"sim_models.pymunk.{module}.found_channels", late)
    assert simulation.read()["P5.y"].shape == (73,)

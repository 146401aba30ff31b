"""The Exudyn model: against facts and laws worked out here, and its manners."""

import subprocess
import sys

import numpy as np
import pytest

import scenes
from scenes import Sampling
from scenes.model.motion import channels
from sim_models.exudyn import engine as model
from sim_models.exudyn.engine import DEFAULT, EXACT
from sim_models.exudyn.settings import ExudynSettings, TimeStepping
from tests import scene_files
from tests.absolute_coordinates import solve

from .helpers import CHEAP, by_level, run


def test_later_turns_repeat_the_first() -> None:
    motion = run(scenes.load("toggle_press"), TimeStepping("", steps=72), turns=20)
    first, last = slice(0, 73), slice(-73, None)
    assert motion["crank_angle"][-1] == pytest.approx(40 * np.pi, rel=1e-12)  # nothing accumulates but round-off
    assert np.abs(motion["P5.y"][last] - motion["P5.y"][first]).max() <= 1e-12
    torque = motion["drive.torque"]
    assert np.abs(torque[last] - torque[first]).max() <= 1e-6 * np.abs(torque).max()  # the transient, 0.5^24 and less


WILD: dict[str, scene_files.Changes] = {
    "slow": {"drive.speed": 6e-5},
    "fast": {"drive.speed": 6e7},
    "heavy": {"bodies.slider.mass": 8e11},
    "light": {"bodies.slider.mass": 8e-7},
    "massless": {"bodies.rod.mass": 0, "bodies.toggle.mass": 0},
    "micrometres": {"units.length": "um"},
    "kilometres": {"units.length": "km"},
}


@pytest.mark.parametrize("name", WILD)
@pytest.mark.parametrize("settings", [DEFAULT, CHEAP], ids=lambda settings: settings.label)
def test_no_size_speed_or_mass_is_too_wild(name: str, settings: ExudynSettings) -> None:
    """By Exudyn's own measures they would be: in newtons and metres Newton's method does not end, or ends too early."""
    scene = scene_files.load("toggle_press", WILD[name])
    exact = run(scene, EXACT).samples
    found = by_level(run(scene, settings), {name: exact[name] for name in channels(scene) if name != "time"})
    assert max(found.values()) <= (1e-6 if settings is DEFAULT else 1e-2)  # measured 1e-7 and 1e-3, as at 60 rpm


def test_kinematic_linkage_close_to_its_change_points() -> None:
    # Masses of 1 kg would take forces there whose round-off is above the tolerance of Newton's method.
    scene = scene_files.load("parallelogram", {"bodies.crank.lengths.A-B": 0.299})
    motion = run(scene, DEFAULT)
    assert max(by_level(motion, solve(scene, *scene.drive.at(motion["time"]))).values()) <= DEFAULT.promise


@pytest.mark.parametrize("engine", ["exudyn", "pymunk"])
def test_import_does_not_load_the_engine(engine: str) -> None:
    code = f"import sys, sim_models.{engine}.engine; sys.exit({engine!r} in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_settings_round_steps_up_to_whole_samples() -> None:
    simulation = model.build(scenes.load("toggle_press"), TimeStepping("", steps=100, richardson=False), Sampling(72))
    simulation.solve()
    assert simulation.counters["steps"] == 144 + 24

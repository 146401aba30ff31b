"""The CasADi model: against equations written in the tests, facts worked out here, and its manners."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import scenes
from scenes import Failure, Positions, Sampling, Status
from tests import scene_files
from tests.agreement import TOLERANCE, kind
from tests.comparisons import SLOW
from tests.sim_models.formulations import off, run

pytest.importorskip("casadi")

from sim_models.casadi import engine
from sim_models.casadi.settings import RungeKutta

QUICK = ("toggle_press", "quick_return", "stephenson_six_bar")
ALL = (*scenes.shipped(), *scene_files.MECHANISMS, "wedge_of_points", "oldham", "two_rods", "busy")
ORDERED = [settings for settings in engine.WORK_PRECISION if isinstance(settings, RungeKutta)]


@pytest.mark.parametrize("name", [pytest.param(name, marks=() if name in QUICK else SLOW) for name in ALL])
def test_every_channel_is_exact(name: str) -> None:
    for channel, error in off(engine, name).items():
        assert error <= (1e-12 if name in QUICK else 50 * TOLERANCE[kind(channel)]), (
            channel
        )  # the clamps' forces: 1e-12


def test_runge_kutta_is_of_order_four() -> None:
    worst = [max(off(engine, "quick_return", settings).values()) for settings in ORDERED]
    steps = [settings.steps for settings in ORDERED]
    orders = -np.diff(np.log(worst)) / np.diff(np.log(steps))
    assert np.abs(orders - 4).max() <= 0.3, orders  # of the leading term alone it would be 4


def test_static_forces_have_the_signs_of_the_channels() -> None:
    """A massless slider-crank under a load on a corner: two-force members, and moments about the slider's pin."""
    slider = {"bodies.slider.mass": 0, "bodies.slider.points.E": [0.2, 0.1]}
    loads = [{"body": "slider", "at": "E", "force": [-100, 0]}]
    scene = scene_files.load("slider_crank", {**slider, "drive.speed": 2, "loads": loads})
    m = run(engine, scene)
    rod = m["B.x"] - m["A.x"] + 1j * (m["B.y"] - m["A.y"])
    on_slider = 100 * rod / rod.real
    limit = 1e-11  # N, of 100
    assert np.abs(m["B.fx"] + 1j * m["B.fy"] - on_slider).max() <= limit
    assert np.abs(m["O.fx"] + 1j * m["O.fy"] - on_slider).max() <= limit
    assert np.abs(m["slider.guide_force"] + on_slider.imag).max() <= limit
    assert np.abs(m["slider.guide_moment"] + 10).max() <= limit
    assert np.abs(m["drive.torque"] - 100 * m["B.vx"] / 2).max() <= limit


def test_positions_are_answered_directly() -> None:
    scene = scenes.load("four_bar")
    sampling = Sampling(12)
    at = Positions(tuple(sampling.commanded(scene).tolist()), channels=frozenset({"T.x", "T.ay"}))
    motion, expected = run(engine, scene, request=at), run(engine, scene, request=sampling)
    assert [*motion.samples] == ["time", "crank_angle", "T.x", "T.ay"]
    for channel, samples in motion.samples.items():
        assert np.abs(samples - expected[channel]).max() <= 1e-13 * np.abs(expected[channel]).max(), channel
    with pytest.raises(Failure) as raised:
        run(engine, scene, ORDERED[0], at)
    assert raised.value.status is Status.unsupported


def test_forces_are_not_found_where_nobody_asks() -> None:
    kinematic = scene_files.load("loaded_four_bar", scene_files.without_masses("loaded_four_bar"))
    weighed = run(engine, scene_files.load("loaded_four_bar"))
    motion = run(engine, kinematic)
    assert "drive.torque" not in motion
    assert np.array_equal(motion["T.ay"], weighed["T.ay"])


MEETING = {"between": ["ground.P", "slider.B"], "stiffness": 1000, "length": 0.1}
ENDINGS: dict[str, tuple[str, scene_files.Changes, Status, str]] = {
    "locks": ("toggle_press", {"bodies.rod.lengths.P4-P5": 200}, Status.cannot_assemble, "past crank angle 166.08"),
    "apart": ("toggle_press", {"bodies.rocker.lengths.O-P3": 3000}, Status.cannot_assemble, "stays open by"),
    "no triangle": (
        "driven_toggle",
        {
            "bodies.plate.lengths": {"A-B": 350, "A-D": 300, "B-D": 120, "B-G": 30, "A-G": 345, "D-K": 60, "G-K": 20},
            "sketch.G": [290, 190],
        },
        Status.cannot_assemble,
        "do not meet",
    ),
    "redundant": ("redundant", {}, Status.unsupported, "1 constraints repeat others"),
    "change point": ("parallelogram", {}, Status.not_converged, "3.14159"),
    "no direction": (
        "slider_crank",
        {"ground.points.P": [4, 0], "springs": [MEETING]},
        Status.nonfinite,
        "the ends of a spring meet",
    ),
}


@pytest.mark.parametrize("ending", ENDINGS)
def test_what_cannot_be_solved_is_refused(ending: str) -> None:
    name, changes, status, reason = ENDINGS[ending]
    with pytest.raises(Failure) as raised:
        run(engine, scene_files.load(name, changes), request=Sampling(72))
    assert raised.value.status is status
    assert reason in raised.value.reason


def test_a_step_onto_another_branch_is_noticed() -> None:
    """Seven steps of the crank are too long where the rod is nearly square to the guide."""
    scene = scene_files.load("toggle_press", {"bodies.rod.lengths.P4-P5": 248.95})
    with pytest.raises(Failure) as raised:
        run(engine, scene, engine.at_steps(7), Sampling(7))
    assert raised.value.status in (Status.wrong_branch, Status.diverged)


def test_manners(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    run(engine, scenes.load("toggle_press"))
    assert not list(tmp_path.iterdir())
    assert capfd.readouterr() == ("", "")
    code = "import sys, sim_models.casadi.engine; sys.exit('casadi' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False, cwd=Path(__file__).parents[3]).returncode == 0

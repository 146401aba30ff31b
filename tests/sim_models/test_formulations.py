"""The optional engines: against equations written in the tests, facts worked out here, and their manners."""

import subprocess
import sys
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import numpy as np
import pytest

import scenes
from compare.engines import registry
from compare.judge.measure import checked_run
from scenes import Failure, Positions, Sampling, Status, hard
from scenes.model import engine as clock
from tests import scene_files
from tests.agreement import TOLERANCE, kind
from tests.comparisons import SLOW, sampled

from .formulations import ALL, SAMPLING, off, run

EXACT = ("casadi", "pinocchio")  # without steps of the time, but for their ladders
ENGINES = (*EXACT, "mujoco")
QUICK = ("quick_return",)  # a slot, a slider, a pinned lever, weights and a press force


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest) -> Any:
    """Return an engine's module where what it needs is installed."""
    pytest.importorskip(registry.ENTRIES[request.param].package)
    return registry.engine(request.param)


only_exact = pytest.mark.parametrize("engine", EXACT, indirect=True)
by_scene = pytest.mark.parametrize("name", [pytest.param(n, marks=() if n in QUICK else SLOW) for n in ALL])


@only_exact
@by_scene
def test_every_channel_is_exact(engine: Any, name: str) -> None:
    for channel, error in off(engine, name).items():
        assert error <= (1e-12 if name in QUICK else 50 * TOLERANCE[kind(channel)]), (
            channel
        )  # the clamps' forces: 1e-12


@pytest.mark.parametrize("engine", ["mujoco"], indirect=True)
@by_scene
def test_every_channel_is_within_the_promise(engine: Any, name: str) -> None:
    worst = max(off(engine, name).values())
    if name == "swinging_segments":  # a step has the mean of an acceleration that jumps in it
        verdict = checked_run("mujoco", scene_files.load(name), SAMPLING, engine.DEFAULT)
        assert (worst > engine.DEFAULT.promise, verdict.status) == (True, Status.inconsistent)
    else:
        assert worst <= engine.DEFAULT.promise


@SLOW
def test_the_ladder_is_of_the_order_of_theory(engine: Any) -> None:
    ladder = [settings for settings in engine.WORK_PRECISION if settings.order][-3:]
    name = "quick_return" if ladder[0].order == 4 else "walking_leg"  # the leg's centrifugal forces are large
    worst = [max(off(engine, name, settings).values()) for settings in ladder]
    orders = -np.diff(np.log(worst)) / np.diff(np.log([settings.steps for settings in ladder]))
    assert np.abs(orders - ladder[0].order).max() <= 0.3, orders  # of the leading term alone it would be zero


@only_exact
def test_static_forces_have_the_signs_of_the_channels(engine: Any) -> None:
    """A massless slider-crank under a load on a corner: two-force members, and moments about the slider's pin."""
    slider = {"bodies.slider.mass": 0, "bodies.slider.points.E": [0.2, 0.1]}
    loads = [{"body": "slider", "at": "E", "force": [-100, 0]}]
    m = run(engine, scene_files.load("slider_crank", {**slider, "drive.speed": 2, "loads": loads}))
    rod = m["B.x"] - m["A.x"] + 1j * (m["B.y"] - m["A.y"])
    on_slider = 100 * rod / rod.real
    limit = 1e-11  # N, of 100
    assert np.abs(m["B.fx"] + 1j * m["B.fy"] - on_slider).max() <= limit
    assert np.abs(m["O.fx"] + 1j * m["O.fy"] - on_slider).max() <= limit
    assert np.abs(m["slider.guide_force"] + on_slider.imag).max() <= limit
    assert np.abs(m["slider.guide_moment"] + 10).max() <= limit
    assert np.abs(m["drive.torque"] - 100 * m["B.vx"] / 2).max() <= limit


@only_exact
def test_positions_are_answered_directly(engine: Any) -> None:
    scene, sampling = scenes.load("four_bar"), Sampling(12)
    at = Positions(tuple(sampling.commanded(scene).tolist()), channels=frozenset({"T.x", "T.ay"}))
    motion, expected = run(engine, scene, request=at), run(engine, scene, request=sampling)
    assert [*motion.samples] == ["time", "crank_angle", "T.x", "T.ay"]
    for channel, samples in motion.samples.items():
        assert np.abs(samples - expected[channel]).max() <= 1e-13 * np.abs(expected[channel]).max(), channel
    with pytest.raises(Failure) as raised:
        run(engine, scene, engine.at_steps(36), at)
    assert raised.value.status is Status.unsupported


@SLOW
def test_forces_are_not_found_where_nobody_asks(engine: Any) -> None:
    kinematic = scene_files.load("loaded_four_bar", scene_files.without_masses("loaded_four_bar"))
    weighed, motion = run(engine, scene_files.load("loaded_four_bar")), run(engine, kinematic)
    assert "drive.torque" not in motion
    assert np.abs(motion["T.ay"] - weighed["T.ay"]).max() <= engine.DEFAULT.promise * np.abs(weighed["T.ay"]).max()


PLATE = {"A-B": 350, "A-D": 300, "B-D": 120, "B-G": 30, "A-G": 345, "D-K": 60, "G-K": 20}
SPRING = {"between": ["ground.P", "slider.B"], "stiffness": 1000, "length": 0.1}
MEETING: scene_files.Changes = {
    **{"bodies.crank.mass": 1, "bodies.rod.mass": 1},
    **{"ground.points.P": [4, 0], "springs": [SPRING]},
}
ENDINGS: dict[str, tuple[str, scene_files.Changes, Status, str]] = {
    "locks": ("toggle_press", {"bodies.rod.lengths.P4-P5": 200}, Status.cannot_assemble, "past crank angle 166.08"),
    "apart": ("toggle_press", {"bodies.rocker.lengths.O-P3": 3000}, Status.cannot_assemble, "stays open by"),
    "no triangle": (
        "driven_toggle",
        {"bodies.plate.lengths": PLATE, "sketch.G": [290, 190]},
        Status.cannot_assemble,
        "do not meet",
    ),
    "redundant": ("redundant", {}, Status.unsupported, "1 constraints repeat others"),
    **{
        f"redundant {name}": (name, scene_files.NONE, Status.unsupported, "1 constraints repeat others")
        for name in ("parallel_bars", "held_twice")
    },
    "change point": ("parallelogram", {}, Status.not_converged, "3.14159"),
    "no direction": ("slider_crank", MEETING, Status.nonfinite, "spring"),
}


@sampled(2)
@pytest.mark.parametrize(
    "ending", [pytest.param(e, marks=() if e in ("locks", "redundant") else SLOW) for e in ENDINGS]
)
def test_what_cannot_be_solved_is_refused(engine: Any, ending: str) -> None:
    name, changes, status, reason = ENDINGS[ending]
    with pytest.raises(Failure) as raised:
        run(engine, scene_files.load(name, changes), request=Sampling(72))
    assert reason in raised.value.reason
    assert raised.value.status is status


def test_what_an_engine_lacks_is_refused() -> None:
    engine = registry.engine("mujoco")
    pytest.importorskip("mujoco")
    for request, scene in ((Sampling(72), "slider_crank"), (Positions((0.0, 0.1)), "four_bar")):
        with pytest.raises(Failure) as raised:
            run(engine, scene_files.load(scene), request=request)
        assert raised.value.status is Status.unsupported


def test_a_body_that_is_too_light_is_unsupported() -> None:
    pytest.importorskip("mujoco")
    light = next(rung.scene() for rung in hard.ladder("mass_slider").rungs if rung.label == "1e-9")
    with pytest.raises(Failure, match=r"^'slider' is too light for MuJoCo beside the heaviest body$") as raised:
        run(registry.engine("mujoco"), light)
    assert raised.value.status is Status.unsupported


def test_every_run_has_its_own_time(engine: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is kept of a scene's first run does not keep the end of that run's time."""
    scene = scenes.load("four_bar")
    run(engine, scene)
    monkeypatch.setattr(clock, "perf_counter", lambda: perf_counter() + 1e4)
    monkeypatch.setattr(clock, "process_time", lambda: process_time() + 1e4)
    run(engine, scene)


@pytest.mark.parametrize("engine", ["mujoco"], indirect=True)
def test_the_defaults_of_mujoco_tear_the_loops_apart(engine: Any) -> None:
    """Its constraints at their defaults are reported as what they are, by the engine or by the checks."""
    settings = next(settings for settings in engine.WORK_PRECISION if not settings.hard)
    assert checked_run("mujoco", scenes.load("toggle_press"), Sampling(72), settings).status is not Status.ok


@SLOW
@only_exact
def test_steps_that_leave_the_branch_are_noticed(engine: Any) -> None:
    """Seven steps a turn jump over the two degrees where the rod is too short; they come out on another branch."""
    scene = scene_files.load("toggle_press", {"bodies.rod.lengths.P4-P5": 248.95})
    with pytest.raises(Failure) as raised:
        run(engine, scene, engine.at_steps(7), Sampling(7))
    assert raised.value.status in (Status.wrong_branch, Status.diverged)


@sampled(1)
@pytest.mark.parametrize("name", ["exudyn", "pymunk", *(pytest.param(n, marks=SLOW) for n in ENGINES)])
def test_nothing_is_imported_before_it_is_needed_and_all_before_a_clock_runs(name: str) -> None:
    pytest.importorskip(name)
    offered = f"import sys; from compare.engines import registry; registry.engine({name!r})"
    imported = f"early = {name!r} in sys.modules; registry.imported({name!r})"
    code = f"{offered}; {imported}; sys.exit(early or {name!r} not in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False, cwd=Path(__file__).parents[2]).returncode == 0

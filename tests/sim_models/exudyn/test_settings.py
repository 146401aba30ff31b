"""The Exudyn model's settings: orders of convergence, what costs what, and what is not asked for costs nothing."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

import scenes
from scenes import Failure, Motion, Sampling, Scene, Settings
from sim_models.exudyn import channels as exudyn_channels
from sim_models.exudyn import engine as model
from sim_models.exudyn import poses as exudyn_poses
from sim_models.exudyn import settings as named
from sim_models.exudyn.engine import ABLATIONS, DEFAULT, EXACT, FAST, LONG_WORK_PRECISION, WORK_PRECISION
from sim_models.exudyn.poses import PoseSolver
from sim_models.exudyn.runs.stepping import TimeSteppedSimulation
from sim_models.exudyn.settings import ExudynExtra, ExudynSettings, JacobianUse, TextbookTimeStepping, TimeStepping
from sim_models.exudyn.system import exudyn
from tests import scene_files
from tests.absolute_coordinates import solve
from tests.agreement import errors, worst
from tests.comparisons import sampled

from .helpers import CHEAP, meeting_spring, run

STEPS_360 = TimeStepping("", steps=360, richardson=False)


# --- orders ----------------------------------------------------------------------------------------------------------


@cache
def exact(name: str) -> tuple[Scene, dict[str, NDArray[np.float64]]]:
    """A shipped scene, and its motion at 25 instants from equations written in the tests."""
    scene = scenes.load(name)
    return scene, solve(scene, *scene.drive.law.at(Sampling(24).times(scene)))


def error(name: str, settings: ExudynSettings) -> float:
    """The largest error of any force."""
    scene, true = exact(name)
    motion = run(scene, settings, samples=24)
    return worst(errors(motion, true))["fx"]


# Coarser steps show the next order too, by more than 0.15, and finer ones round-off, which generalised-alpha takes over
# h^2: 1e-9 of the reactions at a thousand steps. Newton's tolerance of 1e-10 alone is as large as the error of two
# trapezoidal integrations with 288 and 576 steps.
RANGES: dict[str, tuple[Mapping[str, Any], tuple[int, ...], int]] = {
    "generalised-alpha": ({"richardson": False}, (288, 576, 1152), 2),
    "generalised-alpha 0.8": ({"richardson": False, **named.LITTLE_DAMPED}, (288, 576, 1152), 2),
    "generalised-alpha, reduced": ({"richardson": False, **named.REDUCED}, (288, 576, 1152), 2),
    "trapezoidal": ({"richardson": False, **named.TRAPEZOIDAL}, (144, 288, 576), 2),
    "generalised-alpha, extrapolated": ({}, (288, 432, 576), 3),
    "generalised-alpha, reduced, extrapolated": (named.REDUCED, (288, 432, 576), 3),
    "generalised-alpha 0.8, extrapolated": (named.LITTLE_DAMPED, (96, 144, 288), 4),
    "trapezoidal, extrapolated": (named.TIGHT, (96, 144, 288), 4),
}


@sampled(2)
@pytest.mark.parametrize("name", ["toggle_press", "quick_return"])
@pytest.mark.parametrize("family", RANGES)
def test_order(family: str, name: str) -> None:
    options, steps, order = RANGES[family]
    errors = [error(name, TimeStepping("", steps=n, **options)) for n in steps]
    assert -np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(order, abs=0.15)


def test_without_a_run_up_the_transient_is_of_order_one() -> None:
    """As index-3 theory has it; a sample every step shows it, three steps after the start."""
    scene = scenes.load("toggle_press")

    def off(steps: int) -> float:
        at = np.arange(4) * scene.cycle / steps
        true = solve(scene, *scene.drive.law.at(at))
        motion = run(scene, replace(STEPS_360, steps=steps, pre_roll=0), samples=steps)
        return float(np.abs(motion["P5.ay"][3] - true["P5.ay"][3]))

    assert np.log2(off(360) / off(720)) == pytest.approx(1, abs=0.15)


# --- what costs what -------------------------------------------------------------------------------------------------


def solved(scene: Scene, settings: ExudynSettings, channels: frozenset[str] | None = None) -> tuple[Any, Motion]:
    simulation = model.build(scene, settings, Sampling(72, channels=channels))
    simulation.solve()
    return simulation, simulation.read()


def gap(a: Motion, b: Motion) -> float:
    """The largest difference of two motions."""
    return max(worst(errors(a, b.samples)).values())


def test_newton_factorises_as_often_as_it_says() -> None:
    scene = scenes.load("toggle_press")
    runs = {newton: solved(scene, replace(STEPS_360, newton=newton)) for newton in JacobianUse}
    counts = {newton: simulation.counters for newton, (simulation, _) in runs.items()}
    assert counts[JacobianUse.FULL]["jacobians"] == counts[JacobianUse.FULL]["newton_iterations"]
    assert counts[JacobianUse.ONE_A_STEP]["jacobians"] == counts[JacobianUse.ONE_A_STEP]["steps"] == 384
    assert (
        counts[JacobianUse.MODIFIED]["jacobians"] < 384 / 10 < 384 < counts[JacobianUse.MODIFIED]["newton_iterations"]
    )
    for _, motion in runs.values():
        assert gap(motion, runs[JacobianUse.FULL][1]) <= 1e-6  # Newton's 1e-10 over h^2 of 1/360


@sampled(2)
@pytest.mark.parametrize("name", ["toggle_press", "four_bar", "servo_press", "quick_return"])
def test_more_than_the_scene_needs_changes_nothing_but_the_cost(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    scene = scenes.load(name)
    plain, motion = solved(scene, STEPS_360)
    bodies = len(scene.bodies)
    assert plain.counters | {"sensors": 0} == plain.counters
    for settings in ABLATIONS:
        assert isinstance(settings, TimeStepping)
        if settings.extra is ExudynExtra.SPATIAL and name == "quick_return":
            continue  # it has a slot
        extra, same = solved(scene, replace(settings, steps=360))
        assert gap(same, motion) <= 1e-6, settings.label  # as above
        assert extra.counters["steps"] == plain.counters["steps"]
        assert extra.counters["bodies"] == bodies
        in_space = settings.extra is ExudynExtra.SPATIAL
        assert extra.counters["coordinates"] == (6 if in_space else 3) * bodies
        assert extra.counters["constraints"] == 3 * bodies + in_space * (3 * bodies + len(scene.pins))
        assert (extra.counters["sensors"] > 2 * len(scene.pins)) == (
            settings.extra in (ExudynExtra.SENSORS, ExudynExtra.TEXT)
        )
        assert (extra.model.mbs.GetPreStepUserFunction() != 0) == (settings.extra is ExudynExtra.CALLBACK)
        if settings.extra is ExudynExtra.TEXT:
            folder = Path(extra.model.settings.solution.file.name).parent
            assert len(list(folder.iterdir())) == extra.counters["sensors"] + 1
            del extra
            assert not folder.exists()
    assert not list(tmp_path.iterdir())


def test_bodies_in_space_know_no_slots() -> None:
    with pytest.raises(Failure, match="block slides on"):
        run(scene_files.load("shaper"), replace(STEPS_360, extra=ExudynExtra.SPATIAL))


def test_textbook_is_what_exudyn_presets() -> None:
    scene = scenes.load("toggle_press")
    simulation, _ = solved(scene, TextbookTimeStepping("", steps=360))
    assert isinstance(simulation, TimeSteppedSimulation)
    chosen, preset = simulation.model.settings.timeIntegration, exudyn.SimulationSettings().timeIntegration
    for part in ("newton", "generalizedAlpha", "adaptiveStep", "solverType", "automaticStepSize"):
        assert str(getattr(chosen, part)) == str(getattr(preset, part))
    assert simulation.model.settings.solution.file.write
    assert simulation.counters["steps"] == 360
    assert simulation.counters["sensors"] == 32  # 12 of points, 12 of turning bodies, 8 of constraints
    assert error("toggle_press", TextbookTimeStepping("", steps=360)) >= 2 * error(
        "toggle_press", STEPS_360
    )  # measured 3.4


def test_pointwise_is_far_more_accurate() -> None:
    cheap = next(s for s in WORK_PRECISION if s.label == "trapezoidal, loose Newton, 72")
    # measured 2e-12, 5e-9 and 2e-3; and 2e-11
    for settings, largest in ((EXACT, 1e-10), (DEFAULT, 1e-7), (cheap, 1e-2)):
        assert error("toggle_press", settings) <= largest
    assert error("quick_return", EXACT) <= 1e-9


# --- what is not asked for -------------------------------------------------------------------------------------------

ASKED = {
    "position": frozenset({"P5.y"}),
    "velocity": frozenset({"P3.vx", "rod.omega"}),
    "acceleration": frozenset({"P5.ay", "toggle.alpha"}),
    "force": frozenset({"P3.fx", "slider.guide_moment", "drive.torque"}),
}


@sampled(2)
@pytest.mark.parametrize("settings", [EXACT, CHEAP], ids=lambda settings: settings.label)
@pytest.mark.parametrize("level", ASKED)
def test_only_what_is_asked_for_is_returned(level: str, settings: ExudynSettings) -> None:
    scene = scenes.load("toggle_press")
    simulation, motion = solved(scene, settings, ASKED[level])
    assert set(motion.samples) == {*ASKED[level], "time", "crank_angle"}
    _, complete = solved(scene, settings)
    for channel in motion.samples:
        assert (motion[channel] == complete[channel]).all()
    if settings is EXACT:
        # those of the knots predict the next pose
        few = level in ("position", "velocity")
        assert simulation.counters["acceleration_solves"] == (1 + exudyn_poses.KNOTS if few else 72)


@pytest.mark.parametrize("settings", [EXACT, CHEAP], ids=lambda settings: settings.label)
def test_no_multiplier_is_found_where_no_force_is_asked_for(
    settings: ExudynSettings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(PoseSolver, "multipliers", None)
    simulation, _ = solved(scenes.load("toggle_press"), settings, ASKED["acceleration"])
    buffer = simulation._samples if settings is EXACT else simulation._runs[0]
    assert len(buffer) == 3


@pytest.mark.parametrize("settings", [EXACT, DEFAULT], ids=lambda settings: settings.label)
def test_the_solution_is_all_that_the_channels_need(settings: ExudynSettings, monkeypatch: pytest.MonkeyPatch) -> None:
    press = scenes.load("toggle_press")
    simulation = model.build(press, settings, Sampling(72))
    simulation.solve()
    for function in ("kinematics", "forces"):
        monkeypatch.setattr(exudyn_channels, function, None)
    assert set(simulation.read().samples) == set(press.channels.names())


@pytest.mark.parametrize("settings", [EXACT, DEFAULT], ids=lambda settings: settings.label)
def test_a_build_finds_no_pose_of_a_sample(settings: ExudynSettings) -> None:
    press = scenes.load("servo_press")
    few, many = (cast("Any", model.build(press, settings, Sampling(samples))) for samples in (36, 720))
    assert many.poses.newton_iterations <= 1.2 * few.poses.newton_iterations  # other firsts of pieces


def test_springs_are_checked_though_nobody_asks_for_their_ends() -> None:
    with pytest.raises(Failure, match="P and B meet"):
        run(scene_files.load("slider_crank", meeting_spring(0.1)), EXACT, channels=frozenset({"drive.torque"}))


# --- the settings ----------------------------------------------------------------------------------------------------


def test_settings_hold_what_they_promise() -> None:
    every = [*WORK_PRECISION, *LONG_WORK_PRECISION, *ABLATIONS]
    assert len({settings.label for settings in every}) == len(set(every)) == len(every)
    assert {FAST, DEFAULT, EXACT} <= set(WORK_PRECISION)
    steps = [s.steps for s in (*WORK_PRECISION, *LONG_WORK_PRECISION) if isinstance(s, TimeStepping)]
    assert max(steps) >= 100 * min(steps)
    for family in {settings.family for settings in every if settings.family}:
        members = [settings for settings in every if settings.family == family]
        assert len({frozenset(without_steps(settings).items()) for settings in members}) == 1
    assert all(isinstance(settings, TextbookTimeStepping) == bool(settings.note) for settings in every)


def without_steps(settings: Settings) -> dict[str, Any]:
    return {name: value for name, value in asdict(settings).items() if name not in ("steps", "label", "promise")}


def test_extrapolated_trapezoidal_runs_have_an_even_number_of_steps_a_sample() -> None:
    """Their errors have a period of two steps, and do not cancel between odd and even numbers of steps."""
    for steps, made in ((24, 48), (48, 48), (72, 96)):
        simulation = model.build(
            scenes.load("toggle_press"), TimeStepping("", steps=steps, **named.TIGHT), Sampling(24)
        )
        simulation.solve()
        assert simulation.counters["steps"] == 3 * (made + 2)  # once and twice, each with its run-up

"""The Exudyn model's ways of failing."""

import numpy as np
import pytest

import scenes
from scenes import Failure, Sampling, Scene, Status
from scenes.engine import ESTIMATE
from sim_models.exudyn import engine as model
from sim_models.exudyn import stepping as exudyn_stepping
from sim_models.exudyn.engine import DEFAULT, EXACT, FAST
from sim_models.exudyn.settings import ExudynSettings, TimeStepping
from sim_models.exudyn.stepping import SteppedRun
from tests import scene_files

from .helpers import BOTH_ROUTES, ROD, locking, meeting_spring, referred, run


def failure(scene: Scene, settings: ExudynSettings = DEFAULT) -> Failure:
    with pytest.raises(Failure) as raised:
        run(scene, settings)
    assert "\n" not in raised.value.reason
    return raised.value


def with_rod(length: float) -> Scene:
    """Return the toggle press with a rod of that length, mm, instead of 300."""
    return scene_files.load("toggle_press", {ROD: length})


def test_bodies_that_do_not_fit() -> None:
    failed = failure(scene_files.load("toggle_press", {"bodies.rocker.lengths.O-P3": 3000}))
    assert failed.status is Status.cannot_assemble
    assert "11.5000 deg" in failed.reason


@BOTH_ROUTES
def test_linkage_that_locks(settings: ExudynSettings) -> None:
    failed = failure(with_rod(200), settings)
    assert failed.status is Status.cannot_assemble
    assert "166.08" in failed.reason  # where |P4.x| reaches 200 mm


@BOTH_ROUTES
def test_a_lock_that_is_soon_over_is_a_lock(settings: ExudynSettings) -> None:
    """The rod is short of its guide for four degrees only; beyond, the bodies fit together again."""
    failed = failure(with_rod(248.9), settings)
    assert failed.status is Status.cannot_assemble
    assert "209.92" in failed.reason


@BOTH_ROUTES
def test_branches_that_meet(settings: ExudynSettings) -> None:
    failed = failure(scene_files.load("parallelogram"), settings)
    assert failed.status is Status.not_converged
    assert "180.0000 deg" in failed.reason


def test_start_at_a_lock() -> None:
    failed = failure(locking(166.08))
    assert failed.status is Status.unsupported
    assert "a little before the start" in failed.reason
    run(locking(166.08), EXACT)


@pytest.mark.parametrize(
    ("name", "settings", "channel"),
    [
        ("double_toggle_clamp", FAST, "crosshead_link.alpha"),  # begun next to a lock, it rings
        ("walking_leg", TimeStepping("", steps=72, richardson=False), "foot.alpha"),  # steps of 5 degrees are too long
    ],
)
def test_accelerations_that_are_far_off(name: str, settings: ExudynSettings, channel: str) -> None:
    scene = scenes.load(name)
    failed = failure(scene, settings)
    assert failed.status is Status.not_converged
    assert channel in failed.reason
    assert failed.motion is not None
    gap, exact = failed.motion[channel], run(scene, EXACT)[channel]
    assert np.abs(gap - exact).max() > 0.02 * np.abs(exact).max()  # measured 0.03 and 0.2


@pytest.mark.parametrize("name", scenes.shipped())
def test_no_shipped_scene_is_refused(name: str) -> None:
    scene = scenes.load(name)
    run(scene, EXACT)
    simulation = model.build(scene, DEFAULT, Sampling(72))
    simulation.solve()
    simulation.read()
    # what the scene lets pass of accelerations, its least accurate group, and no reaction is worse
    assert 0 < simulation.residuals[ESTIMATE] <= scene.tolerances["exudyn"]["acceleration"]


@pytest.mark.parametrize("share", [0.09, 0.11])
@pytest.mark.parametrize(("level", "column"), [(0, 6), (1, 6), (2, 6), (3, 0)])
def test_one_sample_off_by_a_tenth(level: int, column: int, share: float) -> None:
    """Of the toggle's place, velocity or acceleration along x, or of the force of the pin at O: too much, or not."""
    scene = scenes.load("toggle_press")
    simulation = model.build(scene, DEFAULT, Sampling(72, 2))
    simulation.solve()
    assert isinstance(simulation, SteppedRun)
    motion = simulation.read()
    assert simulation.residuals[ESTIMATE] <= 1e-6  # as accurate as the tolerances of the scene
    peak = np.hypot(motion["O.fx"], motion["O.fy"]).max() / simulation.system.force_unit
    for samples in simulation._runs:
        samples[level, 100, column] += share * (peak if level == 3 else np.ptp(motion["P5.y"]) * (2 * np.pi) ** level)
    if share < 0.1:
        simulation.read()
        return
    with pytest.raises(Failure, match=r"from crank angle 500\.0000 deg on") as raised:
        simulation.read()
    assert raised.value.status is Status.not_converged
    assert raised.value.motion is not None
    assert set(raised.value.motion.samples) == set(motion.samples)


def test_undamped_oscillation_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trapezoidal steps do not damp: begun nearly singular, they oscillate, 130 times as high as all else."""
    monkeypatch.setattr(exudyn_stepping, "SINGULAR_SPEED", np.inf)
    settings = TimeStepping("", steps=360, richardson=False, solver="TrapezoidalIndex2")
    failed = failure(referred("slotted_class_iii")[0], settings)
    assert failed.status is Status.not_converged
    assert "not what its equations ask for" in failed.reason


def test_lengths_that_do_not_meet() -> None:
    """K is given from B and D, which no length joins: only a model can tell whether the two circles meet."""
    lengths = {"A-B": 350, "A-D": 300, "B-D": 120, "B-G": 30, "A-G": 345, "D-K": 60, "G-K": 20}
    changes = {"bodies.plate.lengths": lengths, "sketch.G": [290, 190]}
    failed = failure(scene_files.load("driven_toggle", changes))
    assert failed.status is Status.cannot_assemble
    assert "'D-K' and 'G-K' do not meet" in failed.reason


@BOTH_ROUTES
def test_spring_without_a_direction(settings: ExudynSettings) -> None:
    motion = run(scene_files.load("slider_crank", meeting_spring(0)), settings)
    assert motion["B.fx"][0] == pytest.approx(50 + 2 * motion["B.ax"][0])  # it has no length and no force there
    failed = failure(scene_files.load("slider_crank", meeting_spring(0.1)), settings)
    assert failed.status is Status.nonfinite  # Exudyn takes the spring for none
    assert failed.motion is not None


def test_redundant_constraints_are_counted() -> None:
    failed = failure(scene_files.load("redundant"))
    assert failed.status is Status.unsupported
    assert "1 degrees of freedom and 1 redundant" in failed.reason


def test_sketch_of_neither_branch() -> None:
    scene = scene_files.load("toggle_press", {"sketch.P3": [600, -600], "sketch.P4": [600, -100]})
    assert failure(scene).status is Status.wrong_branch


# The rod is longer than |P4.x| ever gets, 248.99658795 mm near 212.05 deg, by one part in a million or in ten thousand.
def test_jump_to_the_other_branch_is_seen() -> None:
    scene = with_rod(248.996836950)
    failed = failure(scene, TimeStepping("", steps=360, richardson=False))
    assert failed.status is Status.wrong_branch
    assert failed.motion is not None
    assert (failed.motion["P5.y"] > failed.motion["P4.y"]).any()
    assert failure(scene, TimeStepping("", steps=1000, richardson=False)).status is Status.wrong_branch
    assert failure(scene, TimeStepping("", steps=360, solver="TrapezoidalIndex2")).status is Status.diverged
    motion = run(scene, EXACT)
    assert (motion["P5.y"] < motion["P4.y"]).all()  # it went through on its own branch


def test_runs_too_far_apart_to_extrapolate() -> None:
    scene = with_rod(249.021487609)
    assert failure(scene, TimeStepping("", steps=360)).status is Status.not_converged


def test_values_that_are_not_finite_and_a_run_that_ends_early() -> None:
    simulation = model.build(scenes.load("toggle_press"), DEFAULT, Sampling(72))
    simulation.solve()
    assert isinstance(simulation, SteppedRun)
    simulation._runs[-1][:, 40:] = np.nan  # as a run leaves them that stopped there
    with pytest.raises(Failure, match=r"200\.0000 deg") as raised:
        simulation.read()
    assert raised.value.status is Status.nonfinite
    assert raised.value.motion is not None
    assert np.isfinite(raised.value.motion["P5.y"]).sum() == 40

"""What pymunk finds out by itself about a result that is no good, and that it hands the result over all the same."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from sim_models.pymunk.closed import closed, largest_errors

import scenes
from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.engine import ESTIMATE
from scenes.motion import channels
from scenes.scene import ConstantSpeed
from sim_models.pymunk import simulation as pymunk_simulation
from sim_models.pymunk.constraints import Linkage, solved
from sim_models.pymunk.engine import DEFAULT, EXACT, FAST, build
from sim_models.pymunk.masses import fictitious_masses
from sim_models.pymunk.settings import AnySettings, PymunkSettings, Textbook
from sim_models.pymunk.start import start
from tests import scene_files
from tests.agreement import errors

from .runs import Array, reference, solve

SAMPLING = Sampling(72)
COARSE = PymunkSettings("", 144, 1, 100)


def refused(scene: Scene, settings: AnySettings) -> Failure:
    with pytest.raises(Failure) as caught:
        solve(scene, settings, SAMPLING)
    return caught.value


def off_by_peaks(scene: Scene, motion: Motion) -> Array:
    """Return the largest error of accelerations and forces, shape (n,), relative to the largest of its kind."""
    found = errors(motion, reference(scene, SAMPLING))
    judged = [error for name, error in found.items() if name.rpartition(".")[2] in ("ax", "ay", "fx", "fy")]
    return np.asarray(np.max(judged, axis=0))


def test_too_long_a_step_is_told_with_what_it_gave() -> None:
    scene = scenes.load("walking_leg")
    failure = refused(scene, COARSE)
    assert failure.status is Status.not_converged
    assert failure.reason == "the constraints contradict the result by over 10% of its peak at crank angle 190.0000 deg"
    assert failure.motion is not None
    assert set(failure.motion.samples) == {*channels(scene)}
    # The foot turns around sharply there: measured, 0.11 of the largest range of accelerations, which is more than the
    # peak, and 0.05 of forces.
    wrong = off_by_peaks(scene, failure.motion)
    assert 0.05 < wrong.max() < 0.3
    assert abs(wrong.argmax() * 5 - 190) <= 10


@pytest.mark.parametrize("name", ["toggle_press", "walking_leg", "double_toggle_clamp", "quick_return"])
@pytest.mark.parametrize("settings", [FAST, DEFAULT, EXACT])
def test_what_it_knows_of_its_error_is_true(name: str, settings: PymunkSettings) -> None:
    """The error is known without a reference, but for where it ends: in rounding, or in the levels' last difference."""
    scene = scenes.load(name)
    simulation = build(scene, settings, SAMPLING)
    simulation.solve()
    motion = simulation.read()
    known = simulation.residuals[ESTIMATE]
    found = {name: values for name, values in motion.samples.items() if name != "time"}
    expected = reference(scene, SAMPLING)
    for channel in expected:
        if channel.endswith("angle"):  # which counts modulo a turn
            expected[channel] += 2 * np.pi * np.rint((found[channel] - expected[channel]) / (2 * np.pi))
    true = largest_errors(Linkage(scene, fictitious_masses), found, expected)
    assert known == pytest.approx(true.max(), rel=0.02, abs=1e-9)
    assert known < 0.01


def test_nothing_else_would_have_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pymunk_simulation, "check_closed", lambda *_: {})
    scene = scenes.load("walking_leg")
    assert off_by_peaks(scene, solve(scene, COARSE, SAMPLING)).max() > 0.05


@pytest.mark.parametrize(
    ("settings", "status"),
    [
        (PymunkSettings("", 72, 1, 10), Status.wrong_branch),
        (PymunkSettings("", 360, 1, 18), Status.not_converged),
        (Textbook("", 60), Status.wrong_branch),
        (Textbook("", 2304), Status.not_converged),  # measured: 12 % off at the start, whose velocities it takes late
    ],
)
def test_every_refused_motion_is_handed_over(settings: AnySettings, status: Status) -> None:
    failure = refused(scenes.load("toggle_press"), settings)
    assert failure.status is status
    assert failure.motion is not None
    assert all(np.isfinite(values).all() for values in failure.motion.samples.values())


def test_what_is_not_finite_is_not_handed_over() -> None:
    scene = scenes.load("toggle_press")
    assert isinstance(scene.drive, ConstantSpeed)
    failure = refused(replace(scene, drive=replace(scene.drive, speed=1e200)), DEFAULT)
    assert failure.status is Status.nonfinite
    assert failure.motion is None


@pytest.mark.parametrize("name", scene_files.MECHANISMS)
def test_bending_is_the_second_derivative_of_the_gaps(name: str) -> None:
    linkage = Linkage(scene_files.load(name), fictitious_masses)
    q = start(linkage)
    rng = np.random.default_rng(5)
    q, v = q + 0.1 * rng.standard_normal(q.shape), rng.standard_normal(q.shape)  # open joints count too
    gaps = partial(linkage.gaps, position=np.zeros(1))
    h = 1e-4
    second = (gaps(q + h * v) - 2 * gaps(q) + gaps(q - h * v)) / h**2
    # h^2 / 12 of the fourth derivative, and rounding by h^2: 1e-8 each, of sizes up to 10.
    assert linkage.bending(q, v) == pytest.approx(second, abs=1e-6)


@pytest.mark.parametrize("name", scene_files.MECHANISMS)
def test_closed_motion_is_the_true_one(name: str) -> None:
    scene = scene_files.load(name)
    linkage = Linkage(scene, fictitious_masses)
    driven = scene.drive.at(np.zeros(1))
    pose = start(linkage)
    q, v, a = closed(linkage, pose + 1e-6, driven)
    assert q == pytest.approx(pose, abs=1e-9)  # the square of 1e-6, enlarged by curvatures up to 1e3
    h = 1e-5 * scene.drive.cycle
    before, after = (closed(linkage, pose + s * h * v, scene.drive.at(np.full(1, s * h)))[:2] for s in (-1, 1))
    # Half of what they differ by on either side of a law's knot, 1e-5 of a cycle times the jerk: measured, 6e-5.
    assert v == pytest.approx((after[0] - before[0]) / (2 * h), abs=1e-4 * np.abs(v).max())
    assert a == pytest.approx((after[1] - before[1]) / (2 * h), abs=1e-4 * np.abs(a).max())


def test_a_singular_matrix_gives_no_numbers_and_leaves_the_others_alone() -> None:
    J = np.array([np.eye(3), np.ones((3, 3)), 2 * np.eye(3)])
    found = solved(J, np.ones((3, 3)))
    assert np.isnan(found[1]).all()
    assert found[[0, 2], 0, 0].tolist() == [1.0, 0.5]

"""What must not pass in the pymunk model, and what it refuses."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import scenes
from scenes import Failure, Sampling, Scene, Status
from scenes.scene import ConstantSpeed
from sim_models.pymunk.checks import check_path
from sim_models.pymunk.constraints import Linkage, branch
from sim_models.pymunk.engine import DEFAULT, PymunkSettings
from sim_models.pymunk.masses import ballasted_masses
from sim_models.pymunk.start import start
from sim_models.pymunk.stepping import Run
from tests.conftest import SceneFrom, busy_scene
from tests.mechanisms import MECHANISMS

from .runs import DRIVEN_SLIDER, FOUR_BAR, SLIDER_CRANK, errors, off, reference, scene_of, solve


@pytest.fixture(scope="module")
def press() -> Scene:
    return scenes.load("toggle_press")


def failure_of(scene: Scene, settings: PymunkSettings = DEFAULT) -> Failure:
    with pytest.raises(Failure) as caught:
        solve(scene, settings, Sampling(72))
    return caught.value


def test_too_few_sweeps_never_pass(press: Scene) -> None:
    # Measured: with 20 the result is off by 1.3 %, as it says itself; the limit is 10 %.
    statuses = {failure_of(press, PymunkSettings("", 360, 1, sweeps)).status for sweeps in (1, 3, 10, 18)}
    assert statuses <= {Status.wrong_branch, Status.diverged, Status.not_converged, Status.nonfinite}


def test_flip_is_seen_where_it_happens(press: Scene) -> None:
    failure = failure_of(press, PymunkSettings("", 72, 1, 10))
    assert failure.status is Status.wrong_branch
    assert "deg" in failure.reason


def test_every_step_is_checked(press: Scene) -> None:
    linkage = Linkage(press, ballasted_masses)
    pose = start(linkage)
    start_branch = branch(linkage.jacobian(pose))
    run = Run(linkage, pose, [], Sampling(72), 3, 200, DEFAULT)
    run.advance()
    check_path(linkage, run.path, start_branch)
    good = run.record.copy()
    crank, rod, slider = 0, 3, 4
    for body, column, change, status in (
        (rod, 0, 0.01, Status.diverged),  # gapes
        (crank, 2, 1e-3, Status.diverged),  # drifts
        (slider, 4, np.nan, Status.nonfinite),
    ):
        run.record[:] = good
        run.record[101, body, column] += change  # step 100 lies between two samples
        with pytest.raises(Failure, match=f"at crank angle {100 / 216 * 360:.4f} deg") as caught:
            check_path(linkage, run.path, start_branch)
        assert caught.value.status is status


def test_crank_that_cannot_turn_around(tmp_path: Path) -> None:
    failure = failure_of(scene_of(SLIDER_CRANK.replace("A = [0.1, 0] }", "A = [0.35, 0] }"), tmp_path))
    assert failure.status is Status.cannot_assemble
    # The rod is at right angles to the guide where 0.35 sin(angle) = 0.3.
    assert f"crank angle {np.degrees(np.arcsin(0.3 / 0.35)):.3f}" in failure.reason


def test_narrow_lock_is_not_stepped_over(tmp_path: Path) -> None:
    text = """
        ground.points = { O = [0, 0], Q = [1, 0] }
        drive = { body = "crank", speed = 3, start = 0.026 }
        output = { point = "A" }
        bodies.crank = { lengths = { "O-A" = 0.2 }, mass = 2 }
        bodies.coupler = { lengths = { "A-B" = 0.7 }, mass = 2 }
        bodies.rocker = { lengths = { "B-Q" = 0.49999 }, mass = 2 }
        sketch = { angle = 1.5, A = [0, 0.2], B = [0.65, 0.4] }
    """
    # 1.2 m minus 1.19999 m: the bars do not reach within 0.6 deg of 180, less than one continuation step on both sides.
    failure = failure_of(scene_of(text, tmp_path))
    assert failure.status is Status.cannot_assemble
    assert "crank angle 179.37" in failure.reason


def test_bodies_that_do_not_reach(tmp_path: Path) -> None:
    failure = failure_of(scene_of(FOUR_BAR.replace('"B-Q" = 0.35', '"B-Q" = 0.05'), tmp_path))
    assert failure.status is Status.cannot_assemble


def test_massless_rod_is_refused(tmp_path: Path) -> None:
    failure = failure_of(scene_of(SLIDER_CRANK.replace('"A-B" = 0.3 }, mass = 1', '"A-B" = 0.3 }, mass = 0'), tmp_path))
    assert failure.status is Status.unsupported
    assert "'rod'" in failure.reason


def test_point_mass_is_refused_where_it_has_to_turn(tmp_path: Path) -> None:
    """Beside a pin on the crank its mass alone makes it turn heavily; between bodies that forces move nothing does."""
    rod = scene_of(
        SLIDER_CRANK.replace('"A-B" = 0.3 }, mass = 1', '"A-B" = 0.3 }, mass = 1, com = [0.1, 0], inertia = 0'),
        tmp_path,
    )
    found, expected = solve(rod, DEFAULT, Sampling(72)), reference(rod, Sampling(72))
    # Measured: 3e-7 of accelerations, which the extrapolation leaves.
    assert max(error.max() for error in errors(found, expected).values()) <= 1e-5

    text = (scenes.LIBRARY / "toggle_press.toml").read_text("utf-8")
    rod_text = 'lengths = { "P4-P5" = 300 }\nmass = 60'
    assert rod_text in text
    file = tmp_path / "point_mass.toml"
    file.write_text(text.replace(rod_text, rod_text + "\ncom = [150, 0]\ninertia = 0"), encoding="utf-8")
    failure = failure_of(scenes.load(file))
    assert failure.status is Status.unsupported
    assert "'rod'" in failure.reason


def test_massless_crank_is_fine(tmp_path: Path) -> None:
    text = SLIDER_CRANK.replace("A = [0.1, 0] }, mass = 1", "A = [0.1, 0] }, mass = 0")
    assert solve(scene_of(text, tmp_path))["O.fx"] == pytest.approx(1000, abs=0.01)


def test_overflow_is_no_result(tmp_path: Path) -> None:
    scene = scene_of(SLIDER_CRANK, tmp_path)
    assert isinstance(scene.drive, ConstantSpeed)
    failure = failure_of(replace(scene, drive=replace(scene.drive, speed=1e200)))  # which the file could not say
    assert failure.status is Status.nonfinite


def test_wild_accelerations_do_not_pass_as_their_own_scale(scene_from: SceneFrom) -> None:
    """Near 30 degrees the sweeps leave the busy scene's accelerations wrong by three times their true peak.

    Beside the wild accelerations the residual of the constraints looks small; beside the true ones it is not.
    """
    with pytest.raises(Failure) as caught:
        solve(scene_from(busy_scene()), DEFAULT, Sampling(360))
    assert caught.value.status is Status.not_converged


def test_points_by_lengths_that_do_not_meet(scene_from: SceneFrom) -> None:
    text = MECHANISMS["driven_toggle"].replace('"D-K" = 90', '"D-K" = 90, "A-L" = 100, "K-L" = 200')
    failure = failure_of(scene_from(text.replace("K = [230, 290]", "K = [230, 290]\nL = [90, 50]")))
    assert failure.status is Status.cannot_assemble
    assert "from A and K to L of 'plate'" in failure.reason  # A-K, about 370 mm, is itself no given length


def test_start_too_near_a_lock_is_refused(tmp_path: Path) -> None:
    failure = failure_of(scene_of(DRIVEN_SLIDER.replace("START", "0.3999"), tmp_path))
    assert failure.status is Status.cannot_assemble  # 0.4 m is where the rod and the crank are in line
    assert "steps before zero" in failure.reason
    assert "slider at 0.4" in failure.reason


TELESCOPE = """
ground.points = { O = [0, 0], C = [0.3, 0] }
drive = { body = "crank", speed = 5 }
output = { point = "A" }
bodies.crank = { lengths = { "O-A" = 0.1 }, mass = 1 }
bodies.cylinder = { points = { C = [0, 0], D = [-0.2, 0] }, mass = 1, com = [0, 0], inertia = 0 }
bodies.rod = { points = { A = [0, 0] }, mass = 1, slides = { on = "cylinder", through = [0, 0], along = [1, 0] } }
sketch = { A = [0.1, 0], D = [0.1, 0] }
"""


def test_bodies_that_turn_together_without_inertia(tmp_path: Path) -> None:
    failure = failure_of(scene_of(TELESCOPE, tmp_path))
    assert failure.status is Status.unsupported
    assert "'cylinder'" in failure.reason
    # Either's inertia is both's: they turn as one.
    scene = scene_of(TELESCOPE.replace("inertia = 0", "inertia = 1e-3"), tmp_path)
    found, expected = solve(scene, DEFAULT, Sampling(72)), reference(scene, Sampling(72))
    # Measured: 2e-5 of accelerations, which the extrapolation leaves.
    assert max(error.max() for error in errors(found, expected).values()) <= 1e-4
    kinematic = scene_of(TELESCOPE.replace(", mass = 1", "").replace(", com = [0, 0], inertia = 0", ""), tmp_path)
    assert off(solve(kinematic, DEFAULT, Sampling(72))["rod.alpha"], expected["rod.alpha"]) <= 1e-4

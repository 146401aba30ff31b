"""The Exudyn model's ways of failing."""

import re

import numpy as np
import pytest

from scenes import Failure, Sampling, Scene, Status
from sim_models.exudyn import engine, poses, start
from sim_models.exudyn import simulation as simulation_module
from sim_models.exudyn.engine import DEFAULT, EXACT
from sim_models.exudyn.settings import ExudynSettings
from tests import scene_files

from .helpers import BOTH_ROUTES, ROD, locking, meeting_spring, run


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


def test_how_far_the_bodies_are_from_closing() -> None:
    """B is at 0.6 from A, C at 0.05 from D and at |2.1 + 0.3i| from B: too long a coupler."""
    apart = abs(2.1 + 0.3j) - 0.05 - abs(3 + 2.5j - (1 + 2j - 0.6 * np.exp(3.5j)))
    failed = failure(scene_files.load("loaded_four_bar", {"bodies.rocker.lengths.C-D": 0.05}))
    assert failed.reason.endswith(f"with all else closed C stays open by {apart:.4g} m at crank angle 3.500000 rad")


@BOTH_ROUTES
def test_linkage_that_locks(settings: ExudynSettings) -> None:
    failed = failure(with_rod(200), settings)
    assert failed.status is Status.cannot_assemble
    assert "166.08" in failed.reason  # where |P4.x| reaches 200 mm
    assert re.search(r"stays open by [\d.]+ mm at crank angle 16[67]\.", failed.reason)


@BOTH_ROUTES
def test_a_lock_that_is_soon_over_is_a_lock(settings: ExudynSettings) -> None:
    """The rod is short of its guide for four degrees only; beyond, the bodies fit together again."""
    failed = failure(with_rod(248.9), settings)
    assert failed.status is Status.cannot_assemble
    assert "209.92" in failed.reason


@BOTH_ROUTES
def test_a_run_that_does_not_end(settings: ExudynSettings, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = engine.build(scene_files.load("four_bar"), settings, Sampling(72))
    monkeypatch.setattr(simulation_module, "SECONDS", 0.0)
    with pytest.raises(Failure, match="0 s of processor time were not enough for the solution: ") as raised:
        simulation.solve()
    assert raised.value.status is Status.timed_out
    monkeypatch.setattr(poses, "SECONDS", 0.0)
    start.begun.cache_clear()  # or the start is known
    assert failure(scene_files.load("four_bar"), settings).status is Status.timed_out


@BOTH_ROUTES
def test_branches_that_meet(settings: ExudynSettings) -> None:
    failed = failure(scene_files.load("parallelogram"), settings)
    assert failed.status is Status.not_converged
    assert "3.141593 rad" in failed.reason


def test_start_at_a_lock() -> None:
    failed = failure(locking(166.08))
    assert failed.status is Status.unsupported
    assert "a little before the start" in failed.reason
    run(locking(166.08), EXACT)


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

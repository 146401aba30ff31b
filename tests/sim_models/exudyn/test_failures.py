"""The Exudyn model's ways of failing."""

import re

import numpy as np
import pytest

from scenes import Failure, Sampling, Scene, Status
from sim_models.exudyn import engine, poses, start
from sim_models.exudyn.engine import DEFAULT, EXACT
from sim_models.exudyn.runs import simulation as simulation_module
from sim_models.exudyn.settings import ExudynSettings
from tests import scene_files

from .helpers import BOTH_ROUTES, ROD, locking, meeting_spring, run


def failure(scene: Scene, settings: ExudynSettings = DEFAULT) -> Failure:
    with pytest.raises(Failure) as raised:
        run(scene, settings)
    assert "\n" not in raised.value.reason
    return raised.value


# In the four-bar B is at 0.6 from A, C at 0.05 from D and at |2.1 + 0.3i| from B: too long a coupler.
APART = abs(2.1 + 0.3j) - 0.05 - abs(3 + 2.5j - (1 + 2j - 0.6 * np.exp(3.5j)))
# K is given from B and D, which no length joins: only a model can tell whether the two circles meet.
UNMET = {"A-B": 350, "A-D": 300, "B-D": 120, "B-G": 30, "A-G": 345, "D-K": 60, "G-K": 20}
REFUSED: dict[str, tuple[str, scene_files.Changes, Status, str]] = {
    "bodies that do not fit": (
        *("toggle_press", {"bodies.rocker.lengths.O-P3": 3000}, Status.cannot_assemble),
        r"11\.5000 deg",
    ),
    "by how far they do not": (
        *("loaded_four_bar", {"bodies.rocker.lengths.C-D": 0.05}, Status.cannot_assemble),
        re.escape(f"with all else closed C stays open by {APART:.4g} m at crank angle 3.500000 rad") + "$",
    ),
    "a lock": (  # where |P4.x| reaches 200 mm
        *("toggle_press", {ROD: 200}, Status.cannot_assemble),
        r"166\.08.*stays open by [\d.]+ mm at crank angle 16[67]\.",
    ),
    "a lock that is over after four degrees": ("toggle_press", {ROD: 248.9}, Status.cannot_assemble, r"209\.92"),
    "branches that meet": ("parallelogram", {}, Status.not_converged, r"3\.141593 rad"),
    "lengths that do not meet": (
        *("driven_toggle", {"bodies.plate.lengths": UNMET, "sketch.G": [290, 190]}, Status.cannot_assemble),
        "'D-K' and 'G-K' do not meet",
    ),
    "redundant": ("redundant", {}, Status.unsupported, "1 degrees of freedom and 1 redundant"),
    "a sketch of neither branch": (
        *("toggle_press", {"sketch.P3": [600, -600], "sketch.P4": [600, -100]}, Status.wrong_branch),
        "too rough to decide",
    ),
}


@BOTH_ROUTES
@pytest.mark.parametrize("case", REFUSED)
def test_refused_by_name_and_place(case: str, settings: ExudynSettings) -> None:
    name, changes, status, reason = REFUSED[case]
    failed = failure(scene_files.load(name, changes), settings)
    assert failed.status is status
    assert re.search(reason, failed.reason), failed.reason


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


def test_start_at_a_lock() -> None:
    failed = failure(locking(166.08))
    assert failed.status is Status.unsupported
    assert "a little before the start" in failed.reason
    run(locking(166.08), EXACT)


@BOTH_ROUTES
def test_spring_without_a_direction(settings: ExudynSettings) -> None:
    motion = run(scene_files.load("slider_crank", meeting_spring(0)), settings)
    assert motion["B.fx"][0] == pytest.approx(50 + 2 * motion["B.ax"][0])  # it has no length and no force there
    failed = failure(scene_files.load("slider_crank", meeting_spring(0.1)), settings)
    assert failed.status is Status.nonfinite  # Exudyn takes the spring for none
    assert failed.motion is not None

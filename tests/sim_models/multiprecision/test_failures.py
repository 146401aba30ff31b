"""What is refused, where, and what a run leaves behind."""

import re
from itertools import count
from math import acos, inf, sqrt
from typing import Any

import pytest

import scenes
from scenes import Failure, Positions, Sampling, Scene, Status
from tests import scene_files
from tests.comparisons import sampled

from .runs import EPS, closed, continuing, run, slider_crank, two_rods

flint = pytest.importorskip("flint")

from sim_models.multiprecision import engine as model  # noqa: E402
from sim_models.multiprecision.constraints import LinkageEquations  # noqa: E402  (their engine is there)

# K hangs on D and M, whose distance no length gives.
UNMET = {"A-B": 350, "A-D": 300, "B-D": 120, "A-M": 340, "B-M": 40, "D-K": 5, "M-K": 5}
REFUSED: dict[str, tuple[Scene, Status, str]] = {
    "lengths that cannot meet": (
        *(slider_crank({"bodies.slider.slides.through": [0, 5]}), Status.cannot_assemble),
        r"crank angle 0.*closed B stays open by 3 m at crank angle 0\.000000 rad$",  # 5 - 2
    ),
    "a flat sketch of a triangle": (  # P4 is on P2-P3
        scenes.load("toggle_press", {"sketch.P4.0": 480 - 1.7 * 480, "sketch.P4.1": -202 - 1.7 * 98}),
        *(Status.cannot_assemble, "toggle"),
    ),
    "lengths of a body that do not meet": (
        scene_files.load("driven_toggle", {"bodies.plate.lengths": UNMET, "sketch.M": [260, 240]}),
        *(Status.cannot_assemble, "'plate' cannot be put together: the lengths from D and M to K"),
    ),
    # The rods are longer than the crank by two units in the last place: no one can mean that.
    "a lock that roundings make or undo": (
        *(two_rods(1 + 2 * EPS), Status.cannot_assemble),
        r"singular at crank angle 1\.57079\d rad",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_refused_by_name_and_place(case: str) -> None:
    scene, status, reason = REFUSED[case]
    with flint.ctx.workprec(77):
        with pytest.raises(Failure) as failure:
            run(scene, samples=4)
        assert flint.ctx.prec == 77
    assert failure.value.status is status
    assert re.search(reason, failure.value.reason)


# Coupler 1.5 and rocker 2 are in line when the crank pin is 3.5 from C. The sketch is a turn ahead of the start: the
# long way round leads through the lock at the other side.
TURNED = {"bodies.rocker.lengths.C-B": 2, "drive.start": 1, "sketch": {"angle": 7, "A": [1.5, 1.3], "B": [2.9, 2]}}


@pytest.mark.parametrize(
    ("name", "changes", "place", "lock"),
    [
        ("triple_rocker", TURNED, r"crank angle ([\d.]+) rad", acos((2**2 + 3**2 - 3.5**2) / (2 * 2 * 3))),
        # D is 300 mm from A and 120 from E, which runs 235 above A: they line up there.
        ("driven_toggle", {"drive.speed": 150, "drive.end": 400}, r"at ([\d.]+) mm", sqrt(420**2 - 235**2)),
    ],
)
def test_a_lock_is_found_where_it_is(name: str, changes: scene_files.Changes, place: str, lock: float) -> None:
    simulation = model.build(scene_files.load(name, changes), model.DEFAULT, Sampling(36))
    with pytest.raises(Failure) as failure:
        simulation.solve()
    assert failure.value.status is Status.cannot_assemble
    found = re.search(place, failure.value.reason)
    assert found
    assert float(found[1]) == pytest.approx(lock, rel=6e-7)  # as printed


def test_too_few_digits_are_not_passed_off_as_proof() -> None:
    with pytest.raises(Failure) as failure:
        run(two_rods(1 + 1e-9), samples=4, digits=16)
    assert failure.value.status is Status.not_converged


@pytest.mark.parametrize(("name", "coordinate"), [("toggle_press", 2), *(("shaper", k) for k in (3, 4, 5))])
def test_pose_that_is_no_solution_is_not_enclosed(name: str, coordinate: int) -> None:
    scene = scene_files.load(name)
    with flint.ctx.workdps(50):
        linkage = LinkageEquations(scene)
        continuation, goal = continuing(linkage), linkage.drive(scene.sketch.drive)
        pose = closed(linkage, continuation)
        continuation.enclose(pose, goal)
        pose[coordinate, 0] += 1e-9
        with pytest.raises(Failure) as failure:
            continuation.enclose(pose, goal)
    assert failure.value.status is Status.not_converged


def test_no_step_is_longer_than_six_degrees() -> None:
    simulation = model.build(scenes.load("toggle_press"), model.DEFAULT, Sampling(1))
    simulation.solve()
    assert simulation.counters["steps"] >= 60


def test_run_leaves_the_precision_and_says_what_it_did() -> None:
    with flint.ctx.workprec(77):
        simulation = model.build(scenes.load("toggle_press"), model.DEFAULT, Sampling(36))
        assert flint.ctx.prec == 77
        simulation.solve()
        simulation.read()
        assert flint.ctx.prec == 77
    first = dict(simulation.counters)
    simulation.solve()
    assert simulation.counters == first
    assert first["steps"] >= 36
    assert all(0 < residual <= 1e-40 for residual in simulation.residuals.values())  # 50 digits less the condition
    assert "flint" in model.version()


def test_forces_are_proven_as_the_motion_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """Balls that the loads make wide leave the motion proven and the forces not."""
    simulation: Any = model.build(scene_files.load("two_rods"), model.DEFAULT, Sampling(4))
    exact = simulation._force

    def vague(*of: Any) -> Any:
        q = exact(*of)
        q[0, 0] += flint.arb(0, 1e-12)
        return q

    monkeypatch.setattr(simulation, "_force", vague)
    with pytest.raises(Failure, match="50 digits prove the forces only to") as failure:
        simulation.solve()
    assert failure.value.status is Status.not_converged


@sampled(1)
@pytest.mark.parametrize(
    ("name", "steps", "task"),
    [
        ("toggle_press", 1, "the start from the sketch"),
        ("crank_press", 60, "the end of the closing stroke"),  # the sketch is 90 deg, 45 steps, from the start
        ("toggle_press", 60, r"sample \d\d of 73"),
    ],
)
def test_a_run_ends_with_its_budget(monkeypatch: pytest.MonkeyPatch, name: str, steps: int, task: str) -> None:
    """By a clock that goes on by a second a step; no step is longer than two degrees."""
    ticks = count()
    monkeypatch.setattr("scenes.model.engine.process_time", lambda: next(ticks))
    monkeypatch.setattr("scenes.model.engine.perf_counter", lambda: inf)  # the time on the wall is long over
    with pytest.raises(Failure, match=rf"^{steps} s .* {task}: it is at crank angle [\d.]+ deg$") as failure:
        model.build(scenes.load(name), model.MultiprecisionSettings("short", seconds=steps), Sampling(72)).solve()
    assert failure.value.status is Status.timed_out


def test_a_longer_run_may_take_longer() -> None:
    seconds = model.DEFAULT.seconds
    assert model.DEFAULT.seconds_for(Sampling(72)) == seconds
    assert model.DEFAULT.seconds_for(Sampling(36, turns=20)) == 20 * seconds
    assert model.DEFAULT.seconds_for(Positions((0.0,) * 1000)) == 10 * seconds

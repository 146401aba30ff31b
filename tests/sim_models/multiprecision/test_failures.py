"""What is refused, where, and what a run leaves behind."""

import re
from math import acos, degrees, sqrt
from pathlib import Path
from typing import Any

import pytest

import scenes
from scenes import Failure, Sampling, Status
from tests.mechanisms import DRIVEN_TOGGLE

from .runs import EPS, FOUR_BAR, SLIDER_CRANK, TWO_RODS, closed, named, run, scene_of

flint = pytest.importorskip("flint")

from sim_models.multiprecision import constraints as multiprecision_linkage  # noqa: E402  (their engine is there)
from sim_models.multiprecision import engine as model  # noqa: E402
from sim_models.multiprecision import march as multiprecision_march  # noqa: E402


def test_lock_is_found_where_the_cosine_rule_puts_it(tmp_path: Path) -> None:
    """Coupler 1.5 and rocker 2 are in line when the crank pin is 3.5 from D.

    The sketch is a turn ahead of the start: the long way round leads through the lock at the other side.
    """
    text = """
format = 1
name = "locking"
ground.points = { O = [0, 0], D = [3, 0] }
drive = { body = "crank", speed = 1.0, start = 1.0 }
output = { point = "B" }
bodies.crank.points = { O = [0, 0], A = [2, 0] }
bodies.coupler.lengths = { "A-B" = 1.5 }
bodies.rocker.lengths = { "D-B" = 2 }
[sketch]
angle = 7.0
A = [1.5, 1.3]
B = [2.9, 2]
"""
    lock = degrees(acos((2**2 + 3**2 - 3.5**2) / (2 * 2 * 3)))
    simulation = model.build(scene_of(tmp_path, text), model.DEFAULT, Sampling(36))
    with pytest.raises(Failure) as failure:
        simulation.solve()
    assert failure.value.status is Status.cannot_assemble
    found = re.search(r"crank angle ([\d.]+) deg", failure.value.reason)
    assert found
    assert abs(float(found[1]) - lock) <= 1e-4  # as printed


def test_lengths_that_cannot_meet_are_refused(tmp_path: Path) -> None:
    apart = SLIDER_CRANK.replace("through = [0, 0]", "through = [0, 5]")
    with flint.ctx.workprec(77):
        with pytest.raises(Failure, match="crank angle 0") as failure:
            model.build(scene_of(tmp_path, apart), model.DEFAULT, Sampling(36))
        assert flint.ctx.prec == 77
    assert failure.value.status is Status.cannot_assemble


def test_flat_sketch_of_a_triangle_is_refused(tmp_path: Path) -> None:
    flat = FOUR_BAR.replace("T = [2.2, 3.0]", "T = [5.42, 4.18]")  # A + 1.7 (B - A), but for rounding
    with pytest.raises(Failure, match="coupler") as failure:
        model.build(scene_of(tmp_path, flat), model.DEFAULT, Sampling(36))
    assert failure.value.status is Status.cannot_assemble


def test_too_few_digits_are_not_passed_off_as_proof(tmp_path: Path) -> None:
    near_lock = scene_of(tmp_path, TWO_RODS.replace("ROD", repr(1 + 1e-9)))
    with pytest.raises(Failure) as failure:
        run(near_lock, samples=4, digits=16)
    assert failure.value.status is Status.not_converged


def test_driven_slider_out_of_reach_is_found_where_the_rods_line_up(tmp_path: Path) -> None:
    """D is 300 mm from A and 120 from E, which runs 235 above A: they line up at sqrt(420^2 - 235^2)."""
    outward = DRIVEN_TOGGLE.replace("speed = -150", "speed = 150").replace("end = -150", "end = 400")
    simulation = model.build(scene_of(tmp_path, outward), model.DEFAULT, Sampling(36))
    with pytest.raises(Failure) as failure:
        simulation.solve()
    assert failure.value.status is Status.cannot_assemble
    found = re.search(r"crosshead at ([\d.]+) m", failure.value.reason)
    assert found
    assert abs(float(found[1]) - sqrt(0.42**2 - 0.235**2)) <= 1e-6  # as printed


def test_lengths_of_a_body_that_do_not_meet_are_refused(tmp_path: Path) -> None:
    """K hangs on D and M, whose distance no length gives."""
    within = '"A-D" = 300, "B-D" = 120, "A-M" = 340, "B-M" = 40, "D-K" = 5, "M-K" = 5'
    apart = re.sub('"A-D".* }', f"{within} }}", DRIVEN_TOGGLE).replace("K = [230", "M = [260, 240]\nK = [230")
    with pytest.raises(Failure, match="'plate' cannot be put together: the lengths from D and M to K") as failure:
        model.build(scene_of(tmp_path, apart), model.DEFAULT, Sampling(36))
    assert failure.value.status is Status.cannot_assemble


@pytest.mark.parametrize(("name", "coordinate"), [("toggle_press", 2), *(("quick_return", k) for k in (3, 4, 5))])
def test_pose_that_is_no_solution_is_not_enclosed(tmp_path: Path, name: str, coordinate: int) -> None:
    scene = named(tmp_path, name)
    with flint.ctx.workdps(50):
        linkage = multiprecision_linkage.Linkage(scene)
        march, goal = multiprecision_march.March(linkage, 50), linkage.drive(scene.sketch.drive)
        pose = closed(linkage, march)
        march.enclose(pose, goal)
        pose[coordinate, 0] += 1e-9
        with pytest.raises(Failure) as failure:
            march.enclose(pose, goal)
    assert failure.value.status is Status.not_converged


def test_no_step_is_longer_than_two_degrees() -> None:
    simulation = model.build(scenes.load("toggle_press"), model.DEFAULT, Sampling(1))
    simulation.solve()
    assert simulation.counters["steps"] >= 180


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


# --- what doubles cannot tell, and what few digits cannot -------------------------------------------------------------


def test_a_lock_that_roundings_make_or_undo_is_refused(tmp_path: Path) -> None:
    """The rods are longer than the crank by two units in the last place: no one can mean that."""
    with pytest.raises(Failure, match=r"singular at crank angle (89\.9999|90\.0000)") as failure:
        run(scene_of(tmp_path, TWO_RODS.replace("ROD", repr(1 + 2 * EPS))), samples=4)
    assert failure.value.status is Status.cannot_assemble


def test_forces_are_proven_as_the_motion_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Balls that the loads make wide leave the motion proven and the forces not."""
    scene = scene_of(tmp_path, TWO_RODS.replace("ROD", "1.4"))
    simulation = model.build(scene, model.DEFAULT, Sampling(4))
    exact = type(simulation._loads).generalised

    def vague(*of: Any) -> Any:
        q = exact(*of)
        q[0, 0] += flint.arb(0, 1e-12)
        return q

    monkeypatch.setattr(type(simulation._loads), "generalised", vague)
    with pytest.raises(Failure, match="50 digits prove the forces only to") as failure:
        simulation.solve()
    assert failure.value.status is Status.not_converged

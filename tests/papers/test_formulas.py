"""The clamp's formulas against the analytic core, on the published designs and on any other; its constraints."""

from dataclasses import replace

import numpy as np
import pytest

import analytic
from papers.clamp import formulas
from papers.clamp.constraints import ALONE, BOTH, LITERAL, OPENING, SLENDER, STROKE, slacks, tightest
from papers.clamp.formulas import DEGREE, INITIAL, PUBLISHED, RATED, SCHEME_4, Array, Design, measure
from papers.clamp.optimisation.recheck import locking
from papers.clamp.optimisation.study import BROKEN
from papers.clamp.printed import SCENES
from scenes import Motion, Scene, load
from scenes.scene import Force

from .designs import some_designs


def solved(scene: Scene, d: Design, alpha: Array) -> Motion:
    position = 1e-3 * formulas.crosshead(formulas.at(d, alpha))
    return analytic.solve(scene, position, (position - scene.drive.law.start) / 0.1)


def multiplied(scene: Scene, d: Design) -> float:
    """The force on the platen over that of the drive, by Newton and Euler and not by velocities."""
    massless = {body.name: replace(body, mass=0.0) for body in scene.bodies.values()}
    at_rest = replace(scene, bodies=massless, loads=(Force("platen", "C", (-1.0, 0.0)),))
    return float(1 / solved(at_rest, d, np.array([RATED]))["drive.force"][0])


@pytest.mark.parametrize(("name", "length"), [("initial", 1354.00096), ("scheme 4", 1346.53005)])
def test_l3_closes_the_triangle(name: str, length: float) -> None:
    assert abs(measure("L_sum", PUBLISHED[name]) - length) <= 5e-6  # mm, the digits given


@pytest.mark.parametrize("name", PUBLISHED)
def test_formulas_are_the_motion_of_the_shipped_scene(name: str) -> None:
    d, scene = PUBLISHED[name], load(SCENES[name])
    alpha = np.linspace(d.alpha_max, 0.0, 501)
    motion, pose = solved(scene, d, alpha), formulas.at(d, alpha)
    assert (
        np.abs(1e3 * np.array(scene.drive.law.extent) - formulas.crosshead(pose)[[0, -1]]).max() <= 1e-12
    )  # mm; as many digits
    assert (motion["D.x"] > motion["E.x"]).all()  # E is on the tail side of D throughout
    assert np.abs(1e3 * motion["C.x"] - formulas.platen(pose)).max() <= 1e-11  # mm, rounding
    assert np.abs(motion["C.vx"] / motion["E.vx"] - formulas.velocity_ratio(pose)).max() <= 1e-13  # rounding
    per_mm = 1e-3 * motion["C.ax"] / 0.1**2
    assert np.abs(per_mm - formulas.acceleration(pose)).max() <= 1e-14  # of 1e-2, rounding
    assert abs(measure("S_m", d) - 1e3 * np.ptp(motion["C.x"])) <= 1e-11
    assert abs(measure("a_m range", d) / np.ptp(per_mm) - 1) <= 1e-4  # of 501 samples
    assert abs(multiplied(scene, d) - measure("M_P", d)) <= 1e-11


@pytest.mark.parametrize("number", range(3))
def test_formulas_are_the_motion_of_any_design(number: int) -> None:
    d = Design(*(values[number] for values in some_designs(3)))
    scene = locking(d)
    motion = solved(scene, d, np.array([d.alpha_max, 60 * DEGREE, RATED, 0.0]))
    ratio = (motion["C.x"][-1] - motion["C.x"][0]) / (scene.drive.law.extent[1] - scene.drive.law.extent[0])
    assert abs(ratio - measure("R_S", d)) <= 1e-13
    assert abs(motion["E.vx"][2] / motion["C.vx"][2] - measure("M_P", d)) <= 1e-11  # of 20, rounding near the lock
    assert abs(multiplied(scene, d) - measure("M_P", d)) <= 1e-11
    (dies,) = scene.loads
    assert dies.table is not None
    assert abs(np.mean(dies.table.arguments) - motion["C.x"][-1]) <= 1e-13  # met where it locks


def test_a_design_that_does_not_assemble_is_nan() -> None:
    short = SCHEME_4._replace(L4=115.0)  # mm: DE does not reach from the crosshead's guide to D in the locked clamp
    assert not formulas.assembles(short)
    assert np.isnan(formulas.crosshead_stroke(formulas.opened(short)))
    assert formulas.assembles(SCHEME_4)
    assert formulas.assembles(INITIAL)


def test_which_constraints_the_published_designs_meet() -> None:
    initial, scheme_4 = ({c for c, s in slacks(d, BOTH).items() if s < 0} for d in PUBLISHED.values())
    assert initial == {LITERAL}
    assert scheme_4 == {LITERAL, SLENDER, STROKE} == BROKEN


def test_the_limit_of_160_degrees_in_both_readings() -> None:
    for d, literally, open_clamp in ((INITIAL, 202.770, 141.433), (SCHEME_4, 210.418, 133.543)):
        slack = slacks(d, BOTH)
        assert abs(160 - np.degrees(slack[LITERAL]) - literally) <= 5e-4  # deg, the digits given
        assert abs(160 - np.degrees(slack[OPENING]) - open_clamp) <= 5e-4


def test_phi_is_largest_at_an_end_of_the_stroke() -> None:
    d = some_designs(50)
    inside = formulas.sine_phi(d, np.linspace(0, 1, 501)[:, None] * d.alpha_max).max(axis=0)
    assert (inside <= np.maximum(formulas.sine_phi(d, 0.0), formulas.sine_phi(d, d.alpha_max)) + 1e-15).all()


def test_the_sizes_amount_to_the_clearance() -> None:
    for clearance in (BOTH, ALONE):
        d_B, d_D, d_E, H_s = clearance.sizes.values()
        gaps = H_s / 2 - d_B, H_s / 2 - d_D, (d_B + d_D) / 2, (d_D + d_E) / 2
        assert np.abs(np.subtract(gaps, (clearance.B, clearance.D, clearance.L3, clearance.L4))).max() <= 1e-12
    assert tightest(INITIAL).D == 69.5
    assert (BOTH.B, BOTH.D, BOTH.L4) == (129, 69.5, 120)

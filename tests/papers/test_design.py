"""The clamp's optimisation: its formulas against the analytic core, its gradients, its constraints, a few optima."""

import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

import analytic
import scenes
from compare.engines import runner
from papers.clamp import formulas as clamp
from papers.clamp.constraints import LITERAL, OPENING, slacks, tightest
from papers.clamp.formulas import DEGREE, INITIAL, LOWER, SCHEME_4, UNITS, UPPER, VARIABLES, Array
from papers.clamp.optimisation.measures import MEASURES, measure
from papers.clamp.optimisation.problem import Limit, Problem, gains, in_box
from papers.clamp.optimisation.recheck import rechecks
from papers.clamp.optimisation.report import Outcome, write
from papers.clamp.optimisation.scene_file import locking
from papers.clamp.optimisation.search import FEASIBLE, restart, search
from papers.clamp.optimisation.study import (
    AHEAD,
    ALONE,
    BOTH,
    BROKEN,
    LENGTHS,
    MAIN,
    MET,
    SIX,
    Effort,
    Point,
    ahead,
    fixed_ratio,
    study,
)
from papers.clamp.optimisation.tables import improved
from papers.optimise import main
from scenes import Motion, Scene
from scenes.scene import Force
from tests.conftest import SceneFrom

PUBLISHED = {"double_toggle_clamp": INITIAL, "double_toggle_clamp_scheme4": SCHEME_4}
AHEAD_IN_SIX = UNITS * [369.2, 415, 138.072, 280, 4, 18.516, 108.62, 244.769]


def some_designs(count: int) -> Array:
    """Return designs within the bounds that assemble, shape (8, count)."""
    designs = in_box(np.random.default_rng(1).random((8, 20 * count)))
    return designs[:, clamp.assembles(designs)][:, :count]


def solved(scene: Scene, X: Array, alpha: Array) -> Motion:
    position = 1e-3 * clamp.crosshead(X, alpha)
    return analytic.solve(scene, position, (position - scene.drive.start) / 0.1)


# --- formulas ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("X", "force", "ratio", "fastest", "length"),
    [(INITIAL, 20.10666, 1.0149010, 1.63040, 1354.00096), (SCHEME_4, 22.738335, 1.09823537, 1.795997, 1346.53005)],
)
def test_published_designs(X: Array, force: float, ratio: float, fastest: float, length: float) -> None:
    for name, value, digits in (("M_P", force, 1e-5), ("R_S", ratio, 1e-7), ("R_V max", fastest, 1e-5)):
        assert abs(measure(name, X) - value) <= digits / 2
    assert abs(measure("L_sum", X) - length) <= 5e-6


@pytest.mark.parametrize("name", PUBLISHED)
def test_formulas_are_the_motion_of_the_shipped_scene(name: str) -> None:
    X, scene = PUBLISHED[name], scenes.load(name)
    alpha = np.linspace(X[6], 0.0, 501)
    motion = solved(scene, X, alpha)
    assert np.abs(1e3 * motion["C.x"] - clamp.platen(X, alpha)).max() <= 1e-11  # mm, rounding
    assert np.abs(motion["C.vx"] / motion["E.vx"] - clamp.velocity_ratio(X, alpha)).max() <= 1e-13  # rounding
    per_mm = 1e-3 * motion["C.ax"] / 0.1**2
    assert np.abs(per_mm - clamp.acceleration(X, alpha)).max() <= 1e-14  # of 1e-2, rounding
    assert abs(measure("S_m", X) - 1e3 * np.ptp(motion["C.x"])) <= 1e-11
    assert abs(measure("a_m range", X) / np.ptp(per_mm) - 1) <= 1e-4  # of 501 samples


@pytest.mark.parametrize("seed", range(3))
def test_formulas_are_the_motion_of_any_design(seed: int, scene_from: SceneFrom) -> None:
    X = some_designs(3)[:, seed]
    scene = scene_from(locking(X, "any"))
    motion = solved(scene, X, np.array([X[6], 60 * DEGREE, clamp.RATED, 0.0]))
    ratio = (motion["C.x"][-1] - motion["C.x"][0]) / (scene.drive.extent[1] - scene.drive.extent[0])
    assert abs(ratio - measure("R_S", X)) <= 1e-13
    assert abs(motion["E.vx"][2] / motion["C.vx"][2] - measure("M_P", X)) <= 1e-11  # of 20, rounding near the lock
    massless = {body.name: replace(body, mass=0.0) for body in scene.bodies.values()}
    at_rest = replace(scene, bodies=massless, loads=(Force("platen", "C", (-1.0, 0.0)),))
    thrust = solved(at_rest, X, np.array([clamp.RATED]))["drive.force"][0]
    assert abs(1 / thrust - measure("M_P", X)) <= 1e-11  # a force ratio by Newton and Euler, not by velocities


def test_changes_of_the_shipped_scene_are_the_written_one(scene_from: SceneFrom) -> None:
    X = AHEAD_IN_SIX
    written = scene_from(locking(X, "design"))
    L1, L2, L4, L5, theta, *_, Hb = X.tolist()
    lock = float(clamp.platen(X, 0.0))
    changes = {
        "bodies.rear_link.lengths.A-B": L1,
        "bodies.rear_link.lengths.A-D": L5,
        "bodies.rear_link.lengths.B-D": float(clamp.third_length(X)),
        "bodies.front_link.lengths.B-C": L2,
        "bodies.crosshead_link.lengths.D-E": L4,
        "bodies.platen.slides.through.1": (L1 + L2) * np.sin(theta),
        "bodies.crosshead.slides.through.1": Hb,
        "drive.start": float(clamp.crosshead(X, X[6])),
        "drive.end": float(clamp.crosshead(X, 0.0)),
        "loads.0.table.0.0": lock - 1,
        "loads.0.table.1.0": lock + 1,
    }
    changed = scenes.load("double_toggle_clamp", changes)
    alpha = np.linspace(X[6], 0.0, 51)
    ours, theirs = solved(written, X, alpha), solved(changed, X, alpha)
    assert ours.samples.keys() == theirs.samples.keys()
    for channel, values in ours.samples.items():
        assert np.abs(values - theirs[channel]).max() <= 1e-12 * max(1.0, np.abs(values).max()), channel


def test_a_design_that_does_not_assemble_is_told() -> None:
    X = SCHEME_4.copy()
    X[2] = 115  # mm: DE does not reach from the crosshead's guide to D in the locked clamp
    assert not clamp.assembles(X)
    assert np.isnan(clamp.crosshead_stroke(X))
    assert clamp.assembles(SCHEME_4)
    assert clamp.assembles(INITIAL)


# --- gradients --------------------------------------------------------------------------------------------------------


def by_differences(problem: Problem, u: Array) -> Array:
    """Return the gradients of all rows, (rows, 8), by central differences extrapolated to no step, good to 1e-9."""
    steps = 4e-3 / 2.0 ** np.arange(5)
    table = [
        (problem.rows(in_box(u[:, None] + h * np.eye(8))) - problem.rows(in_box(u[:, None] - h * np.eye(8)))) / (2 * h)
        for h in steps
    ]
    for order in range(1, len(steps)):
        table = [(4**order * fine - coarse) / (4**order - 1) for coarse, fine in pairwise(table)]
    return np.asarray(table[0])


BY_SAMPLES = ("R_V max", "R_V peak-valley", "a_m range")  # differences see it where another sample is the largest


@pytest.mark.parametrize("X", [INITIAL, AHEAD_IN_SIX], ids=["initial", "ahead"])
@pytest.mark.parametrize(
    ("names", "tolerance"), [([n for n in MEASURES if n not in BY_SAMPLES], 1e-10), (BY_SAMPLES, 1e-5)]
)
def test_gradients_are_exact(X: Array, names: Sequence[str], tolerance: float) -> None:
    limits = (*(Limit(name, 0.1, np.inf) for name in names), Limit("R_S", 1.05, 1.05))
    u = (X - LOWER) / (UPPER - LOWER)
    for objective in ("M_P", "L_sum"):
        problem = Problem(objective, BOTH, limits, frozenset(), tuple(SCHEME_4))
        values, gradients = problem.with_gradients(u)
        assert np.abs(values - problem.rows(X)).max() <= 1e-14  # rounding
        assert np.abs(gradients - by_differences(problem, u)).max() <= tolerance


# --- constraints ------------------------------------------------------------------------------------------------------


def test_which_constraints_the_published_designs_meet() -> None:
    broken = {name: {c for c, s in slacks(X, BOTH).items() if s < 0} for name, X in PUBLISHED.items()}
    assert broken["double_toggle_clamp"] == {LITERAL}
    assert broken["double_toggle_clamp_scheme4"] == {LITERAL, "L1/L2 <= 0.85", "S_m <= 600 mm"} == BROKEN


def test_the_limit_of_160_degrees_in_both_readings() -> None:
    for X, literally, open_clamp in ((INITIAL, 202.770, 141.433), (SCHEME_4, 210.418, 133.543)):
        slack = slacks(X, BOTH)
        assert abs(160 - np.degrees(slack[LITERAL]) - literally) <= 5e-4  # deg, the digits given
        assert abs(160 - np.degrees(slack[OPENING]) - open_clamp) <= 5e-4


def test_phi_is_largest_at_an_end_of_the_stroke() -> None:
    X = some_designs(50)
    fractions = np.linspace(0, 1, 501)[:, None]
    inside = clamp.sine_phi(X, fractions * X[6]).max(axis=0)
    assert (inside <= np.maximum(clamp.sine_phi(X, 0.0), clamp.sine_phi(X, X[6])) + 1e-15).all()


def test_the_sizes_amount_to_the_clearance() -> None:
    for clearance in (BOTH, ALONE):
        d_B, d_D, d_E, H_s = clearance.sizes
        found = H_s / 2 - d_B, H_s / 2 - d_D, (d_B + d_D) / 2, (d_D + d_E) / 2
        assert np.abs(np.subtract(found, (clearance.B, clearance.D, clearance.L3, clearance.L4))).max() <= 1e-12
    assert tightest(INITIAL).D == 69.5
    assert (BOTH.B, BOTH.D, BOTH.L4) == (129, 69.5, 120)


def test_a_limit_that_is_broken_counts() -> None:
    problem = fixed_ratio(1.05)
    assert abs(problem.violation(SCHEME_4) - (1.09823537 - 1.05)) <= 1e-8  # the worst of three
    assert abs(ahead(SIX, MET, ALONE).violation(SCHEME_4)) <= 1e-15  # scheme 4 is no worse than itself


# --- optima -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("ratio", "best"), [(1.0, 26.874086), (1.08, 24.163611), (1.12, 22.462748)])
def test_a_few_starts_find_the_optimum(ratio: float, best: float) -> None:
    optimum = search(fixed_ratio(ratio), 16)
    assert optimum.violation <= FEASIBLE
    assert abs(optimum.value - best) <= 1e-6  # the digits given
    assert optimum.agree >= 2
    X = optimum.X
    assert ((X >= LOWER) & (X <= UPPER)).all()
    alpha = np.linspace(0, X[6], 2001)
    opening = clamp.ear(X, alpha) + clamp.phi(X, alpha)
    assert opening.min() > 0
    assert opening.max() <= 160 * DEGREE + 1e-9  # no dead point of the crosshead within the stroke


def test_the_optimum_where_the_bounds_leave_one_variable() -> None:
    """At R_S = 1 all but L1 and L4 end at bounds; R_S and phi = 85 deg then leave nothing to choose."""
    theta, gamma, alpha_max, L2, L5, Hb = 4 * DEGREE, 18 * DEGREE, 110 * DEGREE, 505.0, 280.0, 250.0
    L4 = (Hb - L5 * np.sin(theta + gamma)) / np.sin(85 * DEGREE)

    def off(L1: float) -> float:
        return measure("R_S", np.array([L1, L2, L4, L5, theta, gamma, alpha_max, Hb])) - 1

    X = np.array([brentq(off, 320, 410, xtol=1e-12), L2, L4, L5, theta, gamma, alpha_max, Hb])
    assert np.abs(search(fixed_ratio(1.0), 4).X - X).max() <= 1e-8  # mm


def test_least_length_is_no_longer_and_within_its_tolerance() -> None:
    limits = (Limit("M_P", 0.995 * 26.874086, 1.005 * 26.874086), Limit("R_S", 0.995, 1.005))
    optimum = search(Problem("L_sum", BOTH, limits), 8)
    assert abs(optimum.value - 1372.6911) <= 1e-3  # mm
    assert 0.995 - 1e-9 <= measure("M_P", optimum.X) / 26.874086 <= 1.005 + 1e-9


def test_a_design_is_ahead_of_scheme_4_in_all_objectives() -> None:
    optimum = search(ahead(SIX, MET, ALONE), 4)
    X = optimum.X
    assert optimum.violation <= FEASIBLE
    assert min(gains(X, SCHEME_4)) >= 0.005
    for name in ("R_V start", "R_V peak-valley", "a_m range"):
        margin = (measure(name, SCHEME_4) - measure(name, X)) * (1 if MEASURES[name].least else -1)
        assert margin >= -FEASIBLE, name
    kept = {name: slack for name, slack in slacks(X, ALONE).items() if name not in BROKEN}
    assert min(kept.values()) >= -FEASIBLE
    by_samples = np.ptp(clamp.acceleration(X, np.linspace(X[6], 0, 20_001)))
    assert abs(by_samples / measure("a_m range", SCHEME_4) - 1) <= 1e-4  # it is at that limit


def test_an_optimum_that_evolution_can_improve_is_told() -> None:
    problem = fixed_ratio(1.0)
    true = search(problem, 2)
    worse = replace(true, value=0.99 * true.value)
    found = restart(problem, worse, 0)
    assert abs(found + 1 / 0.99 - 1) <= 1e-6
    assert abs(restart(problem, true, 0)) <= 1e-6
    points = [Point(MAIN, "", problem, optimum, (short,)) for optimum, short in ((true, 0.0), (worse, found))]
    assert improved(points) == points[1:]


def test_no_design_is_no_optimum() -> None:
    impossible = Problem("M_P", BOTH, (Limit("R_S", 1.3, 1.3),))
    optimum = search(impossible, 2)
    assert optimum.feasible == 0
    assert np.isnan([optimum.value, *optimum.X]).all()
    assert improved([Point(MAIN, "", impossible, optimum)])


# --- dynamic models and the report -----------------------------------------------------------------------------------


def test_a_dynamic_model_confirms_a_design() -> None:
    (found,) = rechecks({"design": SCHEME_4}, ["exudyn"], lambda _: None)
    assert found.status == "ok"
    assert abs(found.R_S - 1.09823537) <= 1e-8
    assert abs(found.M_P / 22.738335 - 1) <= 1e-4  # inertia takes 6e-5
    assert abs(found.R_V_max - 1.795997) <= 1e-5  # of 3600 samples


def test_a_run_that_fails_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    failed = runner.Run("exudyn", None, scenes.Status.diverged)
    monkeypatch.setattr("compare.judge.measure.run", lambda *_: failed)
    monkeypatch.setattr("compare.engines.runner.run", lambda *_: failed)
    (found,) = rechecks({"design": SCHEME_4}, ["exudyn"], lambda _: None)
    assert found.status == "diverged"
    assert np.isnan([found.M_P, found.R_S, found.R_V_max]).all()


def test_study_and_report(tmp_path: Path) -> None:
    told = list[tuple[Point, int]]()
    points = study(Effort(2, 0), (1.0,), lambda point, total: told.append((point, total)))
    assert {total for _, total in told} == {len(told)} == {len(points)}
    assert {MAIN, LENGTHS, AHEAD} <= {point.set for point in points}
    folder = write(Outcome(points, [], {"ahead": AHEAD_IN_SIX}, 1.0), tmp_path)
    assert sorted(path.name for path in folder.iterdir()) == ["design.csv", "design.html", "design.json"]
    found = json.loads((folder / "design.json").read_text())
    assert [point["set"] for point in found["points"]] == [point.set for point in points]
    assert abs(found["published"][1]["M_P"] - 22.738335) <= 5e-7
    with (folder / "design.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 + len(points)
    assert set(VARIABLES) <= rows[0].keys()
    assert "26.8741" in (folder / "design.html").read_text()


def test_bad_folder_is_told_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "file").touch()
    assert main(["--out", str(tmp_path / "file")]) == 2
    assert capsys.readouterr().err.count("\n") == 1

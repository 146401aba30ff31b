"""The clamp's optimisation: its gradients, a few optima, the dynamic models, and the report."""

import csv
import json
import os
import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from signal import SIGINT
from time import sleep

import numpy as np
import pytest
from scipy.optimize import brentq

import scenes
from compare.engines import runner
from compare.engines.processes.inside import Limits
from papers.clamp.constraints import ALONE, BOTH, Clearance, slacks
from papers.clamp.formulas import DEGREE, INITIAL, MEASURES, SCHEME_4, Array, Design, acceleration, at, closed, measure
from papers.clamp.optimisation import search as searched
from papers.clamp.optimisation import study as studied
from papers.clamp.optimisation.recheck import ENGINES, rechecks
from papers.clamp.optimisation.report import write
from papers.clamp.optimisation.search import (
    FEASIBLE_TOL,
    VARIABLES,
    Limit,
    Optimum,
    Problem,
    gains,
    in_box,
    restart,
    search,
)
from papers.clamp.optimisation.study import AHEAD, LENGTHS, MAIN, MET, SIX, Effort, Point, ahead, fixed_ratio, study
from papers.clamp.optimisation.tables import findings, improved
from tests.comparisons import SLOW, sampled
from tests.deaths import children

from .designs import AHEAD_IN_SIX

BY_SAMPLES = ("R_V max", "R_V peak-valley", "a_m range")  # differences see it where another sample is the largest


@pytest.fixture(scope="module")
def six() -> Optimum:
    return search(ahead(SIX, MET, ALONE), 4)


def by_differences(problem: Problem, u: Array) -> Array:
    """The gradients of all rows, (rows, 8), by central differences extrapolated to no step, good to 1e-9."""
    steps = 4e-3 / 2.0 ** np.arange(5)
    table = [
        (problem.rows(in_box(u[:, None] + h * np.eye(8))) - problem.rows(in_box(u[:, None] - h * np.eye(8)))) / (2 * h)
        for h in steps
    ]
    for order in range(1, len(steps)):
        table = [(4**order * fine - coarse) / (4**order - 1) for coarse, fine in pairwise(table)]
    return np.asarray(table[0])


@pytest.mark.parametrize("d", [INITIAL, AHEAD_IN_SIX], ids=["initial", "ahead"])
@pytest.mark.parametrize(
    ("names", "tolerance"), [([n for n in MEASURES if n not in BY_SAMPLES], 1e-10), (BY_SAMPLES, 1e-5)]
)
def test_gradients_are_exact(d: Design, names: Sequence[str], tolerance: float) -> None:
    limits = (*(Limit(name, 0.1, np.inf) for name in names), Limit("R_S", 1.05, 1.05))
    u = (np.array([getattr(d, name) for name in VARIABLES]) - searched.LOWER) / (searched.UPPER - searched.LOWER)
    for objective in ("M_P", "L_sum"):
        problem = Problem(objective, BOTH, limits, frozenset(), SCHEME_4)
        values, gradients = problem.with_gradients(u)
        assert np.abs(values - problem.rows(d)).max() <= 1e-14  # rounding
        assert np.abs(gradients - by_differences(problem, u)).max() <= tolerance


def test_a_limit_that_is_broken_counts() -> None:
    problem, itself = fixed_ratio(1.05), ahead(SIX, MET, ALONE)
    assert abs(problem.violations(problem.rows(SCHEME_4)).max() - (1.09823537 - 1.05)) <= 1e-8  # the worst of three
    assert itself.violations(itself.rows(SCHEME_4)).max() <= 1e-15  # scheme 4 is no worse than itself


@sampled(1)
@pytest.mark.parametrize(("ratio", "best"), [(1.0, 26.874086), (1.08, 24.163611), (1.12, 22.462748)])
def test_a_few_starts_find_the_optimum(ratio: float, best: float) -> None:
    optimum = search(fixed_ratio(ratio), 16)
    assert optimum.violation <= FEASIBLE_TOL
    assert abs(optimum.value - best) <= 1e-6  # the digits given
    assert optimum.agree >= 2
    d = optimum.design
    inside = np.array([getattr(d, name) for name in VARIABLES])
    assert ((inside >= searched.LOWER) & (inside <= searched.UPPER)).all()
    pose = at(d, np.linspace(0, d.alpha_max, 2001))
    assert (pose.ear + pose.phi).min() > 0
    assert (pose.ear + pose.phi).max() <= 160 * DEGREE + 1e-9  # no dead point of the crosshead within the stroke


def test_the_optimum_where_the_bounds_leave_one_variable() -> None:
    """At R_S = 1 all but L1 and L4 end at bounds; R_S and phi = 85 deg then leave nothing to choose."""
    theta, gamma, alpha_max, L2, L5, Hb = 4 * DEGREE, 18 * DEGREE, 110 * DEGREE, 505.0, 280.0, 250.0
    L4 = (Hb - L5 * np.sin(theta + gamma)) / np.sin(85 * DEGREE)

    def design(L1: float) -> Design:
        return closed(Design(L1, L2, np.nan, L4, L5, Hb, theta, gamma, alpha_max))

    true = design(brentq(lambda L1: measure("R_S", design(L1)) - 1, 320, 410, xtol=1e-12))
    assert np.abs(np.subtract(search(fixed_ratio(1.0), 4).design, true)).max() <= 1e-8  # mm


def test_the_printed_largest_force_ratio() -> None:
    """With (d_B + d_D)/2 of 132 mm and (d_D + d_E)/2 of 135 mm; the limit of L1 - Hb leaves room."""
    optimum = search(Problem("M_P", Clearance(129.0, 69.5, 132.0, 135.0)), 8)
    assert f"{optimum.value:.2f}" == "26.55"
    assert optimum.agree == 8
    assert optimum.design.L1 - optimum.design.Hb < 128


def test_least_length_is_no_longer_and_within_its_tolerance() -> None:
    limits = (Limit("M_P", 0.995 * 26.874086, 1.005 * 26.874086), Limit("R_S", 0.995, 1.005))
    optimum = search(Problem("L_sum", BOTH, limits), 8)
    assert abs(optimum.value - 1372.6911) <= 1e-3  # mm
    assert 0.995 - 1e-9 <= measure("M_P", optimum.design) / 26.874086 <= 1.005 + 1e-9


def test_a_design_is_ahead_of_scheme_4_and_no_worse_to_the_searchs_sampling(six: Optimum) -> None:
    d = six.design
    assert six.violation <= FEASIBLE_TOL
    assert min(gains(d, SCHEME_4)) >= 0.005
    for name in ("R_V start", "R_V peak-valley", "a_m range"):
        margin = (measure(name, SCHEME_4) - measure(name, d)) * (1 if MEASURES[name].least else -1)
        assert margin >= -FEASIBLE_TOL, name
    kept = {name: slack for name, slack in slacks(d, ALONE).items() if name not in studied.BROKEN}
    assert min(kept.values()) >= -FEASIBLE_TOL


def test_what_that_design_is_worse_in_is_named(six: Optimum) -> None:
    """Of the six criteria three are ahead; the others and the broken limits are named with their figures."""
    problem = ahead(SIX, MET, ALONE)
    (sentence,) = (s for s in findings([Point(AHEAD, f"{SIX}; {MET}", problem, six)]) if s.startswith("Ahead"))
    assert "ahead by 0.569 % in each of M_P, R_S and L_sum; " in sentence
    assert "S_m is 623.7 mm, over the printed 600" in sentence
    assert "L1/L2 is 0.890, over the printed 0.85" in sentence
    start, peak_valley, a_m = (float(change) for change in re.findall(r" ([+-][\d.]+) %", sentence))
    ours, rival = (np.ptp(acceleration(at(d, np.linspace(0, d.alpha_max, 100_001)))) for d in (six.design, SCHEME_4))
    assert a_m == pytest.approx(100 * (ours / rival - 1), abs=1e-4)
    assert (start, a_m) == (7.9677, 0.0)
    assert abs(peak_valley) <= 2e-4  # a tie, as a_m's range


@SLOW
def test_an_optimum_that_evolution_can_improve_is_reported() -> None:
    problem = fixed_ratio(1.0)
    true = search(problem, 2)
    worse = replace(true, value=0.99 * true.value)
    short_by = restart(problem, worse, 0)
    assert abs(short_by + 1 / 0.99 - 1) <= 1e-6
    assert abs(restart(problem, true, 0)) <= 1e-6
    points = [Point(MAIN, "", problem, optimum, (short,)) for optimum, short in ((true, 0.0), (worse, short_by))]
    assert improved(points) == points[1:]


def test_no_design_is_no_optimum() -> None:
    impossible = Problem("M_P", BOTH, (Limit("R_S", 1.3, 1.3),))
    optimum = search(impossible, 2)
    assert optimum.feasible == 0
    assert np.isnan([optimum.value, *optimum.design]).all()
    assert improved([Point(MAIN, "", impossible, optimum)])


@SLOW
def test_the_dynamic_models_confirm_a_design(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its open pose is far from that of the shipped scene."""
    monkeypatch.setattr("compare.judge.floor.FLOOR_SAMPLES", 12)
    d = search(fixed_ratio(1.1), 4).design
    rows = list(rechecks({"curve": d}, ENGINES, lambda _: None))
    assert [(row.design, row.engine) for row in rows] == [("curve", engine) for engine in ENGINES]
    for row in rows:
        assert row.status == "ok"
        assert abs(row.R_S - measure("R_S", d)) <= 1e-8
        assert abs(row.M_P / measure("M_P", d) - 1) <= 1e-4  # inertia takes 6e-5
        assert abs(row.R_V_max / measure("R_V max", d) - 1) <= 1e-5  # of 3600 samples


def test_a_run_that_fails_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    failed = runner.Run("exudyn", None, scenes.Status.diverged)
    monkeypatch.setattr("compare.engines.runner.HERE.run", lambda *_: failed)
    (row,) = rechecks({"design": SCHEME_4}, ["exudyn"], lambda _: None)
    assert row.status == "diverged"
    assert np.isnan([row.M_P, row.R_S, row.R_V_max]).all()


def test_ctrl_c_ends_the_searches(monkeypatch: pytest.MonkeyPatch) -> None:
    own = os.getpid()

    def endless(_: object) -> None:
        os.kill(own, SIGINT)
        sleep(600)

    monkeypatch.setattr("papers.clamp.optimisation.study._point", endless)
    monkeypatch.setattr("papers.clamp.optimisation.study.LIMITS", Limits(workers=1))  # for one Ctrl-C
    with pytest.raises(KeyboardInterrupt):
        study(Effort(2, 0), (1.0,), lambda _: None)
    assert children() == []


def test_a_search_that_dies_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("papers.clamp.optimisation.study._point", lambda _: os.abort())
    monkeypatch.setattr("papers.clamp.optimisation.study.LIMITS", Limits(workers=1))  # of two, either may die first
    with pytest.raises(RuntimeError, match=f"{MAIN}, R_S = 1.00: its process ended by SIGABRT"):
        study(Effort(2, 0), (1.0,), lambda _: None)
    assert children() == []


@SLOW
def test_study_and_report(tmp_path: Path) -> None:
    done: list[str] = []
    points = study(Effort(2, 0), (1.0,), done.append)
    assert len(done) == len(points)
    assert all(f" of {len(points)} points: " in text for text in done)
    assert {MAIN, LENGTHS, AHEAD} <= {point.set for point in points}
    folder = write(points, [], {"ahead": AHEAD_IN_SIX}, 1.0, tmp_path)
    assert sorted(path.name for path in folder.iterdir()) == ["design.csv", "design.html", "design.json"]
    written = json.loads((folder / "design.json").read_text())
    assert [point["set"] for point in written["points"]] == [point.set for point in points]
    assert abs(written["published"][1]["M_P"] - 22.738335) <= 5e-7
    with (folder / "design.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 + len(points)
    assert set(VARIABLES) <= rows[0].keys()
    assert "26.8741" in (folder / "design.html").read_text()

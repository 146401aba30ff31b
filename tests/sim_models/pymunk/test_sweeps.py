"""How many sweeps theory asks for, against the engine's own sweeps and against where its runs begin to hold."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest

import scenes
from scenes import Failure, Sampling, Scene, Status
from sim_models.pymunk.constraints import LinkageConstraints
from sim_models.pymunk.engine import DEFAULT, at_steps, iterations_needed
from sim_models.pymunk.masses import ballasted_masses, fictitious_masses
from sim_models.pymunk.space import Model
from sim_models.pymunk.start import start
from sim_models.pymunk.sweeps import contraction, contractions, sweeps_needed
from tests import scene_files
from tests.comparisons import sampled

from .runs import Array, solve


def residuals(model: Model, linkage: LinkageConstraints, pose: Array, rate: Array, sweeps: int) -> float:
    """How fast the joints still open after that many of the engine's own sweeps, from the rates given."""
    model.place(pose, rate)
    model.space.iterations = sweeps
    model.space.step(1e-12)  # long enough to sweep, too short to move
    v = np.array([[*body.velocity, body.angular_velocity] for body in model.bodies.values()])
    return float(np.linalg.norm((linkage.jacobian(pose)[0] @ v.ravel())[:-1]))


@pytest.mark.parametrize("name", ["toggle_press", "swinging_law", "carried_block", "slotted_class_iii"])
def test_engine_s_own_sweeps_contract_as_told(name: str) -> None:
    """With every joint that pymunk has here: pivots, grooves on the ground and on turning bodies, gears."""
    scene = scene_files.load(name)
    linkage = LinkageConstraints(scene, ballasted_masses)
    pose = start(linkage)
    rate = np.random.default_rng(3).standard_normal(pose.shape)
    for name, moved in linkage.moved.items():
        i = linkage.index[name]
        rate[:, i] *= not moved.prescribed
        rate[:, i, 2] *= np.isfinite(moved.moment)

    def after(sweeps: int) -> float:
        return residuals(Model(linkage, pose, rate, 1.0, ""), linkage, pose, rate, sweeps)

    rho = contraction(linkage, pose)
    # Where the residual is a thousandth of the first, the slowest part alone is left; a complex pair makes it waver.
    many = max(2, int(np.ceil(np.log(1e-3) / np.log(rho))))
    assert (after(3 * many) / after(many)) ** (1 / (2 * many)) == pytest.approx(rho, rel=0.03)


def holds(scene: Scene, steps: int, sweeps: int) -> bool:
    try:
        solve(scene, at_steps(steps, sweeps), Sampling(72))
    except Failure as failure:
        return failure.status not in (Status.wrong_branch, Status.diverged, Status.nonfinite)
    return True


# Measured: runs hold from 36, 70 and 27 sweeps on.
@sampled(1)
@pytest.mark.parametrize(("name", "needed"), [("toggle_press", 55), ("double_toggle_clamp", 81), ("quick_return", 30)])
def test_theory_tells_where_runs_begin_to_hold(name: str, needed: int) -> None:
    scene = scenes.load(name)
    assert iterations_needed(scene, DEFAULT) == needed
    assert holds(scene, 1440, needed)
    assert not holds(scene, 1440, needed // 3)


def test_half_a_correction_needs_fewer_sweeps() -> None:
    press = scenes.load("toggle_press")
    half = replace(DEFAULT, correction=0.5)
    assert iterations_needed(press, half) == pytest.approx(55 * np.log(1.5) / np.log(2), abs=1)
    assert iterations_needed(press, replace(DEFAULT, fictitious=True)) == 2
    # The figure of an independent study, all bodies moved by forces; a pose 2.5 deg from the worst one is off by 2 %.
    assert iterations_needed(press, replace(DEFAULT, extra="motor")) == pytest.approx(1240, rel=0.02)
    linkage = LinkageConstraints(press, fictitious_masses)
    assert max(contractions(linkage, start(linkage))) < 0.7


def test_sweeps_at_the_ends_of_theory() -> None:
    assert [sweeps_needed(rho, 0.5) for rho in (0.0, 0.5, 1.0, float("nan"))] == [1, 1, inf, inf]
    assert iterations_needed(scene_files.load("crank"), DEFAULT) == 1  # no joint is pymunk's

"""Many press forces: their cost grows with their number, and on their switches an engine is right on either side."""

from collections.abc import Mapping

import numpy as np
import pytest

import compare
from compare.engines import registry
from compare.mechanics.reference import Acting, fitted
from scenes import Sampling
from scenes.model.motion import Samples
from scenes.scene import PressForce
from tests import scene_files
from tests.comparisons import SLOW, sampled

MANY = 200  # as many loads as a scene may have
ENGINES = ("analytic", "exudyn", "pymunk", "multiprecision", "casadi", "pinocchio")
LASTS = [0.05 + 1.5 * n / MANY for n in range(MANY)]  # m, of a stroke of 2 m


def presses(count: int) -> scene_files.Changes:
    """So many of the press forces, on a rod that pymunk turns, as it does none without mass."""
    each, size = enumerate(LASTS[:: MANY // count]), MANY // count  # N: fewer are larger
    loads = [{"body": "slider", "at": "B", "force": [-size if n % 2 else size, 0], "last": x} for n, x in each]
    return {"loads": loads, "bodies.rod.mass": 1e-12}


@sampled(3)
@pytest.mark.parametrize("count", [20, pytest.param(MANY, marks=SLOW)])
@pytest.mark.parametrize("engine", ENGINES)
def test_many_press_forces_are_those_of_the_power(engine: str, count: int) -> None:
    """Of a crank and a rod of no weight: T w = m a v - F v, with F by displacements of 2 to 4 m, read off the scene."""
    if registry.ENTRIES[engine].missing:
        pytest.skip("not installed")
    model = registry.engine(engine)
    scene, lasts = scene_files.load("slider_crank", presses(count)), LASTS[:: MANY // count]
    simulation = model.build(scene, model.DEFAULT, Sampling(12))
    simulation.solve()
    motion = simulation.read()
    x, v, a = (motion[f"B.{rate}x"] for rate in ("", "v", "a"))
    against = [(x - 2 <= last) & (v < 0) if n % 2 == 0 else (4 - x <= last) & (v > 0) for n, last in enumerate(lasts)]
    forces = MANY // count * sum(np.where(acts, -1.0 if n % 2 else 1.0, 0.0) for n, acts in enumerate(against))
    between = np.abs(v) > 0.1  # not at a dead point, where all forces have their switch
    off = (motion["drive.torque"] * 10 - 2 * a * v + forces * v)[between]
    assert between.sum() == 10
    assert np.abs(off).max() <= model.DEFAULT.promise * np.abs(forces * v).max()


@pytest.mark.parametrize("count", [pytest.param(8, marks=SLOW), pytest.param(MANY, marks=pytest.mark.study)])
def test_many_press_forces_are_judged(count: int) -> None:
    scene = scene_files.load("slider_crank", presses(count))
    judged = compare.check(scene, engines=("analytic", "exudyn", "pymunk"), samples=72)
    assert judged.ok, judged.verdicts


SLIDERS = [f"slider{n}" for n in range(12)]
FORCES = [PressForce(body, "P", (-s, 0.0), last, s) for body in SLIDERS for s in (1, -1) for last in (1.0, 2.0, 4.0)]


def carried(acting: Acting) -> dict[str, Samples]:
    """Return the sums of forces on each slider, by which no two ways to stand are alike."""
    sizes = [force.closing * force.last for force in FORCES]
    own = {body: [n for n, force in enumerate(FORCES) if force.body == body] for body in SLIDERS}
    return {body: np.sum([sizes[n] * acting[n] for n in numbers], axis=0) for body, numbers in own.items()}


@pytest.mark.parametrize("seed", range(5))
def test_sliders_that_turn_round_together_may_each_be_on_either_side(seed: int) -> None:
    """At the second of three samples; 72 forces could stand in 2^72 ways there, of which few are tried."""
    signs = dict(zip(SLIDERS, np.random.default_rng(seed).integers(-1, 2, len(SLIDERS)), strict=True))  # of velocities
    acting = [np.array([True, signs[force.body] == force.closing, False]) for force in FORCES]
    may = [np.array([[True, sign == force.closing, False] for sign in (-1, 1) for _ in range(2)]) for force in FORCES]
    true, tries = carried(acting), []

    def misfit(standing: Acting) -> tuple[Samples, Mapping[str, Samples]]:
        tries.append(carried(standing))
        return np.sum([np.abs(tries[-1][body] - true[body]) for body in SLIDERS], axis=0), tries[-1]

    every, best = fitted(FORCES, may, misfit)
    for body in SLIDERS:
        assert np.array_equal(best[body], true[body]), body
        assert every[body][1] == 0  # on a switch all act, and cancel each other
    assert len(tries) <= 1 + 5 * len(SLIDERS)

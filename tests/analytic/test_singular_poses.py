"""Singular poses between all samples are refused by name and place; where a linkage only comes near, it is solved."""

from collections.abc import Callable
from functools import partial
from math import acos, cos, pi, radians, sin

import numpy as np
import pytest

import analytic
from analytic import engine
from analytic.core.decomposition import members
from analytic.solve import Solver, prepared
from analytic.way import change_points
from scenes import Failure, Positions, Sampling, Scene, Status
from scenes.scene import ConstantSpeed
from tests import scene_files
from tests.agreement import errors, exact
from tests.comparisons import SLOW, sampled

from .newton import as_one_group

EPS = 2.0**-52
START = {"drive.start": 0.0123}  # rad: the poses are half a degree and more off 36 samples, and off any grid
# Crank 1 and coupler 3.5 in line: B is 4.5 from O. The rocker, 2 long on a frame of 4, is then at its least angle.
LEAST = pi - acos((4**2 + 2**2 - 4.5**2) / (2 * 4 * 2))
NEAREST = float(np.angle(4 + 2 * np.exp(1j * LEAST)))  # rad, of the crank


def guides(apart: float) -> Scene:
    """Return a rocker whose slot comes as near to parallel to a guide as this, deg, and turns away again."""
    along = LEAST - radians(apart)
    return scene_files.load("rocking_guide", {"bodies.slider.slides.along": [cos(along), sin(along)]})


def bars(left: float) -> Scene:
    """Return a four-bar whose coupler and rocker reach what they have to, 5 m, and this much more, m."""
    dyad = {"bodies.block": None, "bodies.slider": None, "loads": None, "sketch.P": None, "output": {"point": "B"}}
    return scene_files.load("rocking_guide", {**dyad, "bodies.coupler.lengths.A-B": 3 + left, "sketch.B": [3, 1.8]})


def rod(left: float) -> Scene:
    """Return a slider-crank whose rod is longer than the crank by this, m."""
    return scene_files.load("slider_crank", {**START, "bodies.rod.lengths.A-B": 1 + left, "sketch.B": [1.8, 0]})


def lever(left: float) -> Scene:
    """Return a lever whose slot passes its pivot by what the crank's pin is from there at 0 deg, less this, m."""
    return scene_files.load("slotted_lever", {**START, "bodies.block.slides.through": [0, 0.5 - left]})


PARALLEL = f"the linkage is singular at crank angle {NEAREST:.6f} rad: the guides of block and slider parallel"
MEET = "two ways of assembling the bodies meet at crank angle "
SINGULAR = {
    "PRP": (guides, PARALLEL),
    "RRR": (bars, f"{MEET}3.141593 rad: coupler and rocker in line at B"),
    "RRP": (rod, f"{MEET}1.570796 rad: rod square to the guide of slider"),
    "RPR": (lever, f"{MEET}6.283185 rad: the pins of block and lever square to the guide of block"),
}
NEAR = [1e-2, 1e-6, 1e-9]  # deg or m
BEYOND = [0.0, -1e-12, -1e-6]


def run(scene: Scene, count: int = 36) -> None:
    """Solve as an engine of the comparison does."""
    built = engine.build(scene, engine.DEFAULT, Sampling(count))
    built.solve()


@sampled(2)
@pytest.mark.parametrize("dyad", SINGULAR)
def test_between_samples_each_dyad_is_refused_beyond_and_solved_near_its_singular_pose(dyad: str) -> None:
    scene, why = SINGULAR[dyad]
    for near in NEAR:
        run(scene(near))
    for beyond in BEYOND:
        between = np.linspace(0.0123, 0.0123 + 2 * pi, 37)  # no sample is where it does not close
        for way in (partial(run, scene(beyond)), partial(analytic.solve, scene(beyond), between)):
            with pytest.raises(Failure) as caught:
                way()
            assert caught.value.status is Status.cannot_assemble
            reason = caught.value.reason.partition("; drive.start and drive.end can limit a run to within ")[0]
            assert reason == why, beyond


@pytest.mark.parametrize("dyad", SINGULAR)
def test_a_gap_that_the_search_meets_but_no_sample(dyad: str) -> None:
    """Of a degree, between samples 10 degrees apart."""
    scene, _ = SINGULAR[dyad]
    with pytest.raises(
        Failure, match=r"cannot be reached at crank angle .* rad(: .* m apart)?; the crank turns only from"
    ):
        run(scene(-1e-2 if dyad == "PRP" else -1e-4))


def test_parallel_for_less_than_the_grid_of_the_range() -> None:
    """For 0.025 degrees, half way between two angles of that grid: no end of the range is seen, but what stops it."""
    scene = guides(-1e-6)
    off = scene.with_law(ConstantSpeed(3.0, NEAREST - radians(17.45), None))
    with pytest.raises(Failure, match=r"but for gaps narrower than 0\.001745 rad \(the guides of block and slider"):
        analytic.solve(off, [NEAREST])


def test_next_to_parallel_guides_every_channel_is_right() -> None:
    """Against 50 digits. An angle of guides known to eps is so to eps / angle, and forces go with its square."""
    pytest.importorskip("flint")
    apart = 0.1
    scene = guides(apart)
    true = exact(scene, Positions((0.0123, NEAREST - 0.01, NEAREST, NEAREST + 0.1)))
    motion = analytic.solve(scene, true["crank_angle"], true["time"])
    found = errors(motion, {channel: true[channel] for channel in scene.channels.names()})
    assert max(error.max() for error in found.values()) <= 20 * EPS / radians(apart) ** 2


def by_newton(scene: Scene) -> Solver:
    """Return a solver that takes the last dyad for a larger group."""
    return prepared(scene, as_one_group(scene, -1))


@SLOW
@pytest.mark.parametrize("scene", [guides, bars], ids=["PRP", "RRR"])
def test_between_samples_a_larger_group_is_refused_and_near_it_solved(scene: Callable[[float], Scene]) -> None:
    beyond = by_newton(scene(-1e-6))
    beyond(np.linspace(0.0123, 0.0123 + 2 * pi, 37))
    bodies = ", ".join(members(beyond.linkage.groups[-1]))
    with pytest.raises(Failure, match=f"the linkage is singular at .* rad: {bodies} in a singular configuration"):
        change_points.check_way(beyond)
    near = by_newton(bars(1e-9)) if scene is bars else by_newton(guides(1e-2))
    change_points.check_way(near)

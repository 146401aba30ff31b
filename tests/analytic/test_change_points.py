"""Where two assemblies meet between the sketch and what is asked for, Python refuses as the command does."""

from collections.abc import Callable
from math import pi, radians
from typing import Any

import numpy as np
import pytest

import analytic
from scenes import Failure, Scene, Status
from scenes.scene import ConstantSpeed
from tests import scene_files
from tests.comparisons import sampled

# The parallelogram is drawn at 90 degrees, and stretched out at 0 and 180 degrees.
MEET = "two ways of assembling the bodies meet at crank angle"
NUMBER = "bodies.crank.lengths.A-B"


def parallelogram() -> Scene:
    return scene_files.load("parallelogram")


def angles(*degrees: float) -> Any:
    return np.radians(degrees)


def solved_by_a_grid(scene: Scene, position: Any) -> Any:
    largest = analytic.Extremes("C.x")
    grid = analytic.Grid(float(position.min()), float(position.max()), 50)
    (status,), (reason,) = analytic.reduce_many(scene, {}, grid, [largest])
    if status is not Status.ok:
        raise Failure(status, reason)
    return largest.largest


def one_of_many(scene: Scene, position: Any) -> Any:
    machines = analytic.solve_many(scene, {NUMBER: [0.29, 0.3]}, position)
    (first, status), (_, reason) = machines.status, machines.reason
    assert first is Status.ok  # none spoils another
    if status is not Status.ok:
        raise Failure(status, reason)
    return machines["C.x"]


WAYS: dict[str, Callable[[Scene, Any], Any]] = {
    "solve": analytic.solve,
    "solver": lambda scene, position: analytic.solver(scene, {"C.x"})(position),
    "fast_solver": lambda scene, position: analytic.fast_solver(scene, compiled=False)(position),
    "derivatives": lambda scene, position: analytic.derivatives(scene, ["bodies.coupler.points.G.0"], position),
    "departures": lambda scene, position: analytic.departures(scene, np.append(position[0] - 1e-3, position)),
    "solve_many": one_of_many,
    "reduce_many": solved_by_a_grid,
}


@sampled(14)
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(
    ("position", "meets"),
    [
        (angles(91), None),
        (angles(5, 175), None),
        (angles(450), None),  # a turn on
        (angles(-270), None),
        (angles(185), 180),  # the way there is from 90
        (angles(175, 185), 180),
        (angles(-5), 0),
        (angles(355), 360),  # as -5
        (angles(175, 365), 180),
        (angles(90, 450), 180),
    ],
)
def test_what_lies_behind_a_change_point_is_refused(way: str, position: Any, meets: float | None) -> None:
    scene = parallelogram()
    if meets is None:
        WAYS[way](scene, position)
        return
    with pytest.raises(Failure) as caught:
        WAYS[way](scene, position)
    assert caught.value.status is Status.cannot_assemble
    assert caught.value.reason.startswith(f"{MEET} ")
    place = float(caught.value.reason.removeprefix(f"{MEET} ").split()[0])
    assert min(abs(place - radians(at)) for at in (meets, 0, 180, 360)) < 1e-6


def test_bounds_are_refused_as_a_run_is() -> None:
    scene = parallelogram()
    for way in (lambda: analytic.enclose(scene), lambda: analytic.check_way(analytic.solver(scene))):
        with pytest.raises(Failure, match=MEET):
            way()


@pytest.mark.parametrize(
    ("first", "last", "meets"),
    [(10, 170, None), (190, 250, 180), (250, 190, 180), (-60, -10, 0), (550, 610, 540)],  # the sketch is at 90
)
def test_a_range_that_does_not_hold_the_sketch_is_refused_before_any_sample(
    first: float, last: float, meets: float | None
) -> None:
    """No place of the range is singular; one between it and the sketch leaves open which assembly is meant."""
    scene = parallelogram().with_law(ConstantSpeed(5.0 if last > first else -5.0, radians(first), radians(last)))
    solver = analytic.solver(scene)
    if meets is None:
        analytic.check_way(solver)
        return
    with pytest.raises(Failure, match=f"{MEET} {radians(meets):.6f} rad") as caught:
        analytic.check_way(solver)
    assert caught.value.status is Status.cannot_assemble


def test_up_to_a_change_point_the_assembly_is_the_sketched_one() -> None:
    """A parallelogram's coupler stays level: C is where B is, and the frame's 2 m on."""
    scene = parallelogram()
    motion = analytic.solve(scene, np.linspace(1e-3, pi - 1e-3, 61))
    apart = motion["C.x"] - motion["B.x"]
    assert np.abs(apart - apart[0]).max() <= 1e-9 * abs(apart[0])  # near the change point 1e-3 rad costs four digits
    assert np.abs(motion["C.y"] - motion["B.y"]).max() <= 1e-9


def test_only_the_nearest_places_are_looked_for() -> None:
    scene = parallelogram()
    nearest = analytic.solver(scene).meetings.nearest
    assert [round(position / pi, 6) for position, _ in nearest] == [1.0, 0.0]

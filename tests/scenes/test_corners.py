"""Points on one line: what a body is taken for that has no centre of mass and inertia of its own."""

from collections.abc import Mapping
from itertools import combinations, permutations
from math import dist, hypot

import numpy as np
import pytest

import analytic
from scenes import InputError, Status
from scenes.scene import Body
from tests import scene_files

Lengths = Mapping[str, float]
Points = Mapping[str, list[float]]
ON_A_LINE = {"A": 0.1, "B": 0.3, "C": 0.6, "D": -0.7}  # mm; 0.1 + 0.2 is not 0.3 in doubles


def lever(points: Points | None = None, lengths: Lengths | None = None, **more: object) -> Body:
    """A body of other points than the lever's."""
    names = dict.fromkeys(point for pair in lengths or {} for point in pair.split("-")) if lengths else points or {}
    own = {"lengths": dict(lengths)} if lengths else {"points": dict(points or {})}
    sketch = {point: [number, 0.0] for number, point in enumerate(names) if point != "A"}
    changes = {"bodies.lever": {**own, "mass": 10, **more}, "sketch": sketch, "output.point": next(iter(sketch))}
    return scene_files.load("lever", changes).bodies["lever"]


@pytest.mark.parametrize(
    ("points", "corners"),
    [
        ({"A": [0, 0], "B": [0, 3]}, ("A", "B")),
        ({"B": [250, 1], "A": [0, 1], "C": [1000, 1]}, ("A", "C")),
        ({"A": [0, 0], "C": [86.603, 50], "B": [173.205, 100]}, ("A", "B")),  # at 30 deg, as drawings round
        ({"A": [1, 1], "D": [-5, 7], "B": [2, 0], "E": [4, -2], "C": [0, 2]}, ("D", "E")),
        ({"A": [0, 0], "B": [500, 0.9], "C": [1000, 0]}, ("A", "C")),
        ({"A": [0, 0], "B": [500, 1.1], "C": [1000, 0]}, ("A", "B", "C")),
        ({"A": [0, 0], "B": [500, 300], "C": [1000, 0]}, ("A", "B", "C")),
    ],
)
def test_points_on_one_line_are_a_bar_between_the_outermost_two(points: Points, corners: tuple[str, ...]) -> None:
    assert lever(points).corners == corners


@pytest.mark.parametrize("order", [*permutations("ABC")])
def test_three_lengths_that_close_on_one_line(order: tuple[str, ...]) -> None:
    lengths = {f"{p}-{q}": abs(ON_A_LINE[p] - ON_A_LINE[q]) for p, q in combinations(order, 2)}
    body = lever(lengths=lengths)
    assert body.corners == tuple(point for point in order if point != "B")
    held(body, lengths)


def test_five_points_by_lengths_on_one_line() -> None:
    places = {**ON_A_LINE, "E": 0.55}
    ways = [("A", "B"), *((p, q) for q in "CDE" for p in "AB")]
    lengths = {f"{p}-{q}": abs(places[p] - places[q]) for p, q in ways}
    body = lever(lengths=lengths)
    assert body.corners == ("C", "D")
    held(body, lengths)


def held(body: Body, lengths: Lengths) -> None:
    """Assert that a body has its points on x at these distances, the second in the direction of x."""
    assert body.local is not None
    assert body.local[body.points[1]][0] > 0
    assert {y for _, y in body.local.values()} == {0.0}
    for pair, length in lengths.items():
        p, q = pair.split("-")
        assert dist(body.local[p], body.local[q]) == pytest.approx(1e-3 * length, rel=1e-15)  # a rounding


def test_lengths_that_miss_the_line_by_more_than_rounding() -> None:
    with pytest.raises(InputError, match="the triangle cannot close, expected its longest side to be shorter"):
        lever(lengths={"A-B": 250, "B-C": 750, "A-C": 1000.000001})
    assert lever(lengths={"A-B": 250, "B-C": 750.000001, "A-C": 1000}).lengths is not None


def test_lengths_on_one_line_do_not_vary() -> None:
    """Another one would take the points off it, by far more than itself; the core knows the places alone."""
    bars = {"bodies.lever": {"lengths": {"A-B": 250, "B-C": 750, "A-C": 1000}, "mass": 10}}
    why = r"bodies.lever.lengths.C-A: the points of 'lever' are on one line, .* expected a body that is given by"
    with pytest.raises(InputError, match=rf"lever.toml: variations.0.path: {why}"):
        scene_files.load("lever", bars | {"variations": [{"path": "bodies.lever.lengths.C-A", "plus_minus": 1}]})
    with pytest.raises(InputError, match=why):
        analytic.solve_many(scene_files.load("lever", bars), {"bodies.lever.lengths.C-A": [1000.0]}, [0.0])


def test_more_points_off_the_line_need_both() -> None:
    square = {"A": [0.0, 0.0], "B": [1.0, 0.0], "C": [1.0, 1.0], "D": [0.0, 1.0]}
    with pytest.raises(InputError, match="'com' and 'inertia', since it has a mass and more than three points that"):
        lever(square)
    assert lever(square, com=[0.5, 0.5], inertia=1).inertia == 1e-6


def test_a_machine_that_another_rule_would_be_taken_for_does_not_run() -> None:
    """The rule is the drawing's: a pin off the line by more than 1e-3 of the longest side asks for com and inertia."""
    scene, off = scene_files.load("lever"), [0.0, 0.5, -2.0]
    machines = analytic.solve_many(scene, {"bodies.lever.points.B.1": off}, np.array([0.0]))
    assert [*machines.status] == [Status.ok, Status.ok, Status.cannot_assemble]
    assert "expected points that are on one line, as drawn, or 'com' and 'inertia'" in machines.reason[2]
    torque = machines["drive.torque"][:2, 0]
    assert torque == pytest.approx([49.05, 49.05], rel=1e-15)


def test_the_lever_of_the_drawing() -> None:
    """The drive holds m g l / 2, and l is in its pins: B carries nothing."""
    motion = analytic.solve(scene_files.load("lever"), [0.0])
    assert motion["drive.torque"][0] == pytest.approx(49.05, rel=1e-14)
    centripetal = 10 * 0.5 * (2 * np.pi) ** 2
    assert hypot(motion["A.fx"][0], motion["A.fy"][0]) == pytest.approx(hypot(centripetal, 98.1), rel=1e-14)

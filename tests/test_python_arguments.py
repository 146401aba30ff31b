"""What callers from Python pass: of another kind, or unknown, it is refused in one line that names the nearest."""

from collections.abc import Callable
from fractions import Fraction
from functools import partial
from inspect import signature
from typing import Any, TypeAlias

import numpy as np
import pytest

import analytic as typed_analytic
import compare as typed_compare
import scenes as typed_scenes
from scenes import Motion
from tests import scene_files
from tests.comparisons import SAMPLING, Plug, commanded, sampled

analytic: Any = typed_analytic  # so that they may be called with what they do not take
compare: Any = typed_compare
scenes: Any = typed_scenes

PRESS = scenes.load("toggle_press")
MANY: dict[str, Any] = {"bodies.rod.mass": [60.0, 61.0]}
MASKED: Any = np.ma.masked_array([0.5, 1.0], [False, True])
ROD = ["bodies.rod.mass"]

Call: TypeAlias = Callable[[Any], object]

refused = partial(scene_files.refused, most=249)
RIGHT: dict[str, Any] = {"scene": PRESS, "changes": MANY, "numbers": ROD, "position": [0.5], "channels": {"P5.y"}}
RIGHT |= {"reductions": [analytic.Extremes("P5.y", 2)], "edges": [0.0, 1.0]}
TAKEN = {name: signature(getattr(analytic, name)).parameters.keys() & RIGHT.keys() for name in analytic.__all__}


def calls(argument: str) -> dict[str, Call]:
    """Every function that takes an argument of a scene, called with something in the place of the right one."""

    def call(name: str, value: Any) -> object:
        return getattr(analytic, name)(**{of: RIGHT[of] for of in TAKEN[name]} | {argument: value})

    return {name: partial(call, name) for name, taken in TAKEN.items() if {"scene", argument} <= taken}


WITH_CHANNELS, WITH_A_SCENE = calls("channels"), calls("scene")
WITH_POSITIONS: dict[str, Call] = calls("position") | {
    "its time": lambda time: analytic.solve(PRESS, [0.5, 1.0], time),
    "solver": lambda position: analytic.solver(PRESS)(position),
    "its numbers": lambda masses: analytic.solve_many(PRESS, {"bodies.rod.mass": masses}, [0.5]),
    "fast_solver": lambda position: analytic.fast_solver(PRESS)(position),
    "fast_solver.many": lambda position: analytic.fast_solver(PRESS).many(MANY, position),
    "its velocity": lambda velocity: analytic.inverse(PRESS, -1.0, velocity),
}


@pytest.mark.parametrize("name", WITH_CHANNELS)
def test_channels_that_are_not(name: str) -> None:
    call = WITH_CHANNELS[name]
    assert "channels: no 'P5.z'; did you mean 'P5." in refused(lambda: call({"P5.y", "P5.z"}))
    assert "channels: no 'P5.*'; did you mean 'P5." in refused(lambda: call({"P5.*"}))
    assert refused(lambda: call("P5.y")) == "channels: expected several names, as ['P5.y'], found 'P5.y'"
    assert refused(lambda: call(3)) == "channels: expected several names, found 3"


@pytest.mark.parametrize("given", [["P5.y"], ("P5.y",), {"P5.y"}, frozenset({"P5.y"})])
def test_channels_that_are(given: Any) -> None:
    assert set(analytic.solve(PRESS, [0.5], channels=given).samples) == {"time", "crank_angle", "P5.y"}
    assert "P5.to_lock" in analytic.solve(PRESS, [0.5], channels={"P5.to_lock"})


@pytest.mark.parametrize("name", WITH_A_SCENE)
def test_a_name_is_no_scene(name: str) -> None:
    line = refused(lambda: WITH_A_SCENE[name]("toggle_press"))
    assert line == "scene: expected a Scene, as scenes.load(...) returns it, found 'toggle_press'"


@sampled(5)
@pytest.mark.parametrize("name", WITH_POSITIONS)
def test_masked_arrays_and_what_is_no_number(name: str) -> None:
    call = WITH_POSITIONS[name]
    assert "expected plain numbers, found a masked array" in refused(lambda: call(MASKED))
    for other in ("half", [1j, 0j], [None, 0.5], [[1.0], [1.0, 2.0]]):
        assert "expected real numbers, found" in refused(partial(call, other))


@pytest.mark.parametrize("name", [name for name in WITH_POSITIONS if "numbers" not in name and "fast" not in name])
def test_positions_that_are_not_finite(name: str) -> None:
    for value in (np.nan, np.inf):
        assert "expected finite numbers, found [" in refused(partial(WITH_POSITIONS[name], [0.5, value]))


@pytest.mark.parametrize("call", [analytic.fast_solver(PRESS), analytic.solver(scenes.load("class_iii"))])
def test_positions_that_are_not_finite_of_other_solvers(call: Callable[[Any], object]) -> None:
    assert refused(lambda: call([np.nan])) == "position: expected finite numbers, found [nan]"


def test_a_masked_array_of_an_engine(plug: Plug, reference: Any) -> None:
    """What is masked is no answer, whatever lies below the mask."""
    right = commanded(reference)
    plug(Motion({**right.samples, "P5.y": np.ma.masked_array(right["P5.y"], right["P5.y"] > -1.0)}))
    status, reason = compare.check(PRESS, ["stub"], SAMPLING.samples).verdicts["stub"]
    assert status == "crashed"
    assert "P5.y: expected plain numbers, found a masked array" in reason


@pytest.mark.parametrize(
    ("call", "line"),
    [
        (lambda: scenes.load(None), "scene: expected the name of a shipped one, or the path of a file, found None"),
        (lambda: scenes.load("four_bar", 3), "changes: expected values by path, as {'bodies.rod.mass': 2}, found 3"),
        (lambda: analytic.solve_many(PRESS, ROD, [0.5]), "changes: expected values by path"),
        (lambda: analytic.derivatives(PRESS, ROD[0], [0.5]), "numbers: expected several names, as ['bodies.rod.mass']"),
        (lambda: analytic.derivatives(PRESS, ["bodies.rod.mas"], [0.5]), "did you mean 'bodies.rod.mass'?"),
        (lambda: analytic.reduce_many(PRESS, MANY, [0.5], [analytic.Extremes("P5.z", 2)]), "did you mean 'P5."),
        (lambda: analytic.reduce_many(PRESS, MANY, [0.5], analytic.Extremes("P5.y")), "reductions: expected several"),
        (lambda: analytic.reduce_many(PRESS, MANY, [0.5], ["P5.y"]), "reductions: expected several"),
        (lambda: analytic.solve(PRESS, 0.5), "position, time: expected the shape (n,)"),
        (
            lambda: analytic.derivatives(PRESS, ROD, [[0.5]]),
            "position, time: expected the shape (n,) of both, found (1, 1)",
        ),
        (lambda: analytic.solve(PRESS, np.zeros(4), np.zeros(3)), "expected the shape"),
        (lambda: analytic.solve(PRESS, np.zeros((3, 4))), "expected the shape"),
        (lambda: analytic.solve_many(PRESS, MANY, 0.5), "position: expected the shape (1,)"),
        (lambda: analytic.solve_many(PRESS, MANY, np.zeros((3, 4))), "expected the shape"),
        (lambda: analytic.solve_many(PRESS, MANY, np.zeros(4), np.zeros(3)), "expected the shape"),
        (lambda: analytic.fast_solver(PRESS)(0.5), "expected the shape"),
        (lambda: analytic.derivatives(PRESS, ROD, np.zeros(4), 0.1), "expected the shape"),
        (lambda: analytic.check_way(PRESS), "solver: expected what analytic.solver(...) returns"),
        (lambda: compare.check(None), "scene: expected the name of a shipped one, or the path of a file, found None"),
        (lambda: compare.check("four_bar", "exudyn"), "engines: expected several names, as ['exudyn'], found 'exudyn'"),
        (lambda: compare.check("four_bar", ["exudin"]), "no engine 'exudin'; did you mean 'exudyn'?"),
        (lambda: compare.check("four_bar", samples="72"), "samples: expected a whole number, found '72'"),
        (lambda: compare.check("four_bar", samples=72.0), "samples: expected a whole number, found 72.0"),
        (lambda: compare.check("four_bar", samples=3), "samples: expected a whole number from 8 to 100000, found '3'"),
        (lambda: compare.check("four_bar", turns=True), "turns: expected a whole number, found True"),
        (lambda: compare.check("four_bar", accuracy=None), "accuracy: expected fast, balanced, exact or a relative"),
        (lambda: compare.vary("four_bar", 3), "variation: expected several names, found (3,)"),
        (lambda: compare.vary("four_bar", "drive.sped=1:2:3"), "did you mean 'speed'?"),
        (lambda: compare.vary("four_bar", "drive.speed=1:2:3", engines="exudyn"), "engines: expected several names"),
        (lambda: compare.vary(PRESS, "drive.speed=1:2:3"), "scene: expected the name of a shipped one"),
    ],
)
def test_other_arguments(call: Callable[[], object], line: str) -> None:
    assert line in refused(call)


NO_NUMBERS: dict[str, Any] = {
    "an array": np.zeros(3),
    "a list": [1.0, 2.0],
    "pairs": [("bodies.rod.mass", 1.0)],
    "beyond doubles": 10**400,
    "without a text": 10**5000,
    "none": None,
    "a truth value": True,
    "complex": 1j,
    "an object": object(),
}
WHERE_ONE_IS_MEANT: dict[str, Call] = {
    "off": lambda value: analytic.enclose(PRESS, {"P5.y"}, off={"bodies.rod.mass": value}),
    "accuracy": lambda value: analytic.enclose(PRESS, {"P5.y"}, accuracy=value),
    "Grid's first": lambda value: analytic.Grid(value, 1.0, 3),
    "Grid's last": lambda value: analytic.Grid(0.0, value, 3),
    "Grid's count": lambda value: analytic.Grid(0.0, 1.0, value),
    "Extremes' machines": lambda value: analytic.Extremes("P5.y", value),
    "Extremes' channel": lambda value: analytic.Extremes(value),
    "Integral's machines": lambda value: analytic.Integral("P5.y", value),
    "a reduction": lambda value: analytic.reduce_many(PRESS, MANY, [0.5], [value]),
    "a change": lambda value: scenes.load("toggle_press", {"bodies.rod.mass": value}),
    "samples": lambda value: compare.check("four_bar", samples=value),
}
WHERE_A_TABLE_IS_MEANT: dict[str, Call] = {
    "off": lambda value: analytic.enclose(PRESS, {"P5.y"}, off=value),
    "changes": lambda value: scenes.load("toggle_press", value),
    "changes of many": lambda value: analytic.reduce_many(PRESS, value, [0.5], [analytic.Extremes("P5.y")]),
}


@pytest.mark.parametrize("where", WHERE_ONE_IS_MEANT)
@pytest.mark.parametrize("name", NO_NUMBERS)
def test_what_is_no_single_number(where: str, name: str) -> None:
    assert "expected" in refused(lambda: WHERE_ONE_IS_MEANT[where](NO_NUMBERS[name]))


@pytest.mark.parametrize("where", WHERE_A_TABLE_IS_MEANT)
@pytest.mark.parametrize("name", sorted(NO_NUMBERS.keys() - {"none"}))
def test_what_is_no_table(where: str, name: str) -> None:
    assert "by path, as {'bodies.rod.mass'" in refused(lambda: WHERE_A_TABLE_IS_MEANT[where](NO_NUMBERS[name]))


def test_reductions_of_another_number_of_machines() -> None:
    line = refused(lambda: analytic.reduce_many(PRESS, MANY, [0.5], [analytic.Extremes("P5.y")]))
    assert line == "reductions: expected Extremes('P5.y', 2), found 1"
    assert "edges: expected two numbers" in refused(lambda: analytic.Histogram("P5.y", [1.0, 0.0]))
    assert "position: expected a number" in refused(lambda: analytic.assemblies(PRESS, [0.1, 0.2]))


def test_numbers_of_numpy_and_exact_ones_are_numbers() -> None:
    assert compare.check("four_bar", ("analytic",), samples=np.int64(24)).ok
    assert analytic.solve(PRESS, [Fraction(1, 2)])["P5.y"] == analytic.solve(PRESS, [0.5])["P5.y"]

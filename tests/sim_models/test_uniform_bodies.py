"""What every model takes for the mass properties of a uniform body, against integrals over its shape."""

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from itertools import combinations
from typing import Any, TypeAlias

import pytest
from scipy.integrate import dblquad, quad

import compare
from compare.mechanics.bodies import first_point, rule, weights
from scenes import Scene
from scenes.scene import Body, DrawnBody
from tests import scene_files
from tests.comparisons import SLOW

MASS = 3.0
Properties: TypeAlias = tuple[complex, float]  # centre of mass in the body's frame, m, and inertia about it, kg m^2

# By what a shape is called: the corners in the body's frame, mm, and what the file has of them.
POINT = {"B": 0 + 0j}
BAR = {"A": 20 + 10j, "C": 320 - 390j}
PLATE = {"A": 20 + 10j, "B": 320 - 390j, "C": -150 + 60j}
ON_BAR = {"A": BAR["A"], "B": BAR["A"] + 0.3 * (BAR["C"] - BAR["A"]), "C": BAR["C"]}
MANY = {"D": ON_BAR["B"], **BAR, "E": (BAR["A"] + BAR["C"]) / 2}
SHAPES = {
    "point mass at B": (POINT, POINT, False),
    "uniform bar from A to C": (BAR, BAR, False),
    "three pins on a bar": (BAR, ON_BAR, False),
    "four pins on a bar": (BAR, MANY, False),
    "three pins on a bar by lengths": (BAR, ON_BAR, True),
    "uniform triangular plate A, B, C": (PLATE, PLATE, False),
    "a plate by lengths": (PLATE, PLATE, True),
}


def scene_of(shape: str) -> tuple[Scene, Mapping[str, complex]]:
    """Return a scene with the shape as its one body, and where its corners are in the frame of that body, m."""
    corners, points, by_lengths = SHAPES[shape]
    own: dict[str, Any] = {"points": {point: [z.real, z.imag] for point, z in points.items()}}
    if by_lengths:
        own = {"lengths": {f"{p}-{q}": abs(points[p] - points[q]) for p, q in combinations(points, 2)}}
        first, second, *_ = points.values()
        corners = {p: (z - first) * abs(second - first) / (second - first) for p, z in corners.items()}
    names = [point for point in points if point != "A"]
    changes: scene_files.Changes = {
        "sketch": {p: [points[p].real, points[p].imag] for p in names},
        "output.point": names[0],
    }
    changes |= {"bodies.lever": {**own, "mass": MASS}}
    if shape.startswith("point"):
        slide = {"through": [0, 0], "along": [1, 0]}
        drive = {"body": "lever", "speed": 1, "start": 0, "end": 9}
        changes |= {"bodies.lever.slides": slide, "drive": drive, "units.speed": "mm/s", "sketch.displacement": 0}
    return scene_files.load("lever", changes), {p: 1e-3 * z for p, z in corners.items()}


def integrated(corners: Mapping[str, complex]) -> Properties:
    """Return centre and inertia by integrals of 1, x, y and the square of the distance over the shape."""
    first, *others = corners.values()
    arms = [z - first for z in others]

    def mean(of: Callable[[complex], float]) -> float:
        """Return the mean of a function of the place over the points, the bar or the triangle."""
        if not arms:
            return of(first)
        if len(arms) == 1:
            return float(quad(lambda s: of(first + s * arms[0]), 0, 1)[0])
        return float(2 * dblquad(lambda t, s: of(first + s * arms[0] + t * arms[1]), 0, 1, 0, lambda s: 1 - s)[0])

    com = complex(mean(lambda z: z.real), mean(lambda z: z.imag))
    return com, MASS * mean(lambda z: abs(z - com) ** 2)


def by(module: str, name: str, scene: Scene, body: Body) -> Properties:
    """Return the properties by a model's own function."""
    own = getattr(import_module(module), name)(scene, body)
    return complex(*own.com) if isinstance(own.com, tuple) else complex(own.com), float(own.inertia)


def by_multiprecision(scene: Scene, body: Body) -> Properties:
    pytest.importorskip("flint")
    from sim_models.multiprecision.bodies import local_points, weight

    _, com, inertia = weight(body, local_points(scene, body))
    return complex(com), float(inertia)


def by_judge(scene: Scene, body: Body) -> Properties:
    own = weights(scene, body)
    return own.com + first_point(body), own.inertia


MODELS = (
    *(partial(by, f"sim_models.{name}.bodies", of) for name, of in (("exudyn", "rigid_body"), ("pymunk", "rigid"))),
    partial(by, "sim_models.coordinates.bodies", "framed_body"),  # CasADi's, MuJoCo's and Pinocchio's
    partial(by, "analytic.core.geometry", "rigid_body"),
    by_multiprecision,
    by_judge,
)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("shape", SHAPES)
def test_a_uniform_body_has_the_integrals_over_its_shape(
    shape: str, model: Callable[[Scene, Body], Properties]
) -> None:
    scene, corners = scene_of(shape)
    com, inertia = model(scene, scene.bodies["lever"])
    place, about = integrated(corners)
    assert abs(com - place) <= 1e-14  # m: roundings, of 0.5 m
    assert abs(inertia - about) <= 1e-14  # kg m^2: roundings, of 0.1


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", ["crank", "coupler", "rocker"])
def test_a_body_as_drawn_weighs_the_same_in_every_model(name: str, model: Callable[[Scene, Body], Properties]) -> None:
    """By the sums along the outline, and by the 50 digits' triangles, of which those of an L are negative too."""
    scene = scene_files.load("outlined")
    body = scene.bodies[name]
    assert isinstance(body, DrawnBody)
    com, inertia = model(scene, body)
    assert abs(com - complex(*body.com)) <= 1e-15  # m: roundings, of 0.1 m
    assert inertia == pytest.approx(body.inertia, rel=1e-14)


@SLOW
def test_engines_agree_on_bodies_as_drawn() -> None:
    result = compare.check(scene_files.load("outlined"), ("exudyn", "pymunk", "multiprecision"), samples=24)
    assert result.ok, result.verdicts
    assert result.masses["taken as"].to_list() == [
        "bar from A to B, 40 mm wide, 12 mm thick, 7850 kg/m^3",
        "outline of 8 corners, 8 mm thick, 2700 kg/m^3",
        "outline of 5 corners, 10 mm thick, 7850 kg/m^3",
    ]


@pytest.mark.parametrize("shape", [shape for shape in SHAPES if shape.split()[0] in ("point", "uniform")])
def test_the_rule_is_named(shape: str) -> None:
    scene, _ = scene_of(shape)
    assert rule(scene, scene.bodies["lever"]) == shape


def test_what_is_given_is_named_so() -> None:
    scene = scene_files.load("lever", {"bodies.lever.com": [500, 1], "bodies.lever.inertia": 7.0})
    assert rule(scene, scene.bodies["lever"]) == "as given"
    assert by_judge(scene, scene.bodies["lever"]) == (0.5 + 0.001j, 7e-6)

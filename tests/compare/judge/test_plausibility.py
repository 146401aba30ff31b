"""Unlikely numbers are named, each with its unit; numbers of machines are not."""

import pytest

import scenes
from compare import check
from compare.engines import registry
from compare.judge.plausibility import implausible
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.reference import Floor, Reference
from tests import scene_files
from tests.comparisons import sampled

PIN = {"at": "B", "radius": 10, "coefficient": 0.1}
PUSHES = {"body": "coupler", "at": "T", "along": [1, 0], "over": "drive"}
# What is changed in the four-bar of 100, 200, 250 and 250 mm, whose coupler has a third point at 500 mm; the sentence.
UNLIKELY: dict[str, tuple[scene_files.Changes, str]] = {
    "mm in gravity": ({"gravity": [0, -9810]}, "gravity is 9810 m/s^2, and 9.81 on Earth"),
    "weak gravity": ({"gravity": [0, -0.00981]}, "gravity is 0.00981 m/s^2"),
    "upwards": ({"gravity": [0, 9.81]}, "gravity points upwards, [0, 9.81]"),
    "slippery": ({"friction": [PIN | {"coefficient": 15}]}, "the coefficient of friction at B is 15;"),
    "thick pin": (
        {"friction": [PIN | {"radius": 126}]},
        "the pin at B has a radius of 126 mm, and rocker a length of 250",
    ),
    "com in the ground's frame": (
        {"bodies.rocker": {"lengths": {"C-B": 250}, "mass": 1, "com": [700, 30], "inertia": 100}},
        "the centre of mass of rocker is 451 mm off its points, which are 250 mm apart at most",
    ),
    "inertia too large": (
        {"bodies.coupler.inertia": 6e6},
        "radius of gyration of coupler is 1549 mm, and its points are 500 mm apart at most: 'inertia' is in kg mm^2",
    ),
    "mm taken for m": ({"units.length": "km"}, "the largest length is 500 km, 5e+05 m"),
    "mm taken for um": ({"units.length": "nm"}, "the largest length is 500 nm, 5e-07 m"),
    "helping": (
        {"loads": [PUSHES | {"table": [[0, -40], [90, -40], [180, 40], [270, 40], [360, -40]], "periodic": True}]},
        "the table of loads.0 gives coupler ",
    ),
}
# Just within the bounds, or no numbers of these kinds.
LIKELY: dict[str, scene_files.Changes] = {
    "none": {"gravity": [0, 0]},
    "moon": {"gravity": [0.05, -0.1]},
    "sideways": {"gravity": [9.81, 0]},
    "rubber": {"friction": [PIN | {"coefficient": 1}]},
    "half a bar": {"friction": [PIN | {"radius": 125}]},
    "eccentric": {"friction": [PIN | {"at": "A", "radius": 100}]},
    "lead on a lever": {"bodies.rocker": {"lengths": {"C-B": 250}, "mass": 1, "com": [480, 30], "inertia": 100}},
    "flywheel": {"bodies.coupler.inertia": 5.6e6},
    "no mass, some inertia": {"bodies.coupler.mass": 0, "bodies.coupler.inertia": 1e6},
    "crane": {"units.length": "dm"},
    "resisting": {
        "loads": [PUSHES | {"table": [[0, 40], [90, 40], [180, -40], [270, -40], [360, 40]], "periodic": True}]
    },
    "no work in all": {"loads": [PUSHES | {"table": [[0, 40], [360, 40]], "periodic": True}]},
}


def sentences(name: str, changes: scene_files.Changes = scene_files.NONE) -> list[str]:
    scene = scene_files.load(name, changes)
    solve = registry.reference(scene, frozenset(scene.channels.names()))
    return [*implausible(Reference(Mechanics(scene), solve, 0.0, {}, {}, Floor({}, "")))]


@sampled(4)
@pytest.mark.parametrize("case", UNLIKELY)
def test_an_unlikely_number_is_one_sentence(case: str) -> None:
    changes, expected = UNLIKELY[case]
    (sentence,) = sentences("four_bar", changes)
    assert expected in sentence


@pytest.mark.parametrize("case", LIKELY)
def test_a_likely_number_is_none(case: str) -> None:
    assert not sentences("four_bar", LIKELY[case])


@sampled(8)
@pytest.mark.parametrize("name", scenes.shipped())
def test_of_shipped_scenes_the_engine_is_driven_by_its_gas(name: str) -> None:
    """Its indicator diagram gives work, which is what an engine is for; nothing else is unlikely in any."""
    engine = ["the table of loads.0 gives piston 4.34 times the work that it takes: it helps the motion"]
    assert [line.partition(", as")[0] for line in sentences(name)] == engine * (name == "four_stroke_engine")


def test_a_body_with_a_guide_may_be_longer_than_between_its_points() -> None:
    assert not sentences("lift")  # its table's centre is 500 mm off two points that are 100 mm apart


def test_the_result_has_the_sentences_and_is_ok() -> None:
    result = check(scene_files.load("slider_crank", {"gravity": [0, 9.81]}), engines=("analytic",), samples=24)
    assert sum("gravity points upwards" in reason for reason in result.reasons) == 1
    assert "gravity points upwards" in result._repr_html_()
    assert result.ok

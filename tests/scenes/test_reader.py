"""The scene file: what is read, and numbers that are changed before it is checked."""

import re
from math import pi
from pathlib import Path

import pytest

import scenes
from compare.measure.hard.digits import inputs_off
from compare.mechanics.mechanics import inputs
from scenes import InputError
from scenes.scene import ConstantSpeed, Force
from tests import scene_files


def speed_of(scene: scenes.Scene) -> float:
    assert isinstance(scene.drive.law, ConstantSpeed)
    return scene.drive.law.speed


def force_of(scene: scenes.Scene) -> tuple[float, float]:
    (load,) = scene.loads
    assert isinstance(load, Force)
    return load.force


def test_numbers_arrive_in_si(toggle_press: scenes.Scene) -> None:
    assert speed_of(toggle_press) == pytest.approx(2 * pi, rel=1e-15)
    assert toggle_press.ground["P1"] == pytest.approx((0.404709, -0.217661), rel=1e-15)
    assert force_of(toggle_press) == pytest.approx((0.0, 1e5), rel=1e-15)
    lengths = toggle_press.bodies["toggle"].lengths
    assert lengths is not None
    assert lengths[frozenset(("P4", "P2"))] == pytest.approx(0.76, rel=1e-15)


def test_pins_are_named_by_file_order(toggle_press: scenes.Scene) -> None:
    pins = [f"{pin.channel}: {pin.first}-{pin.second}" for pin in toggle_press.pins]
    to_ground, others = ["O: ground-rocker", "P1: ground-crank"], ["P2: crank-toggle", "P3: rocker-toggle"]
    assert sorted(pins) == [*to_ground, *others, "P4: toggle-rod", "P5: rod-slider"]


def test_units_are_free(toggle_press: scenes.Scene) -> None:
    scene = scenes.load("toggle_press", {"units.length": "um", "units.force": "MN"})
    assert scene.file == "toggle_press, units.length = um, units.force = MN"
    assert scene.ground["P1"][0] == pytest.approx(1e-3 * toggle_press.ground["P1"][0], rel=1e-15)
    assert force_of(scene)[1] == pytest.approx(1e3 * force_of(toggle_press)[1], rel=1e-15)


def test_a_body_of_many_points_needs_a_centre_of_mass_with_a_mass_alone() -> None:
    kinematic = scene_files.without_masses("driven_toggle")
    plate = max(scene_files.load("driven_toggle", kinematic).bodies.values(), key=lambda body: len(body.points))
    assert len(plate.points) > 3
    assert plate.mass is None
    with pytest.raises(InputError, match=rf"bodies\.{plate.name}: expected 'com' and 'inertia', since it has a mass"):
        scene_files.load("driven_toggle", {f"bodies.{plate.name}.{what}": None for what in ("com", "inertia")})


def test_tolerances_are_of_engines_from_outside_too() -> None:
    """Their names have marks that no body's has, and where another has it as well, their distribution's."""
    held = {"2nd-order.fast@acme-engines": {"position": 1e-3}}
    assert scene_files.load("four_bar", {"tolerances": held}).tolerances == held


def test_points_may_have_the_names_of_fields(tmp_path: Path, toggle_press: scenes.Scene) -> None:
    """Their numbers are the same, and as many go into the solution."""
    text, names = scene_files.text("toggle_press"), {"P1": "start", "P2": "forces", "P3": "com", "P4": "positions"}
    for old, new in names.items():
        text = re.sub(rf"\b{old}\b", new, text)
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    scene = scenes.load(tmp_path / "a.toml")
    assert [number.value for number in scene.numbers.values()] == [n.value for n in toggle_press.numbers.values()]
    assert [one.value for one in inputs(scene)] == [one.value for one in inputs(toggle_press)]
    assert len([*inputs_off(scene)]) == len([*inputs_off(toggle_press)])


def test_a_number_is_changed_in_the_units_of_the_file() -> None:
    changes = {"bodies.rocker.lengths.P3-O": 310.0, "drive.speed": -30.0, "bodies.crank.points.P2.0": 80.0}
    scene = scenes.load("toggle_press", changes)
    lengths, points = scene.bodies["rocker"].lengths, scene.bodies["crank"].local
    assert lengths is not None
    assert points is not None
    assert lengths[frozenset(("O", "P3"))] == pytest.approx(0.31, rel=1e-15)
    assert points["P2"] == pytest.approx((0.08, 0.0), rel=1e-15)
    assert speed_of(scene) == pytest.approx(-pi, rel=1e-15)
    assert force_of(scenes.load("toggle_press", {"loads.0.force.1": 7.0})) == pytest.approx((0.0, 7e3), rel=1e-15)


def test_numbers_as_the_file_has_them() -> None:
    paths = ["bodies.rocker.lengths.P3-O", "ground.points.P1.1", "drive.start", "loads.0.force.1"]
    assert scenes.numbers_in("toggle_press", paths) == [300.0, -217.661, 0.0, 100.0]


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("bodies.roker.mass", ["'roker'", "did you mean 'rocker'"]),
        ("bodies.rocker.lengths.O-P4", ["'O-P4'", "did you mean 'O-P3'"]),
        ("bodies.rocker", ["the path of a number", "lengths, mass"]),
        ("bodies.rocker.inertia", ["the file has no 'inertia'", "lengths, mass"]),
        ("name", ["the path of a number"]),
        ("loads.0.force", ["the path of a number", "0, 1"]),
        ("loads.1.force.0", ["the file has no '1'"]),
        ("drive.speed.0", ["goes on", "'0'"]),
        ("", ["the file has no ''", "drive"]),
    ],
)
def test_a_path_to_no_number_is_one_line(path: str, expected: list[str]) -> None:
    for read in (lambda: scenes.numbers_in("toggle_press", [path]), lambda: scenes.load("toggle_press", {path: 1.0})):
        line = scene_files.refused(read)
        assert line.startswith("toggle_press")
        for part in (f": {path}: ", *expected):
            assert part in line


def test_a_number_named_twice() -> None:
    with pytest.raises(InputError, match=r"P3-O: expected each number once"):
        scenes.numbers_in("toggle_press", ["bodies.rocker.lengths.O-P3", "bodies.rocker.lengths.P3-O"])

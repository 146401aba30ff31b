"""The scene file: what is read, and what every slip of a user is told."""

from math import pi
from pathlib import Path

import pytest

import scenes
from scenes import InputError

from .conftest import TOGGLE_PRESS, SceneFrom


def test_numbers_arrive_in_si(toggle_press: scenes.Scene) -> None:
    assert toggle_press.drive.speed == pytest.approx(2 * pi, rel=1e-15)
    assert toggle_press.ground["P1"] == pytest.approx((0.404709, -0.217661), rel=1e-15)
    assert toggle_press.loads[0].force == pytest.approx((0.0, 1e5), rel=1e-15)
    lengths = toggle_press.bodies["toggle"].lengths
    assert lengths is not None
    assert lengths[frozenset(("P4", "P2"))] == pytest.approx(0.76, rel=1e-15)


def test_pins_are_named_by_file_order(toggle_press: scenes.Scene) -> None:
    pairs = {pin.channel: (pin.first, pin.second) for pin in toggle_press.pins}
    assert pairs == {
        "O": ("ground", "rocker"),
        "P1": ("ground", "crank"),
        "P2": ("crank", "toggle"),
        "P3": ("rocker", "toggle"),
        "P4": ("toggle", "rod"),
        "P5": ("rod", "slider"),
    }


def test_units_are_free(scene_from: SceneFrom, toggle_press: scenes.Scene) -> None:
    metres = TOGGLE_PRESS.replace('length = "mm"', 'length = "um"').replace('force = "kN"', 'force = "MN"')
    scene = scene_from(metres)
    assert scene.ground["P1"][0] == pytest.approx(1e-3 * toggle_press.ground["P1"][0], rel=1e-15)
    assert scene.loads[0].force[1] == pytest.approx(1e3 * toggle_press.loads[0].force[1], rel=1e-15)


# (what is replaced, by what, what the one line must say); each is one slip in the shipped scene
SLIPS = {
    "broken TOML": ("[drive]", "[drive", ["not valid TOML", "line"]),
    "unknown key": ("mass = 40", "mas = 40", ["bodies.rocker.mas", "unknown key", "'mass'"]),
    "unknown table": ("[drive]", "[drives]", ["drives", "unknown key", "'drive'"]),
    "missing table": ('[output]\nslider = "P5"', "", ["output", "missing"]),
    "unknown unit": ('length = "mm"', 'length = "mmm"', ["units.length", "'mmm'", "'mm'"]),
    "unit of another quantity": ('length = "mm"', 'length = "kg"', ["units.length", "'kg'"]),
    "nonsense unit": ('length = "mm"', 'length = "5 * (("', ["units.length"]),
    "wrong type": ("mass = 40", 'mass = "40"', ["bodies.rocker.mass", "number", "'40'"]),
    "truth as a number": ("mass = 40", "mass = true", ["bodies.rocker.mass", "number"]),
    "one coordinate": ("P2 = [480, -202]", "P2 = [480]", ["sketch.P2", "two numbers"]),
    "negative mass": ("mass = 40", "mass = -40", ["bodies.rocker.mass", "greater than or equal to 0", "-40"]),
    "NaN mass": ("mass = 40", "mass = nan", ["bodies.rocker.mass", "finite"]),
    "infinite mass": ("mass = 40", "mass = inf", ["bodies.rocker.mass", "finite"]),
    "negative length": ('"O-P3" = 300', '"O-P3" = -300', ["bodies.rocker.lengths.O-P3", "greater than 0"]),
    "zero length": ('"O-P3" = 300', '"O-P3" = 0', ["bodies.rocker.lengths.O-P3", "greater than 0"]),
    "NaN length": ('"O-P3" = 300', '"O-P3" = nan', ["bodies.rocker.lengths.O-P3", "finite"]),
    "not a pair": ('"O-P3" = 300', '"OP3" = 300', ["bodies.rocker.lengths.OP3", "'-'"]),
    "length to itself": ('"O-P3" = 300', '"P3-P3" = 300', ["bodies.rocker.lengths", "different points"]),
    "length given twice": ('"O-P3" = 300', '"O-P3" = 300, "P3-O" = 301', ["bodies.rocker.lengths", "twice"]),
    "missing length": (', "P2-P4" = 760', "", ["bodies.toggle.lengths", "'P2-P4'"]),
    "triangle cannot close": ('"P2-P4" = 760', '"P2-P4" = 981', ["bodies.toggle.lengths", "cannot close", "0.981"]),
    "coincident points": ("P2 = [77, 0] }", "P2 = [0, 0] }", ["bodies.crank.points", "P1 and P2"]),
    "both ways": (
        'lengths = { "O-P3" = 300 }',
        'lengths = { "O-P3" = 300 }\npoints = { O = [0, 0] }',
        ["bodies.rocker"],
    ),
    "com alone": ("mass = 40", "mass = 40\ncom = [1, 0]", ["bodies.rocker", "'com' and 'inertia'"]),
    "hangs on nothing": ('"O-P3" = 300', '"A-B" = 300', ["bodies.rocker", "hangs on nothing"]),
    "too many bodies": (
        "[drive]",
        '[bodies.extra]\nlengths = { "P4-Z" = 1 }\nmass = 1\n[drive]',
        ["under-constrained"],
    ),
    "too few freedoms": (
        "[drive]",
        '[bodies.extra]\nlengths = { "P4-O" = 1 }\nmass = 1\n[drive]',
        ["over-constrained", "= 0"],
    ),
    "no such body to drive": ('body = "crank"', 'body = "krank"', ["drive.body", "'krank'", "'crank'"]),
    "driven slider": ('body = "crank"', 'body = "slider"', ["drive.body", "slides"]),
    "driven coupler": ('body = "crank"', 'body = "rod"', ["drive.body", "0 points on the ground"]),
    "standstill": ("speed = 60", "speed = 0", ["drive.speed", "zero"]),
    "load on no body": ('body = "slider"', 'body = "slidre"', ["loads.0.body", "'slider'"]),
    "load at no point": ('at = "P5"', 'at = "P4"', ["loads.0.at", "'P4'", "P5"]),
    "no direction": ("along = [0, 1]", "along = [0, 0]", ["bodies.slider.slides.along", "direction"]),
    "missing sketch": ("P3 = [0, -300]\n", "", ["sketch.P3", "missing"]),
    "sketch of no point": ("P3 = [0, -300]\n", "P3 = [0, -300]\nP9 = [0, 0]\n", ["sketch.P9", "P5"]),
    "output nowhere": ('slider = "P5"', 'slider = "P6"', ["output.slider", "'P6'", "P5"]),
    "output does not slide": ('slider = "P5"', 'slider = "P4"', ["output.slider", "not on a body that slides"]),
    "one mass missing": ("mass = 40", "", ["bodies.rocker.mass", "missing"]),
    "taken name": ("[bodies.rod]", "[bodies.drive]", ["bodies.drive", "taken"]),
    "huge mass": ("mass = 40", "mass = 1e300", ["bodies.rocker.mass", "1e-15 to 1e+15", "1e+300"]),
    "tiny length": ('"O-P3" = 300', '"O-P3" = 1e-300', ["bodies.rocker.lengths.O-P3", "1e-15"]),
    "huge speed": ("speed = 60", "speed = 1e200", ["drive.speed", "1e+15"]),
    "overflow": ('length = "mm"', 'length = "Ym"', ["bodies.rocker.lengths.O-P3", "1e+15"]),
    "odd name": ("[bodies.rod]", '[bodies."the rod"]', ["bodies.the rod", "not a name"]),
    "another format": ("format = 1", "format = 2", ["format", "1", "2"]),
    "unknown tolerance": ("torque = 1e-6", "torqe = 1e-6", ["tolerances.exudyn.torqe", "'torque'"]),
}


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_one_line(slip: str, tmp_path: Path) -> None:
    old, new, expected = SLIPS[slip]
    assert old in TOGGLE_PRESS, "the slip no longer matches the shipped scene"
    file = tmp_path / "mine.toml"
    file.write_text(TOGGLE_PRESS.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        scenes.load(file)
    line = str(caught.value)
    assert line.startswith(f"{file}: ")
    assert "\n" not in line
    for part in expected:
        assert part in line


@pytest.mark.parametrize("name", ["toggle_pres", "no/such/file.toml", ".", "", "\0"])
def test_a_file_that_cannot_be_read(name: str) -> None:
    with pytest.raises(InputError) as caught:
        scenes.load(name)
    assert "\n" not in str(caught.value)


def test_the_nearest_scene_is_named() -> None:
    with pytest.raises(InputError, match="did you mean 'toggle_press'"):
        scenes.load("toggle_pres")


def test_not_text(tmp_path: Path) -> None:
    file = tmp_path / "binary.toml"
    file.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="text file"):
        scenes.load(file)

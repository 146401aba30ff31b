"""Every slip of a user in a scene file is refused in one line, which names the place and what was expected."""

from pathlib import Path

import pytest

import scenes
from scenes import InputError
from tests import scene_files

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
    "missing length": (
        ', "P2-P4" = 760',
        "",
        ["bodies.toggle.lengths", "P4", "two of the points before it", "'P3-P4'"],
    ),
    "triangle cannot close": (
        '"P2-P4" = 760',
        '"P2-P4" = 981',
        ["bodies.toggle.lengths", "cannot close", "981 mm against 980 mm"],
    ),
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
    "driven slider": (
        'body = "crank"',
        'body = "slider"',
        ["drive.body: 'slider' slides on the ground, and units.speed, 'rpm', is of a crank", "mm/s"],
    ),
    "driven coupler": ('body = "crank"', 'body = "rod"', ["drive.body", "0 points on the ground"]),
    "standstill": ("speed = 60", "speed = 0", ["drive.speed", "zero"]),
    "load on no body": ('body = "slider"', 'body = "slidre"', ["loads.0.body", "'slider'"]),
    "load at no point": ('at = "P5"', 'at = "P4"', ["loads.0.at", "'P4'", "P5"]),
    "no direction": ("along = [0, 1]", "along = [0, 0]", ["bodies.slider.slides.along", "direction"]),
    "missing sketch": ("P3 = [0, -300]\n", "", ["sketch.P3", "missing"]),
    "sketch of no point": ("P3 = [0, -300]\n", "P3 = [0, -300]\nP9 = [0, 0]\n", ["sketch.P9", "P5"]),
    "output nowhere": ('slider = "P5"', 'slider = "P6"', ["output.slider", "'P6'", "P5"]),
    "output does not slide": (
        'slider = "P5"',
        'slider = "P4"',
        ["output.slider", "no body that slides on the ground", "point"],
    ),
    "one mass missing": ("mass = 40", "", ["bodies.rocker.mass", "missing"]),
    "taken name": ("[bodies.rod]", "[bodies.drive]", ["bodies.drive", "taken"]),
    "huge mass": ("mass = 40", "mass = 1e300", ["bodies.rocker.mass", "1e-15 to 1e+15 kg, found 1e+300"]),
    "tiny length": (
        '"O-P3" = 300',
        '"O-P3" = 1e-300',
        ["bodies.rocker.lengths.O-P3", "1e-12 to 1e+18 mm, found 1e-300"],
    ),
    "huge speed": ("speed = 60", "speed = 1e200", ["drive.speed", "to 9.5e+15 rpm, found 1e+200"]),
    "overflow": ('length = "mm"', 'length = "Ym"', ["bodies.rocker.lengths.O-P3", "to 1e-09 Ym, found 300"]),
    "odd name": ("[bodies.rod]", '[bodies."the rod"]', ["bodies.the rod", "not a name"]),
    "another format": ("format = 1", "format = 2", ["format", "1", "2"]),
    "turns a second": ('speed = "rpm"', 'speed = "Hz"', ["units.speed: 'Hz' is not a known unit of speed", "rpm"]),
    "a speed of nothing": ('speed = "rpm"', 'speed = "kg"', ["units.speed: 'kg' is not a known unit of speed", "rpm"]),
    "tolerance of another drive": ("torque = 1e-6", "force = 1e-6", ["tolerances.exudyn.force: expected 'torque'"]),
    "variation of no number": (
        'P1.0"\nplus_minus',
        'P1"\nplus_minus',
        ["variations.0.path: ground.points.P1: expected the path of a number"],
    ),
    "variation of a misspelt number": (
        'path = "bodies.rocker.lengths.O-P3"',
        'path = "bodies.rocker.lengths.O-P"',
        ["variations.3.path: bodies.rocker.lengths.O-P: the file has no 'O-P' there", "did you mean 'O-P3'?"],
    ),
    "variation of the sketch": (
        'path = "ground.points.P1.0"',
        'path = "sketch.P2.0"',
        ["variations.0.path: sketch.P2.0: expected a number of the linkage; one of bodies, drive.speed,"],
    ),
    "variation of one number twice": (
        'path = "ground.points.P1.1"',
        'path = "ground.points.P1.0"',
        ["variations.1.path: ground.points.P1.0: expected each number once"],
    ),
    "variation the other way round": (
        'path = "bodies.toggle.lengths.P2-P3"',
        'path = "bodies.rocker.lengths.P3-O"',
        ["variations.4.path: bodies.rocker.lengths.P3-O: expected each number once"],
    ),
    "variation beyond all numbers": (
        "plus_minus = 0.05",
        "plus_minus = 1e300",
        ["variations.0.plus_minus: expected 1e+45 at most, found 1e+300"],
    ),
    "point called angle": (
        "angle = 11.5",
        "angle = [480, -202]",
        ["sketch.angle: expected a number, since it is where the drive is; a point needs another name"],
    ),
    "point called displacement": (
        "angle = 11.5",
        "displacement = [480, -202]",
        ["sketch.displacement: expected a number, since it is where the drive is; a point needs another name"],
    ),
    "variation of nothing": ("plus_minus = 0.05", "plus_minus = 0", ["variations.0.plus_minus", "greater than 0"]),
    "unknown distribution": (
        'distribution = "uniform"',
        'distribution = "gauss"',
        ["variations.9.distribution: expected 'normal' or 'uniform', found 'gauss'"],
    ),
    "unknown tolerance": ("torque = 1e-6", "torqe = 1e-6", ["tolerances.exudyn.torqe", "'torque'"]),
}


# (mechanism, what is replaced, by what, what the one line must say)
_RING = """
[bodies.one]
points = { X = [0, 0] }
slides = { on = "other", through = [0, 0], along = [1, 0] }
[bodies.other]
points = { Y = [0, 0] }
slides = { on = "one", through = [0, 0], along = [1, 0] }
[drive]"""
_BETWEEN = '"ground.S", "plate.K"'
_TABLE = "table = [[500, 0], [700, 2000]]\n"
MECHANISM_SLIPS = {
    "slides on no body": ("shaper", '"rocker", thr', '"roker", thr', ["bodies.block.slides.on", "'rocker'"]),
    "slides on itself": ("shaper", '"rocker", thr', '"block", thr', ["bodies.block.slides.on", "block on block"]),
    "ring of slides": ("carried_block", "\n[drive]", _RING, ["bodies.one.slides.on", "one on other on one"]),
    "slides on who slides on no body": (
        "carried_block",
        "\n[drive]",
        _RING.replace('on = "one"', 'on = "on"'),
        ["bodies.other.slides.on", "'one'"],
    ),
    "unknown key of a slide": ("shaper", 'on = "rocker"', 'onn = "rocker"', ["bodies.block.slides.onn", "'on'"]),
    "times fall": ("swinging_law", "[0.5, 290]", "[0.1, 290]", ["drive.law.2.0", "increasing times", "0.1 s"]),
    "times stand still": ("swinging_law", "[0.5, 290]", "[0.2, 290]", ["drive.law.2.0", "increasing times"]),
    "law starts late": ("swinging_law", "[[0, 200]", "[[0.1, 200]", ["drive.law.0.0", "first time to be 0", "0.1 s"]),
    "more than ten turns": (
        "tangent",
        "end = 50",
        "end = -1e6",
        ["drive.end", "10 turns at most", "2778.14", "for ever"],
    ),
    "law of more than ten turns": ("turning_law", "360]]", "36000]]", ["drive.law", "10 turns at most", "found 103"]),
    "three rows": ("swinging_law", ", [0.7, 320], [1.0, 250], [1.2, 235]]", "]", ["drive.law", "4 or more", "found 3"]),
    "three columns": ("swinging_law", "[0.5, 290]", "[0.5, 290, 1]", ["drive.law.2", "two numbers"]),
    "one column": ("swinging_law", "[0.5, 290]", "[0.5]", ["drive.law.2", "two numbers"]),
    "law that rests": (
        "swinging_law",
        "[[0, 200], [0.2, 215], [0.5, 290], [0.7, 320], [1.0, 250], [1.2, 235]]",
        "[[0, 200], [0.2, 200], [0.5, 200], [0.7, 200]]",
        ["drive.law", "same position"],
    ),
    "law and speed": ("swinging_law", "law =", "speed = 60\nlaw =", ["drive", "either 'speed' or 'law'"]),
    "neither law nor speed": ("shaper", "speed = 60\n", "", ["drive", "either 'speed' or 'law'"]),
    "start with a law": ("swinging_law", "law =", "start = 60\nlaw =", ["drive.start", "expected none with a 'law'"]),
    "end with a law": ("swinging_law", "law =", "end = 60\nlaw =", ["drive.end", "expected none with a 'law'"]),
    "periodic without a law": (
        "shaper",
        "speed = 60",
        "speed = 60\nperiodic = true",
        ["drive.periodic", "'law'"],
    ),
    "period that does not close": (
        "turning_law",
        "[1.1, 360]",
        "[1.1, 350]",
        ["drive.law", "last position to be the first, or whole turns from it", "off by -10 deg"],
    ),
    "period that closes but for little": ("turning_law", "[1.1, 360]", "[1.1, 360.00002]", ["it is off by 2e-05 deg"]),
    "end behind the start": (
        "tangent",
        "end = 50",
        "end = 150",
        ["drive.end: expected a position below 'start', 130 deg, found 150 deg; or make speed positive"],
    ),
    "end behind a slider's start": (
        "driven_toggle",
        "speed = -150",
        "speed = 150",
        ["drive.end: expected a position above 'start', 100 mm, found -150 mm; or make speed negative"],
    ),
    "end at the start": (
        "tangent",
        "end = 50",
        "end = 130",
        ["drive.end: expected another position than 'start', 130.0"],
    ),
    "driven slider without end": ("driven_toggle", "end = -150\n", "", ["drive.end", "missing", "slider"]),
    "slider at a crank's speed": (
        "driven_toggle",
        '"mm/s"',
        '"rpm"',
        ["drive.body: 'crosshead' slides on the ground, and units.speed, 'rpm', is of a crank", "mm/s"],
    ),
    "crank at a slider's speed": (
        "shaper",
        '"rpm"',
        '"mm/s"',
        ["drive.body: 'crank' does not slide on the ground, and units.speed, 'mm/s', is of a slider", "rpm"],
    ),
    "driven by what a body carries": ("shaper", 'body = "crank"', 'body = "block"', ["drive.body", "'rocker'"]),
    "sketch at an angle": (
        "driven_toggle",
        "[sketch]\ndisplacement",
        "[sketch]\nangle",
        ["sketch.angle: expected 'displacement', since drive.body, 'crosshead', slides on the ground"],
    ),
    "sketch at no displacement": (
        "driven_toggle",
        "displacement = 100\n",
        "",
        ["sketch.displacement: missing", "drive.body, 'crosshead', slides on the ground"],
    ),
    "sketch at a displacement": (
        "shaper",
        "[sketch]\nangle",
        "[sketch]\ndisplacement",
        ["sketch.displacement: expected 'angle', since drive.body, 'crank', does not slide on the ground"],
    ),
    "sketch that shows no angle": ("swinging_block", "T = [570, 120]\n", "", ["sketch", "block and rod", "two points"]),
    "force and table": ("driven_toggle", "table = [[", "force = [1, 0]\ntable = [[", ["loads.0", "'force' or 'table'"]),
    "neither force nor table": ("driven_toggle", _TABLE, "", ["loads.0", "'force' or 'table'"]),
    "table in the last part": ("driven_toggle", "table = [[", "last = 3\ntable = [[", ["loads.0.last", "'force'"]),
    "table on no slider": ("driven_toggle", '"platen"\nat', '"link"\nat', ["loads.0.table", "slides", "'link'"]),
    "table falls": ("driven_toggle", "[700, 2000]]", "[500, 2000]]", ["loads.0.table", "increasing", "found 500 mm"]),
    "table of one row": ("driven_toggle", _TABLE, "table = [[500, 0]]\n", ["loads.0.table", "2 or more", "found 1"]),
    "last on no slider": ("shaper", '"ram"\nat = "E"', '"link"\nat = "E"', ["loads.0.last", "slides", "'link'"]),
    "last on who is carried": ("shaper", '"ram"\nat = "E"', '"block"\nat = "A"', ["loads.0.last", "'block'"]),
    "last on no body": ("shaper", '"ram"\nat = "E"', '"rma"\nat = "E"', ["loads.0.body", "'ram'"]),
    "last square to the guide": ("shaper", "[-500, 0]", "[0, 500]", ["loads.0.force", "along the guide"]),
    "last nothing": ("shaper", "last = 120", "last = 0", ["loads.0.last", "greater than 0"]),
    "spring on no body": ("driven_toggle", '"plate.K"', '"plat.K"', ["springs.0.between", "'plat'", "'plate'"]),
    "spring at no point": ("driven_toggle", '"plate.K"', '"plate.C"', ["springs.0.between", "'C'", "A, B, D, K"]),
    "spring at no ground point": ("driven_toggle", '"ground.S"', '"ground.T"', ["springs.0.between", "'T'", "A, S"]),
    "spring on one body": ("driven_toggle", '"ground.S"', '"plate.B"', ["springs.0.between", "two bodies", "plate"]),
    "spring at one point": ("driven_toggle", _BETWEEN, '"link.B", "plate.B"', ["springs.0.between", "same point"]),
    "spring without a dot": ("driven_toggle", '"ground.S"', '"S"', ["springs.0.between.0", "'body.point'"]),
    "spring with one end": ("driven_toggle", _BETWEEN, '"ground.S"', ["springs.0.between", "two points"]),
    "spring with three ends": ("driven_toggle", _BETWEEN, f'{_BETWEEN}, "link.C"', ["springs.0.between", "two points"]),
    "spring that pushes": ("driven_toggle", "stiffness = 1.5", "stiffness = -1.5", ["springs.0.stiffness", "-1.5"]),
    "spring of no stiffness": ("driven_toggle", "stiffness = 1.5\n", "", ["springs.0.stiffness", "missing"]),
    "fourth point by one length": ("driven_toggle", ', "D-K" = 90', "", ["bodies.plate.lengths", "K", "found 'B-K'"]),
    "fourth point by none": ("driven_toggle", '"B-K" = 60, "D-K" = 90', '"K-Z" = 60', ["lengths", "K", "found none"]),
    "fourth point by three": (
        "driven_toggle",
        '"D-K" = 90',
        '"D-K" = 90, "A-K" = 400',
        ["bodies.plate.lengths", "'A-K', 'B-K', 'D-K'", "'points'"],
    ),
    "fourth point out of reach": ("driven_toggle", '"D-K" = 90', '"D-K" = 190', ["bodies.plate.lengths", "190 mm"]),
    "body called ground": ("shaper", "[bodies.link]", "[bodies.ground]", ["bodies.ground", "taken"]),
    "output on who is carried": (
        "carried_block",
        'point = "P"',
        'slider = "P"',
        ["output.slider", "'P'", "the ground"],
    ),
}


@pytest.mark.parametrize("slip", [*SLIPS, *MECHANISM_SLIPS])
def test_a_slip_is_one_line(slip: str, tmp_path: Path) -> None:
    mechanism, old, new, expected = MECHANISM_SLIPS.get(slip) or ("toggle_press", *SLIPS[slip])
    text = scene_files.text(mechanism)
    assert old in text, "the slip no longer matches the scene"
    file = tmp_path / "mine.toml"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(InputError) as caught:
        scenes.load(file)
    line = str(caught.value)
    assert line.startswith(f"{file}: ")
    assert "\n" not in line
    for part in expected:
        assert part in line

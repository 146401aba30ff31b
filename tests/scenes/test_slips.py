"""Every slip of a user in a scene or ladder file is refused in one line, with the place and what was expected."""

import re
from pathlib import Path

import pytest

import scenes
from scenes import hard
from tests import scene_files
from tests.comparisons import sampled

# By scene, a line a slip: what is replaced => by what :: and, with | between them, what the one line must have.
SLIPS = {
    "toggle_press": r"""
[drive] => [drive :: not valid TOML | line
mass = 40 => mas = 40 :: bodies.rocker.mas | unknown key | 'mass'
[drive] => [drives] :: drives | one drive alone | [drive]
[output]\nslider = "P5" => :: output | missing
length = "mm" => length = "mmm" :: units.length | 'mmm' | 'mm'
mass = 40 => mass = "40" :: bodies.rocker.mass | number | '40'
mass = 40 => mass = true :: bodies.rocker.mass | number
P2 = [480, -202] => P2 = [480] :: sketch.P2 | two numbers
mass = 40 => mass = -40 :: bodies.rocker.mass | greater than or equal to 0 | -40
mass = 40 => mass = nan :: bodies.rocker.mass | finite
"O-P3" = 300 => "O-P3" = -300 :: bodies.rocker.lengths.O-P3 | greater than 0
"O-P3" = 300 => "O-P3" = 0 :: bodies.rocker.lengths.O-P3 | greater than 0
"O-P3" = 300 => "O-P3" = nan :: bodies.rocker.lengths.O-P3 | finite
"O-P3" = 300 => "OP3" = 300 :: bodies.rocker.lengths.OP3 | '-'
"O-P3" = 300 => "P3-P3" = 300 :: bodies.rocker.lengths | different points
"O-P3" = 300 => "O-P3" = 300, "P3-O" = 301 :: bodies.rocker.lengths | twice
, "P2-P4" = 760 => :: bodies.toggle.lengths | P4 | two of the points before it | 'P3-P4'
"P2-P4" = 760 => "P2-P4" = 981 :: bodies.toggle.lengths | cannot close | 981 mm against 980 mm
P2 = [77, 0] } => P2 = [0, 0] } :: bodies.crank.points | P1 and P2
lengths = { "O-P3" = 300 } => lengths = { "O-P3" = 300 }\npoints = { O = [0, 0] } :: bodies.rocker
mass = 40 => mass = 40\ncom = [1, 0] :: bodies.rocker | 'com' and 'inertia'
"O-P3" = 300 => "A-B" = 300 :: bodies.rocker | hangs on nothing
[drive] => [[drive]] :: drive | expected a table
[[loads]] => [[drive]]\nbody = "rocker"\nspeed = 1\n[[loads]] :: not valid TOML
[bodies.rod] => [bodies.rocker] :: not valid TOML
name = "toggle_press" => name = "toggle\u0000press" :: name | not a name
[drive] => [bodies.u]\nlengths = { "X-Y" = 10 }\nmass = 1\n[bodies.v]\nlengths = { "Y-X" = 10 }\nmass = 1\n[drive]
    :: bodies.u | hangs on nothing
[drive] => [bodies.extra]\nlengths = { "P4-Z" = 1 }\nmass = 1\n[drive] :: under-constrained
[drive] => [bodies.extra]\nlengths = { "P4-O" = 1 }\nmass = 1\n[drive] :: over-constrained | = 0
body = "crank" => body = "krank" :: drive.body | 'krank' | 'crank'
body = "crank" => body = "slider"
    :: drive.body: 'slider' slides, and units.speed, 'rpm', is of a crank | mm/s
body = "crank" => body = "rod" :: drive.body | 0 points on the ground
speed = 60 => speed = 0 :: drive.speed | zero
body = "slider" => body = "slidre" :: loads.0.body | 'slider'
at = "P5" => at = "P4" :: loads.0.at | 'P4' | P5
along = [0, 1] => along = [0, 0] :: bodies.slider.slides.along | direction
P3 = [0, -300]\n => :: sketch.P3 | missing
P3 = [0, -300]\n => P3 = [0, -300]\nP9 = [0, 0]\n :: sketch.P9 | P5
slider = "P5" => slider = "P6" :: output.slider | 'P6' | P5
slider = "P5" => slider = "P4" :: output.slider | no body that slides on the ground | point
mass = 40 => :: bodies.rocker.mass | missing
[bodies.rod] => [bodies.drive] :: bodies.drive | taken
mass = 40 => mass = 1e300 :: bodies.rocker.mass | 1e-15 to 1e+15 kg, found 1e+300
"O-P3" = 300 => "O-P3" = 1e-300 :: bodies.rocker.lengths.O-P3 | 1e-12 to 1e+18 mm, found 1e-300
speed = 60 => speed = 1e200 :: drive.speed | to 9.5e+15 rpm, found 1e+200
length = "mm" => length = "Ym" :: ground.points.P1.0 | to 1e-09 Ym, found 404
[bodies.rod] => [bodies."the rod"] :: bodies.the rod | not a name
format = 1 => format = true :: format: expected 1, found 'True'
format = 1 => format = 2 :: format | 1 | 2
speed = "rpm" => speed = "Hz" :: units.speed: 'Hz' is not a known unit of speed | rpm
speed = "rpm" => speed = "kg" :: units.speed: 'kg' is not a known unit of speed | rpm
torque = 1e-6 => force = 1e-6 :: tolerances.exudyn.force: expected 'torque'
P1.0"\nplus_minus => P1"\nplus_minus :: variations.0.path: ground.points.P1: expected the path of a number
path = "bodies.rocker.lengths.O-P3" => path = "bodies.rocker.lengths.O-P"
    :: variations.3.path: bodies.rocker.lengths.O-P: the file has no 'O-P' there | did you mean 'O-P3'?
path = "ground.points.P1.0" => path = "sketch.P2.0"
    :: variations.0.path: sketch.P2.0: expected a number of the linkage; one of bodies, | drive.speed,
path = "ground.points.P1.1" => path = "ground.points.P1.0"
    :: variations.1.path: ground.points.P1.0: expected each number once
path = "bodies.toggle.lengths.P2-P3" => path = "bodies.rocker.lengths.P3-O"
    :: variations.4.path: bodies.rocker.lengths.P3-O: expected each number once
plus_minus = 0.05 => plus_minus = 1e300 :: variations.0.plus_minus: expected 1e+45 at most, found 1e+300
angle = 11.5 => angle = [480, -202]
    :: sketch.angle: expected a number, since it is where the drive is; a point needs another name
angle = 11.5 => displacement = [480, -202]
    :: sketch.displacement: expected a number, since it is where the drive is; a point needs another name
plus_minus = 0.05 => plus_minus = 0 :: variations.0.plus_minus | greater than 0
distribution = "uniform" => distribution = "gauss"
    :: variations.9.distribution: expected 'normal' or 'uniform', found 'gauss'
torque = 1e-6 => torqe = 1e-6 :: tolerances.exudyn.torqe | 'torque'""",
    "outlined": r"""
width = 40 => width = 0 :: bodies.crank.width | greater than 0
width = 40 => width = -40 :: bodies.crank.width | -40
width = 40 => mass = 1 :: bodies.crank: expected 'thickness' and 'density' with one of | 'thickness', 'density', 'mass'
width = 40 => width = 40\nmass = 1 :: bodies.crank | instead of 'mass', found 'width', 'thickness', 'density', 'mass'
width = 40 => width = 40\noutline = [[0, 0], [1, 0], [0, 1]] :: bodies.crank | one of 'outline' and 'width'
density = 7850 => :: bodies.crank: expected 'thickness' and 'density' | found 'width', 'thickness'
density = 7850 => density = 1e-300 :: bodies.crank.density: expected a size from 1e-15 to 1e+15 kg/m^3
density = 7850 => density = 1e-14 :: bodies.crank: expected numbers that give a mass from 1e-15 kg to 1e15 kg
{ "A-B" = 100 } => { "A-B" = 100, "A-X" = 60, "B-X" = 60 } :: bodies.crank.width: expected a body of two points
outline = [[-20, -20], [300, -20], [300, 20], => outline = [[-20, -20], [300, 20], [300, -20],
    :: bodies.coupler.outline: expected sides that meet only at the corner between them | found 0 to 1 and 2 to 3 that
[120, 20], [-20, 20]] => [120, 20], [-20, 20], [-20, -20]]
    :: bodies.coupler.outline | the last one back to the first, found 0 to 1 and 7 to 8 that meet
[25, 270], [60, 100], => [-25, 90], [-25, 95], :: bodies.rocker.outline | that meet
outline = [[-25, -90], [-25, 270], [25, 270], [60, 100], [25, -90]] => outline = [[0.1, 0.3], [0.2, 0.6], [0.3, 0.9]]
    :: bodies.rocker.outline: expected an area, found corners on one line
outline = [[-25, -90], [-25, 270], => outline = [[-25], [-25, 270], :: bodies.rocker.outline.0 | two numbers
[[-25, -90], [-25, 270], [25, 270], [60, 100], [25, -90]] => [[0, 0], [1, 0]] :: bodies.rocker.outline | 3 or more
[sketch] => [[gears]]\nbetween = ["crank", "rocker"]\n[sketch] :: gears: no such joint here | docs/limits.md
[sketch] => [cam]\nbody = "rocker"\n[sketch] :: cam: no such joint here | pins and straight slides
[sketch] => [belts]\n[sketch] :: belts: no such joint here | docs/limits.md
width = 40 => width = 40\nclearance = 0.1 :: bodies.crank.clearance: no clearance here | docs/limits.md
speed = 120 => torque = 5 :: drive.torque: a drive is not pushed | its motion | docs/limits.md""",
    "shaper": r"""
"rocker", thr => "roker", thr :: bodies.block.slides.on | 'rocker'
"rocker", thr => "block", thr :: bodies.block.slides.on | block on block
on = "rocker" => onn = "rocker" :: bodies.block.slides.onn | 'on'
speed = 60\n => :: drive | either 'speed', 'law'
speed = 60 => speed = 60\nperiodic = true :: drive.periodic | 'law'
"rpm" => "mm/s" :: drive.body: 'crank' does not slide, and units.speed, 'mm/s', is of a slider | rpm
body = "crank" => body = "block" :: drive.body: 'block' slides | mm/s
[sketch]\nangle => [sketch]\ndisplacement
    :: sketch.displacement: expected 'angle', since drive.body, 'crank', does not slide
"ram"\nat = "E" => "link"\nat = "E" :: loads.0.last | slides | 'link'
"ram"\nat = "E" => "block"\nat = "A" :: loads.0.last | 'block'
"ram"\nat = "E" => "rma"\nat = "E" :: loads.0.body | 'ram'
[-500, 0] => [0, 500] :: loads.0.force | along the guide
last = 120 => last = 0 :: loads.0.last | greater than 0
[bodies.link] => [bodies.ground] :: bodies.ground | taken""",
    "carried_block": r"""
\n[drive] => \n[bodies.one]\npoints = { X = [0, 0] }\nslides = { on = "other", through = [0, 0], along = [1, 0]
    }\n[bodies.other]\npoints = { Y = [0, 0] }\nslides = { on = "one", through = [0, 0], along = [1, 0] }\n[drive]
    :: bodies.one.slides.on | one on other on one
\n[drive] => \n[bodies.one]\npoints = { X = [0, 0] }\nslides = { on = "other", through = [0, 0], along = [1, 0]
    }\n[bodies.other]\npoints = { Y = [0, 0] }\nslides = { on = "on", through = [0, 0], along = [1, 0] }\n[drive]
    :: bodies.other.slides.on | 'one'
point = "P" => slider = "P" :: output.slider | 'P' | the ground""",
    "swinging_law": r"""
[0.5, 290] => [0.1, 290] :: drive.law.2.0 | increasing times | 0.1 s
[0.5, 290] => [0.2, 290] :: drive.law.2.0 | increasing times
[[0, 200] => [[0.1, 200] :: drive.law.0.0 | first time to be 0 | 0.1 s
, [0.7, 320], [1.0, 250], [1.2, 235]] => ] :: drive.law | 4 or more | found 3
[0.5, 290] => [0.5, 290, 1] :: drive.law.2 | two numbers
[0.5, 290] => [0.5] :: drive.law.2 | two numbers
[[0, 200], [0.2, 215], [0.5, 290], [0.7, 320], [1.0, 250], [1.2, 235]] => [[0, 200], [0.2, 200], [0.5, 200], [0.7,
    200]] :: drive.law | same position
law = => speed = 60\nlaw = :: drive | either 'speed', 'law'
law = => start = 60\nlaw = :: drive.start | expected none with a 'law'
law = => end = 60\nlaw = :: drive.end | expected none with a 'law'""",
    "crank": r"""
speed = 3.0 => segments = [{ to = 1, within = 2, law = "cycloid" }] :: drive.segments.0.law: no law | 'cycloidal'
speed = 3.0 => segments = [{ to = 1, within = 2 }] :: drive.segments.0.law: missing beside 'to'
speed = 3.0 => segments = [{ law = "harmonic", within = 2 }] :: drive.segments.0.to: missing beside 'law'
speed = 3.0 => segments = [{ to = 1, within = 0, law = "harmonic" }] :: drive.segments.0.within | greater than 0
speed = 3.0 => segments = [{ to = 1, law = "harmonic" }] :: drive.segments.0.within: missing
speed = 3.0 => segments = [{ within = 2 }] :: drive.segments: expected a motion
speed = 3.0 => segments = [] :: drive.segments | 1 or more
speed = 3.0 => segments = [{ to = 1, within = 2, law = "harmonic" }], periodic = true :: drive.segments | off by 1 rad
speed = 3.0 => segments = [{ to = 70, within = 2, law = "harmonic" }] :: drive.segments: expected 10 turns at most
speed = 3.0 => segments = [{ to = 1, within = 2, law = "harmonic" }], end = 1 :: drive.end | 'segments' | a 'speed'
speed = 3.0 => harmonics = [[1, 0.5, 0]], periodic = true :: drive.periodic | 'harmonics' | a 'law' or a 'segments'
speed = 3.0 => speed = 3.0, harmonics = [[1, 0.5, 0]] :: drive | found 'speed' and 'harmonics'
speed = 3.0 => harmonics = [[1, 0.5]] :: drive.harmonics.0 | three numbers
speed = 3.0 => harmonics = [[1, -0.5, 0]] :: drive.harmonics.0.1 | greater than 0
speed = 3.0 => harmonics = [[1, 0.3, 0], [1, 0.301, 0]] :: drive.harmonics.1.1 | a common period | 36 | 301
speed = 3.0 => harmonics = [[1, 0.3, 0], [-1, 0.3, 0]] :: drive.harmonics: expected a motion""",
    "tangent": r"""
end = 50 => end = -1e6 :: drive.end | 10 turns at most | 2778.14 | for ever
end = 50 => end = 150 :: drive.end: expected a position below 'start', 130 deg, found 150 deg; or make speed positive
end = 50 => end = 130 :: drive.end: expected another position than 'start', 130.0""",
    "turning_law": r"""
360]] => 36000]] :: drive.law | 10 turns at most | found 103
[1.1, 360] => [1.1, 350] :: drive.law | last position to be the first, or whole turns from it | off by -10 deg
[1.1, 360] => [1.1, 360.00002] :: it is off by 2e-05 deg""",
    "driven_toggle": r"""
speed = -150 => speed = 150 :: drive.end: expected a position above 'start', 100 mm, found -150 mm; or make speed
    negative
end = -150\n => :: drive.end | missing | slider
"mm/s" => "rpm" :: drive.body: 'crosshead' slides, and units.speed, 'rpm', is of a crank | mm/s
[sketch]\ndisplacement => [sketch]\nangle
    :: sketch.angle: expected 'displacement', since drive.body, 'crosshead', slides
displacement = 100\n => :: sketch.displacement: missing | drive.body, 'crosshead', slides
table = [[ => force = [1, 0]\ntable = [[ :: loads.0 | 'force', 'moment' or 'table'
table = [[500, 0], [700, 2000]]\n => :: loads.0 | 'force', 'moment' or 'table'
table = [[ => last = 3\ntable = [[ :: loads.0.last | 'force'
"platen"\nat => "link"\nat :: loads.0.table | slides | 'link'
[700, 2000]] => [500, 2000]] :: loads.0.table | increasing | found 500 mm
table = [[500, 0], [700, 2000]]\n => table = [[500, 0]]\n :: loads.0.table | 2 or more | found 1
"plate.K" => "plat.K" :: springs.0.between | 'plat' | 'plate'
"plate.K" => "plate.C" :: springs.0.between | 'C' | A, B, D, K
"ground.S" => "ground.T" :: springs.0.between | 'T' | A, S
"ground.S" => "plate.B" :: springs.0.between | two bodies | plate
"ground.S", "plate.K" => "link.B", "plate.B" :: springs.0.between | same point
"ground.S" => "S" :: springs.0.between.0 | 'body.point'
"ground.S", "plate.K" => "ground.S" :: springs.0.between | two points
"ground.S", "plate.K" => "ground.S", "plate.K", "link.C" :: springs.0.between | two points
stiffness = 1.5 => stiffness = -1.5 :: springs.0.stiffness | -1.5
stiffness = 1.5\n => :: springs.0.stiffness | missing
, "D-K" = 90 => :: bodies.plate.lengths | K | found 'B-K'
"B-K" = 60, "D-K" = 90 => "K-Z" = 60 :: lengths | K | found none
"D-K" = 90 => "D-K" = 90, "A-K" = 400 :: bodies.plate.lengths | 'A-K', 'B-K', 'D-K' | 'points'
"D-K" = 90 => "D-K" = 190 :: bodies.plate.lengths | 190 mm""",
    "elements": r"""
moment = 5 => moment = "5" :: loads.4.moment | number
moment = 5 => moment = 5\nforce = [1, 2]\nat = "B" :: loads.4 | either 'force', 'moment' or 'table'
moment = 5 => moment = 5\nat = "A" :: loads.4.at | 'rocker' has no point 'A'
moment = 5 => force = 5 :: loads.4.force | slides | 'rocker'
moment = 5 => force = [5, 6] :: loads.4.at | missing
moment = 5 => moment = 5\nover = "time" :: loads.4.over | a 'table'
moment = 5 => moment = 5\nperiodic = true :: loads.4.periodic | 'over'
force = [20, 30] => force = [20, "x"] :: loads.1.force.1 | number
frame = "body" => frame = "bodies" :: loads.1.frame | 'ground' or 'body'
along = [3, 4] => along = [0, 0] :: loads.2.along | direction
over = "time" => over = "times" :: loads.2.over | 'drive', 'time' or 'displacement'
over = "time" => over = "displacement" :: loads.2.over | slides | 'coupler'
at = "T"\nalong = [3, 4] => along = [3, 4] :: loads.2.along | 'at'
along = [3, 4]\n => :: loads.2.table | slides | 'coupler'
[0.2, 50] => [0.6, 50] :: loads.2.table.2.0 | increasing times | 0.5 s
[180, -2], [720, 1] => [180, -2], [180, 1] :: loads.3.table.2.0 | increasing positions | 180 deg
[720, 1] => [720, 2] :: loads.3.table | the last value to be the first | 1 N*m, found 2 N*m
over = "drive"\n => :: loads.3.periodic | 'over'
over = "drive"\ntable = [[0, 1], [180, -2], [720, 1]]\nperiodic = true => table = [[0, 1], [180, -2]]
    :: loads.3.over | 'drive', 'time' or 'displacement'
damping = 0.02 => damping = -0.02 :: springs.0.damping | greater than or equal to 0
stiffness = 0.4\nlength = 200\ndamping = 0.02 => length = 200 :: springs.0.stiffness | 'damping'
length = 200\n => :: springs.0.length | missing
at = "C" => at = "B" :: torsion_springs.0.at | 'ground' has no point 'B'
between = ["ground", "rocker"] => between = ["ground", "rokcer"] :: torsion_springs.0.between | 'rocker'
between = ["ground", "rocker"] => between = ["rocker", "rocker"] :: torsion_springs.0.between | two bodies
between = ["ground", "rocker"] => between = ["rocker"] :: torsion_springs.0.between | two
angle = 20\n => :: torsion_springs.0.angle | missing
units = { => units = { moment = "N", :: units.moment | 'N' | N*m""",
    "bucket": r"""
body = "rod" => body = "rod"\non = "bucket" :: drive.on | 'cylinder' | 'bucket'
speed = 200 => speed = 200\nend_ = 1 :: drive.end_ | 'end'
"mm/s" => "rpm" :: drive.body: 'rod' slides | mm/s
displacement = 640\n => :: sketch.displacement | missing
B = [500, 300]\n => :: sketch.B | missing""",
    "elbow": r"""
on = "boom" => on = "ground" :: drive.body | 0 points on the ground
on = "boom" => on = "bom" :: drive.on | 'boom'
on = "boom" => on = "stick" :: drive.on | no other body
on = "boom"\n => :: drive.body | 0 points on the ground""",
    "ladders/rod": r"""
[steps] => [steps :: not valid TOML
as_is = 300 => locking = 150 :: not valid TOML
title = => titel = :: titel | unknown key | 'title'
why = "It is not hard."\n => :: why | missing
format = 1 => format = 2 :: format | 1 | 2
"toggle_press" => "togle_press" :: scene | no such scene | 'toggle_press'
"toggle_press" => "press.toml" :: scene | no such scene or file
rod.lengths => rood.lengths :: steps.shorter | bodies.rood | 'rod'
.lengths.P4-P5 => :: steps.shorter | bodies.rod | path of a number
as_is = 300 => as_is = "300" :: steps.as_is | path of a text
bodies.rod.lengths.P4-P5 => units.length :: steps.shorter | path of a number
as_is = 300 => as_is = [300] :: steps.as_is | a number or a text | [300]
as_is = 300 => as_is = true :: steps.as_is | a number or a text
as_is = 300 => as_is = inf :: steps.as_is | finite number
paths = ["bodies.rod.lengths.P4-P5"] => paths = [] :: paths | 1 or more
paths = ["bodies.rod.lengths.P4-P5"] => paths = "turns" :: paths | list
shorter = 290\nas_is = 300\nlocking = 20\n => :: steps | 1 or more
["bodies.rod.lengths.P4-P5"]\nexpected = "All solve it."\nwhy = "It is not hard."\n\n[steps]\nshorter = 290\nas_is =
    300 => ["turns"]\nexpected = "A"\nwhy = "B"\n[steps]\nas_is = 1.5 :: steps.as_is | whole number of turns | 1.5
["bodies.rod.lengths.P4-P5"]\nexpected = "All solve it."\nwhy = "It is not hard."\n\n[steps]\nshorter = 290\nas_is =
    300 => ["turns"]\nexpected = "A"\nwhy = "B"\n[steps]\nas_is = "many" :: steps.as_is | whole number of turns | many
locking = "cannot => lock = "cannot :: status.lock | no such step | 'locking'
"cannot_assemble" => "cannot_asemble" :: status.locking | no status | 'cannot_assemble'""",
}
LADDERS = {"ladders/rod"}
ROWS = [(name, row) for name, text in SLIPS.items() for row in re.sub("\n    +", " ", text).strip().split("\n")]


@sampled(72)
@pytest.mark.parametrize(("name", "row"), ROWS)
def test_a_slip_is_one_line(name: str, row: str, tmp_path: Path) -> None:
    change, _, expected = row.partition(" :: ")
    old, new = change.replace(r"\n", "\n").split(" =>")
    text = scene_files.text(name)
    assert old in text, "the slip no longer matches the scene"
    file = tmp_path / "mine.toml"
    file.write_text(text.replace(old, new.removeprefix(" "), 1), encoding="utf-8")
    line = scene_files.refused(lambda: (hard.ladder if name in LADDERS else scenes.load)(file))
    assert line.startswith(f"{file}: ")
    for part in expected.split(" | "):
        assert part in line

"""What is wrong in a file is named with what would be right: form and unit, the loose end, the page of the limits."""

import re
from functools import partial
from pathlib import Path

import pytest

import scenes
from scenes.file.format import SceneFile
from scenes.file.unknown import BEYOND, OTHER_WORDS, PAGE, tables
from tests import scene_files
from tests.comparisons import sampled

ROOT = Path(__file__).parents[2]
# By scene, a line a mistake: what is replaced => by what :: and, with | between them, what the one line must have.
MISTAKES = {
    "four_bar": r"""
gravity = [0, -9.81] => gravity = 9.81 :: gravity: expected two numbers, [x, y] in m/s^2, found 9.81
gravity = [0, -9.81] => gravity = "9.81" :: gravity: expected two numbers, [x, y] in m/s^2, found '9.81'
gravity = [0, -9.81] => gravity = [-9.81] :: gravity: expected two numbers, [x, y] in m/s^2, found [-9.81]
gravity = [0, -9.81] => gravity = { y = -9.81 } :: gravity: expected two numbers | found { y = -9.81 }
gravity = [0, -9.81] => gravity = [0, "-9,81"] :: gravity.1: expected a number, its decimals after a '.', as -9.81
C = [200, 0] => C = 200 :: ground.points.C: expected two numbers, [x, y] in mm, found 200
C = [200, 0] => C = [200, 0, 0] :: ground.points.C: expected two numbers, [x, y] in mm, found [200, 0, 0]
[ground.points]\nO = [0, 0] => [ground]\nO = [0, 0] :: ground.O: unknown key; expected points in [ground.points]
{ "O-A" = 100 } => 50 :: bodies.crank.lengths: expected a table, as { "A-B" = 200 }, found 50
{ "O-A" = 100 } => { OA = 50 } :: bodies.crank.lengths.OA: not a name: expected two point names | as "A-B"
"O-A" = 100 => "O-A" = "400,0" :: lengths.O-A: expected a number in mm, its decimals after a '.', as 400.0, found
"O-A" = 100 => "O-A" = "400" :: bodies.crank.lengths.O-A: expected a number in mm, without quotation marks
"O-A" = 100 => "O-A" = "4 in" :: bodies.crank.lengths.O-A: expected a number in mm, without a unit, which [units] has
"O-A" = 100 => "O-A" = 400,0 :: not valid TOML | a number's decimals come after a '.', as 400.0
mass = 0.5 => mass = 0,5 :: not valid TOML | a number's decimals come after a '.', as 0.5
{ A = [0, 0], B = [250, 0], T = [500, 0] } => [[0, 0], [250, 0]]
    :: bodies.coupler.points: expected a table, as { A = [0, 0], B = [100, 0] }
mass = 0.5 => mass = 0.5 kg :: not valid TOML | a number stands alone, as 0.5; its unit is in [units]
point = "T" => point = T :: not valid TOML | a text needs quotation marks, as "T"
[bodies.crank] => [crank] :: crank: unknown key; expected a body as [bodies.crank]
lengths = { "O-A" = 100 } => O = [0, 0]\nA = [100, 0]
    :: bodies.crank.O: unknown key; expected points in [bodies.crank.points]
[bodies.crank] => [limits]\nt = 5\n[bodies.crank] :: limits.t: expected a table of 'least', 'most', found 5
speed = -60 => speed = "60 rpm" :: drive.speed: expected a number in rpm, without a unit
speed = -60 => rpm = 60 :: drive.rpm: unknown key; did you mean 'speed'?
[drive]\nbody = "crank" => [drive] :: drive.body: missing; a body with one pin on the ground
[sketch] => [drives]\nbody = "crank"\n[sketch] :: drives: one drive alone moves a linkage | docs/limits.md
point = "T" => point = "T"\ngravity = [0, -9] :: output.gravity: unknown key here; 'gravity' belongs to the top of
mass = 0.5 => mass = 0.5\nspeed = 3 :: bodies.crank.speed: unknown key here; 'speed' belongs to [drive]
A = [0, 100] => output = "T" :: sketch.output: expected a point; 'output' belongs to the top of the file
A = [0, 100] => a = [0, 100] :: sketch.a: no such moving point; did you mean 'A'?
length = "mm", => lenght = "mm", :: units.lenght | 'length'
"O-A" = 100 => "o-A" = 100 :: drive.body: 'crank' has 0 points on the ground | 'o' is on crank alone; did you mean 'O'?
"O-A" = 100 => "Q-A" = 100 :: drive.body: 'crank' has 0 points on the ground | the ground has O, C
"O-A" = 100 => "O-a" = 100 :: bodies: under-constrained: point 'a' is on crank alone; did you mean 'A'?
"C-B" = 250 => "c-B" = 250 :: bodies: under-constrained: point 'c' is on rocker alone; did you mean 'C'?
C = [200, 0]\n => :: bodies: under-constrained: nothing holds rocker at C
"C-B" = 250 => "C-X" = 250 :: bodies: under-constrained: nothing holds coupler at B or T, nothing holds rocker at X
[drive] => [bodies.rod]\nlengths = { "T-B2" = 9 }\nmass = 1\n[drive] :: under-constrained: nothing holds rod at B2
[drive] => [bodies.extra]\nlengths = { "O-C" = 9 }\nmass = 1\n[drive]
    :: bodies: over-constrained: without extra it would move""",
    "toggle_press": r"""
force = [0, 100] => force = "100,5" :: loads.0.force: expected two numbers, [x, y] in kN, found '100,5'
"slider"\nat = "P5"\nforce = [0, 100] => "rod"\nat = "P5"\nforce = -12 :: loads.0.force: expected [x, y], or a body that
[[loads]] => [loads] :: loads: expected a list of tables, as [[loads]] in double brackets
[[loads]] => [[forces]] :: forces: unknown key; did you mean 'loads'?
[drive] => [[drive]] :: drive: expected a table, [drive] in single brackets
[output] => [limits.P5.force]\nmost = 9\n[output] :: limits.P5.force: expected [limits."P5.force"]
[output] => [limits]\nP5.force = 9\n[output] :: limits.P5.force: expected [limits."P5.force"]
[output] => [limits."P5.force"]\nmax = 9\n[output] :: limits.P5.force.max: unknown key; did you mean 'most'?
[output] => [limits]\n"P5.force" = 9\n[output] :: limits.P5.force: expected a table of 'least', 'most', found 9
[output] => [[friction]]\nslider = "slider"\ncoefficient = 0.1\n[output]
    :: friction.0.length: missing; the length of the guide's contact
[output] => [[friction]]\nat = "P5"\ncoefficient = 0.1\n[output] :: friction.0.radius: missing; the radius of the pin
along = [0, 1] => along = 90 :: bodies.slider.slides.along: expected two numbers, [x, y], found 90
slides = { through = [0, 0], along = [0, 1] } => slides = true
    :: bodies.slider.slides: expected a table of 'through', 'along', found true
slides = { through = [0, 0], along = [0, 1] }\n =>
    :: under-constrained: nothing but its pin at P5 holds slider, expected its 'slides' or another pin
points = { P5 = [0, 0] } => points = { P6 = [0, 0] }
    :: under-constrained: nothing holds rod at P5, nothing holds slider at P6""",
    "swinging_law": r"""
[0.2, 215] => [0.2, 215, 1] :: drive.law.1: expected two numbers, [time in s, position in deg], found [0.2, 215, 1]
[0.2, 215] => 0.2 :: drive.law.1: expected two numbers, [time in s, position in deg], found 0.2""",
}
ROWS = [(name, row) for name, text in MISTAKES.items() for row in re.sub("\n    +", " ", text).strip().split("\n")]


@sampled(19)
@pytest.mark.parametrize(("name", "row"), ROWS)
def test_a_mistake_is_named_with_what_would_be_right(name: str, row: str, tmp_path: Path) -> None:
    change, _, expected = row.partition(" :: ")
    old, new = change.replace(r"\n", "\n").split(" =>")
    line = refused(name, old, new.removeprefix(" "), tmp_path)
    for part in expected.split(" | "):
        assert part in line


def refused(name: str, old: str, new: str, folder: Path) -> str:
    text = scene_files.text(name)
    assert old in text, "the mistake no longer matches the scene"
    file = folder / "mine.toml"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    return scene_files.refused(lambda: scenes.load(file), most=len(str(file)) + 400).removeprefix(f"{file}: ")


def test_the_page_of_the_limits_has_the_keys_that_name_it(tmp_path: Path) -> None:
    page = (ROOT / PAGE).read_text("utf-8")
    rows = [line.split("|")[-2] for line in page.splitlines() if line.startswith("|")][2:]
    promised = [key for row in rows for key in re.findall("`(.+?)`", row)]
    assert sorted(promised) == sorted(word for words in BEYOND for word in words.split())
    for key in promised:
        table, _, last = key.rpartition(".")
        at, new = (
            ("[drive]\n", f"[drive]\n{last} = 1\n") if table else ("[sketch]\n", f"[[{key}s]]\nat = 1\n[sketch]\n")
        )
        assert f"see {PAGE}" in refused("four_bar", at, new, tmp_path), key


@pytest.mark.parametrize(
    "key", ["contacts", "bushings", "stops", "motor_torque", "initial_velocity", "joints", "mimic"]
)
def test_what_is_beyond_the_models_names_the_page(key: str, tmp_path: Path) -> None:
    for at, new in (("[sketch]\n", f"[[{key}]]\nx = 1\n[sketch]\n"), ("mass = 0.5\n", f"mass = 0.5\n{key} = 1\n")):
        assert f"see {PAGE}" in refused("four_bar", at, new, tmp_path)


@sampled(2)
@pytest.mark.parametrize("name", ["watt_six_bar", "scissor_lift", "walking_leg", "quick_return", "elements", "triad"])
def test_a_pin_that_a_body_names_otherwise_is_found(name: str, tmp_path: Path) -> None:
    scene, pins = scene_files.load(name), 0
    for point, owners in scene.owners.items():
        for body in owners[1:]:
            pins += 1
            line = scene_files.refused(partial(scenes.load, renamed(name, body, point, point.swapcase(), tmp_path)))
            assert f"point '{point.swapcase()}' is on {body} alone; did you mean '{point}'?" in line
            line = scene_files.refused(partial(scenes.load, renamed(name, body, point, f"{point}_x", tmp_path)))
            found = (
                f"'{point}_x' is on {body} alone",
                f"nothing holds {body} at",
                f"'{body}' has 0 points on the ground",
            )
            assert any(words in line for words in found), line
    assert pins >= 5


ACTING = ("loads", "springs", "torsion_springs", "variations", "friction")


def renamed(name: str, body: str, point: str, other: str, folder: Path) -> Path:
    """Write a scene in which a body has another name for one of its points, and nothing acts on the bodies."""
    drawn = scene_files.load(name).bodies[body]
    changes: scene_files.Changes = {key: [] for key in ACTING}
    if drawn.lengths is None:
        places = drawn.local or {}
        changes[f"bodies.{body}.points"] = {other if p == point else p: [*xy] for p, xy in places.items()}
    else:
        pairs = [[other if p == point else p for p in sorted(pair, key=drawn.points.index)] for pair in drawn.lengths]
        changes[f"bodies.{body}.lengths"] = {"-".join(pair): 1.0 for pair in pairs}
    return scene_files.write(folder, name, changes)


LOOSE = {  # by the bodies besides the crank O-A; C and D are on the ground
    'one = "A-B"\ntwo = "B-E"\nthree = "E-C"': "while the drive is held, one, two, three can still move",
    'one = "A-B"\ntwo = "B-C"\nthree = "B-D"': "without one, or without two, or without three it would move",
    'one = "A-B"\ntwo = "B-C"\nthree = "B-D"\nfour = "A-C"\nfive = "A-D"': "hold one, two, three, four, five",
    'one = "A-B"': "nothing holds one at B",
    'other = "C-B"': "nothing holds other at B, nothing holds crank at A",
}


@pytest.mark.parametrize("bars", LOOSE)
def test_a_count_of_freedoms_names_the_bodies(bars: str, tmp_path: Path) -> None:
    bodies = "".join(f"bodies.{name}.lengths = {{ {pair} = 1 }}\n" for name, pair in re.findall('(.+) = (".+?")', bars))
    file = tmp_path / "mine.toml"
    file.write_text(
        f"""format = 1
        name = "mine"
        ground.points = {{ O = [0, 0], C = [3, 0], D = [6, 0] }}
        bodies.crank.lengths = {{ "O-A" = 1 }}
        {bodies}
        drive = {{ body = "crank", speed = 1 }}
        sketch = {{ A = [1, 0] }}
        output = {{ point = "A" }}""",
        encoding="utf-8",
    )
    assert LOOSE[bars] in scene_files.refused(lambda: scenes.load(file))


def test_a_pin_too_many_is_named(tmp_path: Path) -> None:
    line = refused("four_bar", '{ "O-A" = 100 }', '{ "O-A" = 100, "O-T" = 90, "A-T" = 90 }', tmp_path)
    assert "without the pin A of crank and coupler, or without the pin T of crank and coupler it would move" in line


@pytest.mark.parametrize("words", OTHER_WORDS)
def test_words_of_others_are_keys_of_some_table(words: str) -> None:
    known = {key for _, table in tables(SceneFile) for key in table.model_fields}
    assert {*OTHER_WORDS[words].split()} <= known

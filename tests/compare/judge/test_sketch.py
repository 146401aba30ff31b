"""The distance of the linkage from its sketch, and the warnings that name what is far from it."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

import compare
import scenes
from compare.engines import registry
from compare.judge.judgement import judgement
from compare.judge.sketch import check_sketch, off_sketch, warnings, with_notes
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.reference import Floor, Reference, uncertified
from compare.run import main
from scenes import Failure, InputError, Motion, Sampling, Scene, Status
from tests import scene_files
from tests.comparisons import sampled

UPSIDE_DOWN = {"sketch.E": [-27, 46], "sketch.G": [-59, 28], "sketch.F": [-43, 92]}  # the foot over the hip


def unscaled(scene: Scene) -> Reference:
    return Reference(Mechanics(scene), registry.reference(scene), 0.0, {}, {}, Floor({}, ""))


@sampled(8)
@pytest.mark.parametrize("name", scenes.shipped())
def test_shipped_sketches_are_near(name: str) -> None:
    reference = unscaled(scenes.load(name))
    assert set(off_sketch(reference)) == set(reference.scene.sketch.points)
    assert not [*warnings(reference)]


def test_a_leg_drawn_upside_down_is_named() -> None:
    reference = with_notes(uncertified(scene_files.load("walking_leg", UPSIDE_DOWN)))
    judged = judgement(reference, [], Sampling(4), lambda _: ([], ""), lambda _: None)
    assert len(judged.reasons) == 1
    far, _, what_follows = judged.reasons[0].partition("; ")
    assert far.startswith("the sketch is far from where the lengths put its points: F by 38.4")
    assert [part.split()[0] for part in far.partition(": ")[2].split(", ")] == ["F", "G", "E"]
    assert far.endswith(" cm")
    assert "on the side meant" in what_follows


@pytest.mark.parametrize(("displacement", "off"), [(100, 0.036), (64, 0.0), (150, 0.086)])
def test_the_place_of_a_driven_slider_is_as_drawn(displacement: float, off: float) -> None:
    """The crosshead's pin is drawn where it is 64 mm along its guide."""
    reference = unscaled(scene_files.load("driven_toggle", {"sketch.displacement": displacement}))
    assert abs(off_sketch(reference)["E"] - off) <= 1e-12  # m, roundings
    named = [sentence for sentence in warnings(reference) if "check that sketch.displacement is where" in sentence]
    assert ["E by 86 mm; check" in sentence for sentence in named] == [True] * (displacement == 150)


def test_a_drive_that_cannot_be_where_the_sketch_has_it() -> None:
    def nowhere(*_: object) -> Motion:
        raise Failure(Status.cannot_assemble, "too far")

    assert off_sketch(replace(unscaled(scenes.load("toggle_press")), at=nowhere)) == {}


def test_a_point_of_the_ground_that_nothing_uses_makes_no_sketch_near() -> None:
    far = {"ground.points.far": [5000, 0]}
    held = {"springs": [{"between": ["ground.far", "crank.A"], "stiffness": 1, "length": 0}]}
    near, loose, joined = (
        [*warnings(unscaled(scene_files.load("walking_leg", {**UPSIDE_DOWN, **changes})))]
        for changes in ({}, far, {**far, **held})
    )
    assert loose == near != []
    assert not joined


# Of the clamp with the links 30, 40 and 37 mm, 50 mm apart, which at 0 have to span 80 mm: the arm on the wrong side,
# its points swapped, all mirrored, all 25.4 times too near.
OTHER_SIDE = {"sketch.B": [15, 5], "sketch.E": [-15, -80]}
SWAPPED = {"sketch.B": [-130, 10], "sketch.E": [-38, 33]}
INCHES = {
    f"sketch.{p}": [x / 25.4, y / 25.4] for p, x, y in (("A", 0, 30), ("H", 20, 140), ("B", -40, 36), ("E", -130, 10))
}
MIRRORED = {"sketch.A": [0, -30], "sketch.H": [-20, 140], "sketch.B": [40, 36], "sketch.E": [130, 10]}


@sampled(1)
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (OTHER_SIDE, ["sketch.angle = 90.0000 deg", "E by 164 mm", "B by 31.4", "it fits nowhere: best at 9"]),
        (OTHER_SIDE | {"sketch.angle": 60}, ["sketch.angle = 60.0000 deg", "E by ", "H by "]),
        (SWAPPED, ["two ways of assembling", "E by 95.11 mm, B by 93.91 mm"]),
        (MIRRORED, ["two ways of assembling", "E by ", "it fits nowhere"]),
        (INCHES, ["drawn 0.0394 times as large as the bodies, and read in mm"]),
        (
            {"sketch.angle": None},
            ["0.0000 deg (taken where it is absent): H by 200 mm, A by 42.43 mm; it fits at 90."],
        ),
        ({"sketch.angle": 10}, ["sketch.angle = 10.0000 deg: H by ", "it fits at 90."]),
    ],
    ids=["other side", "and another angle", "swapped", "mirrored", "inches", "no angle", "another angle"],
)
def test_a_sketch_that_engines_read_in_several_ways_is_refused(
    changes: scene_files.Changes, words: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before any engine runs."""
    monkeypatch.setattr("compare.engines.runner._attempts", None)
    scene = scene_files.load("side_clamp", changes)
    with pytest.raises(InputError) as caught:
        compare.check(scene, samples=24)
    line = str(caught.value)
    assert line.startswith(f"{scene.file}: sketch: ")
    assert not [word for word in words if word not in line], line


@sampled(2)
@pytest.mark.parametrize(
    ("name", "changes", "noted"),
    [
        ("side_clamp", {}, ""),
        ("side_clamp", {"sketch.B": [-34, 38], "sketch.E": [-124, 20]}, ""),
        ("side_clamp", {"sketch.angle": 60}, "H by 73.21 mm, E by 37.99 mm, B by 17.38 mm, A by 15.53 mm; check"),
        (
            "four_bar",
            {"sketch.angle": None},
            "sketch.angle is where the crank is drawn; it fits at 90.0000 deg",
        ),
        ("four_bar", {"sketch.angle": 45}, "it fits at 90.0000 deg"),
        ("class_iii", {"sketch.angle": None}, "it fits at 61.2"),
    ],
)
def test_a_rough_sketch_is_no_fault_and_noted_where_it_is_far(
    name: str, changes: scene_files.Changes, noted: str
) -> None:
    reference = unscaled(scene_files.load(name, changes))
    check_sketch(reference)
    lines = [*warnings(reference)]
    assert [noted in line for line in lines] == [True] * bool(noted), lines


def test_who_takes_another_assembly_from_a_rough_sketch_is_not_to_blame(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor is the core, which arbitrary precision contradicts."""
    monkeypatch.setattr("compare.judge.sketch.check_sketch", lambda _: None)
    scene = scene_files.load("side_clamp", OTHER_SIDE)
    line = scene_files.refused(lambda: compare.check(scene, samples=24))
    assert ": sketch: " in line
    assert "python-flint takes another assembly from the sketch than the core, sketch.angle = 90.0000 deg: E by" in line
    monkeypatch.setattr("compare.judge.sketch.rough", lambda _: False)
    doubted = compare.check(scene, samples=24)
    assert "suspect the core" in doubted.verdicts["analytic"][1]


def test_a_refused_sketch_has_a_page_and_no_core_to_suspect(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = scene_files.write(tmp_path, "side_clamp", OTHER_SIDE)
    assert main([str(file), "--out", str(tmp_path)]) == 2
    out = "".join(capsys.readouterr())
    assert "suspect" not in out
    assert "sketch.angle = 90.0000 deg" in out
    verdict = json.loads((tmp_path / "side_clamp" / "summary.json").read_text(encoding="utf-8"))["verdict"]
    assert verdict["word"] == "not_solved"


@sampled(1)
@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"sketch.P2": [0, -300], "sketch.P3": [480, -202]}, "close at no position of the drive"),
        ({"sketch.P3": [0, -790], "sketch.P4": [0, -300]}, "sketch.angle = 11.5000 deg: P5 by 1011 mm, P3 by 490 mm"),
        ({"bodies.rocker.lengths.O-P3": 30}, ""),  # whose length is at fault, and no sketch fits
    ],
)
def test_a_way_that_ends_names_the_sketch_that_is_behind_it(changes: scene_files.Changes, words: str) -> None:
    """Two points of the toggle press are swapped."""
    line = scene_files.refused(lambda: compare.check(scene_files.load("toggle_press", changes), samples=24))
    assert "cannot be reached at crank angle" in line
    assert ("sketch" in line) == bool(words)
    assert words in line

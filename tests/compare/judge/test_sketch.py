"""The distance of the linkage from its sketch, and the warnings that name what is far from it."""

from dataclasses import replace

import pytest

import scenes
from compare.engines import registry
from compare.judge.judgement import judgement, off_sketch, warnings
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.reference import Floor, Reference, uncertified
from scenes import Failure, Motion, Sampling, Scene, Status
from tests import scene_files

UPSIDE_DOWN = {"sketch.E": [-27, 46], "sketch.G": [-59, 28], "sketch.F": [-43, 92]}  # the foot over the hip


def unscaled(scene: Scene) -> Reference:
    return Reference(Mechanics(scene), registry.reference(scene), 0.0, {}, {}, Floor({}, ""))


@pytest.mark.parametrize("name", scenes.shipped())
def test_shipped_sketches_are_near(name: str) -> None:
    reference = unscaled(scenes.load(name))
    assert set(off_sketch(reference)) == set(reference.scene.sketch.points)
    assert not [*warnings(reference)]


def test_a_leg_drawn_upside_down_is_named() -> None:
    reference = uncertified(scene_files.load("walking_leg", UPSIDE_DOWN))
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
    assert [sentence.partition("points: ")[2].partition(";")[0] for sentence in named] == (
        ["E by 86 mm"] if displacement == 150 else []
    )


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

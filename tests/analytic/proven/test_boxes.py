"""Random boxes of scenes' ranges hold what 50 digits have at random places in them, in every channel."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import scenes
from analytic.proven.boxes import Boxes, cut
from analytic.recorded.arithmetics import taylor_models
from scenes import Failure, Scene
from scenes.drive import ConstantSpeed
from tests import scene_files
from tests.clean_scenes import clean_scenes
from tests.comparisons import SLOW, sampled

from .test_mutations import Mutation, mutate
from .true_values import BY_50_DIGITS, BY_DOUBLES, Places, escapes, share_known

FEW, MANY, STUDIED = 12, 60, 50
# Dyads of every kind, a larger group, a law by segments, a spline, a press force, tables, springs and friction.
CHOSEN = ("toggle_press", "crank_press_friction", "swinging_segments", "turning_law", "elements", "tangent")
LARGER = ("class_iii", "dump_truck", "scissor_lift", "slotted_class_iii", "class_iii_among_dyads", "andrews_squeezer")
SINGULAR = {
    *("held_twice", "redundant", "parallel_bars"),  # that do not move
    # And those that do not go all the way.
    *("jumps", "parallelogram", "slotted_crank", "slotted_lever", "stephenson_iii", "triple_rocker"),
}
SCENES = sorted({*scenes.shipped(), *(file.stem for file in scene_files.FOLDER.glob("*.toml"))} - SINGULAR)


def slack(scene: Scene) -> float:
    """What 50 digits may be off where a law's positions are rounded to doubles first."""
    return BY_50_DIGITS if isinstance(scene.drive.law, ConstantSpeed) else BY_DOUBLES


def found(scene: Scene, count: int, seed: int) -> list[tuple[str, float, float]]:
    """The escapes at so many places."""
    places = Places.drawn(scene, np.random.default_rng(seed), count)
    return [*escapes(places, places.by_50_digits, slack(scene))]


@sampled(2)
@pytest.mark.parametrize("name", CHOSEN)
def test_no_value_of_50_digits_escapes(name: str) -> None:
    assert found(scene_files.load(name), FEW, 0) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", LARGER)
def test_no_value_of_50_digits_escapes_from_larger_groups(name: str) -> None:
    assert found(scene_files.load(name), MANY, 1) == []


@pytest.mark.study
@pytest.mark.parametrize("name", SCENES)
def test_no_value_of_50_digits_escapes_from_any_scene(name: str) -> None:
    assert found(scene_files.load(name), 5 * MANY, 2) == []


@pytest.mark.parametrize("name", ["toggle_press", "crank_press"])
def test_no_value_of_the_core_escapes(name: str) -> None:
    places = Places.drawn(scene_files.load(name), np.random.default_rng(3), 500)
    assert [*escapes(places, places.by_the_core, BY_DOUBLES)] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_no_value_of_the_core_escapes_from_any_scene(name: str) -> None:
    places = Places.drawn(scene_files.load(name), np.random.default_rng(4), 500)
    assert [*escapes(places, places.by_the_core, BY_DOUBLES)] == []


# Friction is known in narrow boxes only, for which a fifth of the widths drawn is too wide.
@sampled(1)
@pytest.mark.parametrize(
    ("name", "least"), [("toggle_press", 1.0), ("toggle_press_friction", 0.6), ("class_iii", 0.99)]
)
def test_most_is_known(name: str, least: float) -> None:
    assert share_known(Places.drawn(scene_files.load(name), np.random.default_rng(5), MANY)) >= least


@pytest.mark.parametrize("text", [" + third * D**3", "rest + FUNCTION * D"])
def test_what_is_left_out_escapes(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without what a function has beyond its parabola, or without its roundings and its operand's rest."""
    scene = scene_files.load("toggle_press")
    mutate(monkeypatch, Mutation(taylor_models, "_composed", text, "" if "third" in text else "0.0"))
    assert found(scene, FEW, 0)


def drawn(folder: Path, count: int) -> Iterator[Scene]:
    """Random linkages, one half of which have elements and drives of every kind."""
    yield from clean_scenes(folder, count // 2)
    yield from clean_scenes(folder, count - count // 2, elements=True)


def assert_none_escapes(scene: Scene, count: int, seed: int) -> bool:
    """Whether 50 digits have a motion, of which none escapes."""
    try:
        escaped = found(scene, count, seed)
    except Failure:  # friction that jams, in either model
        return False
    assert escaped == [], scene.name
    return True


@SLOW
def test_no_value_of_random_linkages_escapes(tmp_path: Path) -> None:
    assert sum(assert_none_escapes(scene, 4, seed) for seed, scene in enumerate(drawn(tmp_path, 4))) >= 3


@pytest.mark.study
def test_no_value_of_many_random_linkages_escapes(tmp_path: Path) -> None:
    moved = [assert_none_escapes(scene, STUDIED, seed) for seed, scene in enumerate(drawn(tmp_path, 200))]
    assert sum(moved) >= 150


def test_boxes_that_are_cut_leave_nothing_between() -> None:
    """The last part ends where the box does: low + (high - low) is less, or more, where the box is about zero."""
    ends = np.sort(np.random.default_rng(6).uniform(-3, 3, (2, 1000)), axis=0)
    low, high = (of.reshape(64, -1) for of in cut(ends[0], ends[1], 64))
    assert np.array_equal(low, [ends[0], *high[:-1]])
    assert np.array_equal(high[-1], ends[1])


def test_copies_of_a_box_are_all_that_may_be() -> None:
    """A press force comes and goes in wide boxes, each of which is there once with it and once without."""
    boxes = Boxes(scene_files.load("crank_press"), None, {})
    ends = np.linspace(boxes.edges[0], boxes.edges[-1], 9)
    _, own = boxes(ends[:-1], ends[1:])
    assert set(own) == set(range(8))
    assert np.bincount(own).max() == 2

"""Which groups a linkage is made of; branches that a sketch leaves open and bodies held twice over are refused."""

from pathlib import Path

import numpy as np
import pytest

import analytic
import scenes
from scenes import Failure, Status
from tests import scene_files

ROUTES = {
    "shaper": "closed form: crank, RPR, RRP",
    "swinging_block": "closed form: crank, RPR",
    "scotch_yoke": "closed form: crank, RPP",
    "tangent": "closed form: crank, PRP",
    "carried_block": "closed form: crank, RRR, RRP",
    "driven_toggle": "closed form: driven slider, RRR, RRP",
    "slotted_class_iii": "crank, Newton on coupler-plate-upper-block",
    "class_iii": "crank, Newton on coupler-plate-upper-lower",
    "toggle_press": "closed form: crank, RRR, RRP",
}


@pytest.mark.parametrize("name", ROUTES)
def test_route(name: str) -> None:
    assert analytic.route(scene_files.load(name)) == ROUTES[name]


def test_route_of_shipped_scenes() -> None:
    closed = {name: analytic.route(scenes.load(name)).startswith("closed form") for name in scenes.shipped()}
    assert [name for name in closed if not closed[name]] == ["class_iii", "dump_truck", "scissor_lift"]


OPEN: dict[str, tuple[str, scene_files.Changes, str]] = {
    "RRR": ("toggle_press", {"sketch.P3": [240, -101]}, "P3 lies on the line O-P2"),
    "RRP": ("toggle_press", {"sketch.P5": [50, -790]}, "P4-P5 is square to the guide of slider"),
    "RPR": ("slotted_lever", {"sketch.T": [1.5, 3]}, "A-C is square to the guide of block"),
    "PRP": ("slotted_crank", {"sketch.angle": 0.197395559849881}, "guides of block and slider are parallel"),
    "RPP": ("scotch_yoke", {"bodies.yoke.slides.along": [0.2, 1]}, "the guides of yoke and block are parallel"),
}


@pytest.mark.parametrize("kind", OPEN)
def test_a_sketch_that_leaves_the_branch_open_is_refused(kind: str) -> None:
    name, changes, why = OPEN[kind]
    with pytest.raises(Failure, match="the sketch leaves the assembly branch open: ") as caught:
        analytic.solve(scene_files.load(name, changes), [0.0])
    assert caught.value.status is Status.unsupported
    assert why in caught.value.reason


@pytest.mark.parametrize("along", [[0.6, 3], [-1.4, -7], [2e-3, 1e-2]])
def test_parallel_guides_are_parallel_whichever_way_they_are_rounded(along: list[float]) -> None:
    """The same direction in other words differs by a rounding, which must not pick a branch."""
    with pytest.raises(Failure, match="guides of yoke and block are parallel"):
        analytic.route(scene_files.load("scotch_yoke", {"bodies.yoke.slides.along": along}))


def test_bodies_held_twice_over_are_refused() -> None:
    """The count is right as a whole: the rod dangles, but the stay is held by two pins."""
    why = "more joints than freedoms hold stay, and rod can move while the drive is held"
    with pytest.raises(Failure, match=why) as caught:
        analytic.solve(scene_files.load("held_twice"), [0.0])
    assert caught.value.status is Status.unsupported


AFLOAT = """
format = 1
name = "afloat"
ground.points = { O = [0, 0], C = [4, 0] }
bodies.crank.lengths = { "O-A" = 1 }
bodies.link.lengths = { "A-S" = 1.5 }
bodies.other.lengths = { "S-R" = 1.5 }
bodies.plate.points = { P = [0, 0], Q = [1, 0], R = [0, -1] }
bodies.cover.points = { P = [0, 0], Q = [1, 0] }
bodies.cover.slides = { on = "plate", through = [0, 0], along = [1, 0] }
drive = { body = "crank", speed = 1 }
sketch = { angle = 1.0, A = [0.5, 0.8], S = [1.5, 1.5], P = [0.4, 2], R = [0.4, 1], Q = [1.4, 2] }
output = { point = "R" }
"""


def test_bodies_that_hold_only_each_other_are_refused(tmp_path: Path) -> None:
    """The count is right of a plate and its cover too, but what they hang on holds neither of them."""
    path = tmp_path / "afloat.toml"
    path.write_text(AFLOAT)
    with pytest.raises(Failure, match="more joints than freedoms hold plate, cover") as caught:
        analytic.solve(scenes.load(path), [0.0])
    assert caught.value.status is Status.unsupported


def test_no_positions_at_all() -> None:
    """Nothing asked, nothing answered: every channel is there and empty, of dyads and of larger groups."""
    for name in ("shaper", "slotted_class_iii"):
        motion = analytic.solve(scene_files.load(name), np.array([]))
        assert {len(samples) for samples in motion.samples.values()} == {0}
    many = analytic.solve_many(scenes.load("toggle_press"), {"bodies.rod.mass": [60.0, 61]}, [])
    assert many["P5.y"].shape == (2, 0)
    assert many.ok.all()

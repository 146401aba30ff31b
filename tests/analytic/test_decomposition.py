"""Which groups a linkage is made of; branches that a sketch leaves open and bodies held twice over are refused."""

import numpy as np
import pytest

import analytic
import scenes
from scenes import Failure, Status
from scenes.errors import InputError
from tests.conftest import TOGGLE_PRESS, SceneFrom
from tests.mechanisms import MECHANISMS

from .test_motion_range import SCOTCH_YOKE, SLOTTED_CRANK, SLOTTED_LEVER

ROUTES = {
    "quick_return": "closed form: crank, RPR, RRP",
    "swinging_block": "closed form: crank, RPR",
    "scotch_yoke": "closed form: crank, RPP",
    "tangent": "closed form: crank, PRP",
    "carried_block": "closed form: crank, RRR, RRP",
    "driven_toggle": "closed form: driven slider, RRR, RRP",
    "slotted_class_iii": "crank, Newton on coupler-plate-upper-block",
}


@pytest.mark.parametrize("name", ROUTES)
def test_route(scene_from: SceneFrom, name: str) -> None:
    assert analytic.route(scene_from(MECHANISMS[name])) == ROUTES[name]


def test_route_of_shipped_scenes() -> None:
    closed = {name: analytic.route(scenes.load(name)).startswith("closed form") for name in scenes.shipped()}
    assert [name for name in closed if not closed[name]] == ["class_iii"]


# --- an open branch ---------------------------------------------------------------------------------------------------

YOKE_ON_A_SKEW_GUIDE = SCOTCH_YOKE.replace("along = [1, 0] }", "along = [0.1, 1] }")
OPEN = {
    "RRR": (TOGGLE_PRESS.replace("P3 = [0, -300]", "P3 = [240, -101]"), "P3 lies on the line O-P2"),
    "RRP": (TOGGLE_PRESS.replace("P5 = [0, -1090]", "P5 = [50, -790]"), "P4-P5 is square to the guide of slider"),
    "RPR": (SLOTTED_LEVER.replace("T = [-0.3, 0.8]", "T = [1.5, 3]"), "A-C is square to the guide of block"),
    "PRP": (
        SLOTTED_CRANK.replace("angle = 1.5", "angle = 0.197395559849881"),
        "guides of block and slider are parallel",
    ),
    "RPP": (YOKE_ON_A_SKEW_GUIDE, "the guides of yoke and block are parallel"),
}


@pytest.mark.parametrize("kind", OPEN)
def test_a_sketch_that_leaves_the_branch_open_is_refused(scene_from: SceneFrom, kind: str) -> None:
    text, why = OPEN[kind]
    scene = scene_from(text)
    with pytest.raises(Failure, match="the sketch leaves the assembly branch open: ") as caught:
        analytic.solve(scene, [0.0])
    assert caught.value.status is Status.unsupported
    assert why in caught.value.reason


def test_parallel_guides_are_parallel_whichever_way_they_are_rounded(scene_from: SceneFrom) -> None:
    """The same direction in other words differs by a rounding, which must not pick a branch."""
    for along in ("[0.3, 3]", "[-0.7, -7]", "[1e-3, 1e-2]"):
        scene = scene_from(SCOTCH_YOKE.replace("along = [1, 0] }", f"along = {along} }}"))
        with pytest.raises(Failure, match="guides of yoke and block are parallel"):
            analytic.route(scene)


# --- joints -----------------------------------------------------------------------------------------------------------

TWICE = """
format = 1
name = "twice"
ground.points = { O = [0, 0], C = [3, 0], D = [4, 0] }
bodies.crank.lengths = { "O-A" = 1 }
bodies.rod.lengths = { "A-B" = 3 }
bodies.bar.lengths = { "C-E" = 1 }
bodies.strut.lengths = { "D-E" = 1 }
bodies.stay.points = { C = [0, 0], D = [1, 0] }
drive = { body = "crank", speed = 1 }
sketch = { A = [1, 0], B = [4, 0], E = [3.5, 1] }
output = { point = "B" }
"""


def test_bodies_held_twice_over_are_refused(scene_from: SceneFrom) -> None:
    """The count is right as a whole: the rod dangles, but the stay is held by two pins."""
    with pytest.raises(Failure, match="stay are held by more joints than they have freedoms") as caught:
        analytic.solve(scene_from(TWICE), [0.0])
    assert caught.value.status is Status.unsupported


@pytest.mark.parametrize(
    ("old", "new", "kind"),
    [
        ('[bodies.rod]\nlengths = { "P4-P5" = 300 }\nmass = 60\n', "", "under-constrained"),
        (
            "[drive]",
            '[bodies.stay]\nlengths = { "P3-P1" = 500 }\nmass = 1\n[drive]',
            "over-constrained",
        ),
    ],
)
def test_too_many_or_too_few_joints_as_a_whole(scene_from: SceneFrom, old: str, new: str, kind: str) -> None:
    assert old in TOGGLE_PRESS
    text = TOGGLE_PRESS.replace(old, new)
    with pytest.raises(InputError, match=kind):
        scene_from(text)


def test_no_positions_at_all(scene_from: SceneFrom) -> None:
    """Nothing asked, nothing answered: every channel is there and empty, of dyads and of larger groups."""
    for text in (MECHANISMS["quick_return"], MECHANISMS["slotted_class_iii"]):
        motion = analytic.solve(scene_from(text), np.array([]))
        assert {len(samples) for samples in motion.samples.values()} == {0}

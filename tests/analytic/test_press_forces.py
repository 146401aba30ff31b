"""Dead points and the ends of strokes by hand, and a press force that acts there and nowhere else."""

from math import asin, cos, hypot, pi, sin, sqrt
from typing import Any

import numpy as np
import pytest

import analytic
from analytic.core.decomposition import decompose
from analytic.core.geometry import guide_of
from analytic.core.kinematics import followed
from analytic.way.slider import dead_points, stroke_end
from scenes import InputError, Scene
from scenes.scene import PressForce
from tests import scene_files
from tests.comparisons import sampled

from .newton import displaced

OFFSET = {"bodies.slider.slides.through": [0.5, 0.8], "sketch.B": [3.7, 0.8]}


def pressed(force: float = -50.0, **drive: Any) -> scene_files.Changes:
    """Return what makes the slider-crank's load a press force, and changes its drive."""
    load = {"body": "slider", "at": "B", "force": [force, 7], "last": 0.3}
    return {"loads": [load]} | {f"drive.{key}": value for key, value in drive.items()}


def end_of_stroke(scene: Scene) -> float:
    (load,) = (load for load in scene.loads if isinstance(load, PressForce))
    return float(stroke_end(scene, followed(scene, decompose(scene)), load.body, load.closing))


def test_dead_points_of_an_offset_slider_crank() -> None:
    """Crank and rod are in line there: the rod's end is 3 + 1, or 3 - 1, from the crank's pivot, and 0.8 above it."""
    scene = scene_files.load("slider_crank", OFFSET)
    outer, inner = dead_points(displaced(scene, "B"), 0.0, 2 * pi)
    assert outer == pytest.approx(asin(0.8 / 4), abs=1e-14)  # roundings of a slope that s'' = 1 turns into an angle
    assert inner == pytest.approx(pi + asin(0.8 / 2), abs=1e-14)
    s, ds, _ = displaced(scene, "B")(np.array([outer, inner]))
    assert s == pytest.approx([sqrt(4**2 - 0.8**2) - 0.5, sqrt(2**2 - 0.8**2) - 0.5], abs=1e-15)
    assert np.abs(ds).max() <= 1e-14


def x_of(angle: float) -> float:
    return cos(angle) + sqrt(9 - sin(angle) ** 2)


def part(start: float, end: float) -> scene_files.Changes:
    return pressed(speed=10 if end > start else -10, start=start, end=end)


# A force against the guide's direction is met by a slider that moves along it, and the other way round. A cycle that
# never comes to the dead point ends its stroke at one of its own ends.
STROKES: dict[str, tuple[scene_files.Changes, float]] = {
    "outer dead point": (OFFSET | pressed(-50.0), sqrt(4**2 - 0.8**2) - 0.5),
    "inner dead point": (OFFSET | pressed(50.0), sqrt(2**2 - 0.8**2) - 0.5),
    "start": (part(0.3, 1.2), x_of(0.3)),
    "end": (part(1.2, 0.3), x_of(0.3)),
    "dead point within": (part(-0.4, 1.2), 4.0),
    "end before it": (part(6.0, 6.2), x_of(6.2)),
}


@pytest.mark.parametrize("case", STROKES)
def test_a_stroke_ends_at_its_dead_point_or_with_the_drive(case: str) -> None:
    changes, furthest = STROKES[case]
    assert end_of_stroke(scene_files.load("slider_crank", changes)) == pytest.approx(furthest, abs=1e-15)


def test_a_stroke_ends_where_a_law_turns_back() -> None:
    """A law that swings between its knots goes a little beyond them; at its furthest its rate is zero."""
    law = [[0, 0.5], [0.3, 0.9], [0.7, 1.4], [1, 1.1]]
    scene = scene_files.load("slider_crank", pressed(50.0, law=law, speed=None))
    time = np.linspace(0, 1, 200_001)
    furthest = scene.drive.law.at(time).position.max()
    assert furthest > 1.4
    # The law's peak lies between two of ten thousand instants: its extent misses 1e-9 of a swing of one radian there.
    assert end_of_stroke(scene) == pytest.approx(x_of(furthest), abs=1e-8)


@sampled(1)
@pytest.mark.parametrize(("start", "end"), [(-60, 60), (25, 35)])
def test_a_stroke_of_nothing_but_a_larger_group(start: float, end: float) -> None:
    """Part of a turn without a dead point, behind a group that Newton's method solves."""
    ram = {"points": {"E": [0, 0]}, "mass": 3, "slides": {"through": [0, 200], "along": [1, 0]}}
    changes = {
        "bodies.rod": {"lengths": {"P1-E": 300}, "mass": 1},
        "bodies.ram": ram,
        "loads": [{"body": "ram", "at": "E", "force": [-100, 0], "last": 5}],
        "sketch.E": [737, 200],
        "drive.start": start,
        "drive.end": end,
    }
    scene = scene_files.load("slotted_class_iii", changes)
    angle = np.linspace(*scene.drive.law.extent, 801)
    furthest = analytic.solve(scene, angle)["E.x"].max()
    assert 0 <= end_of_stroke(scene) - furthest <= 1e-7  # a dead point between two angles: s'' h^2 / 8


def test_the_guide_is_that_on_the_ground() -> None:
    """The block on the carriage comes first in the file; the guide of the pin that both share is not the block's."""
    scene = scene_files.load("shared_pin")
    assert analytic.route(scene) == "closed form: crank, RRP, RPP"
    t, through = guide_of(scene, "B")
    assert complex(t) == 1
    assert through == 0
    angle = np.linspace(0, 6, 31)
    motion = analytic.solve(scene, angle)
    s, _, _ = displaced(scene, "B")(angle)
    assert s == pytest.approx(motion["B.x"], abs=1e-15)
    # The carriage keeps above the block: its guide y = 2 + (x - 5) / 2, its own x that of B.
    along = hypot(1, 0.5)
    carried, _, _ = displaced(scene, "E")(angle)
    assert carried == pytest.approx((motion["B.x"] - 5) * along, abs=1e-14)
    with pytest.raises(InputError, match="A is on no body that slides on the ground"):
        displaced(scene, "A")

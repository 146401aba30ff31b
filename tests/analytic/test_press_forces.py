"""Dead points and the ends of strokes by hand, and a press force that acts there and nowhere else."""

from math import asin, cos, hypot, pi, sin, sqrt

import numpy as np
import pytest

import analytic
import scenes
from analytic.dead_points import dead_points, displacement, guide_of, stroke_end
from analytic.decomposition import decompose
from analytic.kinematics import followed
from scenes import Scene
from scenes.scene import PressForce
from tests.conftest import SceneFrom
from tests.mechanisms import MECHANISMS, with_drive

from .test_solve import SLIDER_CRANK

OFFSET = SLIDER_CRANK.replace("through = [0, 0]", "through = [0.5, 0.8]").replace("B = [3.8, 0]", "B = [3.7, 0.8]")


def pressed(text: str, force: float = -50.0, last: float = 0.3) -> str:
    return text.replace("force = [-50, 0]", f"force = [{force}, 7]\nlast = {last}")


def end_of_stroke(scene: Scene) -> float:
    (load,) = (load for load in scene.loads if isinstance(load, PressForce))
    return stroke_end(scene, followed(scene, decompose(scene)), load)


# --- by hand ----------------------------------------------------------------------------------------------------------


def test_dead_points_of_an_offset_slider_crank(scene_from: SceneFrom) -> None:
    """Crank and rod are in line there: the rod's end is 3 + 1, or 3 - 1, from the crank's pivot, and 0.8 above it."""
    scene = scene_from(OFFSET)
    displaced = displacement(scene, followed(scene, decompose(scene)), "B")
    outer, inner = dead_points(displaced, 0.0, 2 * pi)
    assert outer == pytest.approx(asin(0.8 / 4), abs=1e-14)  # roundings of a slope that s'' = 1 turns into an angle
    assert inner == pytest.approx(pi + asin(0.8 / 2), abs=1e-14)
    s, ds, _ = displaced(np.array([outer, inner]))
    assert s == pytest.approx([sqrt(4**2 - 0.8**2) - 0.5, sqrt(2**2 - 0.8**2) - 0.5], abs=1e-15)
    assert np.abs(ds).max() <= 1e-14


def test_displacements_have_their_derivatives(scene_from: SceneFrom) -> None:
    """Sixth-order differences, h^6 f^(7) / 140, and roundings over h."""
    scene = scene_from(OFFSET)
    displaced = displacement(scene, followed(scene, decompose(scene)), "B")
    x, h = np.linspace(0, 6, 40), 1e-2
    weights = {1: 3 / 4, 2: -3 / 20, 3: 1 / 60}
    for order in (0, 1):
        slope = sum(w * (displaced(x + n * h)[order] - displaced(x - n * h)[order]) for n, w in weights.items()) / h
        assert np.abs(slope - displaced(x)[order + 1]).max() <= 1e-10


@pytest.mark.parametrize(("force", "reach"), [(-50.0, 4), (50.0, 2)])
def test_a_stroke_ends_at_the_dead_point_that_the_force_looks_at(
    scene_from: SceneFrom, force: float, reach: float
) -> None:
    """A force against the guide's direction is met by a slider that moves along it, and the other way round."""
    scene = scene_from(pressed(OFFSET, force))
    assert end_of_stroke(scene) == pytest.approx(sqrt(reach**2 - 0.8**2) - 0.5, abs=1e-15)


def x_of(angle: float) -> float:
    return cos(angle) + sqrt(9 - sin(angle) ** 2)


@pytest.mark.parametrize(
    ("start", "end", "furthest"),
    [(0.3, 1.2, x_of(0.3)), (1.2, 0.3, x_of(0.3)), (-0.4, 1.2, 4.0), (6.0, 6.2, x_of(6.2))],
)
def test_a_stroke_ends_with_the_drive(scene_from: SceneFrom, start: float, end: float, furthest: float) -> None:
    """A cycle that never comes to the dead point ends its stroke at one of its own ends."""
    speed = 10 if end > start else -10
    scene = scene_from(pressed(SLIDER_CRANK).replace("speed = 10", f"speed = {speed}\nstart = {start}\nend = {end}"))
    assert end_of_stroke(scene) == pytest.approx(furthest, abs=1e-15)


def test_a_stroke_ends_where_a_law_turns_back(scene_from: SceneFrom) -> None:
    """A law that swings between its knots goes a little beyond them; at its furthest its rate is zero."""
    law = "law = [[0, 0.5], [0.3, 0.9], [0.7, 1.4], [1, 1.1]]\n"
    scene = scene_from(pressed(SLIDER_CRANK, 50.0).replace("speed = 10\n", law))
    time = np.linspace(0, 1, 200_001)
    furthest = scene.drive.at(time).position.max()
    assert furthest > 1.4
    # The law's peak lies between two of ten thousand instants: its extent misses 1e-9 of a swing of one radian there.
    assert end_of_stroke(scene) == pytest.approx(x_of(furthest), abs=1e-8)


def test_the_end_of_a_driven_platen_is_its_lock() -> None:
    """The toggle goes through its lock: the platen is furthest where A, B and C are in line, hypot by hand."""
    text = scenes.load("double_toggle_clamp", {"drive.end": 260})
    displaced = displacement(text, followed(text, decompose(text)), "C")
    (dead,) = dead_points(displaced, *text.drive.extent)
    furthest = sqrt((0.352 + 0.457) ** 2 - 0.06347340844382656**2)
    assert displaced(np.array([dead]))[0] == pytest.approx(furthest, abs=1e-15)


# --- where it acts ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("speed", [10, -10])
def test_it_acts_in_the_last_of_the_closing_stroke_alone(scene_from: SceneFrom, speed: int) -> None:
    """Between the two, channel by channel to the bit: with the force all the time, and without any."""
    text = SLIDER_CRANK.replace("speed = 10", f"speed = {speed}")
    angle = np.linspace(0.01, 6.27, 501)
    never, always, press = (
        analytic.solve(scene_from(of), angle)
        for of in (text.replace("[-50, 0]", "[0, 0]"), text.replace("[-50, 0]", "[-50, 7]"), pressed(text))
    )
    acts = (np.array([x_of(a) for a in angle]) > 4 - 0.3) & (-speed * np.sin(angle) > 0)
    assert 0 < acts.sum() < 0.2 * len(angle)
    for channel in press.samples:
        assert np.array_equal(press[channel], np.where(acts, always[channel], never[channel])), channel


def test_it_acts_on_the_platen_of_a_driven_slider(scene_from: SceneFrom) -> None:
    """Here the toggle opens; by virtual power the crosshead's force is larger by 900 N against dx / dq."""
    table = "table = [[500, 0], [700, 2000]]"
    assert table in MECHANISMS["driven_toggle"]
    press, free = (
        scene_from(MECHANISMS["driven_toggle"].replace(table, load))
        for load in ("force = [900, 0]\nlast = 20", "force = [0, 0]")
    )
    q = np.linspace(*press.drive.extent, 301)[1:-1]
    pressing, freely = analytic.solve(press, q), analytic.solve(free, q)
    x, slope = freely["C.x"], freely["C.vx"] / press.drive.at(0.0).rate
    acts = (x <= x.min() + 0.02) & (freely["C.vx"] < 0)  # its end is that of the way, but for one step of the grid
    more = pressing["drive.force"] - freely["drive.force"]
    assert 0 < acts.sum() < len(q)
    assert np.abs(more[~acts]).max() == 0
    inside = acts & (x <= x.min() + 0.019)
    assert np.abs(more[inside] + 900 * slope[inside]).max() <= 1e-9  # some thousand newtons, rounded


def test_a_stroke_of_nothing_but_a_larger_group(scene_from: SceneFrom) -> None:
    """Part of a turn without a dead point, behind a group that Newton's method solves."""
    text = MECHANISMS["slotted_class_iii"].replace(
        "[drive]",
        '[bodies.rod]\nlengths = { "P1-E" = 300 }\nmass = 1\n'
        "[bodies.ram]\npoints = { E = [0, 0] }\nmass = 3\nslides = { through = [0, 200], along = [1, 0] }\n[drive]",
    )
    text = text.replace("[sketch]", '[[loads]]\nbody = "ram"\nat = "E"\nforce = [-100, 0]\nlast = 5\n[sketch]')
    text = text.replace("P1 = [440, 240]", "P1 = [440, 240]\nE = [737, 200]")
    for drive in ("speed = 60\nstart = -60\nend = 60", "speed = 60\nstart = 25\nend = 35"):
        scene = scene_from(with_drive(text, f'[drive]\nbody = "crank"\n{drive}\n'))
        angle = np.linspace(*scene.drive.extent, 801)
        furthest = analytic.solve(scene, angle)["E.x"].max()
        assert 0 <= end_of_stroke(scene) - furthest <= 1e-7  # a dead point between two angles: s'' h^2 / 8


# --- whose guide ------------------------------------------------------------------------------------------------------


def test_the_guide_is_that_on_the_ground(scene_from: SceneFrom) -> None:
    """A block that slides on another slider shares the pin, first in the file; its guide is not the slider's."""
    text = """
format = 1
name = "shared_pin"
ground.points = { O = [0, 0] }
bodies.crank.lengths = { "O-A" = 1 }
bodies.block.points = { B = [0, 0] }
bodies.block.slides = { on = "carriage", through = [0, 0], along = [0, 1] }
bodies.rod.lengths = { "A-B" = 3 }
bodies.slider.points = { B = [0, 0] }
bodies.slider.slides = { through = [0, 0], along = [1, 0] }
bodies.carriage.points = { E = [0, 0] }
bodies.carriage.slides = { through = [5, 2], along = [1, 0.5] }
drive = { body = "crank", speed = 1 }
sketch = { A = [1, 0], B = [4, 0] }
output = { slider = "B" }
"""
    scene = scene_from(text)
    assert analytic.route(scene) == "closed form: crank, RRP, RPP"
    t, through = guide_of(scene, "B")
    assert complex(t) == 1
    assert through == 0
    angle = np.linspace(0, 6, 31)
    motion = analytic.solve(scene, angle)
    s, _, _ = displacement(scene, followed(scene, decompose(scene)), "B")(angle)
    assert s == pytest.approx(motion["B.x"], abs=1e-15)
    # The carriage keeps above the block: its guide y = 2 + (x - 5) / 2, its own x that of B.
    along = hypot(1, 0.5)
    carried, _, _ = displacement(scene, followed(scene, decompose(scene)), "E")(angle)
    assert carried == pytest.approx((motion["B.x"] - 5) * along, abs=1e-14)
    with pytest.raises(ValueError, match="A is on no body that slides on the ground"):
        displacement(scene, followed(scene, decompose(scene)), "A")

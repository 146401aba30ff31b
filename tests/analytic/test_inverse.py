"""From the slider back to the drive: by hand on a slider-crank, and there and back on presses and a driven slider."""

from math import pi

import numpy as np
import pytest

import analytic
import scenes
from analytic.way.slider import InverseStroke
from scenes import Failure, InputError, Scene, Status
from tests import scene_files

from .newton import displaced


def test_slider_crank_by_hand() -> None:
    """With x = r cos + sqrt(l^2 - r^2 sin^2), cos(theta) = (x^2 + r^2 - l^2) / (2 r x): one angle up, one down."""
    scene = scene_files.load("slider_crank")
    x = np.array([2.1, 2.5, 3.0, 3.9])
    by_hand = np.arccos((x**2 + 1 - 9) / (2 * x))
    out, back = sorted(analytic.inverse(scene, x), key=lambda stroke: stroke.start % (2 * np.pi))
    # arccos amplifies roundings by 1 / sin(angle), 1 / 0.3 at most here
    assert np.abs(out.position % (2 * np.pi) - by_hand).max() <= 1e-14
    assert np.abs(back.position % (2 * np.pi) - (2 * np.pi - by_hand)).max() <= 1e-14


def test_there_and_back(toggle_press: Scene) -> None:
    """Where the crank is, how fast it turns and speeds up, from the slider's own motion: constant speed comes back."""
    angle = np.radians(np.arange(30, 190, 7.0))  # one stroke, upwards, away from both dead points
    motion = analytic.solve(toggle_press, angle)
    strokes = analytic.inverse(toggle_press, motion["P5.y"], motion["P5.vy"], motion["P5.ay"])
    assert len(strokes) == 2
    assert np.degrees([stroke.start for stroke in strokes]) == pytest.approx([12.8, 208.6], abs=0.05)
    up = strokes[0]
    slope = np.abs(displaced(toggle_press, "P5")(angle)[1]).min()  # m a radian: a rounding of s is this much angle
    assert np.abs(up.position - angle).max() <= 4 * 2.3e-16 / slope
    assert np.abs(up.rate - 2 * np.pi).max() <= 1e-10  # that angle error, times s'' / s'
    assert np.abs(up.acceleration).max() <= 1e-8  # and once more
    down = strokes[1]
    assert np.abs(analytic.solve(toggle_press, down.position)["P5.y"] - motion["P5.y"]).max() <= 1e-15


def test_strokes_end_at_dead_points_and_out_of_reach_is_not_a_number(toggle_press: Scene) -> None:
    for stroke in analytic.inverse(toggle_press, [-1.2, -1.0, -0.9]):
        assert np.abs(displaced(toggle_press, "P5")(np.array([stroke.start, stroke.end]))[1]).max() <= 1e-14
        assert np.isnan([stroke.position, stroke.rate]).tolist() == [[True, False, True]] * 2


SHORT_ROD = {"bodies.rod.lengths.A-B": 0.5}
IDLE = {
    "ground.points.Q": [0, 1],
    "bodies.stay": {"lengths": {"Q-S": 0.5}, "mass": 1},
    "bodies.stopped": {"points": {"S": [0, 0]}, "slides": {"through": [0.3, 0.1], "along": [0, 1]}, "mass": 1},
    "sketch.S": [0.3, 1.4],
    "output.slider": "S",
}


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"output": {"point": "A"}}, "A is on no body that slides"),
        # A bar from the ground to a slider of its own: neither tells where the crank is.
        (IDLE, "S stands still wherever the drive is"),
        (IDLE | {"drive.start": 0.5, "drive.end": 1.5}, "S stands still wherever the drive is"),
    ],
)
def test_a_point_that_tells_nothing_of_the_drive(changes: scene_files.Changes, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        analytic.inverse(scene_files.load("slider_crank", changes), 1.4)


def driven_as_told(scene: Scene, stroke: InverseStroke, moved: np.ndarray[tuple[int], np.dtype[np.float64]]) -> float:
    """Return how far the drive that a stroke asks for is from moving the output as it moved, relative to its range.

    Position, velocity and acceleration follow from displacements by chain rule: s, s' x', s' x'' + s'' x'^2.
    """
    s, ds, dds = displaced(scene, scene.output)(stroke.position)
    told = np.array([s, ds * stroke.rate, ds * stroke.acceleration + dds * stroke.rate**2])
    return float((np.abs(told - moved).max(axis=1) / np.abs(moved).max(axis=1)).max())


def test_there_and_back_with_a_driven_slider() -> None:
    """The platen's own motion at a constant speed of the crosshead gives back that speed and where it was."""
    scene = scene_files.load("driven_toggle")
    position = np.linspace(*scene.drive.law.extent, 41)[1:-1]
    motion = analytic.solve(scene, position)
    moved = np.array([motion["C.x"], motion["C.vx"], motion["C.ax"]])
    (stroke,) = analytic.inverse(scene, *moved)
    assert (stroke.start, stroke.end) == scene.drive.law.extent
    assert np.abs(stroke.position - position).max() <= 1e-14  # a rounding of 0.7 m, s' being 0.5 and more
    assert np.abs(stroke.rate + 0.15).max() <= 1e-13
    assert np.abs(stroke.acceleration).max() <= 1e-12
    assert driven_as_told(scene, stroke, moved) <= 1e-13  # the same roundings, back again


def test_the_lock_of_a_driven_toggle_is_a_dead_point() -> None:
    """A way that goes on beyond the lock, where A, B and C are in line: the platen is at each place twice."""
    scene = scenes.load("double_toggle_clamp", {"drive.end": 260})
    lock = 0.2355892945761355  # m, of the crosshead; the end of the shipped scene's way
    opening, closing = analytic.inverse(scene, 0.8064)
    assert opening.end == closing.start == pytest.approx(lock, abs=1e-9)  # the number of the scene has that many digits
    for stroke in (opening, closing):
        position = float(stroke.position[0])
        assert analytic.solve(scene, [position])["C.x"][0] == pytest.approx(0.8064, abs=1e-15)
    assert opening.position[0] < lock < closing.position[0]


@pytest.mark.parametrize(("start", "end"), [(-20, 150), (150, -20), (190, 200)])
def test_part_of_a_turn(start: float, end: float) -> None:
    """Strokes end where the drive does, too; the crank passes a dead point at 0 deg, or none."""
    ends = {"drive.start": float(np.radians(start)), "drive.end": float(np.radians(end))}
    scene = scene_files.load("slider_crank", {"drive.speed": 10 if end > start else -10} | ends)
    strokes = analytic.inverse(scene, 3.98 if start != 190 else 2.04)
    found = np.degrees([strokes[0].start, *(stroke.end for stroke in strokes)])
    expected = [190, 200] if start == 190 else [-20, 0, 150]
    assert found == pytest.approx(expected, abs=1e-12)  # a rounding in radians
    for stroke in strokes:
        x = analytic.solve(scene, stroke.position)["B.x"]
        assert x == pytest.approx(3.98 if start != 190 else 2.04, abs=1e-15)


def test_a_law_that_turns_on_is_a_whole_turn() -> None:
    """The quick-return mechanism has two strokes a turn, whatever law drives it; on part of a turn they end with it."""
    turning, swinging = (scene_files.load(name) for name in ("turning_law", "swinging_law"))
    forth, back = analytic.inverse(turning, 0.3)
    assert forth.end == back.start
    assert back.end == pytest.approx(forth.start + 2 * pi, abs=1e-13)  # a rounding of the angle
    for stroke in analytic.inverse(swinging, 0.3):
        least, most = swinging.drive.law.extent
        assert least <= stroke.start <= stroke.end <= most


def test_what_does_not_assemble_all_the_way_is_refused() -> None:
    scene = scene_files.load("slider_crank", SHORT_ROD)
    with pytest.raises(Failure, match="the crank turns only from") as caught:
        analytic.inverse(scene, 1.0)
    assert caught.value.status is Status.cannot_assemble
    with pytest.raises(Failure, match="the guides of block and slider parallel"):  # beyond, they cross all the same
        analytic.inverse(scene_files.load("slotted_crank"), 1.0)
    part = scene_files.load("slider_crank", {**SHORT_ROD, "drive.start": -0.4, "drive.end": 0.3})
    (forth, back) = analytic.inverse(part, 1.45)
    assert forth.position[0] == pytest.approx(-back.position[0], abs=1e-13)  # s' is 0.8 there

"""Reactions and the drive's effort, worked by hand."""

from dataclasses import replace
from math import cos, pi, sin, sqrt

import numpy as np
import pytest

from scenes import Failure, Scene, Status
from scenes.loads import PressForce
from scenes.model.motion import channels
from scenes.scene import MotionLaw
from tests import scene_files

from .runs import EPS, closed, continuing, run, slider_crank

flint = pytest.importorskip("flint")

from sim_models.multiprecision.constraints import LinkageEquations  # noqa: E402  (their engine is there)
from sim_models.multiprecision.start import end_of_stroke  # noqa: E402


def test_slider_crank_statics_by_hand() -> None:
    """At 90 deg the massless rod of length 2 pushes along (√3, -1)/2 from the crank pin (0, 1)."""
    motion = run(slider_crank({"loads": [{"body": "slider", "at": "C", "force": [-100, 0]}]}), samples=4)
    push = 100 / sqrt(3)
    expected = {
        "crank_angle": pi / 2,
        "B.x": sqrt(3),
        "B.vx": -2.0,
        "rod.angle": -pi / 6,
        "B.fx": 100.0,  # of the rod on the slider
        "B.fy": -push,
        "A.fx": 100.0,  # of the crank on the rod
        "O.fx": 100.0,  # of the ground on the crank
        "O.fy": -push,
        "slider.guide_force": push,
        "slider.guide_moment": -50.0,  # against the load, half a metre above B
        "drive.torque": -100.0,  # the load helps: 100 N at 1 m/rad
    }
    for channel, value in expected.items():
        assert abs(motion[channel][1] / value - 1) <= 4 * EPS  # pi/2 as a double, and the roots in this list


def test_unbalanced_crank_by_hand() -> None:
    """One body backwards in its weight: the torque holds the weight, the pivot holds it on its circle."""
    changes = {
        "gravity": [0, -10],
        "ground.points.O": [1, 2],
        "drive": {"body": "crank", "speed": -3, "start": 0.5},
        "bodies.crank.com": [0.5, 0],
        "bodies.crank.inertia": 0.2,
        "sketch": {"angle": 7},
    }
    motion = run(scene_files.load("crank", changes), samples=8)
    angle = 0.5 - np.arange(9) * pi / 4
    expected = {
        "crank_angle": angle,
        "crank.angle": (angle + pi) % (2 * pi) - pi,
        "T.y": 2 + 2 * np.sin(angle),
        "O.fx": -4 * 9 * 0.5 * np.cos(angle),
        "O.fy": 40 - 4 * 9 * 0.5 * np.sin(angle),
        "drive.torque": 40 * 0.5 * np.cos(angle),
    }
    for channel, values in expected.items():
        assert np.abs(motion[channel] - values).max() <= 100 * EPS  # of values up to 60, in numpy


def test_scene_without_masses_moves_alike_and_has_no_forces() -> None:
    without = slider_crank({f"bodies.{body}.mass": None for body in ("crank", "rod", "slider")})
    motion = run(without)
    assert set(motion.samples) == set(channels(without))
    assert "drive.torque" not in motion
    assert np.array_equal(motion["B.ax"], run(slider_crank())["B.ax"])


def stroke_end(scene: Scene, force: float) -> float:
    load = PressForce("slider", "B", (force, 0.0), 0.1, -1 if force > 0 else 1)
    with flint.ctx.workdps(50):
        linkage = LinkageEquations(scene)
        continuation = continuing(linkage)
        q = continuation.follow(closed(linkage, continuation), linkage.drive(scene.drive.start))
        return end_of_stroke(linkage, continuation, q, load)


def test_a_closing_stroke_ends_at_the_dead_point() -> None:
    scene, offset = slider_crank(), slider_crank({"bodies.slider.slides.through": [0.5, 0.3]})
    for force, closed_by in ((-1.0, 3.0), (1.0, 1.0)):
        assert abs(stroke_end(scene, force) - closed_by) <= 4 * EPS
        assert abs(stroke_end(offset, force) - (sqrt(closed_by**2 - 0.3**2) - 0.5)) <= 4 * EPS


def reach(angle: float) -> float:
    return cos(angle) + sqrt(4 - sin(angle) ** 2)


def test_a_closing_stroke_ends_where_a_run_does() -> None:
    """Away from the dead points: at the run's ends, or where the law turns round, there also between two samples."""
    way = slider_crank({"drive.start": 0.5, "drive.end": 2.5})
    assert abs(stroke_end(way, -1.0) - reach(0.5)) <= 4 * EPS
    assert abs(stroke_end(way, 1.0) - reach(2.5)) <= 4 * EPS
    law = MotionLaw("crank", (0.0, 1.0, 2.0, 3.0), (1.0, 1.0 + 4 / 9, 1.0 + 2 / 9, 1.0), periodic=False)
    a, b, c = np.polyfit(law.times, law.positions, 3)[:3]  # four entries: the spline is one cubic
    turn = (-b - sqrt(b * b - 3 * a * c)) / (3 * a)
    farthest = float(law.at(turn).position)
    assert abs(stroke_end(replace(way, drive=law), 1.0) - reach(farthest)) <= 4 * EPS
    assert abs(stroke_end(replace(way, drive=law), -1.0) - reach(float(law.extent[0]))) <= 4 * EPS


def test_table_in_a_press_by_hand() -> None:
    """Massless: the drive's power is the load's. Below, between and beyond the entries."""
    table = {"body": "slider", "at": "C", "table": [[1.5, -10], [2, -50], [2.5, 40]]}
    motion = run(slider_crank({"loads": [table]}), samples=24)
    force = np.interp(motion["B.x"], [1.5, 2, 2.5], [-10, -50, 40])
    assert {-10.0, 40.0} < set(force)
    assert np.abs(motion["drive.torque"] * 2 + force * motion["B.vx"]).max() <= 1e-12  # of 100 W, in doubles


def test_spring_without_a_direction_is_refused() -> None:
    """The slider's corner C, half a metre above B, meets the ground point P at the start."""

    def sprung(length: float) -> Scene:
        spring = {"between": ["ground.P", "slider.C"], "stiffness": 5, "length": length}
        return slider_crank({"ground.points.P": [3, 0.5], "springs": [spring]})

    with pytest.raises(Failure, match=r"ground\.P and slider\.C meet at crank angle 0\.000000 rad") as failure:
        run(sprung(0.1))
    assert failure.value.status is Status.nonfinite
    motion = run(sprung(0))
    assert np.abs(motion["A.fx"] + 5 * (3 - motion["B.x"])).max() <= 16 * EPS  # of 10 N; the crank holds it

"""Reactions and the drive's effort, worked by hand."""

from math import cos, sin, sqrt

import numpy as np
import pytest

from scenes import Failure, Scene, Status
from scenes.elements.loads import PressForce
from scenes.scene import MotionLaw

from .runs import EPS, closed, continuing, run, slider_crank

flint = pytest.importorskip("flint")

from sim_models.multiprecision.constraints import LinkageEquations  # noqa: E402  (their engine is there)
from sim_models.multiprecision.start import closing_sign, end_of_stroke  # noqa: E402


def test_scene_without_masses_moves_alike_and_has_no_forces() -> None:
    without = slider_crank({f"bodies.{body}.mass": None for body in ("crank", "rod", "slider")})
    motion = run(without)
    assert set(motion.samples) == set(without.channels.names())
    assert "drive.torque" not in motion
    assert np.array_equal(motion["B.ax"], run(slider_crank())["B.ax"])


def stroke_end(scene: Scene, force: float) -> float:
    load = PressForce("slider", "B", (force, 0.0), 0.1, -1 if force > 0 else 1)
    with flint.ctx.workdps(50):
        linkage = LinkageEquations(scene)
        continuation = continuing(linkage)
        q = continuation.follow(closed(linkage, continuation), linkage.drive(scene.drive.law.start))
        return end_of_stroke(linkage, continuation, q, load.body, closing_sign(scene, load))


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
    law = MotionLaw((0.0, 1.0, 2.0, 3.0), (1.0, 1.0 + 4 / 9, 1.0 + 2 / 9, 1.0), periodic=False)
    a, b, c = np.polyfit(law.times, law.positions, 3)[:3]  # four entries: the spline is one cubic
    turn = (-b - sqrt(b * b - 3 * a * c)) / (3 * a)
    farthest = float(law.at(turn).position)
    assert abs(stroke_end(way.with_law(law), 1.0) - reach(farthest)) <= 4 * EPS
    assert abs(stroke_end(way.with_law(law), -1.0) - reach(float(law.extent[0]))) <= 4 * EPS


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

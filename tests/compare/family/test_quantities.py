"""The quantities of a family against formulas and geometry written here."""

from collections.abc import Callable, Iterator
from math import acos, asin, cos, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

import analytic
import scenes
from compare.engines.reference import Floor
from compare.family.family import Member
from tests import scene_files

from .runs import CRANK_SLIDER, ROCKER, one, run, solved


@pytest.fixture(scope="module", autouse=True)
def _uncertified() -> Iterator[None]:
    """Leave out the 50 digits, which take most of the time and which no quantity depends on."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("compare.judge.floor.certified", lambda *_: Floor({}, "not certified"))
        yield


@pytest.fixture(scope="module")
def crank_sliders() -> list[Member]:
    """Rods of 250, 300 and 350 mm on a crank of 100 mm, the guide 40 mm beside its centre."""
    return run(CRANK_SLIDER, ["bodies.rod.lengths.A-B=250:350:3"])


@pytest.mark.parametrize("number", [0, 1, 2])
def test_an_offset_crank_slider_by_its_formulas(crank_sliders: list[Member], number: int) -> None:
    """Slider at x(a) = r cos a + sqrt(l^2 - (r sin a - e)^2), a = 4 pi t; dead where crank and rod are in line."""
    r, e, length, w = 0.1, 0.04, (0.25, 0.3, 0.35)[number], 4 * pi
    q = solved(crank_sliders[number]).quantities

    def x(a: float) -> float:
        return r * cos(a) + sqrt(length**2 - (r * sin(a) - e) ** 2)

    outer, inner = sqrt((length + r) ** 2 - e**2), sqrt((length - r) ** 2 - e**2)
    assert q["stroke"] == pytest.approx(outer - inner, rel=1e-10)
    assert q["bottom"] == pytest.approx(inner + 0.02 - 0.015, rel=1e-10)  # of the output point, from `through`
    out, back = asin(e / (length + r)), pi + asin(e / (length - r))  # crank angles of the dead points
    closing = back - out
    assert q["quick return"] == pytest.approx(closing / (2 * pi - closing), rel=1e-6)  # linear between 3600 samples
    near = inner + 0.01 * (outer - inner)
    dwell = brentq(lambda a: x(a) - near, back, back + 1.5) - brentq(lambda a: x(a) - near, back - 1.5, back)
    assert q["dwell"] == pytest.approx(dwell / w, rel=2e-5)
    assert q["dwell share"] == pytest.approx(dwell / (2 * pi), rel=2e-5)

    def speed(a: float) -> float:
        s = r * sin(a) - e
        return -w * r * (sin(a) + s * cos(a) / sqrt(length**2 - s**2))

    def acceleration(a: float, h: float = 1e-5) -> float:
        return w * (speed(a + h) - speed(a - h)) / (2 * h)

    assert q["peak velocity"] == pytest.approx(largest(speed), rel=1e-9)
    assert q["peak acceleration"] == pytest.approx(largest(acceleration), rel=1e-8)

    def torque(a: float) -> float:  # the massless crank and rod pass on the power of slider and load
        return speed(a) * (7 * acceleration(a) - 2000) / w

    assert q["peak torque"] == pytest.approx(largest(torque), rel=1e-8)


def largest(of: Callable[[float], float]) -> float:
    """Return the largest magnitude of a function over one turn."""
    guess = max(np.linspace(0, 2 * pi, 721).tolist(), key=lambda a: abs(of(a)))
    bounds = (guess - 0.01, guess + 0.01)
    best = minimize_scalar(lambda a: -abs(of(a)), bounds=bounds, method="bounded", options={"xatol": 1e-9})
    return -float(best.fun)


def test_the_toggle_press_by_its_geometry() -> None:
    """Stroke and bottom of every rocker, the points found here as intersections of circles."""
    for member in run("toggle_press", [f"{ROCKER}=285:315:4"]):
        rocker = 1e-3 * member.changes[ROCKER]

        def slider(a: float, rocker: float = rocker) -> float:
            p2 = complex(0.404709, -0.217661) + 0.077 * np.exp(1j * a)
            p3 = circles(0j, rocker, p2, 0.49, left=False)
            p4 = circles(p2, 0.76, p3, 0.49, left=True)
            return p4.imag - sqrt(0.3**2 - p4.real**2)

        q = solved(member).quantities
        top = largest(lambda a, slider=slider: 2 + slider(a)) - 2  # type: ignore[misc]  # 2 m above, all are positive
        bottom = 2 - largest(lambda a, slider=slider: 2 - slider(a))  # type: ignore[misc]
        assert q["stroke"] == pytest.approx(top - bottom, rel=1e-9)
        assert q["bottom"] == pytest.approx(bottom, rel=1e-10)


def circles(a: complex, r: float, b: complex, s: float, *, left: bool) -> complex:
    """Return the point at r from a and s from b, to the left of the way from a to b or to the right."""
    d = abs(b - a)
    cosine = (r**2 + d**2 - s**2) / (2 * r * d)
    turn = acos(cosine) * (1 if left else -1)
    return complex(a + r * (b - a) / d * np.exp(1j * turn))


def test_quantities_and_curves_are_those_of_the_scene_with_that_number() -> None:
    """Against the reference on a file with the number written in it, sampled ten times as finely."""
    motion = analytic.solve(scene_files.load("toggle_press", {ROCKER: 312.5}), np.linspace(0, 2 * pi, 36_001))
    cycle = one("toggle_press", {ROCKER: 312.5})
    for name, channel in (("displacement", "y"), ("velocity", "vy"), ("acceleration", "ay")):
        np.testing.assert_allclose(cycle.curves[name], motion[f"P5.{channel}"][::10], rtol=0, atol=1e-11)
    np.testing.assert_allclose(np.degrees(cycle.position), np.linspace(0, 360, 3601), rtol=0, atol=1e-9)
    reactions = {p: np.hypot(motion[f"{p}.fx"], motion[f"{p}.fy"]).max() for p in ("O", "P1", "P2", "P3", "P4", "P5")}
    worst = max(reactions, key=lambda pin: reactions[pin])
    assert cycle.joints["peak reaction"] == worst
    assert cycle.quantities["peak reaction"] == pytest.approx(reactions[worst], rel=1e-7)
    assert cycle.quantities["peak torque"] == pytest.approx(np.abs(motion["drive.torque"]).max(), rel=1e-7)
    angles = {joint: motion[f"{joint}.transmission"].min() for joint in ("P3", "P5")}
    least = min(angles, key=lambda joint: angles[joint])
    assert cycle.joints["least transmission"] == least
    assert cycle.quantities["least transmission"] == pytest.approx(angles[least], rel=1e-7)


def test_peaks_where_a_force_comes_or_goes() -> None:
    """The press force sets in between two samples, and the torque jumps to its peak there."""
    scene = scenes.load("crank_press", {"drive.speed": 60})
    motion = analytic.solve(scene, scene.drive.after(np.linspace(0, 1, 2_000_001)))
    peak = np.abs(motion["drive.torque"]).max()  # itself off by half a step, 3e-6 rad, times the torque's slope of 3
    assert one("crank_press", {"drive.speed": 60}).quantities["peak torque"] == pytest.approx(peak, rel=1e-5)


def test_the_shaper_of_the_textbook() -> None:
    """With a link of any length the stroke is 450 mm, and the cut takes twice as long as the return."""
    for member in run("quick_return", ["bodies.link.lengths.D-E=250:350:3"]):
        assert solved(member).quantities["stroke"] == pytest.approx(0.45, rel=1e-9)
        assert solved(member).quantities["quick return"] == pytest.approx(2.0, rel=1e-6)


def test_the_other_way_round_the_return_is_the_slow_one() -> None:
    cut_left, cut_right = (solved(m).quantities for m in run("quick_return", ["loads.0.force.0=6:-6:2"]))
    assert cut_left["quick return"] * cut_right["quick return"] == pytest.approx(1, rel=1e-12)
    back, forth = (solved(m).quantities for m in run("quick_return", ["drive.speed=-40:40:2"]))
    assert back["quick return"] * forth["quick return"] == pytest.approx(1, rel=1e-5)


def test_no_quick_return_of_two_strokes_or_of_a_single_run(tmp_path: Path) -> None:
    single = scene_files.write(tmp_path, "offset_slider_crank", {"drive.end": 400})  # a little more than one turn
    assert np.isnan(one(single, {"bodies.rod.lengths.A-B": 250}).quantities["quick return"])
    (twice, once) = run("toggle_press", ["bodies.toggle.lengths.P2-P4=700:760:2"])
    assert np.isnan(solved(twice).quantities["quick return"])
    assert not np.isnan(solved(once).quantities["quick return"])


@pytest.mark.parametrize(
    ("load", "along", "below"),
    [
        ({}, 1, True),  # without a load, downwards
        ({}, -1, True),
        ({"force": [100, 0]}, 1, True),  # none along the guide
        ({"force": [0, 100]}, 1, True),
        ({"force": [0, 100]}, -1, True),
        ({"force": [0, -100]}, 1, False),
        ({"force": [0, 100], "last": 6}, -1, True),
        ({"force": [0, -100], "last": 6}, 1, False),
        ({"table": [[-2000, 0], [2000, 1]]}, 1, True),  # along the guide
        ({"table": [[-2000, 0], [2000, 1]]}, -1, False),
    ],
)
def test_the_bottom_is_against_the_load(load: dict[str, object], along: int, below: bool, tmp_path: Path) -> None:
    loads = [{"body": "slider", "at": "P5", **load}] if load else []
    changes = {"loads": loads, "bodies.slider.slides.along": [0, along]}
    file = scene_files.write(tmp_path, "toggle_press", changes)
    cycle = one(file, {ROCKER: 300})
    height, bottom = along * cycle.curves["displacement"], along * cycle.quantities["bottom"]
    assert bottom == pytest.approx(height.min() if below else height.max(), rel=1e-6)


def test_a_drive_that_runs_once_and_a_driven_slider() -> None:
    driven = scene_files.path("driven_toggle")
    whole, half = (solved(member) for member in run(driven, ["drive.end=-150:-25:2"]))
    for cycle, end in ((whole, -0.15), (half, -0.025)):
        assert cycle.position[[0, -1]] == pytest.approx((0.1, end), abs=1e-12)
        assert np.isnan(cycle.quantities["quick return"])
        assert cycle.quantities["peak force"] >= np.abs(cycle.curves["force"]).max()
        assert cycle.quantities["stroke"] == pytest.approx(np.ptp(cycle.curves["displacement"]), rel=1e-6)
    assert half.quantities["stroke"] < whole.quantities["stroke"]
    # the table's force pushes the platen forwards: it closes backwards
    assert whole.quantities["bottom"] == pytest.approx(whole.curves["displacement"].min(), rel=1e-6)


def test_a_law_is_run_over_its_time() -> None:
    for knot in (70, 100):
        cycle = one(scene_files.path("turning_law"), {"drive.law.1.1": knot})
        assert cycle.position == pytest.approx(np.linspace(0, 1.1, 3601), abs=1e-12)
        assert cycle.quantities["peak velocity"] == pytest.approx(np.abs(cycle.curves["velocity"]).max(), rel=1e-5)
        assert cycle.quantities["quick return"] > 0


def test_a_point_has_a_stroke_and_no_bottom() -> None:
    cycle = one("four_bar", {"drive.speed": -60})
    assert {"x", "y"} <= set(cycle.curves)
    assert not {"bottom", "dwell", "quick return"} & set(cycle.quantities)
    width, height = np.ptp(cycle.curves["x"]), np.ptp(cycle.curves["y"])
    assert cycle.quantities["stroke"] == pytest.approx(np.hypot(width, height), rel=1e-6)

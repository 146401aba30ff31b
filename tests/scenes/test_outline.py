"""Bodies as drawn: mass, centre of mass and inertia by hand formulas and by quadrature; other numbers weigh anew."""

from collections.abc import Sequence
from math import cos, pi, sin

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import analytic
import scenes
from scenes import Scene, Status
from scenes.fields import quantity_at
from scenes.outline import meetings, of_bar, of_plate, places
from scenes.scene import DrawnBody
from tests import scene_files

Outline = Sequence[tuple[float, float]]
DENSITY = 20.0  # kg/m^2
L_SHAPE: Outline = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 5), (0, 5)]
NOTCHED: Outline = [(0, 0), (4, 0), (4, 3), (2, 1), (0, 3)]
ROUND = 1e-13  # relative: roundings of some ten terms, which cancel to a tenth


def weight(outline: Outline, density: float = DENSITY) -> list[float]:
    mass, (x, y), inertia = of_plate(outline, density)
    return [mass, x, y, inertia]


def rectangle(x: float, y: float, a: float, b: float) -> Outline:
    return [(x, y), (x + a, y), (x + a, y + b), (x, y + b)]


def test_a_rectangle() -> None:
    assert weight(rectangle(2, -1, 3, 4)) == pytest.approx([240, 3.5, 1, 240 * (9 + 16) / 12], rel=ROUND)


def test_a_right_triangle() -> None:
    """Legs a and b: m (a^2 + b^2) / 18, which is m (a^2 + b^2 + c^2) / 36."""
    assert weight([(0, 0), (3, 0), (0, 6)]) == pytest.approx([180, 1, 2, 180 * (9 + 36) / 18], rel=ROUND)


def test_two_rectangles_make_an_l() -> None:
    """Steiner's theorem, about a centre that is their balance."""
    m, n = 20 * 3.0, 20 * 4.0
    (a, b), (c, d) = (1.5, 0.5), (0.5, 3.0)
    x, y = (m * a + n * c) / (m + n), (m * b + n * d) / (m + n)
    about = m * ((3**2 + 1) / 12 + (a - x) ** 2 + (b - y) ** 2) + n * ((1 + 4**2) / 12 + (c - x) ** 2 + (d - y) ** 2)
    assert weight(L_SHAPE) == pytest.approx([m + n, x, y, about], rel=ROUND)


@pytest.mark.parametrize("n", [5, 24, 192])
def test_a_regular_polygon_tends_to_a_disc(n: int) -> None:
    """Of radius r: the area n/2 r^2 sin(2 pi/n), the inertia m r^2 (2 + cos(2 pi/n)) / 6; of a disc m r^2 / 2."""
    r = 0.3
    found = weight([(1 + r * cos(2 * pi * k / n), r * sin(2 * pi * k / n)) for k in range(n)])
    mass = DENSITY * n / 2 * r**2 * sin(2 * pi / n)
    exact = [mass, 1, 0, mass * r**2 * (2 + cos(2 * pi / n)) / 6]
    assert found == pytest.approx(exact, rel=1e-12, abs=1e-15)
    assert found[3] == pytest.approx(DENSITY * pi * r**4 / 2, rel=10 / n**2 * pi**2)


@given(*[st.floats(-10, 10)] * 2, st.floats(-pi, pi), st.integers(0, 5), st.booleans())
def test_moved_turned_begun_elsewhere_or_drawn_the_other_way_round(
    dx: float, dy: float, angle: float, first: int, backwards: bool
) -> None:
    mass, x, y, inertia = weight(L_SHAPE)

    def move(p: float, q: float) -> tuple[float, float]:
        return dx + p * cos(angle) - q * sin(angle), dy + p * sin(angle) + q * cos(angle)

    corners = [move(*L_SHAPE[(k + first) % 6]) for k in range(6)][:: -1 if backwards else 1]
    assert weight(corners) == pytest.approx([mass, *move(x, y), inertia], rel=1e-12, abs=1e-12)
    assert not [*meetings(places(corners))]


def test_against_a_quadrature() -> None:
    """Midpoints of squares on the notched plate; those on its slanted sides count half, which is exact for the area."""
    n = 400
    s = (np.arange(4 * n) + 0.5) / n
    x, y = np.meshgrid(s, s[: 3 * n])
    top = 1 + abs(x - 2)
    inside = np.where(np.isclose(y, top, atol=1e-9), 0.5, y < top) / n**2
    m, a, b = (float((inside * of).sum()) for of in (np.ones_like(x), x, y))
    about = float((inside * ((x - a / m) ** 2 + (y - b / m) ** 2)).sum())
    found = weight(NOTCHED, 1.0)
    assert found == pytest.approx([m, a / m, b / m, about], rel=1 / n**2)


def test_a_bar_is_a_rectangle_about_its_pins() -> None:
    mass, com, inertia = of_bar((0.1, 0.2), (0.4, 0.6), 0.2, DENSITY)
    assert [mass, *com, inertia] == pytest.approx([2, 0.25, 0.4, 2 * (0.5**2 + 0.2**2) / 12], rel=ROUND)
    n = complex(-0.8, 0.6) * 0.1
    corners = [(x + side * n.real, y + side * n.imag) for x, y, side in
               ((0.1, 0.2, 1), (0.1, 0.2, -1), (0.4, 0.6, -1), (0.4, 0.6, 1))]  # fmt: skip
    assert weight(corners) == pytest.approx([mass, *com, inertia], rel=ROUND)


def test_in_the_units_of_the_file() -> None:
    """The crank of 100 by 40 by 12 mm of steel, 0.3768 kg, by its lengths; and a bar of three pins on one line."""
    crank = scene_files.load("outlined").bodies["crank"]
    assert crank.mass == pytest.approx(0.1 * 0.04 * 0.012 * 7850, rel=ROUND)
    assert crank.com == pytest.approx((0.05, 0))
    made = {"width": 100, "thickness": 10, "density": 1000}
    of_three = {"points": {"A": [0, 0], "B": [250, 0], "C": [1000, 0]}, **made}
    lever = scene_files.load("lever", {"bodies.lever": of_three}).bodies["lever"]
    assert [lever.mass, *(lever.com or ()), lever.inertia] == pytest.approx([1, 0.5, 0, (1 + 0.01) / 12], rel=ROUND)


def drawn(scene: Scene, body: str) -> DrawnBody:
    own = scene.bodies[body]
    assert isinstance(own, DrawnBody)
    return own


def test_a_triangle_is_the_uniform_plate_between_its_pins() -> None:
    """Three corners at three points: every channel is that of the plate of the same mass, m (a^2 + b^2 + c^2) / 36."""
    corners = {"B": [0, 0], "C": [280, 0], "T": [140, 120]}
    plain = {"points": corners, "mass": 0.28 * 0.12 / 2 * 0.008 * 2700}
    outlined = {"points": corners, "outline": [*corners.values()], "thickness": 8, "density": 2700}
    angles = np.linspace(0, 2 * pi, 13)
    one, other = (
        analytic.solve(scene_files.load("outlined", {"bodies.coupler": b}), angles) for b in (plain, outlined)
    )
    for channel, samples in one.samples.items():
        assert other[channel] == pytest.approx(samples, rel=1e-12, abs=1e-12 * np.abs(samples).max()), channel


def test_other_numbers_weigh_anew() -> None:
    """Mass and inertia are no numbers of such a body, but what follows from those of its drawing."""
    scene = scene_files.load("outlined")
    assert not {f"bodies.rocker.{of}" for of in ("mass", "inertia", "com.0")} & {*scene.numbers}
    before, twice = drawn(scene, "rocker"), {"bodies.rocker.thickness": 0.02, "bodies.crank.lengths.A-B": 0.2}
    after = scene.with_numbers(twice)
    assert drawn(after, "rocker").mass == pytest.approx(2 * before.mass, rel=ROUND)
    assert drawn(after, "rocker").com == before.com
    assert drawn(after, "crank").com == pytest.approx((0.1, 0))
    assert before.weighed.mass == before.mass
    quantity = quantity_at(Scene, ("bodies", "rocker", "density"))  # as a baseline finds its unit
    assert quantity is not None
    assert scene.all_units[quantity.dimension] == ("kg/m^3", 1.0)


VARIED = ("crank.width", "crank.density", "crank.lengths.A-B", "coupler.outline.2.0", "rocker.outline.3.1")


@pytest.mark.parametrize("path", VARIED)
def test_derivatives_are_differences(path: str) -> None:
    """Central differences of two steps, extrapolated: off by a step's fourth power, 1e-12, and by roundings over it."""
    path, file, angles = f"bodies.{path}", scene_files.path("outlined"), np.linspace(0, 6, 7)
    (now,) = scenes.numbers_in(file, [path])
    channels = frozenset({"drive.torque", "D.fx", "B.fy"})
    exact = analytic.derivatives(scenes.load(file), [path], angles, channels=channels)

    def slope(step: float) -> dict[str, np.ndarray]:
        high, low = (analytic.solve(scenes.load(file, {path: now + by}), angles) for by in (step, -step))
        return {channel: (high[channel] - low[channel]) / (2 * step) for channel in channels}

    wide, near = slope(2e-3 * now), slope(1e-3 * now)
    for channel in channels:
        better = (4 * near[channel] - wide[channel]) / 3
        assert np.abs(exact[channel][0] - better).max() <= 1e-9 * np.abs(better).max()


def test_of_many_machines_each_is_weighed_or_refused() -> None:
    scene, thickness = scene_files.load("outlined"), [10.0, 12.5, 10.0, 10.0, -1.0]
    corner = [60.0, 70.0, -24.0, -80.0, 60.0]  # of the fourth machine beyond the other side
    changes = {"bodies.rocker.thickness": thickness, "bodies.rocker.outline.3.0": corner}
    many = analytic.solve_many(scene, changes, np.array([1.0]))
    expected = [Status.ok, Status.ok, Status.ok, Status.cannot_assemble, Status.cannot_assemble]
    assert [*many.status] == expected
    assert "bodies.rocker.outline: expected sides that meet only at" in many.reason[3]
    assert "bodies.rocker.thickness" in many.reason[4]
    for k in range(3):
        values = {"bodies.rocker.thickness": thickness[k], "bodies.rocker.outline.3.0": corner[k]}
        alone = analytic.solve(scenes.load(scene_files.path("outlined"), values), [1.0])
        assert many["drive.torque"][k] == pytest.approx(alone["drive.torque"], rel=1e-12)


def test_a_bar_of_three_pins_on_one_line_stays_one() -> None:
    own = {"points": {"A": [0, 0], "B": [250, 0], "C": [1000, 0]}, "width": 100, "thickness": 10, "density": 1000}
    scene = scene_files.load("lever", {"bodies.lever": own})
    many = analytic.solve_many(scene, {"bodies.lever.points.B.1": [0.5, 2.0]}, np.array([0.0]))
    assert [*many.status] == [Status.ok, Status.cannot_assemble]
    assert many["drive.torque"][0] == pytest.approx(9.81 / 2, rel=ROUND)


@pytest.mark.parametrize("way", [1, -1])
def test_a_u_has_sides_on_one_line_that_do_not_meet(way: int) -> None:
    corners = [[0, 0], [30, 0], [30, 20], [20, 20], [20, 10], [10, 10], [10, 20], [0, 20]][::way]
    u = drawn(scene_files.load("outlined", {"bodies.coupler.outline": corners}), "coupler")
    assert u.mass == pytest.approx(500e-6 * 0.008 * 2700, rel=ROUND)
    assert u.com == pytest.approx((0.015, 0.009), rel=ROUND)  # 300 mm^2 at 5 mm, 200 at 15

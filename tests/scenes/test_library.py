"""What each shipped scene is: its geometry and figures from its source, by hand or by formulas of their own."""

from typing import NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray

import analytic
import scenes
from scenes import Motion
from scenes.scene import GROUND
from tests import scene_files

Angles = NDArray[np.float64]

TURN = np.radians(np.arange(720) / 2)  # half-degree steps, without the end


def turned(name: str, crank_angle: Angles = TURN) -> Motion:
    """Solve a scene whose crank turns at a constant speed."""
    return analytic.solve(scenes.load(name), crank_angle)


def test_quick_return_is_a_slotted_lever() -> None:
    crank_pin = 0.120 * np.exp(1j * TURN)
    slot = crank_pin + 0.240j
    tip = -0.240j + 0.450 * slot / np.abs(slot)
    height = -0.240 + 0.450 * np.cos(np.pi / 6)
    ram = tip.real + np.sqrt(0.300**2 - (tip.imag - height) ** 2)
    motion = turned("quick_return")
    assert np.abs(motion["D.x"] + 1j * motion["D.y"] - tip).max() <= 1e-14  # m, rounding
    assert np.abs(motion["E.x"] - ram).max() <= 1e-14
    assert np.abs(motion["block.angle"] - np.angle(slot)).max() <= 1e-14  # rad, rounding


def test_four_bar_is_a_crank_rocker() -> None:
    crank, ground, coupler, rocker = 1, 2, 2.5, 2.5  # of 100 mm
    shortest, *others, longest = sorted((crank, ground, coupler, rocker))
    assert shortest == crank
    assert shortest + longest < sum(others)  # Grashof: the crank turns fully
    motion = turned("four_bar")
    angles = transmission_angle(motion, "coupler", "rocker")
    for extreme, diagonal in ((angles.min(), ground - crank), (angles.max(), ground + crank)):
        by_cosine_law = np.degrees(np.arccos((coupler**2 + rocker**2 - diagonal**2) / (2 * coupler * rocker)))
        assert abs(extreme - by_cosine_law) <= 1e-10  # deg, rounding; 0 and 180 deg are among the samples


def test_four_bar_draws_a_straight_line() -> None:
    crank_angles = np.radians(np.arange(90, 271))
    motion = analytic.solve(scenes.load("four_bar"), crank_angles)
    x, y = motion["T.x"], motion["T.y"]
    for at, by_triangles_3_4_5 in ((0, 0.4), (90, 0.2), (180, 0.0)):  # m
        assert np.hypot(x[at] - by_triangles_3_4_5, y[at] - 0.4) <= 1e-14  # m, rounding
    assert np.ptp(y) <= 0.001  # m, of 0.4 m: straight to a quarter of a percent


@pytest.mark.parametrize(("name", "neighbours"), [("watt_six_bar", True), ("stephenson_six_bar", False)])
def test_six_bar_is_of_its_kind(name: str, neighbours: bool) -> None:
    """A six-bar has two ternary links: neighbours in Watt's, joined by binary links alone in Stephenson's."""
    scene = scenes.load(name)
    links = {GROUND: tuple(scene.ground)} | {body.name: body.points for body in scene.bodies.values()}
    pinned = {link: [pin for pin in scene.pins if link in (pin.first, pin.second)] for link in links}
    ternary = {link for link, pins in pinned.items() if len(pins) == 3}
    assert sorted(len(pins) for pins in pinned.values()) == [2, 2, 2, 2, 3, 3]
    assert any({pin.first, pin.second} == ternary for pin in scene.pins) is neighbours


@pytest.mark.parametrize(
    ("name", "bodies", "smallest"),
    [
        ("watt_six_bar", ("coupler", "bell_crank"), 45),
        ("watt_six_bar", ("link", "rocker"), 35),
        ("stephenson_six_bar", ("coupler", "rocker"), 45),
        ("stephenson_six_bar", ("left", "right"), 43),
        ("walking_leg", ("lower_rod", "swing"), 9),
    ],
)
def test_smallest_transmission_angle(name: str, bodies: tuple[str, str], smallest: float) -> None:
    assert abs(transmission_angle(turned(name), *bodies).min() - smallest) <= 0.5  # deg: as the scene's head rounds it


def test_watt_six_bar_doubles_a_swing() -> None:
    motion = turned("watt_six_bar")
    for body, swing in (("bell_crank", 50), ("rocker", 110)):
        assert abs(np.degrees(np.ptp(np.unwrap(motion[f"{body}.angle"]))) - swing) <= 0.5  # deg: as the head rounds it


def test_walking_leg_has_the_foot_path_of_jansen() -> None:
    """Against his numbers typed again, and circles: which of two meeting points is which is seen in his drawing."""
    path = jansen_foot_path()
    motion = turned("walking_leg")
    foot = motion["F.x"] + 1j * motion["F.y"]
    assert np.abs(foot - path / 100).max() <= 1e-13  # m; rounding, which a transmission angle of 9 deg multiplies by 6
    stride = np.ptp(path.real)
    stance = path.imag < path.imag.min() + 0.01 * stride
    assert abs(stance.mean() - 0.4) <= 0.01  # of the turn is the foot on the ground, flat to a hundredth of its stride,
    assert np.ptp(path.real[stance]) >= 0.75 * stride  # along three quarters of it,
    assert (np.diff(path.real, append=path.real[0])[stance] > 0).all()  # and never slips back


def test_peaucellier_draws_an_exact_straight_line() -> None:
    motion = turned("peaucellier", np.radians(np.linspace(-30, 100, 131)))
    place, velocity = (motion[f"D.{level}x"] + 1j * motion[f"D.{level}y"] for level in ("", "v"))
    to_line = 0.8 + 0.6j  # from O to Q, and to the line
    distance = (0.250**2 - 0.120**2) / (2 * 0.100)  # m, of the line
    assert np.abs((to_line.conjugate() * place).real - distance).max() <= 2e-15  # m, rounding
    assert np.abs((to_line.conjugate() * velocity).real).max() <= 1e-14 * np.abs(velocity).max()
    assert np.ptp((to_line.conjugate() * place).imag) > 0.3  # m


class SqueezerState(NamedTuple):
    """A state published by the Test Set for IVP Solvers, rad and s: of crank, k3, k5 and k7, and the multipliers, N."""

    crank: tuple[float, float, float]  # position, rate, acceleration
    angles: tuple[float, float, float]  # γ, δ, ε
    multipliers: tuple[float, ...]
    accuracy: float  # relative, of rates, accelerations and forces: how well it is on its own constraints


SQUEEZER = {
    "initial values": SqueezerState(
        (-0.0617138900142764496, 0.0, 14222.4439199541138706),
        (0.455279819163070380, 0.487364979543842550, 1.23054744454982119),
        (98.5668703962410896, -6.12268834425566266, 0.0, 0.0, 0.0, 0.0),
        1e-12,
    ),
    "reference solution at 0.03 s": SqueezerState(
        (15.81077119629904, 1139.920302151208, -24631.76316945196),
        (0.04082224013073101, 0.5244099658805304, 1.048080741042263),
        (
            *(199.1753333731910, -29.75531228015052, 23.06654119098399),
            *(31.45271365475927, 22.64249232082739, 11.61740700019673),
        ),
        3e-7,
    ),
}


@pytest.mark.parametrize("state", SQUEEZER.values(), ids=SQUEEZER)
def test_andrews_squeezer_at_published_states(state: SqueezerState) -> None:
    """Its equations are driven by a moment of 0.033 N m, so here this much must follow from the crank's motion."""
    (position, rate, acceleration), (gamma, delta, epsilon) = state.crank, state.angles
    t = np.linspace(-5e-4, 5e-4, 11)
    law = np.degrees(position + t * (rate + t * acceleration / 2))
    drive = {"body": "k1", "law": [*zip((t - t[0]).tolist(), law.tolist(), strict=True)]}
    scene = scene_files.load("andrews_squeezer", {"drive": drive})
    motion = analytic.solve(scene, np.array([position]), np.array([5e-4]))
    a, b = -0.06934 - 0.00227j, -0.03635 + 0.03273j  # m, the pivots on the ground
    g, d, e = np.exp(1j * np.array([gamma, delta, epsilon]))
    for point, place in {"E": b - 0.035j * g, "G": a + 0.040 * d, "H": a - 0.040j * e}.items():
        assert abs(motion[f"{point}.x"][0] + 1j * motion[f"{point}.y"][0] - place) <= 2e-15, point  # m, rounding
    forces = [motion[f"{pin}.{axis}"][0] for pin in ("E", "E/k4", "E/k6") for axis in ("fx", "fy")]
    assert np.abs(np.array(forces) - state.multipliers).max() <= state.accuracy * max(state.multipliers)
    assert abs(motion["drive.torque"][0] / 0.033 - 1) <= state.accuracy


Places = NDArray[np.complex128]


def transmission_angle(motion: Motion, first: str, second: str) -> NDArray[np.float64]:
    """The angle, 0 to 90 deg, between two bars by their x axes."""
    return np.degrees(np.arcsin(np.abs(np.sin(motion[f"{first}.angle"] - motion[f"{second}.angle"]))))


def meet(centre_1: Places, radius_1: float, centre_2: Places, radius_2: float) -> Places:
    """Where two circles meet, on the left of the way from the first centre to the second."""
    way = centre_2 - centre_1
    along = (radius_1**2 - radius_2**2 + np.abs(way) ** 2) / (2 * np.abs(way))
    meeting: Places = centre_1 + way / np.abs(way) * (along + 1j * np.sqrt(radius_1**2 - along**2))
    return meeting


def jansen_foot_path() -> Places:
    a, b, c, d, e, f, g, h, i, j, k, l, m = 38, 41.5, 39.3, 40.1, 55.8, 39.4, 36.7, 65.7, 49, 50, 61.9, 7.8, 15  # noqa: E741
    pivot = np.full(TURN.shape, -a - 1j * l)
    crank_pin = m * np.exp(1j * TURN)
    upper_knee = meet(pivot, b, crank_pin, j)
    hip = meet(pivot, d, upper_knee, e)
    lower_knee = meet(crank_pin, k, pivot, c)
    ankle = meet(lower_knee, g, hip, f)
    return meet(lower_knee, i, ankle, h)

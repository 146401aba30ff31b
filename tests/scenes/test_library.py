"""What each shipped scene is: its geometry and figures from its source, by hand or by formulas of their own."""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

import analytic
import scenes
from scenes import Motion, Scene
from scenes.scene import GROUND, Force

Angles = NDArray[np.float64]

TURN = np.radians(np.arange(720) / 2)  # half-degree steps, without the end


def solve(name: str) -> Motion:
    """Solve a scene whose crank turns at a constant speed."""
    return at_angles(name, TURN)


def at_angles(name: str, crank_angle: Angles) -> Motion:
    scene = scenes.load(name)
    return analytic.solve(scene, crank_angle, (crank_angle - scene.drive.start) / scene.drive.at(0).rate)


def at_times(scene: Scene, time: Angles) -> Motion:
    return analytic.solve(scene, scene.drive.at(time).position, time)


# --- what each scene is ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["toggle_press", "four_bar", "watt_six_bar", "stephenson_six_bar", "walking_leg"])
def test_the_drive_does_no_work_in_a_turn(name: str) -> None:
    """Weights and constant forces give back what they take. The mean over a period has no error but rounding."""
    torque = solve(name)["drive.torque"]
    assert abs(torque.mean()) <= 1e-12 * np.abs(torque).max()


def test_crank_press() -> None:
    dead = at_angles("crank_press", np.radians([90, 270]))["B.y"]
    assert abs(dead[1] + 1.390 + 0.090) <= 1e-14  # m, rounding; the rod in line below the crank
    assert abs(dead[0] - dead[1] - 0.180) <= 1e-14  # m, rounding; in line, the stroke is twice the crank's radius
    # Where the paper's force begins, 20.40 deg before the lower dead centre; 209.1 mm/s by r, l and the sine law.
    there = at_angles("crank_press", np.radians([270 - 20.40, 270 - 20.39]))
    assert abs(there["B.y"][0] - dead[1] - 0.006) <= 3e-6  # m; as much as 0.005 deg are
    assert abs(there["B.vy"][0] + 0.2091) <= 1e-4  # m/s; the digits given
    assert abs(there["drive.torque"][1] - 53e3) <= 500  # N m; the digits of the scene's head


def test_servo_press_is_the_toggle_press_with_a_law() -> None:
    """By the chain rule, with the toggle press's motion by the angle and a spline made here."""
    times, degrees = np.array(SERVO_LAW).T
    trend = 360 / times[-1]
    spline = CubicSpline(times, np.radians(degrees - trend * times), bc_type="periodic")
    time = np.linspace(0, 1, 721)
    angle, rate = spline(time) + np.radians(trend) * time, spline(time, 1) + np.radians(trend)
    motion, plain = at_times(scenes.load("servo_press"), time), at_angles("toggle_press", angle)
    w = 2 * np.pi  # rad/s, of the toggle press
    by_the_law = {
        "crank_angle": angle,
        "P5.y": plain["P5.y"],
        "P5.vy": plain["P5.vy"] / w * rate,
        "P5.ay": plain["P5.ay"] / w**2 * rate**2 + plain["P5.vy"] / w * spline(time, 2),
    }
    for channel, expected in by_the_law.items():
        assert np.abs(motion[channel] - expected).max() <= 1e-13 * np.abs(expected).max(), channel  # rounding


def test_servo_press_goes_down_fast_and_presses_slowly() -> None:
    scene, press = scenes.load("servo_press"), PRESSES["servo_press"]
    on_table = at_times(scene, np.array([time for time, _ in SERVO_LAW]))["crank_angle"]
    assert np.abs(np.degrees(on_table) - [angle for _, angle in SERVO_LAW]).max() <= 1e-12  # deg, rounding
    rate = np.degrees(scene.drive.at(np.linspace(0, 1, 10_001)).rate)
    assert 113 <= rate.min() <= rate.max() <= 638  # deg/s; as the head says, and never backwards
    met, end = stroke(press)
    there = at_times(scene, np.array([met, end]))
    plain = at_angles("toggle_press", there["crank_angle"])
    assert abs(np.degrees(there["crank_angle"][1]) - 372.8) <= 0.05  # deg; this and the rest to the head's digits
    assert abs(there["P5.vy"][0] + 0.054) <= 5e-4  # m/s
    assert abs(plain["P5.vy"][0] + 0.158) <= 5e-4
    upper = at_angles("toggle_press", np.radians([208.55, 208.65]))
    assert upper["P5.vy"][0] > 0 > upper["P5.vy"][1]


@pytest.mark.parametrize("name", ["crank_press", "servo_press", "quick_return"])
def test_a_force_in_the_last_part_of_the_stroke_acts_there_and_nowhere_else(name: str) -> None:
    """What the slider's own balance leaves when its inertia and its pin are taken away."""
    press = PRESSES[name]
    switches = np.array(stroke(press))
    end = at_times(press.scene, switches)[press.position][1]
    hair = 1e-9  # s, beside the switches: ten thousand times what rounding leaves of them
    time = np.sort([*np.linspace(0, press.scene.drive.cycle, 361), *(switches - hair), *(switches + hair)])
    motion = at_times(press.scene, time)
    inertia = press.mass * motion[f"{press.point}.a{press.axis}"]
    load = inertia - motion[f"{press.point}.f{press.axis}"]
    acts = (motion[press.position] - end <= press.last) & (motion[f"{press.point}.v{press.axis}"] < 0)
    assert np.abs(load - press.force * acts).max() <= 1e-12 * (press.force + np.abs(inertia).max())  # rounding
    assert np.count_nonzero(np.diff(acts)) == 2  # on once and off once in a cycle


@pytest.mark.parametrize("name", ["crank_press", "servo_press", "quick_return"])
def test_the_drive_does_the_work_of_pressing_in_a_cycle(name: str) -> None:
    """Inertia and weight give back what they take; what is left is force times way."""
    press = PRESSES[name]
    drive = press.scene.drive
    knots = [time for time, _ in SERVO_LAW] if name == "servo_press" else [0, drive.cycle]
    breaks = np.unique([*knots, *stroke(press)])  # where the power, or a derivative of it, jumps
    nodes, weights = np.polynomial.legendre.leggauss(60)
    work = 0.0
    for start, end in pairwise(breaks):
        time = start + (nodes + 1) / 2 * (end - start)
        work += weights @ (at_times(press.scene, time)["drive.torque"] * drive.at(time).rate) * (end - start) / 2
    assert abs(work - press.force * press.last) <= 1e-9 * press.force * press.last  # the quadrature's


def test_quick_return_is_the_textbook_s() -> None:
    a = 2 * np.degrees(np.arccos(120 / 240))  # of the return; the bar is square to the crank at the dead points
    assert abs((360 - a) / a - 2) <= 1e-14
    dead = at_angles("quick_return", np.radians([a / 2 - 90, 270 - a / 2]))  # right and left: symmetric about upright
    assert np.abs(dead["E.vx"]).max() <= 1e-14  # m/s, rounding
    assert abs(dead["E.x"][0] - dead["E.x"][1] - 0.450) <= 1e-14  # m, rounding
    assert np.abs(dead["link.angle"] - [0, 0]).max() <= 1e-7  # rad; level, by a root of rounding
    angle = np.arange(720) / 2
    motion = at_angles("quick_return", np.radians(angle))
    cuts = (angle < 270 - a / 2) | (angle > a / 2 - 90 + 360)
    assert (motion["E.vx"][cuts & (np.abs(motion["E.vx"]) > 1e-12)] < 0).all()
    assert (motion["E.vx"][~cuts & (np.abs(motion["E.vx"]) > 1e-12)] > 0).all()


def test_quick_return_is_a_slotted_lever() -> None:
    crank_pin = 0.120 * np.exp(1j * TURN)
    slot = crank_pin + 0.240j
    tip = -0.240j + 0.450 * slot / np.abs(slot)
    height = -0.240 + 0.450 * np.cos(np.pi / 6)
    ram = tip.real + np.sqrt(0.300**2 - (tip.imag - height) ** 2)
    motion = solve("quick_return")
    assert np.abs(motion["D.x"] + 1j * motion["D.y"] - tip).max() <= 1e-14  # m, rounding
    assert np.abs(motion["E.x"] - ram).max() <= 1e-14
    assert np.abs(motion["block.angle"] - np.angle(slot)).max() <= 1e-14  # rad, rounding


@pytest.mark.parametrize("name", ["double_toggle_clamp", "double_toggle_clamp_scheme4"])
def test_clamp_by_the_formulas_of_its_source(name: str) -> None:
    clamp, scene = CLAMPS[name], scenes.load(name)
    alpha = np.radians(np.linspace(clamp.alpha_max, 0, 10_001))
    motion = clamp.at(scene, alpha)
    assert np.abs(np.array(scene.drive.extent) - clamp.crosshead(alpha)[[0, -1]]).max() <= 1e-15  # m; as many digits
    assert np.abs(motion["C.x"] - clamp.platen(alpha)).max() <= 1e-14  # m, rounding
    assert (motion["D.x"] > motion["E.x"]).all()  # E is on the tail side of D throughout
    ratio = motion["C.vx"] / motion["E.vx"]
    assert np.abs(ratio - clamp.velocity_ratio(alpha)).max() <= 1e-13  # rounding
    crosshead, platen = scene.drive.extent[1] - scene.drive.extent[0], motion["C.x"][-1] - motion["C.x"][0]
    assert abs(1e3 * crosshead - clamp.travel) <= 5e-6  # mm; this and the rest to the digits given
    assert abs(1e3 * platen - clamp.platen_travel) <= 5e-6
    assert abs(platen / crosshead - clamp.stroke_ratio) <= 5e-8
    assert abs(ratio.max() - clamp.largest_velocity_ratio) <= 5e-6


@pytest.mark.parametrize("name", ["double_toggle_clamp", "double_toggle_clamp_scheme4"])
def test_clamp_multiplies_a_force_as_its_source_says(name: str) -> None:
    clamp, scene = CLAMPS[name], scenes.load(name)
    massless = {body.name: replace(body, mass=0.0) for body in scene.bodies.values()}
    at_rest = replace(scene, bodies=massless, loads=(Force("platen", "C", (-1.0, 0.0)),))
    thrust = clamp.at(at_rest, np.radians([2.5]))["drive.force"][0]
    assert abs(1 / thrust - clamp.force_ratio) <= 5e-6  # the digits given


@pytest.mark.parametrize("name", ["double_toggle_clamp", "double_toggle_clamp_scheme4"])
def test_clamp_locks(name: str) -> None:
    scene = scenes.load(name)
    motion = at_times(scene, scene.drive.cycle * np.array([0.9, 1.0]))
    B, C = (motion[f"{point}.x"] + 1j * motion[f"{point}.y"] for point in "BC")
    assert abs((B.conjugate() * C).imag[1]) <= 1e-15  # m^2, rounding; A, B and C are in line,
    assert (
        motion["C.vx"][0] >= 1e-3 >= 1e12 * abs(motion["C.vx"][1])
    )  # m/s; so the platen stands, as it did not before,
    assert abs(motion["C.fx"][1] - 2e6) <= 1e3  # N; holds half of 4000 kN, to the digits of the table,
    assert abs(motion["drive.force"][1]) <= 10  # N; and takes no thrust but that of inertia


def test_clamp_table_rounds_a_length() -> None:
    for name, rounded, off in (("double_toggle_clamp", 120, 0.00096), ("double_toggle_clamp_scheme4", 134, -0.46995)):
        clamp = CLAMPS[name]
        L3_squared = clamp.L1**2 + clamp.L5**2 - 2 * clamp.L1 * clamp.L5 * np.cos(np.radians(clamp.gamma))
        assert abs(1e3 * np.sqrt(L3_squared) - rounded - off) <= 5e-6  # mm, the digits given


def test_four_bar_is_a_crank_rocker() -> None:
    crank, ground, coupler, rocker = 1, 2, 2.5, 2.5  # of 100 mm
    shortest, *others, longest = sorted((crank, ground, coupler, rocker))
    assert shortest == crank
    assert shortest + longest < sum(others)  # Grashof: the crank turns fully
    motion = solve("four_bar")
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
    assert abs(transmission_angle(solve(name), *bodies).min() - smallest) <= 0.5  # deg: as the scene's head rounds it


def test_watt_six_bar_doubles_a_swing() -> None:
    motion = solve("watt_six_bar")
    for body, swing in (("bell_crank", 50), ("rocker", 110)):
        assert abs(np.degrees(np.ptp(np.unwrap(motion[f"{body}.angle"]))) - swing) <= 0.5  # deg: as the head rounds it


def test_walking_leg_has_the_foot_path_of_jansen() -> None:
    """Against his numbers typed again, and circles: which of two meeting points is which is seen in his drawing."""
    path = jansen_foot_path()
    motion = solve("walking_leg")
    foot = motion["F.x"] + 1j * motion["F.y"]
    assert np.abs(foot - path / 100).max() <= 1e-13  # m; rounding, which a transmission angle of 9 deg multiplies by 6
    stride = np.ptp(path.real)
    stance = path.imag < path.imag.min() + 0.01 * stride
    assert abs(stance.mean() - 0.4) <= 0.01  # of the turn is the foot on the ground, flat to a hundredth of its stride,
    assert np.ptp(path.real[stance]) >= 0.75 * stride  # along three quarters of it,
    assert (np.diff(path.real, append=path.real[0])[stance] > 0).all()  # and never slips back


# --- geometry of their own ------------------------------------------------------------------------------------------

Places = NDArray[np.complex128]


def transmission_angle(motion: Motion, first: str, second: str) -> NDArray[np.float64]:
    """Return the angle, 0 to 90 deg, between two bars by their x axes."""
    return np.degrees(np.arcsin(np.abs(np.sin(motion[f"{first}.angle"] - motion[f"{second}.angle"]))))


def meet(centre_1: Places, radius_1: float, centre_2: Places, radius_2: float) -> Places:
    """Return where two circles meet, on the left of the way from the first centre to the second."""
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


# --- presses --------------------------------------------------------------------------------------------------------

SERVO_LAW = ((0, 209), (0.15, 274), (0.3, 325), (0.45, 348), (0.6, 371), (0.75, 424), (0.9, 515), (1, 569))  # s, deg


@dataclass(frozen=True)
class Press:
    """A slider that closes against an axis once a cycle and meets a force in the last part of that stroke."""

    name: str
    point: str
    axis: str
    mass: float  # kg, of the slider
    force: float  # N
    last: float  # m

    @property
    def scene(self) -> Scene:
        return scenes.load(self.name)

    @property
    def position(self) -> str:
        return f"{self.point}.{self.axis}"


PRESSES = {
    press.name: press
    for press in (
        Press("crank_press", "B", "y", 800, 1600e3, 0.006),
        Press("servo_press", "P5", "y", 800, 1600e3, 0.006),
        Press("quick_return", "E", "x", 150, 6e3, 0.400),
    )
}


def stroke(press: Press) -> tuple[float, float]:
    """Return when the slider meets the force and when its closing stroke ends, s."""
    scene = press.scene

    def at(time: float, channel: str) -> float:
        return float(at_times(scene, np.array([time]))[channel][0])

    time = np.linspace(0, scene.drive.cycle, 361)
    way = at_times(scene, time)[press.position]
    lowest = int(way.argmin())
    velocity = f"{press.point}.v{press.axis}"
    end = float(brentq(lambda t: at(t, velocity), time[lowest - 1], time[lowest + 1], xtol=1e-15))
    left = at(end, press.position) + press.last
    before = int(np.flatnonzero(way[:lowest] > left)[-1])
    met = float(brentq(lambda t: at(t, press.position) - left, time[before], time[before + 1], xtol=1e-15))
    return met, end


# --- clamps ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Clamp:
    """A column of the source's table 2, and its formulas; m and deg."""

    L1: float
    L2: float
    L4: float
    L5: float
    Hb: float
    theta: float
    gamma: float
    alpha_max: float
    travel: float  # mm
    platen_travel: float  # mm
    stroke_ratio: float
    largest_velocity_ratio: float
    force_ratio: float  # at alpha = 2.5 deg

    def angles(self, alpha: Angles) -> tuple[Angles, Angles, Angles, Angles]:
        """Return AB's and AD's above the horizontal, BC's below it, DE's above it towards the tail."""
        bar = np.radians(self.theta) + alpha
        ear = bar + np.radians(self.gamma)
        height = (self.L1 + self.L2) * np.sin(np.radians(self.theta))
        beta = np.arcsin((self.L1 * np.sin(bar) - height) / self.L2)
        return bar, ear, beta, np.arcsin((self.Hb - self.L5 * np.sin(ear)) / self.L4)

    def crosshead(self, alpha: Angles) -> Angles:
        _, ear, _, phi = self.angles(alpha)
        return self.L5 * np.cos(ear) - self.L4 * np.cos(phi)

    def platen(self, alpha: Angles) -> Angles:
        bar, _, beta, _ = self.angles(alpha)
        return self.L1 * np.cos(bar) + self.L2 * np.cos(beta)

    def velocity_ratio(self, alpha: Angles) -> Angles:
        bar, ear, beta, phi = self.angles(alpha)
        return self.L1 * np.sin(bar + beta) * np.cos(phi) / (self.L5 * np.sin(ear + phi) * np.cos(beta))

    def at(self, scene: Scene, alpha: Angles) -> Motion:
        crosshead = self.crosshead(alpha)
        return analytic.solve(scene, crosshead, (crosshead - scene.drive.start) / 0.1)


CLAMPS = {
    "double_toggle_clamp": Clamp(
        *(0.352, 0.457, 0.120, 0.305, 0.2355, 4.5, 19.4, 110), 566.04116, 574.47572, 1.0149010, 1.63040, 20.10666
    ),
    "double_toggle_clamp_scheme4": Clamp(
        *(0.368, 0.430, 0.135, 0.280, 0.239, 4.0, 18.0, 105), 546.76579, 600.47753, 1.0982354, 1.79600, 22.73834
    ),
}

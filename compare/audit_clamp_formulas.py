"""Double-toggle clamp: the printed formulas, each as it is printed and, beside it, as it should be.

From zhycasting.com, Multi-Objective Optimization of Clamping Unit for 4000 kN Die Casting Machine. Its figure is
missing, and the angles are read so that the formulas for R_V, the rates and M_P hold: the rear link A-B stands at
theta + alpha and A-D at gamma more, the front link B-C at -beta, the crosshead's link E-D at -phi. Closing makes w1 and
w4 clockwise, w2 counter-clockwise. A formula takes what it needs of others from the motion.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import cos, pi, sin, sqrt

from scenes import Motion, Scene
from scenes.motion import Samples

from .audit_claims import Equation
from .state import State

SOURCE = "double-toggle clamp"
DESIGNS: Mapping[str, Mapping[str, str]] = {
    "initial": {
        "L1": "352",
        "L2": "457",
        "L3": "120",
        "L4": "120",
        "L5": "305",
        "Hb": "235.5",
        "theta": "4.5",
        "gamma": "19.4",
        "alpha_max": "110",
    },
    "scheme 4": {
        "L1": "368",
        "L2": "430",
        "L3": "134",
        "L4": "135",
        "L5": "280",
        "Hb": "239",
        "theta": "4.0",
        "gamma": "18.0",
        "alpha_max": "105",
    },
}  # table 2, mm and degrees, as printed
SCENES: Mapping[str, str] = {"initial": "double_toggle_clamp", "scheme 4": "double_toggle_clamp_scheme4"}


@dataclass(frozen=True)
class Pose:
    """Lengths, m, and angles, rad, of the clamp at alpha; any shapes that fit each other."""

    L1: Any
    L2: Any
    L4: Any
    L5: Any
    Hb: Any
    theta: Any
    gamma: Any
    alpha: Any
    beta: Any
    phi: Any

    @property
    def psi(self) -> Samples:
        """Return where A-D stands, rad."""
        angle: Samples = self.alpha + self.theta + self.gamma
        return angle


@dataclass(frozen=True)
class Moving(Pose):
    """The clamp in motion, SI; every array of shape (n,)."""

    Vo: Samples
    w1: Samples
    w2: Samples
    w4: Samples
    e1: Samples
    vm: Samples
    am: Samples
    Sm: Samples  # the platen's way to the lock
    So: Samples  # the crosshead's
    Po_Pm: Samples  # what a force on the platen adds to the drive's, by that force


def assembled(design: Mapping[str, Any], alpha: Any) -> Pose:
    """Return the clamp at alpha, rad, from a design in mm and degrees whose values may be arrays."""
    L1, L2, L4, L5, Hb = (1e-3 * design[name] for name in ("L1", "L2", "L4", "L5", "Hb"))
    theta, gamma = (pi / 180 * design[name] for name in ("theta", "gamma"))
    beta = np.arcsin((L1 * sin(theta + alpha) - (L1 + L2) * sin(theta)) / L2)
    phi = np.arcsin((Hb - L5 * sin(theta + gamma + alpha)) / L4)
    return Pose(L1, L2, L4, L5, Hb, theta, gamma, alpha, beta, phi)


def moving(scene: Scene, design: Mapping[str, float], loaded: Motion, free: Motion, force: float) -> Moving:
    """Return the clamp in a motion, given also as it is with a force, N, against the platen; without the last sample.

    In the last sample it locks, where M_P is infinite.
    """
    state = State(scene, free)
    place = {point: state.point(point)[0] for point in "ABCDE"}
    theta, gamma = (pi / 180 * design[name] for name in ("theta", "gamma"))
    lengths = (1e-3 * design[name] for name in ("L1", "L2", "L4", "L5", "Hb"))
    x_m, x_o = free["C.x"], free["E.x"]
    values = (
        *(np.full_like(x_m, value) for value in (*lengths, theta, gamma)),
        np.angle(place["B"] - place["A"]) - theta,
        -np.angle(place["C"] - place["B"]),
        -np.angle(place["D"] - place["E"]),
        free["E.vx"],
        -free["rear_link.omega"],
        free["front_link.omega"],
        -free["crosshead_link.omega"],
        -free["rear_link.alpha"],
        free["C.vx"],
        free["C.ax"],
        x_m[-1] - x_m,
        x_o[-1] - x_o,
        (loaded["drive.force"] - free["drive.force"]) / force,
    )
    return Moving(*(value[:-1] for value in values))


# --- the formulas ----------------------------------------------------------------------------------------------------


def platen_stroke(p: Pose, root: int = 1) -> Samples:
    """Return S_m, the numerator of R_S, from alpha to the lock; the root has the printed sign if `root` is 1."""
    far = sqrt(p.L2**2 - (p.L1 * sin(p.alpha + p.theta) - (p.L1 + p.L2) * sin(p.theta)) ** 2)
    stroke: Samples = (p.L1 + p.L2) * cos(p.theta) - p.L1 * cos(p.theta + p.alpha) - root * far
    return stroke


def crosshead_stroke(p: Pose, root: int = 1) -> Samples:
    """Return S_o, the denominator of R_S, from alpha to the lock; the roots have the printed signs if `root` is 1."""
    locked = sqrt(p.L4**2 - (p.Hb - p.L5 * sin(p.theta + p.gamma)) ** 2)
    here = sqrt(p.L4**2 - (p.Hb - p.L5 * sin(p.theta + p.gamma + p.alpha)) ** 2)
    stroke: Samples = p.L5 * (cos(p.gamma + p.theta) - cos(p.alpha + p.gamma + p.theta)) + root * (locked - here)
    return stroke


def velocity_ratio(p: Pose) -> Samples:
    """Return R_V."""
    ratio: Samples = (p.L1 * sin(p.alpha + p.theta + p.beta) * cos(p.phi)) / (
        p.L5 * sin(p.alpha + p.theta + p.gamma + p.phi) * cos(p.beta)
    )
    return ratio


def force_ratio(p: Pose) -> Samples:
    """Return M_P."""
    ratio: Samples = (p.L5 * sin(p.alpha + p.theta + p.gamma + p.phi) * cos(p.beta)) / (
        p.L1 * sin(p.alpha + p.theta + p.beta) * cos(p.phi)
    )
    return ratio


def omega_1(p: Pose, Vo: Any) -> Samples:
    """Return the rate of the rear link."""
    rate: Samples = Vo * cos(p.phi) / (p.L5 * sin(p.alpha + p.theta + p.gamma + p.phi))
    return rate


def omega_4(p: Pose, Vo: Any) -> Samples:
    """Return the rate of the crosshead's link."""
    rate: Samples = Vo * cos(p.alpha + p.theta + p.gamma) / (p.L4 * sin(p.alpha + p.theta + p.gamma + p.phi))
    return rate


def omega_2(p: Pose, w1: Samples) -> Samples:
    """Return the rate of the front link."""
    rate: Samples = p.L1 * w1 * cos(p.alpha + p.theta) / (p.L2 * cos(p.beta))
    return rate


def epsilon_1(p: Pose, w1: Samples, w4: Samples) -> Samples:
    """Return the acceleration of the rear link."""
    angle = p.alpha + p.theta + p.gamma + p.phi
    acceleration: Samples = (p.L5 * w1**2 * cos(angle) - p.L4 * w4**2) / (p.L5 * sin(angle))
    return acceleration


def platen_acceleration_printed(p: Pose, w1: Samples, w2: Samples, e1: Samples) -> Samples:
    """Return a_m as it is printed."""
    angle = p.alpha + p.theta + p.beta
    acceleration: Samples = p.L1 * e1 * sin(angle) - p.L1 * w1**2 * cos(angle) - p.L2 * w2**2 * cos(p.beta)
    return acceleration


def platen_acceleration(p: Pose, w1: Samples, w2: Samples, e1: Samples) -> Samples:
    """Return a_m as it should be."""
    angle = p.alpha + p.theta + p.beta
    along_front_link = p.L1 * e1 * sin(angle) - p.L1 * w1**2 * cos(angle) - p.L2 * w2**2
    acceleration: Samples = along_front_link / cos(p.beta)
    return acceleration


E = Equation[Moving]
EQUATIONS = (
    E(
        "eq R_S",
        "length",
        "S_m / S_o, as below",
        lambda v: v.Sm / v.So * crosshead_stroke(v) - platen_stroke(v),
        branches={
            "with − before S_o's pair of roots": lambda v: v.Sm / v.So * crosshead_stroke(v, -1) - platen_stroke(v)
        },
        note="judged by R_S S_o = S_m, for every way to the lock",
    ),
    E(
        "eq R_S, S_m",
        "length",
        "(L₁+L₂) cos θ − L₁ cos(θ+α) − √(L₂² − [L₁ sin(α+θ) − (L₁+L₂) sin θ]²)",
        lambda v: v.Sm - platen_stroke(v),
        branches={"with + before the root": lambda v: v.Sm - platen_stroke(v, -1)},
    ),
    E(
        "eq R_S, S_o",
        "length",
        "L₅[cos(γ+θ) − cos(α+γ+θ)] + √(L₄² − [H_b − L₅ sin(θ+γ)]²) − √(L₄² − [H_b − L₅ sin(θ+γ+α)]²)",
        lambda v: v.So - crosshead_stroke(v),
        branches={"with −√ + √: the crosshead keeps behind D": lambda v: v.So - crosshead_stroke(v, -1)},
    ),
    E(
        "eq R_V",
        "ratio",
        "L₁ sin(α+θ+β) cos φ / (L₅ sin(α+θ+γ+φ) cos β)",
        lambda v: v.vm / v.Vo - velocity_ratio(v),
    ),
    E(
        "eq a_m",
        "acceleration",
        "L₁ε₁ sin(α+θ+β) − L₁ω₁² cos(α+θ+β) − L₂ω₂² cos β",
        lambda v: v.am - platen_acceleration_printed(v, v.w1, v.w2, v.e1),
        "[L₁ε₁ sin(α+θ+β) − L₁ω₁² cos(α+θ+β) − L₂ω₂²] / cos β",
        lambda v: v.am - platen_acceleration(v, v.w1, v.w2, v.e1),
    ),
    E("eq omega_1", "rate", "V_o cos φ / (L₅ sin(α+θ+γ+φ))", lambda v: v.w1 - omega_1(v, v.Vo)),
    E("eq omega_4", "rate", "V_o cos(α+θ+γ) / (L₄ sin(α+θ+γ+φ))", lambda v: v.w4 - omega_4(v, v.Vo)),
    E("eq omega_2", "rate", "L₁ω₁ cos(α+θ) / (L₂ cos β)", lambda v: v.w2 - omega_2(v, v.w1)),
    E(
        "eq epsilon_1",
        "rate²",
        "[L₅ω₁² cos(α+θ+γ+φ) − L₄ω₄²] / (L₅ sin(α+θ+γ+φ))",
        lambda v: v.e1 - epsilon_1(v, v.w1, v.w4),
        note="at constant V_o",
    ),
    E(
        "eq M_P",
        "force ratio",
        "L₅ sin(α+θ+γ+φ) cos β / (L₁ sin(α+θ+β) cos φ)",
        lambda v: v.Po_Pm - 1 / force_ratio(v),
        note="judged by 1/M_P, which is finite in the lock too",
    ),
)

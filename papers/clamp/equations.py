"""Double-toggle clamp: the printed formulas, each as it is printed and, beside it, as it should be.

A formula takes what it needs of others from the motion.
"""

from typing import Any

from numpy import cos, sin, sqrt

from scenes.motion import Samples

from ..claims import Equation
from .variables import Moving, Pose


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

"""Toggle press: equations (20) to (27), speeds and accelerations, each as it is printed and as it should be.

A form is the difference of an equation's two sides.
"""

from numpy import cos, sin

from scenes.motion import Samples

from ..claims import Equation
from .variables import Variables

E = Equation[Variables]


def _across(length: float, w: Samples, a: Samples, t: Samples) -> Samples:
    """Return l α sin θ + l ω² cos θ: less the acceleration of a bar's end past its start, along x."""
    return length * a * sin(t) + length * w**2 * cos(t)


def _up(length: float, w: Samples, a: Samples, t: Samples) -> Samples:
    """Return l α cos θ − l ω² sin θ: that acceleration along y."""
    return length * a * cos(t) - length * w**2 * sin(t)


EQUATIONS = (
    E(
        "eq 20",
        "speed",
        "−l₀ω sin θ − l₂ω₂ sin θ₂ = −l₁ω₁ sin θ₁",
        lambda v: -v.l0 * v.w * sin(v.t) - v.l2 * v.w2 * sin(v.t2) - (-v.l1 * v.w1 * sin(v.t1)),
    ),
    E(
        "eq 20.2",
        "speed",
        "l₀ω cos θ − l₂ω₂ cos θ₂ = l₁ω₁ cos θ₁",
        lambda v: v.l0 * v.w * cos(v.t) - v.l2 * v.w2 * cos(v.t2) - v.l1 * v.w1 * cos(v.t1),
        "l₀ω cos θ + l₂ω₂ cos θ₂ = l₁ω₁ cos θ₁",
        lambda v: v.l0 * v.w * cos(v.t) + v.l2 * v.w2 * cos(v.t2) - v.l1 * v.w1 * cos(v.t1),
    ),
    E(
        "eq 21",
        "speed",
        "−l₂ω₂ sin θ₂ − l₃ω₃ sin θ₃ = −l₄ω₄ sin θ₄",
        lambda v: -v.l2 * v.w2 * sin(v.t2) - v.l3 * v.w3 * sin(v.t3) - (-v.l4 * v.w4 * sin(v.t4)),
    ),
    E(
        "eq 21.2",
        "speed",
        "l₂ω₂ cos θ₂ + l₃ω₃ cos θ₃ = l₄ω₄ cos θ₄",
        lambda v: v.l2 * v.w2 * cos(v.t2) + v.l3 * v.w3 * cos(v.t3) - v.l4 * v.w4 * cos(v.t4),
    ),
    E(
        "eq 22",
        "speed",
        "−l₁ω₁ sin θ₁ − l₃ω₃ sin θ₃ − l₅ω₅ sin θ₅ = 0",
        lambda v: -v.l1 * v.w1 * sin(v.t1) - v.l3 * v.w3 * sin(v.t3) - v.l5 * v.w5 * sin(v.t5),
    ),
    E(
        "eq 22.2",
        "speed",
        "l₁ω₁ cos θ₁ + l₃ω₃ cos θ₃ + l₅ω₅ cos θ₅ = v",
        lambda v: v.l1 * v.w1 * cos(v.t1) + v.l3 * v.w3 * cos(v.t3) + v.l5 * v.w5 * cos(v.t5) - v.v,
    ),
    E(
        "eq 23",
        "speed",
        "v = l₁ω₁ cos θ₁ + l₃ω₃ cos θ₃ + l₅ω₅ cos θ₅",
        lambda v: v.v - (v.l1 * v.w1 * cos(v.t1) + v.l3 * v.w3 * cos(v.t3) + v.l5 * v.w5 * cos(v.t5)),
    ),
    E(
        "eq 24",
        "acceleration",
        "l₀α sin θ + l₀ω² cos θ + l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ = l₁α₁ sin θ₁ + l₁ω₁² cos θ₁",
        lambda v: _across(v.l0, v.w, v.a, v.t) + _across(v.l2, v.w2, v.a2, v.t2) - _across(v.l1, v.w1, v.a1, v.t1),
    ),
    E(
        "eq 24.2",
        "acceleration",
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ + l₁ω₁² sin θ₁",
        lambda v: (
            _up(v.l0, v.w, v.a, v.t)
            + _up(v.l2, v.w2, v.a2, v.t2)
            - (v.l1 * v.a1 * cos(v.t1) + v.l1 * v.w1**2 * sin(v.t1))
        ),
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁",
        lambda v: _up(v.l0, v.w, v.a, v.t) + _up(v.l2, v.w2, v.a2, v.t2) - _up(v.l1, v.w1, v.a1, v.t1),
    ),
    E(
        "eq 25",
        "acceleration",
        "l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ = l₄α₄ sin θ₄ + l₄ω₄² cos θ₄",
        lambda v: _across(v.l2, v.w2, v.a2, v.t2) + _across(v.l3, v.w3, v.a3, v.t3) - _across(v.l4, v.w4, v.a4, v.t4),
    ),
    E(
        "eq 25.2",
        "acceleration",
        "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ = l₄α₄ cos θ₄ − l₄ω₄² sin θ₄",
        lambda v: _up(v.l2, v.w2, v.a2, v.t2) + _up(v.l3, v.w3, v.a3, v.t3) - _up(v.l4, v.w4, v.a4, v.t4),
    ),
    E(
        "eq 26",
        "acceleration",
        "l₁α₁ sin θ₁ + l₁ω₁² cos θ₁ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ + l₅α₅ sin θ₅ + l₅ω₅² cos θ₅ = 0",
        lambda v: _across(v.l1, v.w1, v.a1, v.t1) + _across(v.l3, v.w3, v.a3, v.t3) + _across(v.l5, v.w5, v.a5, v.t5),
    ),
    E(
        "eq 26.2",
        "acceleration",
        "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
        lambda v: _up(v.l2, v.w2, v.a2, v.t2) + _up(v.l3, v.w3, v.a3, v.t3) + _up(v.l5, v.w5, v.a5, v.t5) - v.a_s,
        "l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
        lambda v: _up(v.l1, v.w1, v.a1, v.t1) + _up(v.l3, v.w3, v.a3, v.t3) + _up(v.l5, v.w5, v.a5, v.t5) - v.a_s,
    ),
    E(
        "eq 27",
        "acceleration",
        "αₛ = l₁α₁² cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
        lambda v: v.a_s - (_up(v.l1, v.w1, v.a1**2, v.t1) + _up(v.l3, v.w3, v.a3, v.t3) + _up(v.l5, v.w5, v.a5, v.t5)),
        "αₛ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
        lambda v: v.a_s - (_up(v.l1, v.w1, v.a1, v.t1) + _up(v.l3, v.w3, v.a3, v.t3) + _up(v.l5, v.w5, v.a5, v.t5)),
    ),
)

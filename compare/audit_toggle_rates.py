"""Toggle press: equations (20) to (27), speeds and accelerations, each as it is printed and as it should be.

A form is the difference of an equation's two sides.
"""

from numpy import cos, sin

from scenes.motion import Samples

from .audit_claims import Equation
from .audit_toggle_variables import Variables

E = Equation[Variables]


def _eq24_2(v: Variables) -> Samples:
    return v.l0 * v.a * cos(v.t) - v.l0 * v.w**2 * sin(v.t) + v.l2 * v.a2 * cos(v.t2) - v.l2 * v.w2**2 * sin(v.t2)


def _rods(v: Variables) -> Samples:
    """Return the terms of P3-P4 and P4-P5 that (26) and (27) share."""
    return v.l3 * v.a3 * cos(v.t3) - v.l3 * v.w3**2 * sin(v.t3) + v.l5 * v.a5 * cos(v.t5) - v.l5 * v.w5**2 * sin(v.t5)


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
        lambda v: (
            v.l0 * v.a * sin(v.t)
            + v.l0 * v.w**2 * cos(v.t)
            + v.l2 * v.a2 * sin(v.t2)
            + v.l2 * v.w2**2 * cos(v.t2)
            - (v.l1 * v.a1 * sin(v.t1) + v.l1 * v.w1**2 * cos(v.t1))
        ),
    ),
    E(
        "eq 24.2",
        "acceleration",
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ + l₁ω₁² sin θ₁",
        lambda v: _eq24_2(v) - (v.l1 * v.a1 * cos(v.t1) + v.l1 * v.w1**2 * sin(v.t1)),
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁",
        lambda v: _eq24_2(v) - (v.l1 * v.a1 * cos(v.t1) - v.l1 * v.w1**2 * sin(v.t1)),
    ),
    E(
        "eq 25",
        "acceleration",
        "l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ = l₄α₄ sin θ₄ + l₄ω₄² cos θ₄",
        lambda v: (
            v.l2 * v.a2 * sin(v.t2)
            + v.l2 * v.w2**2 * cos(v.t2)
            + v.l3 * v.a3 * sin(v.t3)
            + v.l3 * v.w3**2 * cos(v.t3)
            - (v.l4 * v.a4 * sin(v.t4) + v.l4 * v.w4**2 * cos(v.t4))
        ),
    ),
    E(
        "eq 25.2",
        "acceleration",
        "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ = l₄α₄ cos θ₄ − l₄ω₄² sin θ₄",
        lambda v: (
            v.l2 * v.a2 * cos(v.t2)
            - v.l2 * v.w2**2 * sin(v.t2)
            + v.l3 * v.a3 * cos(v.t3)
            - v.l3 * v.w3**2 * sin(v.t3)
            - (v.l4 * v.a4 * cos(v.t4) - v.l4 * v.w4**2 * sin(v.t4))
        ),
    ),
    E(
        "eq 26",
        "acceleration",
        "l₁α₁ sin θ₁ + l₁ω₁² cos θ₁ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ + l₅α₅ sin θ₅ + l₅ω₅² cos θ₅ = 0",
        lambda v: (
            v.l1 * v.a1 * sin(v.t1)
            + v.l1 * v.w1**2 * cos(v.t1)
            + v.l3 * v.a3 * sin(v.t3)
            + v.l3 * v.w3**2 * cos(v.t3)
            + v.l5 * v.a5 * sin(v.t5)
            + v.l5 * v.w5**2 * cos(v.t5)
        ),
    ),
    E(
        "eq 26.2",
        "acceleration",
        "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
        lambda v: v.l2 * v.a2 * cos(v.t2) - v.l2 * v.w2**2 * sin(v.t2) + _rods(v) - v.a_s,
        "l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
        lambda v: v.l1 * v.a1 * cos(v.t1) - v.l1 * v.w1**2 * sin(v.t1) + _rods(v) - v.a_s,
    ),
    E(
        "eq 27",
        "acceleration",
        "αₛ = l₁α₁² cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
        lambda v: v.a_s - (v.l1 * v.a1**2 * cos(v.t1) - v.l1 * v.w1**2 * sin(v.t1) + _rods(v)),
        "αₛ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
        lambda v: v.a_s - (v.l1 * v.a1 * cos(v.t1) - v.l1 * v.w1**2 * sin(v.t1) + _rods(v)),
    ),
)

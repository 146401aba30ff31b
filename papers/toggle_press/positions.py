"""Toggle press: equations (1) to (19), the positions, each as it is printed and, beside it, as it should be.

A form is the difference of an equation's two sides. It takes what it needs of other equations from the motion, so that
each misprint counts once, where it stands.
"""

from math import pi, tau

import numpy as np
from numpy import arccos, cos, exp, sin, sqrt
from numpy import arctan as atan

from scenes.motion import Samples

from ..claims import Equation
from .variables import Variables

E = Equation[Variables]
WITH_MINUS = "with −√"


def _apart(angle: Samples, printed: Samples) -> Samples:
    """Return the difference of two angles, rad, modulo one turn."""
    difference: Samples = np.remainder(angle - printed + pi, tau) - pi
    return difference


def _eq8(v: Variables, root: int) -> Samples:
    A1, B1 = 2 * v.l1 * (v.l0 * cos(v.t) + v.x), 2 * v.l1 * (v.l0 * sin(v.t) - v.y)
    C1 = _c1(v)
    return _apart(v.t1, 2 * atan((B1 + root * sqrt(A1**2 + B1**2 - C1**2)) / (A1 - C1)))


def _c1(v: Variables) -> Samples:
    return v.l2**2 - v.l1**2 - (v.l0 * sin(v.t) - v.y) ** 2 - (v.l0 * cos(v.t) + v.x) ** 2


def _eq10(v: Variables, root: int) -> Samples:
    A2, B2 = 2 * v.l2 * (v.l0 * cos(v.t) + v.x), 2 * v.l2 * (v.l0 * sin(v.t) - v.y)
    C2 = _c2_corrected(v)
    return _apart(v.t2, 2 * atan((B2 + root * sqrt(A2**2 + B2**2 - C2**2)) / (A2 - C2)))


def _c2(v: Variables) -> Samples:
    return v.l1**2 - v.l2**2 - (v.l0 * sin(v.t) - v.y) ** 2 - (v.l0 * cos(v.t) + v.x) ** 2


def _c2_corrected(v: Variables) -> Samples:
    return v.l2**2 - v.l1**2 + (v.l0 * sin(v.t) - v.y) ** 2 + (v.l0 * cos(v.t) + v.x) ** 2


def _eq14(v: Variables, root: int) -> Samples:
    return _theta3(v, 2 * v.l4 * v.l2 * sin(v.t2), root)


def _eq14_corrected(v: Variables, root: int) -> Samples:
    return _theta3(v, -2 * v.l2 * v.l3 * sin(v.t2), root)


def _theta3(v: Variables, E1: Samples, root: int) -> Samples:
    D1, F1 = -2 * v.l2 * v.l3 * cos(v.t2), _f1(v)
    return _apart(v.t3, 2 * atan((E1 + root * sqrt(D1**2 + E1**2 - F1**2)) / (D1 - F1)))


def _f1(v: Variables) -> Samples:
    return v.l4**2 - v.l3**2 - (v.l2 * cos(v.t2)) ** 2 - (v.l2 * sin(v.t2)) ** 2


def _in_half_angle(angle: Samples, A: Samples, B: Samples, C: Samples) -> Samples:
    """Return the equation of which 2 atan((B ± sqrt(A^2 + B^2 - C^2)) / (A - C)) are the roots."""
    return A * cos(angle) + B * sin(angle) + C


EQUATIONS = (
    E("eq 1", "length", "L₀ + L₂ = L₁ + x + y", lambda v: v.L0 + v.L2 - (v.L1 - v.x + 1j * v.y)),
    E("eq 2", "length", "L₂ + L₃ = L₄", lambda v: v.L2 + v.L3 - v.L4),
    E("eq 3", "length", "L₁ + L₃ + L₅ = S", lambda v: v.L1 + v.L3 + v.L5 - 1j * v.S),
    E(
        "eq 4",
        "length",
        "l₀ e^iθ + l₂ e^iθ₂ = l₁ e^iθ₁ − x + iy",
        lambda v: v.l0 * exp(1j * v.t) + v.l2 * exp(1j * v.t2) - (v.l1 * exp(1j * v.t1) - v.x + 1j * v.y),
    ),
    E(
        "eq 5",
        "length",
        "Re: l₀ cos θ + l₂ cos θ₂ = l₁ cos θ₁ − x",
        lambda v: v.l0 * cos(v.t) + v.l2 * cos(v.t2) - (v.l1 * cos(v.t1) - v.x),
    ),
    E(
        "eq 5.2",
        "length",
        "Im: l₀ sin θ = l₁ sin θ₁ + y",
        lambda v: v.l0 * sin(v.t) - (v.l1 * sin(v.t1) + v.y),
        "l₀ sin θ + l₂ sin θ₂ = l₁ sin θ₁ + y",
        lambda v: v.l0 * sin(v.t) + v.l2 * sin(v.t2) - (v.l1 * sin(v.t1) + v.y),
    ),
    E(
        "eq 6",
        "length",
        "l₀ cos θ + l₂ cos θ₂ = l₁ cos θ₁ − x",
        lambda v: v.l0 * cos(v.t) + v.l2 * cos(v.t2) - (v.l1 * cos(v.t1) - v.x),
    ),
    E(
        "eq 6.2",
        "length",
        "l₀ sin θ + l₂ sin θ₂ = l₁ sin θ₁ + y",
        lambda v: v.l0 * sin(v.t) + v.l2 * sin(v.t2) - (v.l1 * sin(v.t1) + v.y),
    ),
    E(
        "eq 7",
        "length",
        "l₁ cos θ₁ − l₂ cos θ₂ = l₀ cos θ₁ + x",
        lambda v: v.l1 * cos(v.t1) - v.l2 * cos(v.t2) - (v.l0 * cos(v.t1) + v.x),
        "l₁ cos θ₁ − l₂ cos θ₂ = l₀ cos θ + x",
        lambda v: v.l1 * cos(v.t1) - v.l2 * cos(v.t2) - (v.l0 * cos(v.t) + v.x),
    ),
    E(
        "eq 7.2",
        "length",
        "l₁ sin θ₁ − l₂ sin θ₂ = l₀ sin θ₁ − y",
        lambda v: v.l1 * sin(v.t1) - v.l2 * sin(v.t2) - (v.l0 * sin(v.t1) - v.y),
        "l₁ sin θ₁ − l₂ sin θ₂ = l₀ sin θ − y",
        lambda v: v.l1 * sin(v.t1) - v.l2 * sin(v.t2) - (v.l0 * sin(v.t) - v.y),
    ),
    E(
        "eq 8",
        "angle",
        "θ₁ = 2 atan((B₁ + √(A₁² + B₁² − C₁²)) / (A₁ − C₁)), A₁ = 2 l₁(l₀ cos θ + x), B₁ = 2 l₁(l₀ sin θ − y)",
        lambda v: _eq8(v, +1),
        branches={WITH_MINUS: lambda v: _eq8(v, -1)},
    ),
    E(
        "eq 9",
        "area",
        "C₁ = l₂² − l₁² − (l₀ sin θ − y)² − (l₀ cos θ + x)²",
        lambda v: _in_half_angle(v.t1, 2 * v.l1 * v.X, 2 * v.l1 * v.Y, _c1(v)),
        note="judged by A cos θ + B sin θ + C = 0, of which (8), (10) and (14) are the roots",
    ),
    E(
        "eq 10",
        "angle",
        "θ₂ = 2 atan((B₂ + √(A₂² + B₂² − C₂²)) / (A₂ − C₂)), A₂ = 2 l₂(l₀ cos θ + x), B₂ = 2 l₂(l₀ sin θ − y)",
        lambda v: _eq10(v, +1),
        branches={WITH_MINUS: lambda v: _eq10(v, -1)},
        note="with C₂ as corrected in (11); with the printed one neither sign of the root holds",
    ),
    E(
        "eq 11",
        "area",
        "C₂ = l₁² − l₂² − (l₀ sin θ − y)² − (l₀ cos θ + x)²",
        lambda v: _in_half_angle(v.t2, 2 * v.l2 * v.X, 2 * v.l2 * v.Y, _c2(v)),
        "C₂ = l₂² − l₁² + (l₀ sin θ − y)² + (l₀ cos θ + x)²",
        lambda v: _in_half_angle(v.t2, 2 * v.l2 * v.X, 2 * v.l2 * v.Y, _c2_corrected(v)),
        note="or else A₂ and B₂ have the wrong sign",
    ),
    E(
        "eq 12",
        "length",
        "l₂ e^iθ₂ + l₃ e^iθ₃ = l₄ e^iθ₄",
        lambda v: v.l2 * exp(1j * v.t2) + v.l3 * exp(1j * v.t3) - v.l4 * exp(1j * v.t4),
    ),
    E(
        "eq 13",
        "length",
        "l₂ cos θ₂ + l₃ cos θ₃ = l₄ cos θ₄",
        lambda v: v.l2 * cos(v.t2) + v.l3 * cos(v.t3) - v.l4 * cos(v.t4),
    ),
    E(
        "eq 13.2",
        "length",
        "l₂ sin θ₂ + l₃ sin θ₃ = l₄ sin θ₄",
        lambda v: v.l2 * sin(v.t2) + v.l3 * sin(v.t3) - v.l4 * sin(v.t4),
    ),
    E(
        "eq 14",
        "angle",
        "θ₃ = 2 atan((E₁ + √(D₁² + E₁² − F₁²)) / (D₁ − F₁)), D₁ = −2 l₂ l₃ cos θ₂, E₁ = 2 l₄ l₂ sin θ₂",
        lambda v: _eq14(v, +1),
        "E₁ = −2 l₂ l₃ sin θ₂, and −√",
        lambda v: _eq14_corrected(v, -1),
        branches={WITH_MINUS: lambda v: _eq14(v, -1)},
    ),
    E(
        "eq 15",
        "area",
        "F₁ = l₄² − l₃² − (l₂ cos θ₂)² − (l₂ sin θ₂)²",
        lambda v: _in_half_angle(v.t3, -2 * v.l2 * v.l3 * cos(v.t2), -2 * v.l2 * v.l3 * sin(v.t2), _f1(v)),
        note="with E₁ as corrected in (14)",
    ),
    E(
        "eq 16",
        "length",
        "l₁ e^iθ₁ + l₃ e^iθ₃ + l₅ e^iθ₅ = iS",
        lambda v: v.l1 * exp(1j * v.t1) + v.l3 * exp(1j * v.t3) + v.l5 * exp(1j * v.t5) - 1j * v.S,
    ),
    E(
        "eq 17",
        "length",
        "l₁ cos θ₁ + l₃ cos θ₃ + l₅ cos θ₅ = 0",
        lambda v: v.l1 * cos(v.t1) + v.l3 * cos(v.t3) + v.l5 * cos(v.t5),
    ),
    E(
        "eq 17.2",
        "length",
        "l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅ = 0",
        lambda v: v.l1 * sin(v.t1) + v.l3 * sin(v.t3) + v.l5 * sin(v.t5),
        "l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅ = S",
        lambda v: v.l1 * sin(v.t1) + v.l3 * sin(v.t3) + v.l5 * sin(v.t5) - v.S,
    ),
    E(
        "eq 18",
        "angle",
        "θ₅ = arccos((−l₁ cos θ₁ − l₃ cos θ₃) / l₅)",
        lambda v: _apart(v.t5, arccos((-v.l1 * cos(v.t1) - v.l3 * cos(v.t3)) / v.l5)),
        branches={"with −arccos": lambda v: _apart(v.t5, -arccos((-v.l1 * cos(v.t1) - v.l3 * cos(v.t3)) / v.l5))},
    ),
    E(
        "eq 19",
        "length",
        "S = l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅",
        lambda v: v.S - (v.l1 * sin(v.t1) + v.l3 * sin(v.t3) + v.l5 * sin(v.t5)),
    ),
)

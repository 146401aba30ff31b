"""Toggle press: equations (1) to (27), the kinematics, each as it is printed and, beside it, as it should be.

Yang (2023), doi:10.56578/jisc020103. Bars are numbered as in the paper: 0 the crank P1-P2, 1 the rocker O-P3, 2 to 4
the toggle's sides P2-P3, P3-P4 and P2-P4, 5 the rod P4-P5; (x, -y) is P1. Vectors are complex numbers. The variables
are those over turns of the crank that the reference solves: a form, the difference of an equation's two sides, takes
what it needs of other equations from the motion, so that each misprint counts once, where it stands.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import pi, tau
from typing import Any

import numpy as np
from numpy import arccos, cos, sin, sqrt
from numpy import arctan as atan
from numpy.typing import ArrayLike

from compare.mechanics.motion_vectors import MotionVectors, Vectors
from scenes import Motion, load
from scenes.drive import Driven, MotionLaw
from scenes.model.motion import Samples

from ..claims import Equation
from ..reference import solved
from ..written import equation

SAMPLES = 720  # a turn
SWAY = 0.4  # rad, of the crank that turns unevenly
LENGTHS = (77.0, 300.0, 490.0, 490.0, 760.0, 300.0)  # mm, as printed
BARS = (("P1", "P2"), ("O", "P3"), ("P2", "P3"), ("P3", "P4"), ("P2", "P4"), ("P4", "P5"))
BODIES = ("crank", "rocker", "toggle", "toggle", "toggle", "rod")  # of the bars


class Uneven(MotionLaw):
    """A crank that turns faster and slower within each turn; in closed form, so that no spline has to be imported."""

    def at(self, time: ArrayLike) -> Driven:
        """Return angle, rate and acceleration at some instants, s."""
        w = tau / self.cycle
        turned = w * np.asarray(time, np.float64)
        return Driven(turned + SWAY * sin(turned), w * (1 + SWAY * cos(turned)), -SWAY * w**2 * sin(turned))


@dataclass(frozen=True)
class Variables:
    """The paper's variables, SI, those of the bars by their numbers; arrays of shape (n,)."""

    l: Sequence[float]  # noqa: E741
    x: float
    y: float
    L: Sequence[Vectors]
    t: Sequence[Samples]  # theta, and so on: angle, rate and acceleration
    w: Sequence[Samples]
    a: Sequence[Samples]
    S: Samples
    v: Samples
    a_s: Samples

    def cos(self, bar: int) -> Samples:
        """Return l cos θ of a bar."""
        return self.l[bar] * cos(self.t[bar])

    def sin(self, bar: int) -> Samples:
        """Return l sin θ of a bar."""
        return self.l[bar] * sin(self.t[bar])

    @property
    def symbols(self) -> Mapping[str, Any]:
        """The values of the symbols of the printed equations."""
        others = {"x": self.x, "y": self.y, "S": self.S, "v": self.v, "αₛ": self.a_s}
        for symbol, of in (("l", self.l), ("θ", self.t), ("ω", self.w), ("α", self.a)):
            others |= {f"{symbol}{index}": value for index, value in zip(("", *"₁₂₃₄₅"), of, strict=True)}
        return others | {"l₀": others["l"]}

    @property
    def scale(self) -> Mapping[str, tuple[float, str]]:
        """Return scale and unit of each kind of equation: l1 = 300 mm, the crank's peak rate, and their products."""
        length, w = self.l[1], float(np.abs(self.w[0]).max())
        return {
            "length": (length, "m"),
            "area": (length**2, "m²"),
            "angle": (1.0, "rad"),
            "speed": (length * w, "m/s"),
            "acceleration": (length * w**2, "m/s²"),
        }


def bars(state: MotionVectors) -> list[Vectors]:
    """The vectors of the six bars, each of shape (n,), m."""
    return [state.point(end)[0] - state.point(start)[0] for start, end in BARS]


def over_two_turns() -> Variables:
    """The variables over a turn at constant speed, and one at a speed that varies: there alpha is not zero."""
    steady = load("toggle_press")
    uneven = Uneven("crank", (0.0, steady.drive.cycle), (0.0, tau), periodic=True)
    motions = [solved(scene, SAMPLES) for scene in (steady, replace(steady, drive=uneven))]
    both = Motion({channel: np.concatenate([m[channel] for m in motions]) for channel in motions[0].samples})
    state = MotionVectors(steady, both)
    vectors = bars(state)
    _, rates, accelerations = zip(*map(state.turning, BODIES), strict=True)
    lengths, (x, y) = [length / 1e3 for length in LENGTHS], steady.ground["P1"]
    slider = (both["P5.y"], both["P5.vy"], both["P5.ay"])
    return Variables(lengths, x, -y, vectors, [np.angle(bar) for bar in vectors], rates, accelerations, *slider)


length, speed, acceleration = (partial(equation, kind) for kind in ("length", "speed", "acceleration"))
WITH_MINUS = "with −√"


def _apart(theta: Samples, printed: Samples) -> Samples:
    """The difference of two angles, rad, modulo one turn."""
    return np.asarray(np.remainder(theta - printed + pi, tau) - pi)


def _in_half_angle(theta: Samples, A: Samples, B: Samples, C: Samples) -> Samples:
    """Return A cos θ + B sin θ + C, of which the angles of `_root` are the zeros."""
    return A * cos(theta) + B * sin(theta) + C


def _root(theta: Samples, A: Samples, B: Samples, C: Samples, sign: int) -> Samples:
    """How far an angle is off 2 atan((B ± √(A² + B² − C²)) / (A − C)), rad."""
    return _apart(theta, 2 * atan((B + sign * sqrt(A**2 + B**2 - C**2)) / (A - C)))


def _ab(v: Variables, bar: int) -> tuple[Samples, Samples]:
    """Return A and B as they stand with (8) and (10)."""
    return 2 * v.l[bar] * (v.cos(0) + v.x), 2 * v.l[bar] * (v.sin(0) - v.y)


def _c(v: Variables, sign: int) -> Samples:
    """Return C1, with the sign −, and C2 as it should be, with +."""
    return v.l[2] ** 2 - v.l[1] ** 2 + sign * (v.sin(0) - v.y) ** 2 + sign * (v.cos(0) + v.x) ** 2


def _def(v: Variables, before_e: float) -> tuple[Samples, Samples, Samples]:
    """Return D1 and F1, and between them E1 = `before_e` l₂ sin θ₂."""
    F = v.l[4] ** 2 - v.l[3] ** 2 - v.cos(2) ** 2 - v.sin(2) ** 2
    return -2 * v.l[2] * v.l[3] * cos(v.t[2]), before_e * v.l[2] * sin(v.t[2]), F


POSITIONS = (
    Equation[Variables](
        "length", "eq 1", "L₀ + L₂ = L₁ + x + y", lambda v: v.L[0] + v.L[2] - (v.L[1] - v.x + 1j * v.y)
    ),
    Equation[Variables]("length", "eq 2", "L₂ + L₃ = L₄", lambda v: v.L[2] + v.L[3] - v.L[4]),
    Equation[Variables]("length", "eq 3", "L₁ + L₃ + L₅ = S", lambda v: v.L[1] + v.L[3] + v.L[5] - 1j * v.S),
    length("eq 4", "l₀ e^iθ + l₂ e^iθ₂ = l₁ e^iθ₁ − x + iy"),
    length("eq 5", "Re: l₀ cos θ + l₂ cos θ₂ = l₁ cos θ₁ − x", after="Re: "),
    length("eq 5.2", "Im: l₀ sin θ = l₁ sin θ₁ + y", "l₀ sin θ + l₂ sin θ₂ = l₁ sin θ₁ + y", after="Im: "),
    length("eq 6", "l₀ cos θ + l₂ cos θ₂ = l₁ cos θ₁ − x"),
    length("eq 6.2", "l₀ sin θ + l₂ sin θ₂ = l₁ sin θ₁ + y"),
    length("eq 7", "l₁ cos θ₁ − l₂ cos θ₂ = l₀ cos θ₁ + x", "l₁ cos θ₁ − l₂ cos θ₂ = l₀ cos θ + x"),
    length("eq 7.2", "l₁ sin θ₁ − l₂ sin θ₂ = l₀ sin θ₁ − y", "l₁ sin θ₁ − l₂ sin θ₂ = l₀ sin θ − y"),
    Equation[Variables](
        "angle",
        "eq 8",
        "θ₁ = 2 atan((B₁ + √(A₁² + B₁² − C₁²)) / (A₁ − C₁)), A₁ = 2 l₁(l₀ cos θ + x), B₁ = 2 l₁(l₀ sin θ − y)",
        lambda v: _root(v.t[1], *_ab(v, 1), _c(v, -1), +1),
        branches={WITH_MINUS: lambda v: _root(v.t[1], *_ab(v, 1), _c(v, -1), -1)},
    ),
    Equation[Variables](
        "area",
        "eq 9",
        "C₁ = l₂² − l₁² − (l₀ sin θ − y)² − (l₀ cos θ + x)²",
        lambda v: _in_half_angle(v.t[1], *_ab(v, 1), _c(v, -1)),
        note="judged by A cos θ + B sin θ + C = 0, of which (8), (10) and (14) are the roots",
    ),
    Equation[Variables](
        "angle",
        "eq 10",
        "θ₂ = 2 atan((B₂ + √(A₂² + B₂² − C₂²)) / (A₂ − C₂)), A₂ = 2 l₂(l₀ cos θ + x), B₂ = 2 l₂(l₀ sin θ − y)",
        lambda v: _root(v.t[2], *_ab(v, 2), _c(v, +1), +1),
        branches={WITH_MINUS: lambda v: _root(v.t[2], *_ab(v, 2), _c(v, +1), -1)},
        note="with C₂ as corrected in (11); with the printed one neither sign of the root holds",
    ),
    Equation[Variables](
        "area",
        "eq 11",
        "C₂ = l₁² − l₂² − (l₀ sin θ − y)² − (l₀ cos θ + x)²",
        lambda v: _in_half_angle(v.t[2], *_ab(v, 2), -_c(v, +1)),
        "C₂ = l₂² − l₁² + (l₀ sin θ − y)² + (l₀ cos θ + x)²",
        lambda v: _in_half_angle(v.t[2], *_ab(v, 2), _c(v, +1)),
        note="or else A₂ and B₂ have the wrong sign",
    ),
    length("eq 12", "l₂ e^iθ₂ + l₃ e^iθ₃ = l₄ e^iθ₄"),
    length("eq 13", "l₂ cos θ₂ + l₃ cos θ₃ = l₄ cos θ₄"),
    length("eq 13.2", "l₂ sin θ₂ + l₃ sin θ₃ = l₄ sin θ₄"),
    Equation[Variables](
        "angle",
        "eq 14",
        "θ₃ = 2 atan((E₁ + √(D₁² + E₁² − F₁²)) / (D₁ − F₁)), D₁ = −2 l₂ l₃ cos θ₂, E₁ = 2 l₄ l₂ sin θ₂",
        lambda v: _root(v.t[3], *_def(v, 2 * v.l[4]), +1),
        "E₁ = −2 l₂ l₃ sin θ₂, and −√",
        lambda v: _root(v.t[3], *_def(v, -2 * v.l[3]), -1),
        branches={WITH_MINUS: lambda v: _root(v.t[3], *_def(v, 2 * v.l[4]), -1)},
    ),
    Equation[Variables](
        "area",
        "eq 15",
        "F₁ = l₄² − l₃² − (l₂ cos θ₂)² − (l₂ sin θ₂)²",
        lambda v: _in_half_angle(v.t[3], *_def(v, -2 * v.l[3])),
        note="with E₁ as corrected in (14)",
    ),
    length("eq 16", "l₁ e^iθ₁ + l₃ e^iθ₃ + l₅ e^iθ₅ = iS"),
    length("eq 17", "l₁ cos θ₁ + l₃ cos θ₃ + l₅ cos θ₅ = 0"),
    length("eq 17.2", "l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅ = 0", "l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅ = S"),
    Equation[Variables](
        "angle",
        "eq 18",
        "θ₅ = arccos((−l₁ cos θ₁ − l₃ cos θ₃) / l₅)",
        lambda v: _apart(v.t[5], arccos((-v.cos(1) - v.cos(3)) / v.l[5])),
        branches={"with −arccos": lambda v: _apart(v.t[5], -arccos((-v.cos(1) - v.cos(3)) / v.l[5]))},
    ),
    length("eq 19", "S = l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅"),
)

RATES = (
    speed("eq 20", "−l₀ω sin θ − l₂ω₂ sin θ₂ = −l₁ω₁ sin θ₁"),
    speed("eq 20.2", "l₀ω cos θ − l₂ω₂ cos θ₂ = l₁ω₁ cos θ₁", "l₀ω cos θ + l₂ω₂ cos θ₂ = l₁ω₁ cos θ₁"),
    speed("eq 21", "−l₂ω₂ sin θ₂ − l₃ω₃ sin θ₃ = −l₄ω₄ sin θ₄"),
    speed("eq 21.2", "l₂ω₂ cos θ₂ + l₃ω₃ cos θ₃ = l₄ω₄ cos θ₄"),
    speed("eq 22", "−l₁ω₁ sin θ₁ − l₃ω₃ sin θ₃ − l₅ω₅ sin θ₅ = 0"),
    speed("eq 22.2", "l₁ω₁ cos θ₁ + l₃ω₃ cos θ₃ + l₅ω₅ cos θ₅ = v"),
    speed("eq 23", "v = l₁ω₁ cos θ₁ + l₃ω₃ cos θ₃ + l₅ω₅ cos θ₅"),
    acceleration("eq 24", "l₀α sin θ + l₀ω² cos θ + l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ = l₁α₁ sin θ₁ + l₁ω₁² cos θ₁"),
    acceleration(
        "eq 24.2",
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ + l₁ω₁² sin θ₁",
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁",
    ),
    acceleration("eq 25", "l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ = l₄α₄ sin θ₄ + l₄ω₄² cos θ₄"),
    acceleration("eq 25.2", "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ = l₄α₄ cos θ₄ − l₄ω₄² sin θ₄"),
    acceleration("eq 26", "l₁α₁ sin θ₁ + l₁ω₁² cos θ₁ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ + l₅α₅ sin θ₅ + l₅ω₅² cos θ₅ = 0"),
    acceleration(
        "eq 26.2",
        "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
        "l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
    ),
    acceleration(
        "eq 27",
        "αₛ = l₁α₁² cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
        "αₛ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
    ),
)

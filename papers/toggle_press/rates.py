"""Toggle press: equations (20) to (27), speeds and accelerations, each as it is printed and as it should be.

A form is the difference of an equation's two sides.
"""

from functools import partial

from numpy import cos, sin

from scenes.motion import Samples

from ..claims import Equation
from .variables import Variables

speed, acceleration = (partial(Equation[Variables], kind) for kind in ("speed", "acceleration"))


def _s(v: Variables, bar: int) -> Samples:
    """Return l ω sin θ of a bar."""
    return v.l[bar] * v.w[bar] * sin(v.t[bar])


def _c(v: Variables, bar: int) -> Samples:
    """Return l ω cos θ of a bar."""
    return v.l[bar] * v.w[bar] * cos(v.t[bar])


def _ac(v: Variables, bar: int) -> Samples:
    """Return l α cos θ of a bar."""
    return v.l[bar] * v.a[bar] * cos(v.t[bar])


def _wws(v: Variables, bar: int) -> Samples:
    """Return l ω² sin θ of a bar."""
    return v.l[bar] * v.w[bar] ** 2 * sin(v.t[bar])


def _up(v: Variables, bar: int) -> Samples:
    """Return l α cos θ − l ω² sin θ: the acceleration of a bar's end past its start, along y."""
    return _ac(v, bar) - _wws(v, bar)


def _across(v: Variables, bar: int) -> Samples:
    """Return l α sin θ + l ω² cos θ: less that acceleration along x."""
    return v.l[bar] * v.a[bar] * sin(v.t[bar]) + v.l[bar] * v.w[bar] ** 2 * cos(v.t[bar])


EQUATIONS = (
    speed("eq 20", "−l₀ω sin θ − l₂ω₂ sin θ₂ = −l₁ω₁ sin θ₁", lambda v: -_s(v, 0) - _s(v, 2) + _s(v, 1)),
    speed(
        "eq 20.2",
        "l₀ω cos θ − l₂ω₂ cos θ₂ = l₁ω₁ cos θ₁",
        lambda v: _c(v, 0) - _c(v, 2) - _c(v, 1),
        "l₀ω cos θ + l₂ω₂ cos θ₂ = l₁ω₁ cos θ₁",
        lambda v: _c(v, 0) + _c(v, 2) - _c(v, 1),
    ),
    speed("eq 21", "−l₂ω₂ sin θ₂ − l₃ω₃ sin θ₃ = −l₄ω₄ sin θ₄", lambda v: -_s(v, 2) - _s(v, 3) + _s(v, 4)),
    speed("eq 21.2", "l₂ω₂ cos θ₂ + l₃ω₃ cos θ₃ = l₄ω₄ cos θ₄", lambda v: _c(v, 2) + _c(v, 3) - _c(v, 4)),
    speed("eq 22", "−l₁ω₁ sin θ₁ − l₃ω₃ sin θ₃ − l₅ω₅ sin θ₅ = 0", lambda v: -_s(v, 1) - _s(v, 3) - _s(v, 5)),
    speed("eq 22.2", "l₁ω₁ cos θ₁ + l₃ω₃ cos θ₃ + l₅ω₅ cos θ₅ = v", lambda v: _c(v, 1) + _c(v, 3) + _c(v, 5) - v.v),
    speed("eq 23", "v = l₁ω₁ cos θ₁ + l₃ω₃ cos θ₃ + l₅ω₅ cos θ₅", lambda v: v.v - (_c(v, 1) + _c(v, 3) + _c(v, 5))),
    acceleration(
        "eq 24",
        "l₀α sin θ + l₀ω² cos θ + l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ = l₁α₁ sin θ₁ + l₁ω₁² cos θ₁",
        lambda v: _across(v, 0) + _across(v, 2) - _across(v, 1),
    ),
    acceleration(
        "eq 24.2",
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ + l₁ω₁² sin θ₁",
        lambda v: _up(v, 0) + _up(v, 2) - (_ac(v, 1) + _wws(v, 1)),
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁",
        lambda v: _up(v, 0) + _up(v, 2) - _up(v, 1),
    ),
    acceleration(
        "eq 25",
        "l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ = l₄α₄ sin θ₄ + l₄ω₄² cos θ₄",
        lambda v: _across(v, 2) + _across(v, 3) - _across(v, 4),
    ),
    acceleration(
        "eq 25.2",
        "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ = l₄α₄ cos θ₄ − l₄ω₄² sin θ₄",
        lambda v: _up(v, 2) + _up(v, 3) - _up(v, 4),
    ),
    acceleration(
        "eq 26",
        "l₁α₁ sin θ₁ + l₁ω₁² cos θ₁ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ + l₅α₅ sin θ₅ + l₅ω₅² cos θ₅ = 0",
        lambda v: _across(v, 1) + _across(v, 3) + _across(v, 5),
    ),
    acceleration(
        "eq 26.2",
        "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
        lambda v: _up(v, 2) + _up(v, 3) + _up(v, 5) - v.a_s,
        "l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
        lambda v: _up(v, 1) + _up(v, 3) + _up(v, 5) - v.a_s,
    ),
    acceleration(
        "eq 27",
        "αₛ = l₁α₁² cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
        lambda v: v.a_s - (v.l[1] * v.a[1] ** 2 * cos(v.t[1]) - _wws(v, 1) + _up(v, 3) + _up(v, 5)),
        "αₛ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
        lambda v: v.a_s - (_up(v, 1) + _up(v, 3) + _up(v, 5)),
    ),
)

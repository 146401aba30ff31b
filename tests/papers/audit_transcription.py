"""The two sources transcribed a second time, from the papers and in another form, for the audit's tests.

Nothing here is the audit's: positions come from circles that meet, rates from differences of the positions, and the
printed equations are written as complex numbers or in other trigonometric forms.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CRANK, ROCKER, SIDE, BASE, ROD = 0.077, 0.300, 0.490, 0.760, 0.300
P1 = complex(0.404709, 0.872339 - 1.090)
STEP = 2e-3  # rad: five points give a second derivative to 1e-9


@dataclass(frozen=True)
class Angle:
    """An angle and its first two derivatives by the time, shape (n,)."""

    at: Array
    rate: Array
    second: Array

    @property
    def unit(self) -> NDArray[np.complex128]:
        return np.asarray(np.exp(1j * self.at))

    @property
    def turned(self) -> NDArray[np.complex128]:
        """The derivative of the unit vector."""
        return 1j * self.rate * self.unit

    @property
    def twice(self) -> NDArray[np.complex128]:
        """The second derivative of the unit vector."""
        return (1j * self.second - self.rate**2) * self.unit


def angles(theta: Array) -> Array:
    """The angles theta_1 to theta_5, shape (5, n), for crank angles of shape (n,)."""
    p2 = P1 + CRANK * np.exp(1j * theta)
    distance, towards = abs(p2), np.angle(p2)
    p3 = ROCKER * np.exp(1j * (towards - np.arccos((distance**2 + ROCKER**2 - SIDE**2) / (2 * distance * ROCKER))))
    half = np.arcsin(BASE / 2 / SIDE)  # of the triangle's apex at P3
    p4 = p3 + (p2 - p3) * np.exp(-2j * half)
    p5 = 1j * (p4.imag - np.sqrt(ROD**2 - p4.real**2))
    return np.unwrap(np.angle([p3, p3 - p2, p4 - p3, p4 - p2, p5 - p4]), axis=1)


def moving(theta: Array, omega: Array, alpha: Array) -> list[Angle]:
    """Theta and theta_1 to theta_5 with their rates, by differences."""
    around = np.array([np.angle(np.exp(1j * angles(theta + k * STEP))) for k in (-2, -1, 0, 1, 2)])
    around = around[2] + np.remainder(around - around[2] + np.pi, 2 * np.pi) - np.pi
    first = np.tensordot([1, -8, 0, 8, -1], around, axes=1) / (12 * STEP)
    second = np.tensordot([-1, 16, -30, 16, -1], around, axes=1) / (12 * STEP**2)
    others = [Angle(a, f * omega, f * alpha + s * omega**2) for a, f, s in zip(around[2], first, second, strict=True)]
    return [Angle(theta, omega, alpha), *others]


def printed(t: list[Angle]) -> dict[str, Array]:
    """Some of the printed equations, left side less right side, with terms of the closed loop moved together."""
    crank, rocker, two, three, _, rod = t
    y = -P1.imag
    slider = ROCKER * rocker.unit + SIDE * three.unit + ROD * rod.unit
    loop = CRANK * crank.turned + SIDE * two.turned - ROCKER * rocker.turned
    chain = SIDE * three.twice + ROD * rod.twice
    return {
        "eq 5.2": np.imag(CRANK * crank.unit - ROCKER * rocker.unit) - y,
        "eq 7": np.real(ROCKER * rocker.unit - SIDE * two.unit - CRANK * rocker.unit) - P1.real,
        "eq 17.2": slider.imag,
        "eq 20.2": (loop - 2 * SIDE * two.turned).imag,
        "eq 24.2": np.imag(CRANK * crank.twice + SIDE * two.twice - ROCKER * rocker.twice)
        - 2 * ROCKER * rocker.rate**2 * rocker.unit.imag,
        "eq 26.2": np.imag(SIDE * two.twice - ROCKER * rocker.twice),
        "eq 27": ROCKER * rocker.unit.real * (rocker.second - rocker.second**2) + 0 * chain.imag,
    }


def half_angle_roots(t: list[Angle]) -> dict[str, tuple[Array, Array]]:
    """The roots with + and - of the printed (8) and (14), by the form atan2(B, A) +- arccos(-C/|A, B|)."""
    crank, _, two, _, _, _ = t
    x, y = CRANK * crank.unit.real + P1.real, CRANK * crank.unit.imag + P1.imag
    c1 = SIDE**2 - ROCKER**2 - x**2 - y**2
    f1 = BASE**2 - 2 * SIDE**2
    return {
        "eq 8": _roots(2 * ROCKER * x, 2 * ROCKER * y, c1),
        "eq 14": _roots(-2 * SIDE**2 * np.cos(two.at), 2 * BASE * SIDE * np.sin(two.at), np.full_like(x, f1)),
    }


def _roots(A: Array, B: Array, C: Array) -> tuple[Array, Array]:
    """The angles at which A cos + B sin + C = 0: 2 atan((B +- root) / (A - C)) in another form."""
    towards, apart = np.arctan2(B, A), np.arccos(-C / np.hypot(A, B))
    return towards + apart, towards - apart


@dataclass(frozen=True)
class Clamp:
    """A design of table 2, mm and degrees; the crosshead's and the platen's place over alpha, by the closed loop."""

    L1: float
    L2: float
    L4: float
    L5: float
    Hb: float
    theta: float
    gamma: float
    alpha_max: float

    def crosshead(self, alpha: Array) -> Array:
        """X of E, which trails D, for alpha in degrees."""
        d = self.L5 * np.exp(1j * np.radians(alpha + self.theta + self.gamma))
        return np.asarray(d.real - np.sqrt(self.L4**2 - (self.Hb - d.imag) ** 2))

    def platen(self, alpha: Array) -> Array:
        """X of C, which leads B, for alpha in degrees."""
        b = self.L1 * np.exp(1j * np.radians(alpha + self.theta))
        level = (self.L1 + self.L2) * np.sin(np.radians(self.theta))
        return np.asarray(b.real + np.sqrt(self.L2**2 - (b.imag - level) ** 2))

    def ratio(self, alpha: Array) -> Array:
        """V_m / v_o from the places alone."""
        return _slope(self.platen, alpha) / _slope(self.crosshead, alpha)

    def acceleration(self, alpha: Array, speed: float) -> Array:
        """A_m, mm/s^2, at a constant speed of the crosshead, mm/s: v_o d(R_V)/dt."""
        return speed**2 * _slope(self.ratio, alpha, 0.05) / _slope(self.crosshead, alpha)

    @property
    def stroke_ratio(self) -> float:
        ends = np.array([0.0, self.alpha_max])
        return float(np.ptp(self.platen(ends)) / np.ptp(self.crosshead(ends)))


def _slope(of: Callable[[Array], Array], at: Array, step: float = 0.02) -> Array:
    """The derivative by six-point differences, per degree."""
    h = step * np.arange(1, 4)
    weights = np.array([3 / 4, -3 / 20, 1 / 60]) / step
    return np.asarray(sum(w * (of(at + k) - of(at - k)) for w, k in zip(weights, h, strict=True)))


INITIAL = Clamp(352, 457, 120, 305, 235.5, 4.5, 19.4, 110)
SCHEME_4 = Clamp(368, 430, 135, 280, 239, 4.0, 18.0, 105)

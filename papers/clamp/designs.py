"""Double-toggle clamp: what its designs do, at face value and at the corners of what table 2's rounding leaves open."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy import pi
from numpy.typing import NDArray

from scenes.motion import Samples

from ..claims import Range, half_unit
from . import equations as formulas
from .variables import DESIGNS, Pose, assembled

ALPHAS = 1001  # over the stroke: the extremes of smooth curves to 1e-6 of themselves
NEAR_LOCK = 2.5  # deg, where M_P is printed
SPEED = 0.1  # m/s, of the crosshead, which is not given
SPEEDS = (0.05, 0.2)  # m/s, that are plausible

Values: TypeAlias = Mapping[str, NDArray[np.float64]]
Quantity: TypeAlias = Callable[["Design"], Samples]


@dataclass(frozen=True)
class Design:
    """A design of table 2: every value of shape (m, 1), at face value first and then at all corners of its rounding."""

    values: Values  # mm and deg

    def over(self, quantity: Quantity) -> tuple[float, Range]:
        """Return a quantity at face value, and its range over the rounding where the clamp can still be assembled."""
        found = quantity(self)
        return float(found[0]), (float(np.nanmin(found)), float(np.nanmax(found)))

    def at(self, alpha: float) -> Pose:
        """Return the clamp at some alpha, deg."""
        with np.errstate(invalid="ignore"):  # a corner may not reach the lock
            return assembled(self.values, np.full_like(self.values["L1"], pi / 180 * alpha))

    @cached_property
    def face(self) -> "Design":
        """Return the design at face value alone."""
        return Design({variable: values[:1] for variable, values in self.values.items()})

    @cached_property
    def open(self) -> Pose:
        """Return the clamp where it starts to close, shape (m, 1)."""
        with np.errstate(invalid="ignore"):
            return assembled(self.values, pi / 180 * self.values["alpha_max"])

    @cached_property
    def stroke(self) -> Pose:
        """Return the clamp over its stroke, from the lock to where it is open, shape (m, n)."""
        with np.errstate(invalid="ignore"):
            return assembled(self.values, pi / 180 * self.values["alpha_max"] * np.linspace(0, 1, ALPHAS))


def design(name: str) -> Design:
    """Return a design of table 2 with the corners of its rounding."""
    printed = DESIGNS[name]
    ends = product((-1, 1), repeat=len(printed))
    signs = np.array([np.zeros(len(printed)), *ends]).T
    halves = np.array([half_unit(text) for text in printed.values()])
    values = np.array([float(text) for text in printed.values()])
    columns = values[:, None] + halves[:, None] * signs
    return Design({variable: column[:, None] for variable, column in zip(printed, columns, strict=True)})


# --- quantities, each of shape (m,) ----------------------------------------------------------------------------------


def force_ratio(d: Design) -> Samples:
    """Return M_P near the lock, where it is printed."""
    return formulas.force_ratio(d.at(NEAR_LOCK))[:, 0]


def platen_stroke(d: Design) -> Samples:
    """Return S_m, mm."""
    return 1e3 * formulas.platen_stroke(d.open)[:, 0]


def stroke_ratio(d: Design) -> Samples:
    """Return R_S, with the signs of the roots that hold."""
    with np.errstate(invalid="ignore"):  # a corner may not reach the lock
        ratio: Samples = (formulas.platen_stroke(d.open) / formulas.crosshead_stroke(d.open, -1))[:, 0]
    return ratio


def length_sum(d: Design) -> Samples:
    """Return the sum of L1 to L5, mm."""
    return np.asarray(np.sum([d.values[f"L{k}"] for k in range(1, 6)], axis=0)[:, 0])


def third_length(d: Design) -> Samples:
    """Return the L3, mm, that L1, L5 and gamma leave."""
    L1, L5, gamma = d.values["L1"], d.values["L5"], pi / 180 * d.values["gamma"]
    length: Samples = np.sqrt(L1**2 + L5**2 - 2 * L1 * L5 * np.cos(gamma))[:, 0]
    return length


def largest_velocity_ratio(d: Design) -> Samples:
    """Return the largest R_V."""
    return np.asarray(np.nanmax(formulas.velocity_ratio(d.stroke), axis=1))


def velocity_ratio_span(d: Design) -> Samples:
    """Return R_V's peak less its valley between the peak and where the clamp is open."""
    ratio = formulas.velocity_ratio(d.stroke)
    opening = np.arange(ALPHAS) >= np.nanargmax(ratio, axis=1)[:, None]
    return np.asarray(np.nanmax(ratio, axis=1) - np.nanmin(np.where(opening, ratio, np.nan), axis=1))


def first_velocity_ratio(d: Design) -> Samples:
    """Return R_V where the clamp starts to close."""
    return formulas.velocity_ratio(d.open)[:, 0]


def largest_phi(d: Design) -> Samples:
    """Return the largest phi, deg: where the clamp locks."""
    return np.asarray(180 / pi * np.nanmax(d.stroke.phi, axis=1))


def first_phi(d: Design) -> Samples:
    """Return phi, deg, where the clamp starts to close."""
    return np.asarray(180 / pi * d.open.phi[:, 0])


def platen_acceleration(p: Pose, speed: float, *, printed: bool = False) -> Samples:
    """Return a_m, m/s^2, at a speed of the crosshead, m/s; from the formula as it is printed, or as it should be."""
    w1, w4 = formulas.omega_1(p, speed), formulas.omega_4(p, speed)
    w2, e1 = formulas.omega_2(p, w1), formulas.epsilon_1(p, w1, w4)
    form = formulas.platen_acceleration_printed if printed else formulas.platen_acceleration
    return form(p, w1, w2, e1)


def accelerations(d: Design, *, printed: bool) -> Samples:
    """Return a_m over the stroke at `SPEED`, mm/s^2, at face value, from the lock to where the clamp is open."""
    return np.asarray(1e3 * platen_acceleration(d.face.stroke, SPEED, printed=printed)[0])


def mean_deceleration(d: Design) -> Samples:
    """Return a_m's mean over the time of closing at `SPEED`, mm/s^2: R_V v_o^2 / S_o, as R_V ends at zero."""
    with np.errstate(invalid="ignore"):  # a corner may not reach the lock
        stroke = formulas.crosshead_stroke(d.open, -1)[:, 0]
    return np.asarray(1e3 * SPEED**2 * first_velocity_ratio(d) / stroke)

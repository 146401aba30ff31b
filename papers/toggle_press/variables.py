"""Toggle press: the variables of the printed equations, over turns of the crank that the reference solves.

Yang (2023), doi:10.56578/jisc020103. Angles are those of the paper: theta of the crank P1-P2, theta_1 of O-P3, theta_2
of P2-P3, theta_3 of P3-P4, theta_4 of P2-P4, theta_5 of P4-P5; (x, -y) is P1. Vectors are complex numbers.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from math import tau
from typing import Any

import numpy as np
from numpy import cos, sin
from numpy.typing import ArrayLike

from compare.engines import registry
from compare.engines.state import State, Vectors
from scenes import Motion, Sampling, load
from scenes.drive import Driven, MotionLaw
from scenes.motion import Samples

SOURCE = "toggle press"
SAMPLES = 720  # a turn
SWAY = 0.4  # rad, of the crank that turns unevenly
LENGTHS = (0.077, 0.300, 0.490, 0.490, 0.760, 0.300)  # l0 to l5, m, as printed
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
    """The paper's variables, SI: t, w and a are a bar's angle, rate and acceleration, L its vector; shape (n,)."""

    l0: float
    l1: float
    l2: float
    l3: float
    l4: float
    l5: float
    x: float
    y: float
    L0: Vectors
    L1: Vectors
    L2: Vectors
    L3: Vectors
    L4: Vectors
    L5: Vectors
    t: Samples
    t1: Samples
    t2: Samples
    t3: Samples
    t4: Samples
    t5: Samples
    w: Samples
    w1: Samples
    w2: Samples
    w3: Samples
    w4: Samples
    w5: Samples
    a: Samples
    a1: Samples
    a2: Samples
    a3: Samples
    a4: Samples
    a5: Samples
    S: Samples
    v: Samples
    a_s: Samples

    @property
    def X(self) -> Samples:  # noqa: N802
        """Return l0 cos(theta) + x."""
        return self.l0 * cos(self.t) + self.x

    @property
    def Y(self) -> Samples:  # noqa: N802
        """Return l0 sin(theta) - y."""
        return self.l0 * sin(self.t) - self.y

    @property
    def scale(self) -> Mapping[str, tuple[float, str]]:
        """Return scale and unit of each kind of equation: l1 = 300 mm, the crank's peak rate, and their products."""
        length, w = self.l1, float(np.abs(self.w).max())
        return {
            "length": (length, "m"),
            "area": (length**2, "m²"),
            "angle": (1.0, "rad"),
            "speed": (length * w, "m/s"),
            "acceleration": (length * w**2, "m/s²"),
        }


def bars(state: State) -> list[Vectors]:
    """Return the vectors of the six bars, each of shape (n,), m."""
    return [state.point(end)[0] - state.point(start)[0] for start, end in BARS]


def over_two_turns() -> Variables:
    """Return the variables over a turn at constant speed, and one at a speed that varies: there alpha is not zero."""
    steady = load("toggle_press")
    uneven = Uneven("crank", (0.0, steady.drive.cycle), (0.0, tau), periodic=True)
    sampling = Sampling(SAMPLES)
    motions = [
        registry.reference(scene)(sampling.commanded(scene), sampling.times(scene))
        for scene in (steady, replace(steady, drive=uneven))
    ]
    both = Motion({channel: np.concatenate([m[channel] for m in motions]) for channel in motions[0].samples})
    state = State(steady, both)
    _, rates, accelerations = zip(*map(state.turning, BODIES), strict=True)
    x, y = steady.ground["P1"]
    slider = (both["P5.y"], both["P5.vy"], both["P5.ay"])
    values = (*LENGTHS, x, -y, *bars(state), *map(np.angle, bars(state)), *rates, *accelerations, *slider)
    named: dict[str, Any] = {field.name: value for field, value in zip(fields(Variables), values, strict=True)}
    return Variables(**named)

"""Toggle press: the variables of the printed equations, over turns of the crank that the reference solves.

Yang (2023), doi:10.56578/jisc020103. Bars are numbered as in the paper: 0 the crank P1-P2, 1 the rocker O-P3, 2 to 4
the toggle's sides P2-P3, P3-P4 and P2-P4, 5 the rod P4-P5; (x, -y) is P1. Vectors are complex numbers.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import tau
from typing import Any

import numpy as np
from numpy import cos, sin
from numpy.typing import ArrayLike

from compare.mechanics.motion_vectors import MotionVectors, Vectors
from scenes import Motion, load
from scenes.drive import Driven, MotionLaw
from scenes.model.motion import Samples

from ..reference import solved

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

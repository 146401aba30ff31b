"""Double-toggle clamp: its printed designs, and the variables of the printed formulas, still and over a motion.

From zhycasting.com, Multi-Objective Optimization of Clamping Unit for 4000 kN Die Casting Machine. Its figure is
missing, and the angles are read so that the formulas for R_V, the rates and M_P hold: the rear link A-B stands at
theta + alpha and A-D at gamma more, the front link B-C at -beta, the crosshead's link E-D at -phi. Closing makes w1 and
w4 clockwise, w2 counter-clockwise.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy import pi, sin

from compare.engines.state import State
from scenes import Motion, Scene
from scenes.motion import Samples

SOURCE = "double-toggle clamp"
DESIGNS: Mapping[str, Mapping[str, str]] = {
    "initial": {
        "L1": "352",
        "L2": "457",
        "L3": "120",
        "L4": "120",
        "L5": "305",
        "Hb": "235.5",
        "theta": "4.5",
        "gamma": "19.4",
        "alpha_max": "110",
    },
    "scheme 4": {
        "L1": "368",
        "L2": "430",
        "L3": "134",
        "L4": "135",
        "L5": "280",
        "Hb": "239",
        "theta": "4.0",
        "gamma": "18.0",
        "alpha_max": "105",
    },
}  # table 2, mm and degrees, as printed
SCENES: Mapping[str, str] = {"initial": "double_toggle_clamp", "scheme 4": "double_toggle_clamp_scheme4"}


@dataclass(frozen=True)
class Pose:
    """Lengths, m, and angles, rad, of the clamp at alpha; any shapes that fit each other."""

    L1: Any
    L2: Any
    L4: Any
    L5: Any
    Hb: Any
    theta: Any
    gamma: Any
    alpha: Any
    beta: Any
    phi: Any


@dataclass(frozen=True)
class Moving(Pose):
    """The clamp in motion, SI; every array of shape (n,)."""

    Vo: Samples
    w1: Samples
    w2: Samples
    w4: Samples
    e1: Samples
    vm: Samples
    am: Samples
    Sm: Samples  # the platen's way to the lock
    So: Samples  # the crosshead's
    Po_Pm: Samples  # what a force on the platen adds to the drive's, by that force


def assembled(design: Mapping[str, Any], alpha: Any) -> Pose:
    """Return the clamp at alpha, rad, from a design in mm and degrees whose values may be arrays."""
    L1, L2, L4, L5, Hb = (1e-3 * design[name] for name in ("L1", "L2", "L4", "L5", "Hb"))
    theta, gamma = (pi / 180 * design[name] for name in ("theta", "gamma"))
    beta = np.arcsin((L1 * sin(theta + alpha) - (L1 + L2) * sin(theta)) / L2)
    phi = np.arcsin((Hb - L5 * sin(theta + gamma + alpha)) / L4)
    return Pose(L1, L2, L4, L5, Hb, theta, gamma, alpha, beta, phi)


def moving(scene: Scene, design: Mapping[str, float], loaded: Motion, free: Motion, force: float) -> Moving:
    """Return the clamp in a motion, given also as it is with a force, N, against the platen; without the last sample.

    In the last sample it locks, where M_P is infinite.
    """
    state = State(scene, free)
    place = {point: state.point(point)[0] for point in "ABCDE"}
    theta, gamma = (pi / 180 * design[name] for name in ("theta", "gamma"))
    lengths = (1e-3 * design[name] for name in ("L1", "L2", "L4", "L5", "Hb"))
    x_m, x_o = free["C.x"], free["E.x"]
    values = (
        *(np.full_like(x_m, value) for value in (*lengths, theta, gamma)),
        np.angle(place["B"] - place["A"]) - theta,
        -np.angle(place["C"] - place["B"]),
        -np.angle(place["D"] - place["E"]),
        free["E.vx"],
        -free["rear_link.omega"],
        free["front_link.omega"],
        -free["crosshead_link.omega"],
        -free["rear_link.alpha"],
        free["C.vx"],
        free["C.ax"],
        x_m[-1] - x_m,
        x_o[-1] - x_o,
        (loaded["drive.force"] - free["drive.force"]) / force,
    )
    return Moving(*(value[:-1] for value in values))

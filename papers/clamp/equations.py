"""Double-toggle clamp: the printed formulas as equations on its motion, which has what they need of each other."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from compare.mechanics.motion_vectors import MotionVectors
from scenes import Motion, Scene
from scenes.model.motion import Samples

from ..claims import Equation, Scale
from . import formulas
from .formulas import Design, Pose


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


def moving(scene: Scene, d: Design, loaded: Motion, free: Motion, force: float) -> Moving:
    """The clamp in a motion, given also as it is with a force, N, against the platen; without the last sample."""
    # In the last sample it locks, where M_P is infinite.
    state = MotionVectors(scene, free)
    place = {point: state.point(point)[0] for point in "ABCDE"}
    x_m, x_o = free["C.x"], free["E.x"]
    values = (
        *(np.full_like(x_m, 1e-3 * length) for length in (d.L1, d.L2, d.L4, d.L5, d.Hb)),
        *(np.full_like(x_m, angle) for angle in (d.theta, d.gamma)),
        np.angle(place["B"] - place["A"]) - d.theta,
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


KINDS: Mapping[str, tuple[str, str, int, int]] = {
    "length": ("position", "m", 1, 0),
    "ratio": ("velocity", "", 0, 0),
    "rate": ("velocity", "rad/s", -1, 1),
    "rate²": ("acceleration", "rad/s²", -2, 2),
    "acceleration": ("acceleration", "m/s²", -1, 2),
    "force ratio": ("force", "", 0, 0),
}  # of quantities: the group of the scenes' tolerances, the unit, and the powers of L1 and V_o in the scale
length, ratio, rate, rate_squared, acceleration, force = (partial(Equation[Moving], kind) for kind in KINDS)


def scale(v: Moving) -> Scale:
    """Return scale and unit of each kind of quantity."""
    L, V = float(v.L1.max()), float(v.Vo.max())
    return {kind: (L**of_L * V**of_V, unit) for kind, (_, unit, of_L, of_V) in KINDS.items()}


EQUATIONS = (
    length(
        "eq R_S",
        "S_m / S_o, as below",
        lambda v: v.Sm / v.So * formulas.crosshead_stroke(v, +1) - formulas.platen_stroke(v),
        branches={
            "with − before S_o's pair of roots": lambda v: (
                v.Sm / v.So * formulas.crosshead_stroke(v, -1) - formulas.platen_stroke(v)
            )
        },
        note="judged by R_S S_o = S_m, for every way to the lock",
    ),
    length(
        "eq R_S, S_m",
        "(L₁+L₂) cos θ − L₁ cos(θ+α) − √(L₂² − [L₁ sin(α+θ) − (L₁+L₂) sin θ]²)",
        lambda v: v.Sm - formulas.platen_stroke(v, +1),
        branches={"with + before the root": lambda v: v.Sm - formulas.platen_stroke(v, -1)},
    ),
    length(
        "eq R_S, S_o",
        "L₅[cos(γ+θ) − cos(α+γ+θ)] + √(L₄² − [H_b − L₅ sin(θ+γ)]²) − √(L₄² − [H_b − L₅ sin(θ+γ+α)]²)",
        lambda v: v.So - formulas.crosshead_stroke(v, +1),
        branches={"with −√ + √: the crosshead keeps behind D": lambda v: v.So - formulas.crosshead_stroke(v, -1)},
    ),
    ratio(
        "eq R_V", "L₁ sin(α+θ+β) cos φ / (L₅ sin(α+θ+γ+φ) cos β)", lambda v: v.vm / v.Vo - formulas.velocity_ratio(v)
    ),
    acceleration(
        "eq a_m",
        "L₁ε₁ sin(α+θ+β) − L₁ω₁² cos(α+θ+β) − L₂ω₂² cos β",
        lambda v: v.am - formulas.platen_acceleration(v, v.w1, v.w2, v.e1, printed=True),
        "[L₁ε₁ sin(α+θ+β) − L₁ω₁² cos(α+θ+β) − L₂ω₂²] / cos β",
        lambda v: v.am - formulas.platen_acceleration(v, v.w1, v.w2, v.e1),
    ),
    rate("eq omega_1", "V_o cos φ / (L₅ sin(α+θ+γ+φ))", lambda v: v.w1 - formulas.omega_1(v, v.Vo)),
    rate("eq omega_4", "V_o cos(α+θ+γ) / (L₄ sin(α+θ+γ+φ))", lambda v: v.w4 - formulas.omega_4(v, v.Vo)),
    rate("eq omega_2", "L₁ω₁ cos(α+θ) / (L₂ cos β)", lambda v: v.w2 - formulas.omega_2(v, v.w1)),
    rate_squared(
        "eq epsilon_1",
        "[L₅ω₁² cos(α+θ+γ+φ) − L₄ω₄²] / (L₅ sin(α+θ+γ+φ))",
        lambda v: v.e1 - formulas.epsilon_1(v, v.w1, v.w4),
        note="at constant V_o",
    ),
    force(
        "eq M_P",
        "L₅ sin(α+θ+γ+φ) cos β / (L₁ sin(α+θ+β) cos φ)",
        lambda v: v.Po_Pm - 1 / formulas.force_ratio(v),
        note="judged by 1/M_P, which is finite in the lock too",
    ),
)

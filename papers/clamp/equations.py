"""Double-toggle clamp: the printed formulas as equations on its motion, which has what they need of each other."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from compare.mechanics.motion_vectors import MotionVectors
from scenes import Motion, Scene

from ..claims import Scale
from ..written import Equation, Symbols
from .formulas import Design


def moving(scene: Scene, d: Design, loaded: Motion, free: Motion, force: float) -> Symbols:
    """The source's symbols, SI, in a motion, given also as it is with a force, N, against the platen; shape (n,).

    S_m and S_o are the ways to the lock, P_o what P_m adds to the drive's force.
    """
    # The source counts beta and phi clockwise, and rates positive while the clamp closes. Signs are turned to its
    # convention here alone, so that the formulas stay as printed.
    state = MotionVectors(scene, free)
    A, B, C, D, E = (state.point(point)[0] for point in "ABCDE")
    x_m, x_o = free["C.x"], free["E.x"]
    symbols = {f"L{index}": 1e-3 * length for index, length in zip("₁₂₄₅", (d.L1, d.L2, d.L4, d.L5), strict=True)}
    symbols |= {"H_b": 1e-3 * d.Hb, "θ": d.theta, "γ": d.gamma}
    symbols |= {"α": np.angle(B - A) - d.theta, "β": -np.angle(C - B), "φ": -np.angle(D - E)}
    symbols |= {"ω₁": -free["rear_link.omega"], "ω₂": free["front_link.omega"], "ω₄": -free["crosshead_link.omega"]}
    symbols |= {"ε₁": -free["rear_link.alpha"], "v_m": free["C.vx"], "a_m": free["C.ax"], "V_o": free["E.vx"]}
    symbols |= {"S_m": x_m[-1] - x_m, "S_o": x_o[-1] - x_o}
    symbols |= {"P_m": force, "P_o": loaded["drive.force"] - free["drive.force"]}
    # In the last sample it locks, where M_P is infinite.
    return {symbol: np.broadcast_to(value, x_m.shape)[:-1] for symbol, value in symbols.items()}


KINDS: Mapping[str, tuple[str, str, int, int]] = {
    "length": ("position", "m", 1, 0),
    "ratio": ("velocity", "", 0, 0),
    "rate": ("velocity", "rad/s", -1, 1),
    "rate²": ("acceleration", "rad/s²", -2, 2),
    "acceleration": ("acceleration", "m/s²", -1, 2),
    "force ratio": ("force", "", 0, 0),
}  # of quantities: the group of the scenes' tolerances, the unit, and the powers of L1 and V_o in the scale


def scale(v: Symbols) -> Scale:
    """Return scale and unit of each kind of quantity."""
    # By dimension: a quantity of L^a V^b is relative to that power of the rear link and of the crosshead's largest
    # speed.
    L, V = float(v["L₁"].max()), float(v["V_o"].max())
    return {kind: (L**of_L * V**of_V, unit) for kind, (_, unit, of_L, of_V) in KINDS.items()}


def formula(kind: str, name: str, left: str, text: str, corrected: str = "", **more: Any) -> Equation:
    """A printed formula as an equation: with `left`, what it gives, on its left side."""
    meant = f"{left} = {corrected}"
    return Equation(kind, f"eq {name}", text, corrected, read=f"{left} = {text}", meant=meant, **more)


S_M = "(L₁+L₂) cos θ − L₁ cos(θ+α) − √(L₂² − [L₁ sin(α+θ) − (L₁+L₂) sin θ]²)"
LOCKED = "√(L₄² − [H_b − L₅ sin(θ+γ)]²)"
S_O = f"L₅[cos(γ+θ) − cos(α+γ+θ)] + {LOCKED} − √(L₄² − [H_b − L₅ sin(θ+γ+α)]²)"
OTHER_ROOTS = (f"+ {LOCKED} −", f"− {LOCKED} +")
M_P = "L₅ sin(α+θ+γ+φ) cos β / (L₁ sin(α+θ+β) cos φ)"

VELOCITY_RATIO = formula("ratio", "R_V", "v_m / V_o", "L₁ sin(α+θ+β) cos φ / (L₅ sin(α+θ+γ+φ) cos β)")
EQUATIONS = (
    Equation(
        "length",
        "eq R_S",
        "S_m / S_o, as below",
        read=f"S_m / S_o ({S_O}) = {S_M}",
        branch=("with − before S_o's pair of roots", *OTHER_ROOTS),
        note="judged by R_S S_o = S_m, for every way to the lock",
    ),
    formula("length", "R_S, S_m", "S_m", S_M, branch=("with + before the root", "− √", "+ √")),
    formula("length", "R_S, S_o", "S_o", S_O, branch=("with −√ + √: the crosshead keeps behind D", *OTHER_ROOTS)),
    VELOCITY_RATIO,
    formula(
        "acceleration",
        "a_m",
        "a_m",
        "L₁ε₁ sin(α+θ+β) − L₁ω₁² cos(α+θ+β) − L₂ω₂² cos β",
        "[L₁ε₁ sin(α+θ+β) − L₁ω₁² cos(α+θ+β) − L₂ω₂²] / cos β",
    ),
    formula("rate", "omega_1", "ω₁", "V_o cos φ / (L₅ sin(α+θ+γ+φ))"),
    formula("rate", "omega_4", "ω₄", "V_o cos(α+θ+γ) / (L₄ sin(α+θ+γ+φ))"),
    formula("rate", "omega_2", "ω₂", "L₁ω₁ cos(α+θ) / (L₂ cos β)"),
    formula("rate²", "epsilon_1", "ε₁", "[L₅ω₁² cos(α+θ+γ+φ) − L₄ω₄²] / (L₅ sin(α+θ+γ+φ))", note="at constant V_o"),
    Equation(
        "force ratio",
        "eq M_P",
        M_P,
        read=f"P_o / P_m = 1 / ({M_P})",
        note="judged by 1/M_P, which is finite in the lock too",
    ),
)

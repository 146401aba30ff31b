"""Toggle press: equations (28) to (32), the kinetostatics, each as it is printed and, beside it, as it should be.

The figure with the directions of the forces is not to hand: each printed force may be the reference's with either sign.
Those signs are taken with which most of the printed equations hold. An equation that holds with signs of its own alone
is inconsistent with the others.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product

import numpy as np
from numpy.typing import NDArray

from compare.engines import registry
from compare.mechanics.bodies import inertia
from compare.mechanics.motion_vectors import MotionVectors
from scenes import Motion, Sampling, Scene, load
from scenes.elements.loads import Force
from scenes.model.motion import Samples

from ..claims import EQUATION_TOL, Claim, Scale, Verdict, judge, largest
from ..written import Difference, Equation, Symbols
from .kinematics import bars

SAMPLES = Sampling(24)  # enough to separate equations that hold from others, for thousands of signs at once
CHANNELS = {"RP": "P1", "RP2": "P2", "RO": "O", "RP3": "P3", "RP4": "P4", "RP5": "P5"}  # forces, and their pins
FORCES = tuple(f"F_{name}{axis}" for name in CHANNELS for axis in "xy")
# By body its first hinge; the printed way from there to its centre of mass; mass and inertia times acceleration.
COMPONENTS = {
    "crank": ("P1", "Ls", "m S̈x", "m S̈y", "J₀α"),
    "rocker": ("O", "Ls₁", "m₁ S̈x₁", "m₁ S̈₁y", "J₁α₁"),
    "toggle": ("P2", "", "m₂ S̈₂x", "m₂ S̈₂y", "J₂α₂"),
    "rod": ("P4", "Ls₄", "m₄ S̈₄x", "m₄ S̈₄y", "J₄α₄"),
    "slider": ("P5", "", "", "m₅α₅", ""),
}
force, moment = (partial(Equation, kind) for kind in ("force", "moment"))

EQUATIONS = (
    force("eq 28", "−F_RPx + F_RP2x = −m S̈x"),
    force("eq 28.2", "F_RPy − F_RP2y = −m S̈y"),
    moment(
        "eq 28.3",
        "−F_RPx Ls − F_RPy Ls cos θ + F_RP2x(L₀ − Ls cos θ) + M_d = −J₀α",
        "−F_RPx Ls sin θ − F_RPy Ls cos θ − F_RP2x(L₀ − Ls) sin θ − F_RP2y(L₀ − Ls) cos θ − M_d = −J₀α",
    ),
    force("eq 29", "−F_ROx + F_RP3x = −m₁ S̈x₁"),
    force("eq 29.2", "F_ROy − F_RP3y = −m₁ S̈₁y"),
    moment(
        "eq 29.3",
        "−F_ROx Ls₁ sin θ₁ − F_ROy Ls₁ cos θ₁ + F_RP3x(L₁ − Ls₁ sin θ₁) + F_RP3y(L₁ − Ls₁ cos θ₁) = −J₁α₁",
        "−F_ROx Ls₁ sin θ₁ − F_ROy Ls₁ cos θ₁ − F_RP3x(L₁ − Ls₁) sin θ₁ − F_RP3y(L₁ − Ls₁) cos θ₁ = −J₁α₁",
    ),
    force("eq 30", "−F_RP2x − F_RP3x + F_RP4x = −m₂ S̈₂x"),
    force("eq 30.2", "F_RP2y − F_RP3y + F_RP4y = −m₂ S̈₂y", "F_RP2y + F_RP3y − F_RP4y = −m₂ S̈₂y"),
    moment(
        "eq 30.3",
        "−F_RP2x Ls₂ sin(θ₂+φ) − F_RP2y Ls₂ cos(θ₂+φ) − F_RP3x Ls₂ sin(θ₃+φ) − F_RP3y Ls₂ sin(θ₃+φ)"
        " + F_RP4x Ls₂ sin(θ₄+φ) − F_RP4y Ls₂ sin(θ₄+φ) = −J₂α₂",
        "y₂F_RP2x + x₂F_RP2y + y₃F_RP3x + x₃F_RP3y − y₄F_RP4x − x₄F_RP4y = −J₂α₂, (xₖ, yₖ) from the mass centre to Pₖ",
        note="Ls₂ and φ are not given; those that fit best are taken",
    ),
    force("eq 31", "−F_RP4x + F_RP5x = −m₄ S̈₄x"),
    force("eq 31.2", "F_RP4y − F_RP5y = −m₄ S̈₄y"),
    moment(
        "eq 31.3",
        "−F_RP4x Ls₄ sin θ₅ − F_RP4y Ls₄ cos θ₅ + F_RP5x(L₄ − Ls₄ sin θ₅) + F_RP5y(L₄ − Ls₄ cos θ₅) = −J₄α₄",
        "−F_RP4x Ls₄ sin θ₅ − F_RP4y Ls₄ cos θ₅ − F_RP5x(L₅ − Ls₄) sin θ₅ − F_RP5y(L₅ − Ls₄) cos θ₅ = −J₄α₄",
    ),
    force(
        "eq 32",
        "−F_RP5x + Q = 0",
        "−F_RP5x + N = 0, N of the slider on its guide",
        note="Q is the resistance, which acts along the guide",
    ),
    force(
        "eq 32.2",
        "−F_RP5x − F = m₅α₅ + m₅g",
        "F_RP5y − Q = −m₅αₛ",
        note="F is taken as Q, α₅ as the slider's; gravity is left out, as the paper states",
    ),
)


def claims() -> Iterator[Claim]:
    """A row for each equation of the kinetostatics."""
    scene = load("toggle_press")
    given = statics(scene, registry.motion(scene, SAMPLES))
    # All 2^13 choices of signs of 12 force components and of Q at once, as an axis of the arrays: shapes are (signs,
    # samples). The choice is made by counting equations, not by least residuals, because one misprint has a residual of
    # order one and would outweigh all else.
    signs = np.array(list(product((1.0, -1.0), repeat=len(FORCES) + 1))).T[:, :, None]  # shape (13, m, 1)
    every = _signed(given, signs)
    scale = scale_of(given)
    residual_of = {e.claim: np.abs(e.printed(every)).max(axis=-1) / scale[e.kind][0] for e in EQUATIONS}
    shared = int(np.argmax(sum(residuals <= EQUATION_TOL for residuals in residual_of.values())))
    chosen = _signed(given, signs[:, shared, :])
    reversed_ = ", ".join(name for name, sign in zip(FORCES, signs[:, shared, 0], strict=False) if sign < 0)
    for each in EQUATIONS:
        row = judge(each, chosen, scale)
        if row.verdict is not Verdict.HOLDS and float(residual_of[each.claim].min()) <= EQUATION_TOL:
            row = replace(row, verdict=Verdict.INCONSISTENT, note="holds alone, with signs that the others contradict")
        if each is EQUATIONS[0]:
            row = replace(row, note=f"signs with which most equations hold: {reversed_} against the reference's")
        yield row
    yield _solved(chosen)


def scale_of(s: Symbols) -> Scale:
    """Scale and unit of each kind of equation: the largest force, and that times l1 = 300 mm."""
    force = max(largest(s[name]) for name in FORCES)
    return {"force": (force, "N"), "moment": (force * s["L₁"], "N m")}


def statics(scene: Scene, motion: Motion) -> Symbols:
    """The symbols of statics, SI, in a motion, with the reference's signs; not Ls₂ and φ, which are not given."""
    state = MotionVectors(scene, motion)
    place = {point: state.point(point)[0] for point in ("O", *(f"P{k}" for k in range(1, 6)))}
    (resistance,) = (load for load in scene.loads if isinstance(load, Force))
    Q = np.full_like(motion["time"], resistance.force[1])
    symbols: Symbols = {name: motion[f"{CHANNELS[name[2:-1]]}.f{name[-1]}"] for name in FORCES}
    # The guide's force is that on the slider to the left, hence of the slider to the right.
    symbols |= {"M_d": motion["drive.torque"], "N": motion["slider.guide_force"], "Q": Q, "F": Q}
    for name, (first, Ls, mx, my, J) in COMPONENTS.items():
        body = scene.bodies[name]
        (com, _, acceleration), mass = state.com(body), body.mass or 0.0
        symbols |= {mx: mass * acceleration.real, my: mass * acceleration.imag}
        symbols |= {Ls: float(np.abs(com - place[first]).mean()), J: inertia(body) * state.turning(name)[2]}
    for bar, index in zip(bars(state), "₀₁₂₃₄₅", strict=True):
        symbols |= {f"θ{index}": np.angle(bar), f"L{index}": float(np.abs(bar).mean())}
    for point, index in zip(("P2", "P3", "P4"), "₂₃₄", strict=True):
        arm = place[point] - state.com(scene.bodies["toggle"])[0]
        symbols |= {f"x{index}": arm.real, f"y{index}": arm.imag}
    weight = (scene.bodies["slider"].mass or 0.0) * 9.81
    return symbols | {"θ": symbols["θ₀"], "m₅αₛ": symbols["m₅α₅"], "m₅g": weight}


# (30.3) is linear in Ls₂ cos φ and Ls₂ sin φ by the addition theorem: its left sides at (Ls₂, φ) = (1, 0) and (1, pi/2)
# are the columns of a least-squares problem over the samples. An equation that no constant (Ls₂, φ) satisfies keeps its
# residual.
def _signed(s: Symbols, signs: NDArray[np.float64]) -> Symbols:
    """With m choices of signs of `FORCES` and of Q, the last, shape (m, n), and the Ls₂ and φ that fit (30.3) best."""
    s = s | {name: sign * s[name] for name, sign in zip((*FORCES, "Q"), signs, strict=True)}
    s["F"] = s["Q"]
    (toggle,) = (e.printed for e in EQUATIONS if e.claim == "eq 30.3")
    forces = [toggle(s | {"Ls₂": 1.0, "φ": phi, "J₂α₂": 0.0}) for phi in (0.0, np.pi / 2)]
    columns = np.stack(forces, axis=-1)
    inertial = np.broadcast_to(-s["J₂α₂"], columns.shape[:-1])[..., None]
    x, y = np.moveaxis((np.linalg.pinv(columns) @ inertial)[..., 0], -1, 0)[..., None]
    return s | {"Ls₂": np.hypot(x, y), "φ": np.arctan2(y, x)}


def _solved(s: Symbols) -> Claim:
    """The row of all equations at once, solved for the forces: how far the torque is off, or the worst force."""
    printed = _unknowns(s, [e.printed for e in EQUATIONS], (*FORCES, "M_d"))
    corrected = _unknowns(s, [e.corrected if e.correction else e.printed for e in EQUATIONS], (*FORCES, "N", "M_d"))
    torque = largest(s["M_d"])
    deviation = largest(printed["M_d"] - s["M_d"]) / torque
    sizes = dict.fromkeys(FORCES, scale_of(s)["force"][0]) | {"M_d": torque}
    worst = max(largest(corrected[name] - s[name]) / size for name, size in sizes.items())
    return Claim(
        "eq 28 to 32, solved",
        "14 equations for 12 pin forces and M_d",
        f"M_d is off by up to {deviation * torque / 1e3:.3g} kN m of {torque / 1e3:.3g}",
        deviation,
        Verdict.HOLDS
        if deviation <= EQUATION_TOL
        else Verdict.MISPRINT
        if worst <= EQUATION_TOL
        else Verdict.NOT_REPRODUCIBLE,
        "as corrected, for 12 pin forces, N and M_d: the reference's reactions",
        worst,
        "as printed by least squares, since the guide's force is missing",
    )


# The equations are affine in forces and torque: the constant part is their residual with all unknowns zero, a column is
# what a unit of one unknown adds. The pseudoinverse solves each sample by least squares, as the printed system, which
# has no guide force, has more equations than unknowns.
def _unknowns(s: Symbols, forms: Sequence[Callable[[Symbols], Difference]], names: Sequence[str]) -> dict[str, Samples]:
    """The unknowns that satisfy linear equations best, each of shape (n,)."""
    still = np.zeros_like(s["Q"])

    def at(name: str) -> NDArray[np.float64]:
        """The equations with one unknown of 1, or none, shape (n, equations)."""
        state = s | {unknown: still + (unknown == name) for unknown in (*FORCES, "N", "M_d")}
        return np.stack([form(state) + still for form in forms], axis=-1)

    none = at("")
    matrix = np.stack([at(name) - none for name in names], axis=-1)
    return dict(zip(names, (np.linalg.pinv(matrix) @ -none[..., None])[..., 0].T, strict=True))

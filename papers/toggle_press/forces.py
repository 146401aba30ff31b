"""Toggle press: equations (28) to (32), the kinetostatics, each as it is printed and, beside it, as it should be.

The signs of the forces are taken with which most of the printed equations hold. An equation that holds with signs of
its own alone is inconsistent with the others.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import TypeAlias

import numpy as np
from numpy import cos, sin
from numpy.typing import NDArray

from scenes import load
from scenes.model.motion import Samples

from ..claims import EXACT, Claim, Difference, Equation, Verdict, judge, largest
from ..reference import solved
from .statics import FORCES, Statics, fitted, lever_moment, signed, statics

SAMPLES = 24  # a turn: enough to separate equations that hold from others, for thousands of signs at once

StaticsForm: TypeAlias = Callable[[Statics], Difference]
force, moment = (partial(Equation[Statics], kind) for kind in ("force", "moment"))


def claims() -> Iterator[Claim]:
    """A row for each equation of the kinetostatics."""
    scene = load("toggle_press")
    given = statics(scene, solved(scene, SAMPLES))
    signs = np.array(list(product((1.0, -1.0), repeat=len(FORCES) + 1))).T[:, :, None]  # shape (13, m, 1)
    every = fitted(signed(given, signs))
    scale = given.scale
    off = {e.claim: np.abs(e.printed(every)).max(axis=-1) / scale[e.kind][0] for e in EQUATIONS}
    shared = int(np.argmax(sum(residuals <= EXACT for residuals in off.values())))
    chosen = fitted(signed(given, signs[:, shared, :]))
    reversed_ = ", ".join(f"F_{name}" for name, sign in zip(FORCES, signs[:, shared, 0], strict=False) if sign < 0)
    for equation in EQUATIONS:
        row = judge(equation, chosen, scale)
        alone = float(off[equation.claim].min())
        if row.verdict is not Verdict.HOLDS and alone <= EXACT:
            row = replace(row, verdict=Verdict.INCONSISTENT, note="holds alone, with signs that the others contradict")
        if equation is EQUATIONS[0]:
            row = replace(row, note=f"signs with which most equations hold: {reversed_} against the reference's")
        yield row
    yield _solved(chosen)


# --- the equations ---------------------------------------------------------------------------------------------------


def _toggle(s: Statics) -> Samples:
    F, (x2, y2), (x3, y3), (x4, y4) = s.F, s.arms["P2"], s.arms["P3"], s.arms["P4"]
    of_rocker_and_crank = y2 * F["RP2x"] + x2 * F["RP2y"] + y3 * F["RP3x"] + x3 * F["RP3y"]
    return np.asarray(of_rocker_and_crank - y4 * F["RP4x"] - x4 * F["RP4y"])


def _first_pin(s: Statics, pin: str, Ls: float, t: Samples) -> Samples:
    """The moment, about a bar's centre of mass, of what it exerts at its first end."""
    return np.asarray(-s.F[f"{pin}x"] * Ls * sin(t) - s.F[f"{pin}y"] * Ls * cos(t))


def _two_pins(s: Statics, first: str, second: str, L: float, Ls: float, t: Samples) -> Samples:
    """The moment of what it exerts at both ends."""
    return _first_pin(s, first, Ls, t) + _first_pin(s, second, L - Ls, t)


def _printed_pins(s: Statics, first: str, second: str, L: float, Ls: float, t: Samples) -> Samples:
    at_second = s.F[f"{second}x"] * (L - Ls * sin(t)) + s.F[f"{second}y"] * (L - Ls * cos(t))
    return _first_pin(s, first, Ls, t) + at_second


EQUATIONS = (
    force("eq 28", "−F_RPx + F_RP2x = −m S̈x", lambda s: -s.F["RPx"] + s.F["RP2x"] + s.mx[0]),
    force("eq 28.2", "F_RPy − F_RP2y = −m S̈y", lambda s: s.F["RPy"] - s.F["RP2y"] + s.my[0]),
    moment(
        "eq 28.3",
        "−F_RPx Ls − F_RPy Ls cos θ + F_RP2x(L₀ − Ls cos θ) + M_d = −J₀α",
        lambda s: (
            -s.F["RPx"] * s.Ls[0]
            - s.F["RPy"] * s.Ls[0] * cos(s.t[0])
            + s.F["RP2x"] * (s.L[0] - s.Ls[0] * cos(s.t[0]))
            + s.Md
            + s.Ja[0]
        ),
        "−F_RPx Ls sin θ − F_RPy Ls cos θ − F_RP2x(L₀ − Ls) sin θ − F_RP2y(L₀ − Ls) cos θ − M_d = −J₀α",
        lambda s: _two_pins(s, "RP", "RP2", s.L[0], s.Ls[0], s.t[0]) - s.Md + s.Ja[0],
    ),
    force("eq 29", "−F_ROx + F_RP3x = −m₁ S̈x₁", lambda s: -s.F["ROx"] + s.F["RP3x"] + s.mx[1]),
    force("eq 29.2", "F_ROy − F_RP3y = −m₁ S̈₁y", lambda s: s.F["ROy"] - s.F["RP3y"] + s.my[1]),
    moment(
        "eq 29.3",
        "−F_ROx Ls₁ sin θ₁ − F_ROy Ls₁ cos θ₁ + F_RP3x(L₁ − Ls₁ sin θ₁) + F_RP3y(L₁ − Ls₁ cos θ₁) = −J₁α₁",
        lambda s: _printed_pins(s, "RO", "RP3", s.L[1], s.Ls[1], s.t[1]) + s.Ja[1],
        "−F_ROx Ls₁ sin θ₁ − F_ROy Ls₁ cos θ₁ − F_RP3x(L₁ − Ls₁) sin θ₁ − F_RP3y(L₁ − Ls₁) cos θ₁ = −J₁α₁",
        lambda s: _two_pins(s, "RO", "RP3", s.L[1], s.Ls[1], s.t[1]) + s.Ja[1],
    ),
    force("eq 30", "−F_RP2x − F_RP3x + F_RP4x = −m₂ S̈₂x", lambda s: -s.F["RP2x"] - s.F["RP3x"] + s.F["RP4x"] + s.mx[2]),
    force(
        "eq 30.2",
        "F_RP2y − F_RP3y + F_RP4y = −m₂ S̈₂y",
        lambda s: s.F["RP2y"] - s.F["RP3y"] + s.F["RP4y"] + s.my[2],
        "F_RP2y + F_RP3y − F_RP4y = −m₂ S̈₂y",
        lambda s: s.F["RP2y"] + s.F["RP3y"] - s.F["RP4y"] + s.my[2],
    ),
    moment(
        "eq 30.3",
        "−F_RP2x Ls₂ sin(θ₂+φ) − F_RP2y Ls₂ cos(θ₂+φ) − F_RP3x Ls₂ sin(θ₃+φ) − F_RP3y Ls₂ sin(θ₃+φ)"
        " + F_RP4x Ls₂ sin(θ₄+φ) − F_RP4y Ls₂ sin(θ₄+φ) = −J₂α₂",
        lambda s: s.lever[0] * lever_moment(s, 0.0) + s.lever[1] * lever_moment(s, np.pi / 2) + s.Ja[2],
        "y₂F_RP2x + x₂F_RP2y + y₃F_RP3x + x₃F_RP3y − y₄F_RP4x − x₄F_RP4y = −J₂α₂, (xₖ, yₖ) from the mass centre to Pₖ",
        lambda s: _toggle(s) + s.Ja[2],
        note="Ls₂ and φ are not given; those that fit best are taken",
    ),
    force("eq 31", "−F_RP4x + F_RP5x = −m₄ S̈₄x", lambda s: -s.F["RP4x"] + s.F["RP5x"] + s.mx[3]),
    force("eq 31.2", "F_RP4y − F_RP5y = −m₄ S̈₄y", lambda s: s.F["RP4y"] - s.F["RP5y"] + s.my[3]),
    moment(
        "eq 31.3",
        "−F_RP4x Ls₄ sin θ₅ − F_RP4y Ls₄ cos θ₅ + F_RP5x(L₄ − Ls₄ sin θ₅) + F_RP5y(L₄ − Ls₄ cos θ₅) = −J₄α₄",
        lambda s: _printed_pins(s, "RP4", "RP5", s.L[4], s.Ls[3], s.t[5]) + s.Ja[3],
        "−F_RP4x Ls₄ sin θ₅ − F_RP4y Ls₄ cos θ₅ − F_RP5x(L₅ − Ls₄) sin θ₅ − F_RP5y(L₅ − Ls₄) cos θ₅ = −J₄α₄",
        lambda s: _two_pins(s, "RP4", "RP5", s.L[5], s.Ls[3], s.t[5]) + s.Ja[3],
    ),
    force(
        "eq 32",
        "−F_RP5x + Q = 0",
        lambda s: -s.F["RP5x"] + s.Q,
        "−F_RP5x + N = 0, N of the slider on its guide",
        lambda s: -s.F["RP5x"] + s.N,
        note="Q is the resistance, which acts along the guide",
    ),
    force(
        "eq 32.2",
        "−F_RP5x − F = m₅α₅ + m₅g",
        lambda s: -s.F["RP5x"] - s.Q - (s.my[4] + s.mg),
        "F_RP5y − Q = −m₅αₛ",
        lambda s: s.F["RP5y"] - s.Q + s.my[4],
        note="F is taken as Q, α₅ as the slider's; gravity is left out, as the paper states",
    ),
)


# --- all together ----------------------------------------------------------------------------------------------------


def _solved(s: Statics) -> Claim:
    """The row of all equations at once, solved for the forces: how far the torque is off, or the worst force."""
    printed = _unknowns(s, [e.printed for e in EQUATIONS], (*FORCES, "Md"))
    corrected = _unknowns(s, [e.corrected or e.printed for e in EQUATIONS], (*FORCES, "N", "Md"))
    torque = largest(s.Md)
    off = largest(printed["Md"] - s.Md) / torque
    worst = max(largest(corrected[name] - s.F[name]) for name in FORCES) / s.scale["force"][0]
    worst = max(worst, largest(corrected["Md"] - s.Md) / torque)
    return Claim(
        "eq 28 to 32, solved",
        "14 equations for 12 pin forces and M_d",
        f"M_d is off by up to {off * torque / 1e3:.3g} kN m of {torque / 1e3:.3g}",
        off,
        Verdict.HOLDS if off <= EXACT else Verdict.MISPRINT if worst <= EXACT else Verdict.NOT_REPRODUCIBLE,
        "as corrected, for 12 pin forces, N and M_d: the reference's reactions",
        worst,
        "as printed by least squares, since the guide's force is missing",
    )


def _unknowns(s: Statics, forms: Sequence[StaticsForm], names: Sequence[str]) -> dict[str, Samples]:
    """The unknowns that satisfy linear equations best, each of shape (n,)."""
    still = np.zeros_like(s.Q)

    def at(name: str) -> NDArray[np.float64]:
        """The equations with one unknown of 1, or none, shape (n, equations)."""
        given = {unknown: still + (unknown == name) for unknown in (*FORCES, "N", "Md")}
        state = replace(s, N=given.pop("N"), Md=given.pop("Md"), F=given)
        return np.stack([form(state) + still for form in forms], axis=-1)

    none = at("")
    matrix = np.stack([at(name) - none for name in names], axis=-1)
    return dict(zip(names, (np.linalg.pinv(matrix) @ -none[..., None])[..., 0].T, strict=True))

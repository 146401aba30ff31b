"""Toggle press: equations (1) to (27), the kinematics, each as it is printed and, beside it, as it should be.

Yang (2023), doi:10.56578/jisc020103. Bars are numbered as in the paper: 0 the crank P1-P2, 1 the rocker O-P3, 2 to 4
the toggle's sides P2-P3, P3-P4 and P2-P4, 5 the rod P4-P5; (x, -y) is P1. Vectors are complex numbers. The variables
are those over turns of the crank that the reference solves: a form, the difference of an equation's two sides, takes
what it needs of other equations from the motion, so that each misprint counts once, where it stands.
"""

from functools import partial
from math import tau
from typing import Any

import numpy as np

from compare.engines import registry
from compare.mechanics.motion_vectors import MotionVectors, Vectors
from scenes import Motion, Sampling, load
from scenes.laws import SegmentedLaw

from ..claims import Scale
from ..written import Equation, Symbols

SAMPLES = Sampling(720)
LENGTHS = (77.0, 300.0, 490.0, 490.0, 760.0, 300.0)  # mm, as printed
BARS = (("P1", "P2"), ("O", "P3"), ("P2", "P3"), ("P3", "P4"), ("P2", "P4"), ("P4", "P5"))
BODIES = ("crank", "rocker", "toggle", "toggle", "toggle", "rod")  # of the bars


def scale_of(v: Symbols) -> Scale:
    """Return scale and unit of each kind of equation: l1 = 300 mm, the crank's peak rate, and their products."""
    length, w = v["l₁"], float(np.abs(v["ω"]).max())
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


def over_two_turns() -> Symbols:
    """The paper's symbols, SI, over a turn at constant speed, and one at a speed that varies: there alpha is not zero.

    Those of the bars have their numbers, but the crank's none; arrays of shape (n,).
    """
    steady = load("toggle_press")
    # At a constant speed alpha is zero, and a misprint in a term with alpha would not show. The second turn has a
    # cycloidal speed, with alpha of both signs.
    uneven = SegmentedLaw(0.0, (tau,), (steady.cycle,), ("cycloidal",), periodic=True)
    motions = [registry.motion(scene, SAMPLES) for scene in (steady, steady.with_law(uneven))]
    both = Motion({channel: np.concatenate([m[channel] for m in motions]) for channel in motions[0].samples})
    state = MotionVectors(steady, both)
    vectors = bars(state)
    _, rates, accelerations = zip(*map(state.turning, BODIES), strict=True)
    lengths, (x, y) = [length / 1e3 for length in LENGTHS], steady.ground["P1"]
    symbols: Symbols = {"x": x, "y": -y, "S": both["P5.y"], "v": both["P5.vy"], "αₛ": both["P5.ay"]}
    by_bar: tuple[Any, ...] = (vectors, lengths, [np.angle(bar) for bar in vectors], rates, accelerations)
    for symbol, of_bars in zip("Llθωα", by_bar, strict=True):
        symbols |= {f"{symbol}{index}": value for index, value in zip(("", *"₁₂₃₄₅"), of_bars, strict=True)}
    return symbols | {"l₀": lengths[0], "L₀": vectors[0]}


length, area, angle, speed, acceleration = (
    partial(Equation, kind) for kind in ("length", "area", "angle", "speed", "acceleration")
)
WITH_MINUS = ("with −√", "+ √", "− √")
AB_1 = "A₁ = 2 l₁(l₀ cos θ + x), B₁ = 2 l₁(l₀ sin θ − y)"
AB_2 = "A₂ = 2 l₂(l₀ cos θ + x), B₂ = 2 l₂(l₀ sin θ − y)"
C_1 = "C₁ = l₂² − l₁² − (l₀ sin θ − y)² − (l₀ cos θ + x)²"
PRINTED_C_2 = "C₂ = l₁² − l₂² − (l₀ sin θ − y)² − (l₀ cos θ + x)²"
C_2 = "C₂ = l₂² − l₁² + (l₀ sin θ − y)² + (l₀ cos θ + x)²"  # as it should be
D_1, F_1 = "D₁ = −2 l₂ l₃ cos θ₂", "F₁ = l₄² − l₃² − (l₂ cos θ₂)² − (l₂ sin θ₂)²"
E_1 = "E₁ = −2 l₂ l₃ sin θ₂"  # as it should be
THETA_3 = "θ₃ = 2 atan((E₁ + √(D₁² + E₁² − F₁²)) / (D₁ − F₁))"

POSITIONS = (
    length("eq 1", "L₀ + L₂ = L₁ + x + y", read="L₀ + L₂ = L₁ − x + iy"),
    length("eq 2", "L₂ + L₃ = L₄"),
    length("eq 3", "L₁ + L₃ + L₅ = S", read="L₁ + L₃ + L₅ = iS"),
    length("eq 4", "l₀ e^iθ + l₂ e^iθ₂ = l₁ e^iθ₁ − x + iy"),
    length("eq 5", "Re: l₀ cos θ + l₂ cos θ₂ = l₁ cos θ₁ − x"),
    length("eq 5.2", "Im: l₀ sin θ = l₁ sin θ₁ + y", "l₀ sin θ + l₂ sin θ₂ = l₁ sin θ₁ + y"),
    length("eq 6", "l₀ cos θ + l₂ cos θ₂ = l₁ cos θ₁ − x"),
    length("eq 6.2", "l₀ sin θ + l₂ sin θ₂ = l₁ sin θ₁ + y"),
    length("eq 7", "l₁ cos θ₁ − l₂ cos θ₂ = l₀ cos θ₁ + x", "l₁ cos θ₁ − l₂ cos θ₂ = l₀ cos θ + x"),
    length("eq 7.2", "l₁ sin θ₁ − l₂ sin θ₂ = l₀ sin θ₁ − y", "l₁ sin θ₁ − l₂ sin θ₂ = l₀ sin θ − y"),
    angle("eq 8", f"θ₁ = 2 atan((B₁ + √(A₁² + B₁² − C₁²)) / (A₁ − C₁)), {AB_1}", given=C_1, branch=WITH_MINUS),
    area(
        "eq 9",
        C_1,
        read=f"A₁ cos θ₁ + B₁ sin θ₁ + C₁ = 0, {AB_1}, {C_1}",
        note="judged by A cos θ + B sin θ + C = 0, of which (8), (10) and (14) are the roots",
    ),
    angle(
        "eq 10",
        f"θ₂ = 2 atan((B₂ + √(A₂² + B₂² − C₂²)) / (A₂ − C₂)), {AB_2}",
        given=C_2,
        branch=WITH_MINUS,
        note="with C₂ as corrected in (11); with the printed one neither sign of the root holds",
    ),
    area(
        "eq 11",
        PRINTED_C_2,
        C_2,
        read=f"A₂ cos θ₂ + B₂ sin θ₂ + C₂ = 0, {PRINTED_C_2}",
        meant=f"A₂ cos θ₂ + B₂ sin θ₂ + C₂ = 0, {C_2}",
        given=AB_2,
        note="or else A₂ and B₂ have the wrong sign",
    ),
    length("eq 12", "l₂ e^iθ₂ + l₃ e^iθ₃ = l₄ e^iθ₄"),
    length("eq 13", "l₂ cos θ₂ + l₃ cos θ₃ = l₄ cos θ₄"),
    length("eq 13.2", "l₂ sin θ₂ + l₃ sin θ₃ = l₄ sin θ₄"),
    angle(
        "eq 14",
        f"{THETA_3}, {D_1}, E₁ = 2 l₄ l₂ sin θ₂",
        f"{E_1}, and −√",
        given=F_1,
        meant=f"{THETA_3.replace('+ √', '− √')}, {D_1}, {E_1}",
        branch=WITH_MINUS,
    ),
    area(
        "eq 15", F_1, read=f"D₁ cos θ₃ + E₁ sin θ₃ + F₁ = 0, {D_1}, {E_1}, {F_1}", note="with E₁ as corrected in (14)"
    ),
    length("eq 16", "l₁ e^iθ₁ + l₃ e^iθ₃ + l₅ e^iθ₅ = iS"),
    length("eq 17", "l₁ cos θ₁ + l₃ cos θ₃ + l₅ cos θ₅ = 0"),
    length("eq 17.2", "l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅ = 0", "l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅ = S"),
    angle("eq 18", "θ₅ = arccos((−l₁ cos θ₁ − l₃ cos θ₃) / l₅)", branch=("with −arccos", "= arccos", "= −arccos")),
    length("eq 19", "S = l₁ sin θ₁ + l₃ sin θ₃ + l₅ sin θ₅"),
)

RATES = (
    speed("eq 20", "−l₀ω sin θ − l₂ω₂ sin θ₂ = −l₁ω₁ sin θ₁"),
    speed("eq 20.2", "l₀ω cos θ − l₂ω₂ cos θ₂ = l₁ω₁ cos θ₁", "l₀ω cos θ + l₂ω₂ cos θ₂ = l₁ω₁ cos θ₁"),
    speed("eq 21", "−l₂ω₂ sin θ₂ − l₃ω₃ sin θ₃ = −l₄ω₄ sin θ₄"),
    speed("eq 21.2", "l₂ω₂ cos θ₂ + l₃ω₃ cos θ₃ = l₄ω₄ cos θ₄"),
    speed("eq 22", "−l₁ω₁ sin θ₁ − l₃ω₃ sin θ₃ − l₅ω₅ sin θ₅ = 0"),
    speed("eq 22.2", "l₁ω₁ cos θ₁ + l₃ω₃ cos θ₃ + l₅ω₅ cos θ₅ = v"),
    speed("eq 23", "v = l₁ω₁ cos θ₁ + l₃ω₃ cos θ₃ + l₅ω₅ cos θ₅"),
    acceleration("eq 24", "l₀α sin θ + l₀ω² cos θ + l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ = l₁α₁ sin θ₁ + l₁ω₁² cos θ₁"),
    acceleration(
        "eq 24.2",
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ + l₁ω₁² sin θ₁",
        "l₀α cos θ − l₀ω² sin θ + l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁",
    ),
    acceleration("eq 25", "l₂α₂ sin θ₂ + l₂ω₂² cos θ₂ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ = l₄α₄ sin θ₄ + l₄ω₄² cos θ₄"),
    acceleration("eq 25.2", "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ = l₄α₄ cos θ₄ − l₄ω₄² sin θ₄"),
    acceleration("eq 26", "l₁α₁ sin θ₁ + l₁ω₁² cos θ₁ + l₃α₃ sin θ₃ + l₃ω₃² cos θ₃ + l₅α₅ sin θ₅ + l₅ω₅² cos θ₅ = 0"),
    acceleration(
        "eq 26.2",
        "l₂α₂ cos θ₂ − l₂ω₂² sin θ₂ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
        "l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅ = αₛ",
    ),
    acceleration(
        "eq 27",
        "αₛ = l₁α₁² cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
        "αₛ = l₁α₁ cos θ₁ − l₁ω₁² sin θ₁ + l₃α₃ cos θ₃ − l₃ω₃² sin θ₃ + l₅α₅ cos θ₅ − l₅ω₅² sin θ₅",
    ),
)

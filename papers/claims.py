"""Claims of a printed source, and the verdicts on them, which follow from residuals by the rules here and no others.

| verdict | of an equation | of a number |
|---|---|---|
| holds | the printed form is satisfied | it is computed too, to half a unit of its last digit |
| wrong branch | only with another sign of a root or an inverse function | |
| misprint | only in the corrected form | only in the corrected form or unit |
| underdetermined | | it is among what the missing or rounded input allows |
| inconsistent | it holds alone, but not together with the others | it contradicts other printed numbers by themselves |
| not reproducible | no form that was tried holds | it contradicts the model |
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from math import inf, nan
from typing import Generic, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from scenes.motion import Samples

EXACT = 1e-12  # scaled: the rounding of an equation's few terms, on a motion that is good to some 1e-14

V = TypeVar("V")
Range: TypeAlias = tuple[float, float]
Difference: TypeAlias = Samples | NDArray[np.complex128]  # of an equation's two sides


class Verdict(StrEnum):
    """What became of a claim."""

    HOLDS = "holds"
    MISPRINT = "misprint"
    WRONG_BRANCH = "wrong branch"
    INCONSISTENT = "inconsistent"
    NOT_REPRODUCIBLE = "not reproducible"
    UNDERDETERMINED = "underdetermined"


@dataclass(frozen=True)
class Claim:
    """One row of the audit. Residuals are relative; None where there is nothing to subtract."""

    source: str
    claim: str
    printed: str
    computed: str | float
    residual: float | None
    verdict: Verdict
    corrected: str = ""
    corrected_residual: float | None = None
    note: str = ""


@dataclass(frozen=True)
class Equation(Generic[V]):
    """A printed equation as the difference of its sides, shape (n,), beside its other branches and its correction."""

    claim: str
    kind: str  # of quantity, which gives the scale
    text: str
    printed: Callable[[V], Difference]
    corrected_text: str = ""
    corrected: Callable[[V], Difference] | None = None
    branches: Mapping[str, Callable[[V], Difference]] = field(default_factory=dict)
    note: str = ""


def worst(residual: Difference) -> float:
    """Return the largest magnitude; what is not finite is as wrong as can be."""
    size = np.abs(residual)
    return float(size.max()) if np.isfinite(size).all() else inf


def plain(value: float) -> str:
    """Return a value to three digits, without a power of ten unless it is small."""
    return f"{float(f'{value:.3g}'):.15g}"


def judge(
    source: str,
    equation: Equation[V],
    variables: V,
    scale: Mapping[str, tuple[float, str]],
    tolerance: float = EXACT,
) -> Claim:
    """Return the row of an equation.

    Args:
        source: where it is printed.
        equation: its forms.
        variables: what they take, over the motion.
        scale: and unit of each kind of equation, SI.
        tolerance: the scaled residual up to which a form holds.
    """
    size, unit = scale[equation.kind]
    with np.errstate(invalid="ignore", divide="ignore"):  # a misprint may leave a root's domain, and is told by it
        printed = worst(equation.printed(variables)) / size
        branches = {name: worst(form(variables)) / size for name, form in equation.branches.items()}
        corrected = worst(equation.corrected(variables)) / size if equation.corrected is not None else None
    text = equation.corrected_text
    name, best = min(branches.items(), key=lambda branch: branch[1], default=("", inf))
    if printed <= tolerance:
        verdict, text, corrected = Verdict.HOLDS, "", None
    elif best <= tolerance:
        verdict, text, corrected = Verdict.WRONG_BRANCH, name, best
    elif corrected is not None and corrected <= tolerance:
        verdict = Verdict.MISPRINT
    else:
        verdict = Verdict.NOT_REPRODUCIBLE
    computed = (
        "both sides agree"
        if printed <= tolerance
        else f"the sides differ by up to {plain(printed * size)} {unit}".rstrip()
    )
    if not np.isfinite(printed):
        computed = "has no real value over the whole turn"
    return Claim(source, equation.claim, equation.text, computed, printed, verdict, text, corrected, equation.note)


def half_unit(printed: str) -> float:
    """Return half a unit of the last digit of a printed number."""
    decimals = len(printed.partition(".")[2])
    return float(0.5 * 10.0**-decimals)


def number(
    source: str,
    claim: str,
    printed: str,
    computed: float,
    *,
    allowed: Sequence[Range] = (),
    among_printed: bool = False,
    corrected: tuple[str, float] = ("", nan),
    scale: float | None = None,
    note: str = "",
) -> Claim:
    """Return the row of a printed number.

    Args:
        source: where it is printed.
        claim: what it is, with its unit.
        printed: with the digits that are printed.
        computed: from the inputs at face value.
        allowed: the ranges of it over inputs that are missing, or rounded.
        among_printed: whether what it is computed from are other printed claims, so that they contradict it.
        corrected: how it should be read, and what is computed then.
        scale: of the residual; the printed number itself unless given.
        note: what a reader has to know.
    """
    value, half = float(printed), half_unit(printed) * (1 + 1e-9)
    size = abs(value) if scale is None else scale
    text, right = corrected
    if abs(computed - value) <= half:
        verdict = Verdict.HOLDS
    elif any(low - half <= value <= high + half for low, high in allowed):
        verdict = Verdict.UNDERDETERMINED
    elif among_printed:
        verdict = Verdict.INCONSISTENT
    else:
        verdict = Verdict.MISPRINT if abs(right - value) <= half else Verdict.NOT_REPRODUCIBLE
    if allowed and verdict is not Verdict.HOLDS:
        said = " or ".join(f"{low:.5g} to {high:.5g}" for low, high in allowed)
        note = "; ".join(part for part in (f"possible: {said}", note) if part)
    left = abs(right - value) / size if text else None
    return Claim(source, claim, printed, computed, abs(computed - value) / size, verdict, text, left, note)


def limit(
    source: str,
    claim: str,
    printed: str,
    excess: float | None,
    allowed: Range,
    *,
    scale: float,
    computed: str | float,
    corrected: tuple[str, float] = ("", inf),
    note: str = "",
) -> Claim:
    """Return the row of a printed inequality that a printed design should satisfy.

    Args:
        source: where it is printed.
        claim: what it is about.
        printed: the inequality.
        excess: by how much it is violated at face value; None where an input is missing.
        allowed: the range of the excess over inputs that are missing, or rounded.
        scale: of the excess.
        computed: the value at face value.
        corrected: how the inequality should be read, and the excess then.
        note: what a reader has to know.
    """
    low, high = allowed
    if (high if excess is None else excess) <= 0:
        verdict = Verdict.HOLDS
    elif low <= 0:
        verdict = Verdict.UNDERDETERMINED
    else:
        verdict = Verdict.MISPRINT if corrected[1] <= 0 else Verdict.INCONSISTENT
    residual = None if excess is None else max(excess, 0.0) / scale
    left = max(corrected[1], 0.0) / scale if corrected[0] else None
    return Claim(source, claim, printed, computed, residual, verdict, corrected[0], left, note)


def comparison(source: str, claim: str, printed: str, true: Iterable[bool], computed: str, note: str = "") -> Claim:
    """Return the row of a claim in words, true or not for each reading that the source leaves open."""
    answers = set(true)
    verdict = Verdict.HOLDS if answers == {True} else Verdict.UNDERDETERMINED
    if answers == {False}:
        verdict = Verdict.NOT_REPRODUCIBLE
    return Claim(source, claim, printed, computed, None, verdict, note=note)


def unstated(source: str, claim: str, printed: str, computed: str) -> Claim:
    """Return the row of a claim that gives nothing to check: it is left open whatever is computed."""
    return Claim(source, claim, printed, computed, None, Verdict.UNDERDETERMINED)


def bound(source: str, claim: str, printed: str, computed: str, share: float, corrected: tuple[str, float]) -> Claim:
    """Return the row of a printed quantity that cannot be above a bound.

    Args:
        source: where it is printed.
        claim: what it is.
        printed: the quantity.
        computed: the bound, in words.
        share: the quantity over the bound.
        corrected: how it should be read, and its share of the bound then.
    """
    text, right = corrected
    over, left = max(share - 1, 0.0), max(right - 1, 0.0)
    if over == 0:
        return Claim(source, claim, printed, computed, over, Verdict.HOLDS)
    verdict = Verdict.MISPRINT if left == 0 else Verdict.NOT_REPRODUCIBLE
    return Claim(source, claim, printed, computed, over, verdict, text, left)

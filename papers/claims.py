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

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from math import inf, nan
from typing import TypeAlias

import numpy as np

from .written import Difference, Equation, Symbols

EQUATION_TOL = 1e-12  # scaled: the rounding of an equation's few terms, on a motion that is good to some 1e-14
UNDECIDED = (True, False)  # a claim in words that gives nothing to check

Range: TypeAlias = tuple[float, float]
Scale: TypeAlias = Mapping[str, tuple[float, str]]  # and unit, SI, by kind of quantity


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

    claim: str
    printed: str
    computed: str | float
    residual: float | None
    verdict: Verdict
    corrected: str = ""
    corrected_residual: float | None = None
    note: str = ""


def judge(equation: Equation, variables: Symbols, scale: Scale, tolerance: float = EQUATION_TOL) -> Claim:
    """The row of an equation over a motion; a form holds to the tolerance."""
    size, unit = scale[equation.kind]
    with np.errstate(invalid="ignore", divide="ignore"):  # a misprint may leave a root's domain, which is then its row
        printed = largest(equation.printed(variables)) / size
        branched = largest(equation.branched(variables)) / size
        corrected = largest(equation.corrected(variables)) / size if equation.correction else None
    text = equation.correction
    apart = float(f"{printed * size:.3g}")  # of which 15 digits show no power of ten unless it is small
    computed = f"the sides differ by up to {apart:.15g} {unit}".rstrip()
    # Forms are tried in the order of their distance from print: the printed one, another sign of a root, the
    # correction. A correction is reported only where no choice of branch makes the printed form hold.
    if printed <= tolerance:
        verdict, text, corrected, computed = Verdict.HOLDS, "", None, "both sides agree"
    elif branched <= tolerance:
        verdict, text, corrected = Verdict.WRONG_BRANCH, equation.branch[0], branched
    elif corrected is not None and corrected <= tolerance:
        verdict = Verdict.MISPRINT
    else:
        verdict = Verdict.NOT_REPRODUCIBLE
    if not np.isfinite(printed):
        computed = "has no real value over the whole turn"
    return Claim(equation.claim, equation.text, computed, printed, verdict, text, corrected, equation.note)


def number(
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
    """The row of a printed number, with its digits, and of what is computed from the inputs at face value.

    `allowed` are the ranges of it over inputs that are missing, or rounded; with `among_printed` those inputs are other
    printed claims, which contradict it; `corrected` is how it should be read, and what is computed then; the residual's
    `scale` is the printed number itself unless given.
    """
    # A number rounds to what is printed if it is within half a unit of the last digit. The factor keeps a value that
    # lies exactly on that end, 0.125 for "0.12" or "0.13", inside despite its binary rounding.
    value, half = float(printed), half_unit(printed) * (1 + 1e-9)
    size = abs(value) if scale is None else scale
    text, right = corrected
    # From the mildest verdict to the severest. A missing input comes before a contradiction: where some admissible
    # input gives the printed number, nothing is proven against it.
    if abs(computed - value) <= half:
        verdict = Verdict.HOLDS
    elif any(low - half <= value <= high + half for low, high in allowed):
        verdict = Verdict.UNDERDETERMINED
    elif among_printed:
        verdict = Verdict.INCONSISTENT
    else:
        verdict = Verdict.MISPRINT if abs(right - value) <= half else Verdict.NOT_REPRODUCIBLE
    if allowed and verdict is not Verdict.HOLDS:
        ranges = " or ".join(f"{low:.5g} to {high:.5g}" for low, high in allowed)
        note = joined(f"possible: {ranges}", note)
    left = abs(right - value) / size if text else None
    return Claim(claim, printed, computed, abs(computed - value) / size, verdict, text, left, note)


def limit(
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
    """The row of a printed inequality that printed values should satisfy.

    `excess` is by how much it is violated at face value, None where an input is missing, and `allowed` its range over
    inputs that are missing, or rounded; `computed` the value at face value; `corrected` how the inequality should be
    read, and the excess then.
    """
    # The inequality holds where the excess is not positive. With a missing input only the whole range decides: it holds
    # if even the largest excess is not positive, and it is open if the least one is not.
    low, high = allowed
    if (high if excess is None else excess) <= 0:
        verdict = Verdict.HOLDS
    elif low <= 0:
        verdict = Verdict.UNDERDETERMINED
    else:
        verdict = Verdict.MISPRINT if corrected[1] <= 0 else Verdict.INCONSISTENT
    residual = None if excess is None else max(excess, 0.0) / scale
    left = max(corrected[1], 0.0) / scale if corrected[0] else None
    return Claim(claim, printed, computed, residual, verdict, corrected[0], left, note)


def comparison(claim: str, printed: str, true: Iterable[bool], computed: str, note: str = "") -> Claim:
    """The row of a claim in words, true or not for each reading that the source leaves open."""
    answers = set(true)
    answer = Verdict.HOLDS if True in answers else Verdict.NOT_REPRODUCIBLE
    verdict = answer if len(answers) == 1 else Verdict.UNDERDETERMINED
    return Claim(claim, printed, computed, None, verdict, note=note)


def largest(residual: Difference) -> float:
    """The largest magnitude; infinity where a value is not finite."""
    size = np.abs(residual)
    return float(size.max()) if np.isfinite(size).all() else inf


def half_unit(printed: str) -> float:
    """Return half a unit of the last digit of a printed number."""
    return float(0.5 * 10.0 ** -len(printed.partition(".")[2]))


def span(values: Iterable[float]) -> Range:
    """The least and the largest of some values."""
    known = list(values)
    return min(known), max(known)


def joined(*notes: str) -> str:
    """Return those notes that are not empty as one."""
    return "; ".join(filter(None, notes))

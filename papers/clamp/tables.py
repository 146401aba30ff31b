"""Double-toggle clamp: its two tables, what the rounding of table 2 does to table 1, and what was measured."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import sqrt
from typing import TypeAlias

import numpy as np
from scipy.optimize import minimize

from scenes.model.motion import Samples

from ..claims import UNDECIDED, Claim, Range, comparison, half_unit, joined, number
from . import formulas
from .formulas import DEGREE, MEASURES, PUBLISHED, UNITS, Array, Design, assembles, closed
from .printed import MEASURED, TABLE_1, TABLE_2

Measured: TypeAlias = Callable[[Design], Array]
Spans: TypeAlias = Mapping[str, Mapping[str, float]]  # by reading, then by design, and `change`

NEAR_LOCK = 2.5  # deg, where M_P is printed
SPEED = 100.0  # mm/s, of the crosshead, which is not given
SPEEDS = (50.0, 200.0)  # mm/s, that are plausible
ALPHAS = 1001  # over the stroke
COUNT = 2**8  # corners of the eight values of table 2 that take part in the motion

QUANTITIES: Mapping[str, tuple[Measured, str]] = {
    "M_P": (MEASURES["M_P"].of, f"at α = {NEAR_LOCK}°"),
    "R_S": (MEASURES["R_S"].of, "with the signs of S_o's roots that hold"),
    "L_sum": (MEASURES["L_sum"].of, "mm"),
    "R_V max": (MEASURES["R_V max"].of, ""),
    "R_V peak-valley": (MEASURES["R_V peak-valley"].of, "read as the peak less the valley before it"),
    "R_V startup": (MEASURES["R_V start"].of, "read as R_V where the clamp starts to close"),
}
PEAK_VALLEY: Mapping[str, Callable[[Samples], float]] = {
    "over the stroke": lambda a: float(np.ptp(a)),
    "from the peak to the valley after it": lambda a: float(a.max() - a[: a.argmax()].min()),
}
UNLIKE: Mapping[str, Callable[[Samples], float]] = {
    "its largest magnitude": lambda a: float(np.abs(a).max()),
    "its peak": lambda a: float(a.max()),
    "its peak less its mean": lambda a: float(a.max() - a.mean()),
}  # what peak-valley might mean instead


@dataclass(frozen=True)
class Corners:
    """A design of table 2 at face value, and at those corners of its rounding at which it can lock."""

    designs: Design  # values of shape (m,), the face value first
    locking: int  # of the `COUNT` corners

    def over(self, quantity: Measured) -> tuple[float, Range]:
        """A quantity at face value, and its range over the rounding."""
        values = quantity(self.designs)
        return float(values[0]), (float(values.min()), float(values.max()))


def values_and_halves(name: str) -> tuple[Array, Array]:
    """The values of a design of table 2, mm and deg, and half a unit of the last digit of each."""
    texts = TABLE_2[name].values()
    return np.array([float(text) for text in texts]), np.array([half_unit(text) for text in texts])


def corners(name: str) -> Corners:
    """A design of table 2 with the corners of its rounding."""
    values, halves = values_and_halves(name)
    signs = np.array([np.zeros(len(values)), *product((-1, 1), repeat=len(values))])
    d = Design(*(UNITS * (values + halves * signs)).T)
    locks = assembles(d)
    # L3 takes no part in the motion: every corner of the others stands here twice.
    return Corners(Design(*(values[locks] for values in d)), int(locks[1:].sum()) // 2)


def table_1(known: Mapping[str, Corners]) -> Iterator[Claim]:
    """A row for each entry of table 1."""
    for name, design in known.items():
        for row, (quantity, reading) in QUANTITIES.items():
            face, allowed = design.over(quantity)
            note = joined(reading, _about_force_ratio(name) if row == "M_P" else "")
            yield number(f"table 1 {row}, {name}", TABLE_1[row][name], face, allowed=[allowed], note=note)
    for name in known:
        yield _together(name)
    yield from _accelerations(known)
    for row, printed in TABLE_1.items():
        change = 100 * (float(printed["scheme 4"]) / float(printed["initial"]) - 1)
        note = "from the two printed values, %"
        if row in QUANTITIES:
            before, after = (design.over(QUANTITIES[row][0])[0] for design in known.values())
            note += f"; {100 * (after / before - 1):+.1f} from the computed ones"
        yield number(f"table 1 change of {row}", printed["change"], change, among_printed=True, scale=100, note=note)


def _together(name: str) -> Claim:
    """The row on whether one clamp within the rounding of table 2 has all that table 1 prints, but for a_m."""
    wanted = [(quantity, TABLE_1[row][name]) for row, (quantity, _) in QUANTITIES.items()]
    clamp = one_for_all(name, wanted)
    values = ", ".join(f"{variable} {value:.7g}" for variable, value in (clamp or {}).items())
    return comparison(
        f"table 1 but for a_m with table 2, {name}",
        "all of one clamp",
        [clamp is not None],
        f"one that rounds to table 2 has it all: {values}" if clamp else "no clamp that rounds to table 2 was found",
    )


def one_for_all(name: str, wanted: Sequence[tuple[Measured, str]]) -> dict[str, float] | None:
    """A clamp within the rounding of table 2, L3 included, that has all wanted numbers to their last digits.

    Of its values and its numbers the one that is off most, in half units, is off least. None where that search leads
    nowhere, which proves nothing.
    """
    centre, halves = values_and_halves(name)
    target, units = (np.array([number_of(text) for _, text in wanted]) for number_of in (float, half_unit))
    n = len(centre)

    def clamp(x: Array) -> Design:
        """Return the clamp with other values by x, in half units, but with the L3 that closes it."""
        return closed(Design(*(UNITS * (centre + halves * x[:n]))))

    def room(x: Array) -> Array:
        """Return by how much all stay within the most, the last of x, above and below, in half units."""
        d = clamp(x)
        numbers = np.array([quantity(d) for quantity, _ in wanted])
        deviation = np.concatenate([(d / UNITS - centre) / halves, (numbers - target) / units])
        return np.concatenate([x[n] - deviation, x[n] + deviation])

    start, bounds = np.append(np.zeros(n), 1.0), {"type": "ineq", "fun": room}
    end = minimize(lambda x: x[n], start, constraints=bounds, method="SLSQP")
    if not (end.success and end.x[n] <= 1):
        return None
    return dict(zip(Design._fields, (clamp(end.x) / UNITS).tolist(), strict=True))


def _about_force_ratio(name: str) -> str:
    """How much half a unit of table 2 changes M_P, by the three values that weigh most, and where it is as printed."""
    values, halves = values_and_halves(name)
    ratio, *more = MEASURES["M_P"].of(Design(*(UNITS * np.vstack([values, values + np.diag(halves)])).T))
    changes = sorted(zip(Design._fields, np.divide(more, ratio) - 1, strict=True), key=lambda change: -abs(change[1]))
    moved = ", ".join(f"{variable} by {100 * change:+.1f} %" for variable, change in changes[:3])
    alphas = np.linspace(1, 5, 4001)  # deg
    there = np.interp(
        1 / float(TABLE_1["M_P"][name]), formulas.velocity_ratio(formulas.at(PUBLISHED[name], DEGREE * alphas)), alphas
    )
    return f"half a unit of a value in table 2 moves it: {moved}; the printed M_P is that at α = {there:.3f}°"


def _accelerations(known: Mapping[str, Corners]) -> Iterator[Claim]:
    """The rows on a_m's peak-valley, which goes with the square of a speed that is not given."""
    # One speed has to give both values, and their ratio does not depend on it: the peak-valley that fits this best is
    # taken.
    printed = {name: TABLE_1["a_m peak-valley"][name] for name in known}
    initial, scheme_4 = map(float, printed.values())
    spans = _spans(PEAK_VALLEY)
    best = min(spans, key=lambda text: abs(spans[text]["change"] - 100 * (scheme_4 / initial - 1)))
    fits = {name: SPEED * sqrt(float(text) / spans[best][name]) for name, text in printed.items()}
    for name, text in printed.items():
        span = spans[best][name]
        slow, fast = (span * (speed / SPEED) ** 2 for speed in SPEEDS)
        yield number(
            f"table 1 a_m peak-valley, {name}",
            text,
            span,
            allowed=[(slow, fast)],
            note=f"mm/s², at an assumed V_o of {SPEED:g} mm/s; {fits[name]:.1f} mm/s would fit; a_m {best}",
        )
    apart = 100 * (fits["scheme 4"] / fits["initial"] - 1)
    yield number(
        "table 1 change of a_m peak-valley, at the same V_o",
        TABLE_1["a_m peak-valley"]["change"],
        spans[best]["change"],
        scale=100,
        note=f"%; {_listed(spans)}; a V_o for scheme 4 that is {apart:.1f} % higher would fit. Unlike a peak-valley:"
        f" {_listed(_spans(UNLIKE))}; {_of_the_mean(known, initial)}",
    )


def _spans(readings: Mapping[str, Callable[[Samples], float]]) -> Spans:
    """What each reading gives for each design at face value, mm/s^2, and how far scheme 4 is above the initial, %."""
    strokes = {name: formulas.at(d, d.alpha_max * np.linspace(0, 1, ALPHAS)) for name, d in PUBLISHED.items()}
    values = {
        f"{form}, {text}": {
            name: by_design(formulas.acceleration(p, SPEED, printed=as_is)) for name, p in strokes.items()
        }
        for form, as_is in (("as corrected", False), ("as printed", True))
        for text, by_design in readings.items()
    }
    return {
        text: by_design | {"change": 100 * (by_design["scheme 4"] / by_design["initial"] - 1)}
        for text, by_design in values.items()
    }


def _listed(spans: Spans) -> str:
    return ", ".join(f"{span['change']:+.1f} {text}" for text, span in spans.items())


def _of_the_mean(known: Mapping[str, Corners], printed: float) -> str:
    """How the mean deceleration changes, which comes nearest of all, in words: R_V v_o^2 / S_o at the start."""
    (face, (low, high)), (changed, (least, most)) = (
        d.over(lambda c: SPEED**2 * MEASURES["R_V start"].of(c) / formulas.crosshead_stroke(formulas.opened(c)))
        for d in known.values()
    )
    ends = " to ".join(f"{100 * (end - 1):+.1f}" for end in (least / high, most / low))
    fits = SPEED * sqrt(printed / face)
    return f"{100 * (changed / face - 1):+.1f} the mean deceleration ({ends} within rounding; at {fits:.0f} mm/s)"


def table_2(known: Mapping[str, Corners]) -> Iterator[Claim]:
    """The rows of what table 2 prints twice, L3 and the ratio of L1 and L2; and whether its values can lock."""
    for name, design in known.items():
        face, allowed = design.over(formulas.third_length)
        yield number(f"table 2 L3, {name}", TABLE_2[name]["L3"], face, allowed=[allowed], note="mm, from L₁, L₅ and γ")
    L1, L2 = (float(TABLE_2["scheme 4"][length]) for length in ("L1", "L2"))
    yield number("table 2 L1/L2, scheme 4", "0.856", L1 / L2, among_printed=True)
    for name, design in known.items():
        yield comparison(
            f"table 2 with its rounding, {name}",
            "a clamp that locks",
            [True, design.locking == COUNT],
            f"{design.locking} of {COUNT} corners of the rounding can lock",
            "the others cannot where L₄ is shorter than H_b − L₅ sin(θ+γ); no range here is over such corners",
        )


def measured(design: Corners) -> Iterator[Claim]:
    """What the source measured on scheme 4 beside ours."""
    for row, printed in MEASURED.items():
        face, allowed = design.over(QUANTITIES[row][0])
        from_ours, from_theirs = (
            100 * (float(printed) / value - 1) for value in (face, float(TABLE_1[row]["scheme 4"]))
        )
        note = f"{from_ours:+.1f} % from the computed value, {from_theirs:+.1f} % from the printed prediction"
        yield number(f"measured {row}", printed, face, allowed=[allowed], note=note)
    thrust = 4500 / design.over(QUANTITIES["M_P"][0])[0]
    yield comparison(
        "measured clamping force",
        "4500 kN ± 3.2 %",
        UNDECIDED,
        f"takes a thrust of {thrust:.0f} kN at α = {NEAR_LOCK}°, which is not given",
    )

"""Double-toggle clamp: its two tables, and what was measured."""

from collections.abc import Callable, Iterator, Mapping
from math import sqrt

import numpy as np

from scenes.motion import Samples

from ..claims import Claim, comparison, number, unstated
from . import designs, rounding
from .designs import NEAR_LOCK, SPEED, SPEEDS, Design
from .variables import DESIGNS, SOURCE

TABLE_1: Mapping[str, Mapping[str, str]] = {
    "M_P": {"initial": "20.20", "scheme 4": "23.10", "change": "14.4"},
    "R_S": {"initial": "1.02", "scheme 4": "1.09", "change": "6.9"},
    "L_sum": {"initial": "1354", "scheme 4": "1346", "change": "-0.6"},
    "R_V max": {"initial": "1.63", "scheme 4": "1.80", "change": "10.4"},
    "R_V peak-valley": {"initial": "0.65", "scheme 4": "0.65", "change": "0"},
    "R_V startup": {"initial": "1.16", "scheme 4": "1.17", "change": "0.9"},
    "a_m peak-valley": {"initial": "128.5", "scheme 4": "135.6", "change": "5.5"},
}  # the change in percent
QUANTITIES: Mapping[str, tuple[Callable[[Design], Samples], str]] = {
    "M_P": (designs.force_ratio, f"at α = {NEAR_LOCK}°"),
    "R_S": (designs.stroke_ratio, "with the signs of S_o's roots that hold"),
    "L_sum": (designs.length_sum, "mm"),
    "R_V max": (designs.largest_velocity_ratio, ""),
    "R_V peak-valley": (designs.velocity_ratio_span, "read as the peak less the valley before it"),
    "R_V startup": (designs.first_velocity_ratio, "read as R_V where the clamp starts to close"),
}
FORMS: Mapping[str, bool] = {"as corrected": False, "as printed": True}  # whether a_m is
PEAK_VALLEY: Mapping[str, Callable[[Samples], float]] = {
    "over the stroke": lambda a: float(np.ptp(a)),
    "from the peak to the valley after it": lambda a: float(a.max() - a[: a.argmax()].min()),
}
UNLIKE: Mapping[str, Callable[[Samples], float]] = {
    "its largest magnitude": lambda a: float(np.abs(a).max()),
    "its peak": lambda a: float(a.max()),
    "its peak less its mean": lambda a: float(a.max() - a.mean()),
}  # what peak-valley might mean instead


def table_1(known: Mapping[str, Design]) -> Iterator[Claim]:
    """Yield a row for each entry of table 1."""
    for name, design in known.items():
        for what, (quantity, reading) in QUANTITIES.items():
            face, allowed = design.over(quantity)
            note = "; ".join(filter(None, (reading, _about_force_ratio(name) if what == "M_P" else "")))
            yield number(SOURCE, f"table 1 {what}, {name}", TABLE_1[what][name], face, allowed=[allowed], note=note)
    for name in known:
        yield _together(name)
    yield from _accelerations(known)
    for what, printed in TABLE_1.items():
        change = 100 * (float(printed["scheme 4"]) / float(printed["initial"]) - 1)
        note = "from the two printed values, %"
        if what in QUANTITIES:
            before, after = (design.over(QUANTITIES[what][0])[0] for design in known.values())
            note += f"; {100 * (after / before - 1):+.1f} from the computed ones"
        yield number(
            SOURCE, f"table 1 change of {what}", printed["change"], change, among_printed=True, scale=100, note=note
        )


def _together(name: str) -> Claim:
    """Return the row on whether one clamp within the rounding of table 2 has all that table 1 prints, but for a_m."""
    wanted = [(quantity, TABLE_1[what][name]) for what, (quantity, _) in QUANTITIES.items()]
    found = rounding.one_for_all(name, wanted)
    said = ", ".join(f"{variable} {value:.7g}" for variable, value in (found or {}).items())
    return comparison(
        SOURCE,
        f"table 1 but for a_m with table 2, {name}",
        "all of one clamp",
        [found is not None],
        f"one that rounds to table 2 has it all: {said}" if found else "no clamp that rounds to table 2 was found",
    )


def _about_force_ratio(name: str) -> str:
    changes = list(rounding.sensitivity(name).items())[:3]
    said = ", ".join(f"{variable} by {100 * change:+.1f} %" for variable, change in changes)
    at = rounding.alpha_of(name, float(TABLE_1["M_P"][name]))
    return f"half a unit of a value in table 2 moves it: {said}; the printed M_P is that at α = {at:.3f}°"


def _accelerations(known: Mapping[str, Design]) -> Iterator[Claim]:
    """Yield the rows on a_m's peak-valley, which goes with the square of a speed that is not given.

    One speed has to give both values, and their ratio does not depend on it: the peak-valley that fits this best is
    taken.
    """
    printed = {name: TABLE_1["a_m peak-valley"][name] for name in known}
    initial, scheme_4 = map(float, printed.values())
    spans = _spans(known, PEAK_VALLEY)
    changes = _changes(spans)
    best = min(changes, key=lambda text: abs(changes[text] - 100 * (scheme_4 / initial - 1)))
    fits = {name: 1e3 * SPEED * sqrt(float(text) / spans[best][name]) for name, text in printed.items()}
    for name, text in printed.items():
        span = spans[best][name]
        slow, fast = (span * (speed / SPEED) ** 2 for speed in SPEEDS)
        yield number(
            SOURCE,
            f"table 1 a_m peak-valley, {name}",
            text,
            span,
            allowed=[(slow, fast)],
            note=f"mm/s², at an assumed V_o of {1e3 * SPEED:g} mm/s; {fits[name]:.1f} mm/s would fit; a_m {best}",
        )
    apart = 100 * (fits["scheme 4"] / fits["initial"] - 1)
    yield number(
        SOURCE,
        "table 1 change of a_m peak-valley, at the same V_o",
        TABLE_1["a_m peak-valley"]["change"],
        changes[best],
        scale=100,
        note=f"%; {_said(changes)}; a V_o for scheme 4 that is {apart:.1f} % higher would fit. Unlike a peak-valley:"
        f" {_said(_changes(_spans(known, UNLIKE)))}; {_of_the_mean(known, initial)}",
    )


def _spans(
    known: Mapping[str, Design], readings: Mapping[str, Callable[[Samples], float]]
) -> Mapping[str, Mapping[str, float]]:
    """Return what each reading gives for each design, mm/s^2."""
    return {
        f"{form}, {text}": {name: of(designs.accelerations(design, printed=printed)) for name, design in known.items()}
        for form, printed in FORMS.items()
        for text, of in readings.items()
    }


def _changes(spans: Mapping[str, Mapping[str, float]]) -> Mapping[str, float]:
    """Return by how much, in percent, scheme 4 is above the initial design."""
    return {text: 100 * (span["scheme 4"] / span["initial"] - 1) for text, span in spans.items()}


def _said(changes: Mapping[str, float]) -> str:
    return ", ".join(f"{change:+.1f} {text}" for text, change in changes.items())


def _of_the_mean(known: Mapping[str, Design], printed: float) -> str:
    """Return how the mean deceleration changes, which comes nearest of all, in words."""
    (face, (low, high)), (changed, (least, most)) = (d.over(designs.mean_deceleration) for d in known.values())
    ends = " to ".join(f"{100 * (end - 1):+.1f}" for end in (least / high, most / low))
    fits = 1e3 * SPEED * sqrt(printed / face)
    return f"{100 * (changed / face - 1):+.1f} the mean deceleration ({ends} within rounding; at {fits:.0f} mm/s)"


def table_2(known: Mapping[str, Design]) -> Iterator[Claim]:
    """Yield the rows of what table 2 says twice: L3, and the ratio of L1 and L2."""
    for name, design in known.items():
        face, allowed = design.over(designs.third_length)
        note = "mm, from L₁, L₅ and γ"
        yield number(SOURCE, f"table 2 L3, {name}", DESIGNS[name]["L3"], face, allowed=[allowed], note=note)
    L1, L2 = (float(DESIGNS["scheme 4"][length]) for length in ("L1", "L2"))
    yield number(SOURCE, "table 2 L1/L2, scheme 4", "0.856", L1 / L2, among_printed=True)


def measured(design: Design) -> Iterator[Claim]:
    """Yield what the source measured on scheme 4 beside ours."""
    for what, printed in (("R_S", "1.085"), ("R_V max", "1.77")):
        face, allowed = design.over(QUANTITIES[what][0])
        from_ours, from_theirs = (
            100 * (float(printed) / value - 1) for value in (face, float(TABLE_1[what]["scheme 4"]))
        )
        note = f"{from_ours:+.1f} % from the computed value, {from_theirs:+.1f} % from the printed prediction"
        yield number(SOURCE, f"measured {what}", printed, face, allowed=[allowed], note=note)
    thrust = 4500 / design.over(designs.force_ratio)[0]
    yield unstated(
        SOURCE,
        "measured clamping force",
        "4500 kN ± 3.2 %",
        f"takes a thrust of {thrust:.0f} kN at α = {NEAR_LOCK}°, which is not given",
    )


def simulated(engine: str, off: float, ratio: float, fastest: float) -> Claim:
    """Return what the source simulated beside an engine's run.

    Args:
        engine: which one.
        off: how far the printed R_V is off the engine's, at most.
        ratio: R_S of scheme 4.
        fastest: the largest R_V of its samples.
    """
    return comparison(
        SOURCE,
        f"simulated R_V, as ADAMS, {engine}",
        "within 1.2 %",
        [off <= 0.012],
        f"within {100 * off:.1e} %; scheme 4: R_S {ratio:.5f}, R_V max {fastest:.4f}",
        "of v_o, at default settings; the formula is exact, and 1.2 % are far more than an integration leaves",
    )

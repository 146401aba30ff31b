"""Double-toggle clamp: its two tables, and what was measured."""

from collections.abc import Callable, Iterator, Mapping
from math import sqrt

from scenes.motion import Samples

from . import audit_clamp_designs as designs
from . import audit_clamp_rounding as rounding
from .audit_claims import Claim, comparison, number, unstated
from .audit_clamp_designs import NEAR_LOCK, SPEED, SPEEDS, Design
from .audit_clamp_formulas import DESIGNS, SOURCE

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
READINGS: Mapping[str, Mapping[str, bool]] = {
    "as corrected, over the stroke": {"printed": False, "whole": True},
    "as corrected, between the peak and the valley after it": {"printed": False, "whole": False},
    "as printed, over the stroke": {"printed": True, "whole": True},
}  # of the peak-valley of a_m


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

    One speed has to give both values, and their ratio does not depend on it: the reading that fits this best is taken.
    """
    printed = {name: TABLE_1["a_m peak-valley"][name] for name in known}
    initial, scheme_4 = map(float, printed.values())
    spans = {
        text: {name: designs.acceleration_span(design, **reading) for name, design in known.items()}
        for text, reading in READINGS.items()
    }
    changes = {text: 100 * (span["scheme 4"] / span["initial"] - 1) for text, span in spans.items()}
    best = min(changes, key=lambda text: abs(changes[text] - 100 * (scheme_4 / initial - 1)))
    for name, text in printed.items():
        span = spans[best][name]
        slow, fast = (span * (speed / SPEED) ** 2 for speed in SPEEDS)
        fits = 1e3 * SPEED * sqrt(float(text) / span)
        yield number(
            SOURCE,
            f"table 1 a_m peak-valley, {name}",
            text,
            span,
            allowed=[(slow, fast)],
            note=f"mm/s², at an assumed V_o of {1e3 * SPEED:g} mm/s; {fits:.1f} mm/s would fit; a_m {best}",
        )
    yield number(
        SOURCE,
        "table 1 change of a_m peak-valley, at the same V_o",
        TABLE_1["a_m peak-valley"]["change"],
        changes[best],
        scale=100,
        note="%; " + ", ".join(f"{change:+.1f} {text}" for text, change in changes.items()),
    )


def table_2(known: Mapping[str, Design]) -> Iterator[Claim]:
    """Yield the rows of what table 2 says twice: L3, and the ratio of L1 and L2."""
    for name, design in known.items():
        face, allowed = design.over(designs.third_length)
        note = "mm, from L₁, L₅ and γ"
        yield number(SOURCE, f"table 2 L3, {name}", DESIGNS[name]["L3"], face, allowed=[allowed], note=note)
    L1, L2 = (float(DESIGNS["scheme 4"][length]) for length in ("L1", "L2"))
    yield number(SOURCE, "table 2 L1/L2, scheme 4", "0.856", L1 / L2, among_printed=True)


def measured(design: Design, off_engine: float | None) -> Iterator[Claim]:
    """Yield what the source measured or simulated on scheme 4 beside ours.

    Args:
        design: scheme 4.
        off_engine: how far R_V is off Exudyn's; None where that could not run.
    """
    for what, printed in (("R_S", "1.085"), ("R_V max", "1.77")):
        face, allowed = design.over(QUANTITIES[what][0])
        from_ours, from_theirs = (
            100 * (float(printed) / value - 1) for value in (face, float(TABLE_1[what]["scheme 4"]))
        )
        note = f"{from_ours:+.1f} % from the computed value, {from_theirs:+.1f} % from the printed prediction"
        yield number(SOURCE, f"measured {what}", printed, face, allowed=[allowed], note=note)
    if off_engine is not None:
        yield comparison(
            SOURCE,
            "simulated R_V, as ADAMS",
            "within 1.2 %",
            [off_engine <= 0.012],
            f"Exudyn within {100 * off_engine:.1e} %",
            "of v_o, at default settings; the formula is exact, and 1.2 % are far more than an integration leaves",
        )
    thrust = 4500 / design.over(designs.force_ratio)[0]
    yield unstated(
        SOURCE,
        "measured clamping force",
        "4500 kN ± 3.2 %",
        f"takes a thrust of {thrust:.0f} kN at α = {NEAR_LOCK}°, which is not given",
    )

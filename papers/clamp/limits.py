"""Double-toggle clamp: every printed constraint, on both designs. Pins and crosshead have sizes that are not given."""

from collections.abc import Iterator, Mapping

from ..claims import Claim, limit, number
from . import printed
from .constraints import ALONE, BOTH, LOOSEST, Clearance, opening
from .formulas import DEGREE, MEASURES, at
from .optimisation.search import Problem, search
from .tables import Corners

PINS = (60.0, 140.0)  # mm, plausible diameters of the pins B, D and E
HEIGHTS = (100.0, 500.0)  # mm, plausible heights H_s of the crosshead
SMALLER = Clearance(B=129.0, D=BOTH.D, L3=132.0, L4=135.0)  # mm, of sizes with which M_P can be what is printed
STARTS = 8  # of local searches, all of which end at one M_P


def constraints(name: str, design: Corners) -> Iterator[Claim]:
    """A row for each constraint on a design."""
    x = {variable: float(text) for variable, text in printed.TABLE_2[name].items()}
    excess = max(max(low - x[v], x[v] - high) / high for v, (low, high) in printed.BOUNDS.items())
    ends = [v for v, limits in printed.BOUNDS.items() if x[v] in limits]
    text = ", ".join(f"{low:g} ≤ {v} ≤ {high:g}" for v, (low, high) in printed.BOUNDS.items())
    computed = f"at a bound: {', '.join(ends)}" if ends else "none at a bound"
    yield limit(f"bounds, {name}", text, excess, (excess, excess), scale=1, computed=computed)
    yield from _free_space(name, x)
    yield _stability(name, design)
    yield from _ranges(name, design)


def _free_space(name: str, x: Mapping[str, float]) -> Iterator[Claim]:
    """The constraints that take the sizes of pins and crosshead; the ranges are of what is plausible."""
    (thin, thick), (low, high) = PINS, HEIGHTS
    for link, pin in (("L1", "B"), ("L5", "D")):
        need = x[link] - x["Hb"]
        yield limit(
            f"constraint on {link}, interference, {name}",
            f"{link} + d_{pin} − H_b − H_s/2 ≤ 0",
            None,
            (need + thin - high / 2, need + thick - low / 2),
            scale=x[link],
            computed=f"holds where H_s ≥ {2 * need:g} mm + 2 d_{pin}",
            note=f"d_{pin} and H_s are not given; plausible: {thin:g} to {thick:g} mm, {low:g} to {high:g} mm",
        )
    for link, pins in (("L4", "E"), ("L3", "B")):
        yield limit(
            f"constraint on {link}, clearance, {name}",
            f"{link} ≥ (d_{pins} + d_D)/2",
            None,
            (thin - x[link], thick - x[link]),
            scale=x[link],
            computed=f"holds where d_{pins} + d_D ≤ {2 * x[link]:g} mm",
            note=f"the diameters are not given; plausible: {thin:g} to {thick:g} mm",
        )


def _stability(name: str, design: Corners) -> Claim:
    literally, allowed = design.over(lambda d: opening(d, 0.0) / DEGREE - printed.MAX_OPENING)
    together, _ = design.over(lambda d: opening(d, d.alpha_max) / DEGREE - printed.MAX_OPENING)
    return limit(
        f"constraint, toggle-lock stability, {name}",
        "α_max + γ + φ_max + θ ≤ 160°",
        literally,
        allowed,
        scale=printed.MAX_OPENING,
        computed=printed.MAX_OPENING + literally,
        corrected=("with φ at α_max: φ is largest in the lock, where α = 0", together),
        note=f"{printed.MAX_OPENING + together:.1f}° with φ at α_max",
    )


def _ranges(name: str, design: Corners) -> Iterator[Claim]:
    quantities = {
        "L1/L2": (MEASURES["L1/L2"].of, *printed.LENGTH_RATIO, "0.7 ≤ L1/L2 ≤ 0.85"),
        "φ_max": (lambda d: at(d, 0.0).phi / DEGREE, 0.0, printed.MAX_PHI, "φ_max ≤ 85°"),
        "S_m": (MEASURES["S_m"].of, *printed.PLATEN_STROKE, "500 ≤ S_m ≤ 600 mm"),
        "R_S": (MEASURES["R_S"].of, 0.0, printed.MAX_STROKE_RATIO, "R_S ≤ 1.12"),
    }
    for label, (quantity, low, high, text) in quantities.items():
        face, (least, most) = design.over(quantity)
        nearest = max(low - least, least - high), max(low - most, most - high)
        yield limit(
            f"constraint on {label}, {name}",
            text,
            max(low - face, face - high),
            (min(nearest), max(nearest)),
            scale=high,
            computed=face,
            note=f"{least:.4g} to {most:.4g} within the rounding of table 2",
        )


def largest_force_ratio() -> Claim:
    """The row of the largest M_P of all designs, which goes with the sizes that are not given."""
    # The largest M_P grows with the space that pins and crosshead leave. Its range is therefore given by the tightest
    # and the loosest sizes alone; SMALLER has sizes with which it can be the printed one.
    both, alone, any_, smaller = (search(Problem("M_P", c), STARTS).value for c in (BOTH, ALONE, LOOSEST, SMALLER))
    return number(
        "optimisation, largest M_P",
        printed.LARGEST_FORCE_RATIO,
        both,
        allowed=[(alone, any_)],
        note="by the sizes of pins and crosshead, from those that just allow scheme 4 to any; here with those that just"
        f" allow both printed designs; {smaller:.2f} where L3 ≥ {SMALLER.L3:g}, L4 ≥ {SMALLER.L4:g} and"
        f" L1 − H_b ≤ {SMALLER.B:g} mm, of which the last leaves room",
    )

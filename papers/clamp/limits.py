"""Double-toggle clamp: every printed constraint, on both designs. Pins and crosshead have sizes that are not given."""

from collections.abc import Iterator, Mapping

from scenes.motion import Samples

from ..claims import Claim, limit
from . import designs
from .designs import Design
from .variables import DESIGNS, SOURCE

BOUNDS: Mapping[str, tuple[float, float]] = {
    "L1": (320, 410),
    "L2": (415, 505),
    "L4": (100, 150),
    "L5": (280, 330),
    "theta": (4, 6),
    "gamma": (18, 25),
    "alpha_max": (90, 110),
    "Hb": (210, 250),
}  # mm and deg
PINS = (60.0, 140.0)  # mm, plausible diameters of the pins B, D and E
HEIGHTS = (100.0, 500.0)  # mm, plausible heights H_s of the crosshead


def constraints(name: str, design: Design) -> Iterator[Claim]:
    """Yield a row for each constraint on a design."""
    x = {variable: float(text) for variable, text in DESIGNS[name].items()}
    yield _bounds(name, x)
    yield from _free_space(name, x)
    yield _stability(name, design)
    yield from _ranges(name, design)


def _bounds(name: str, x: Mapping[str, float]) -> Claim:
    excess = max(max(low - x[v], x[v] - high) / high for v, (low, high) in BOUNDS.items())
    at = [v for v, ends in BOUNDS.items() if x[v] in ends]
    printed = ", ".join(f"{low:g} ≤ {v} ≤ {high:g}" for v, (low, high) in BOUNDS.items())
    computed = f"at a bound: {', '.join(at)}" if at else "none at a bound"
    return limit(SOURCE, f"bounds, {name}", printed, excess, (excess, excess), scale=1, computed=computed)


def _free_space(name: str, x: Mapping[str, float]) -> Iterator[Claim]:
    """Yield the constraints that take the sizes of pins and crosshead; the ranges are of what is plausible."""
    (thin, thick), (low, high) = PINS, HEIGHTS
    for link, pin in (("L1", "B"), ("L5", "D")):
        need = x[link] - x["Hb"]
        yield limit(
            SOURCE,
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
            SOURCE,
            f"constraint on {link}, clearance, {name}",
            f"{link} ≥ (d_{pins} + d_D)/2",
            None,
            (thin - x[link], thick - x[link]),
            scale=x[link],
            computed=f"holds where d_{pins} + d_D ≤ {2 * x[link]:g} mm",
            note=f"the diameters are not given; plausible: {thin:g} to {thick:g} mm",
        )


def _stability(name: str, design: Design) -> Claim:
    def total(d: Design) -> Samples:
        angles: Samples = (d.values["alpha_max"] + d.values["gamma"] + d.values["theta"])[:, 0]
        return angles

    printed, allowed = design.over(lambda d: total(d) + designs.largest_phi(d) - 160)
    together, _ = design.over(lambda d: total(d) + designs.first_phi(d) - 160)
    return limit(
        SOURCE,
        f"constraint, toggle-lock stability, {name}",
        "α_max + γ + φ_max + θ ≤ 160°",
        printed,
        allowed,
        scale=160,
        computed=160 + printed,
        corrected=("with φ at α_max: φ is largest in the lock, where α = 0", together),
        note=f"{160 + together:.1f}° with φ at α_max",
    )


def _ranges(name: str, design: Design) -> Iterator[Claim]:
    quantities = {
        "L1/L2": (lambda d: (d.values["L1"] / d.values["L2"])[:, 0], 0.7, 0.85, "0.7 ≤ L1/L2 ≤ 0.85"),
        "φ_max": (designs.largest_phi, 0.0, 85.0, "φ_max ≤ 85°"),
        "S_m": (designs.platen_stroke, 500.0, 600.0, "500 ≤ S_m ≤ 600 mm"),
        "R_S": (designs.stroke_ratio, 0.0, 1.12, "R_S ≤ 1.12"),
    }
    for what, (quantity, low, high, printed) in quantities.items():
        face, (least, most) = design.over(quantity)
        nearest = max(low - least, least - high), max(low - most, most - high)
        yield limit(
            SOURCE,
            f"constraint on {what}, {name}",
            printed,
            max(low - face, face - high),
            (min(nearest), max(nearest)),
            scale=high,
            computed=face,
            note=f"{least:.4g} to {most:.4g} within the rounding of table 2",
        )

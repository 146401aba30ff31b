"""What of a design can be optimised or limited, and what of it is reported."""

from collections.abc import Callable, Mapping
from typing import NamedTuple

from .. import formulas as clamp
from ..formulas import Array
from . import stroke


class Measure(NamedTuple):
    """A function of X; divided by its scale it is of order one."""

    of: Callable[[Array], Array]
    scale: float
    least: bool  # whether less is better


MEASURES: Mapping[str, Measure] = {
    "M_P": Measure(clamp.force_ratio, 20.0, least=False),
    "R_S": Measure(clamp.stroke_ratio, 1.0, least=False),
    "L_sum": Measure(clamp.total_length, 1000.0, least=True),
    "R_V start": Measure(stroke.start, 1.0, least=False),
    "R_V max": Measure(stroke.fastest, 1.0, least=False),
    "R_V peak-valley": Measure(stroke.peak_valley, 1.0, least=True),
    "a_m range": Measure(stroke.range_of_acceleration, 0.01, least=True),
    "S_m": Measure(clamp.platen_stroke, 600.0, least=False),
    "L1/L2": Measure(lambda X: X[0] / X[1], 1.0, least=True),
    "L4": Measure(lambda X: X[2], 100.0, least=False),
}


def measure(name: str, X: Array) -> float:
    """Return a measure of one design."""
    return float(MEASURES[name].of(X))

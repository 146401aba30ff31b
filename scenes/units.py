"""Units: a plain product of powers of unit names, read by a grammar; what a name means is pint's."""

import re
from functools import cache, lru_cache
from math import nan
from typing import TYPE_CHECKING

from .errors import InputError, nearest, one_line
from .format import Units

if TYPE_CHECKING:
    from pint import UnitRegistry

_EXAMPLES = {
    "length": ("meter", ("m", "mm", "cm", "um", "km", "in", "ft")),
    "mass": ("kilogram", ("kg", "g", "t", "lb")),
    "force": ("newton", ("N", "kN", "MN", "lbf")),
    "angle": ("radian", ("rad", "deg")),
    "speed": ("radian / second", ("rad/s", "deg/s", "rpm")),
}
_SLIDING_SPEED = ("meter / second", ("m/s", "mm/s", "m/min", "in/s"))
_POWER = r"(?:°|[^\W\d]\w{0,31})(?: ?(?:\*\*|\^) ?-?\d{1,2}(?:\.\d{1,2})?)?"
_PRODUCT = re.compile(rf"{_POWER}(?: ?[*/] ?{_POWER}){{0,7}}")
_SMALLEST, _LARGEST = 1e-30, 1e30  # of a unit in SI: between quecto and quetta, and its square is a double


def si_factors(units: Units, *, slider_driven: bool) -> dict[str, float]:
    """Return what to multiply each quantity's number by to have it in SI.

    Raises:
        InputError: a text is no unit of its quantity; the message has its place in the file and the nearest unit.
    """
    factors = {}
    known = _EXAMPLES | ({"speed": _SLIDING_SPEED} if slider_driven else {})
    for name, (si, examples) in known.items():
        unit = getattr(units, name) or si
        wrong = ""
        if not _PRODUCT.fullmatch(unit):
            wrong = "is not a product of powers of unit names, such as kg*m**2 or kN/mm"
        elif not _SMALLEST <= _factor(unit, si) <= _LARGEST:
            of = "speed of a driven slider" if known[name] is _SLIDING_SPEED else name
            wrong = f"is not a unit of {of} that is known"
        if wrong:
            shown = one_line(unit, 40)
            raise InputError(f"units.{name}: '{shown}' {wrong}{nearest(shown, examples)}")
        factors[name] = _factor(unit, si)
    return factors


@lru_cache(100)
def _factor(unit: str, si: str) -> float:
    """Return how many of the SI unit a unit is; NaN where it is none of the same quantity."""
    registry = _registry()
    try:
        return float(registry.Quantity(1.0, registry.parse_units(unit)).to(si).magnitude)
    except Exception:  # pint raises its own, ValueError, AssertionError or OverflowError, by kind of nonsense
        return nan


@cache
def _registry() -> "UnitRegistry[float]":
    from pint import UnitRegistry  # late, and once: by far the slowest import here

    return UnitRegistry()

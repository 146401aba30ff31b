"""Numbers for a reader: quantities in the units of the report, errors as short powers of ten."""

from math import floor, isinf, isnan, log10

from ..engines.axis import prefixed
from .units import Units

DIGITS, OF_LENGTHS = 3, 4  # significant ones
PLAIN = 1e-3, 1e6  # from here to there a number needs no power of ten
PLAIN_PERCENT = 1e-6  # what is less is no longer told apart, %


def short(value: float) -> str:
    """Return a number in few characters: `0.125`, `84,213`, `9e-8`."""
    if isnan(value):
        return "–"
    if isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0 or PLAIN[0] <= abs(value) < PLAIN[1]:
        return _plain(value).replace("-", "−")
    mantissa, power = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(power)}"


def written(value: float, unit: str, units: Units) -> str:
    """Return a quantity in SI in the unit of the report, or else with the prefix that suits it: `84.2 kN`."""
    if isnan(value):
        return "–"
    if value == 0:
        return "0"
    factor, name = units.get(unit) or prefixed(abs(float(f"{value:.{DIGITS - 1}e}")) or 1.0, unit)
    return f"{_significant(factor * value, OF_LENGTHS if unit == 'm' else DIGITS)}{' ' * (name not in ('', '°'))}{name}"


def percent(share: float) -> str:
    """Return a share in per cent, to one digit: `0.0004 %`."""
    value = 100 * share
    if 0 < value < PLAIN_PERCENT:
        return f"< {PLAIN_PERCENT:f} %"
    return f"{_significant(value, 1) if PLAIN_PERCENT <= value < 1 else short(value)} %"


def _plain(value: float) -> str:
    return f"{value:,.0f}" if float(value).is_integer() or abs(value) >= 10**DIGITS else f"{value:.{DIGITS}g}"


def _significant(value: float, digits: int) -> str:
    decimals = digits - 1 - floor(log10(abs(value))) if value else 0
    return f"{value:,.{max(decimals, 0)}f}".replace("-", "−")

"""Numbers for a reader: quantities in engineering form, errors as short powers of ten."""

from math import floor, isinf, isnan, log10

from ..engines.axis import prefixed

DIGITS = 3  # significant ones
PLAIN = 1e-3, 1e6  # from here to there a number needs no power of ten
PLAIN_PERCENT = 1e-5  # from here on, in %


def short(value: float) -> str:
    """Return a number in few characters: `0.125`, `84,213`, `9e-8`."""
    if isnan(value):
        return "–"
    if isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0 or PLAIN[0] <= abs(value) < PLAIN[1]:
        return _plain(value)
    mantissa, power = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(power)}"


def engineering(value: float, unit: str) -> str:
    """Return a quantity in SI with the prefix that suits it: `84.2 kN`."""
    if isnan(value):
        return "–"
    factor, prefixed_unit = prefixed(abs(float(f"{value:.{DIGITS - 1}e}")) or 1.0, unit)
    return f"{_significant(factor * value)} {prefixed_unit}"


def percent(share: float) -> str:
    """Return a share in per cent, to one digit: `0.0004 %`."""
    value = 100 * share
    if not PLAIN_PERCENT <= abs(value) < 1:
        return f"{short(value)} %"
    return f"{value:.{-floor(log10(abs(value)))}f} %"


def _plain(value: float) -> str:
    return f"{value:,.0f}" if float(value).is_integer() or abs(value) >= 10**DIGITS else f"{value:.{DIGITS}g}"


def _significant(value: float) -> str:
    decimals = DIGITS - 1 - floor(log10(abs(value))) if value else 0
    return f"{value:,.{max(decimals, 0)}f}"

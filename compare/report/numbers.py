"""Numbers for a reader: quantities in the units of a page, shares in per cent, errors as short powers of ten."""

from math import isfinite

from ..mechanics.quantities import Units, by_power, number, suited, units, written

__all__ = ["Units", "capital", "percent", "short", "suited", "units", "written"]

PLAIN = 1e-3, 1e6  # from here to there a number needs no power of ten
MIN_PERCENT = 1e-4  # of what is less the share itself is shown, by a power of ten


def capital(text: str) -> str:
    """A text with a capital letter."""
    return text[:1].upper() + text[1:]


def percent(share: float) -> str:
    """A share in per cent, to one digit: `0.0004 %`; of less than 1e-6 the share itself, as `8e-8`."""
    value = 100 * share
    if 0 < value < MIN_PERCENT:
        return short(share)
    if not isfinite(value):
        return short(value)
    return f"{number(value, 1) if MIN_PERCENT <= value < 1 else short(value)} %"


def short(value: float) -> str:
    """A number in few characters: `0.125`, `84,213`, `9e-8`."""
    if isfinite(value) and value and not PLAIN[0] <= abs(value) < PLAIN[1]:
        return by_power(value)
    text = number(value)
    return text.rstrip("0").rstrip(".") if "." in text else text

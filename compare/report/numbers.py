"""Numbers for a reader: quantities in the units of a page, shares in per cent, errors as short powers of ten."""

from collections.abc import Iterable, Mapping
from math import floor, isfinite, isinf, isnan, log10, pi
from typing import TypeAlias

import numpy as np

from scenes.model.motion import UNITS, quantity

from ..mechanics.axis import prefixed
from ..mechanics.reference import Reference
from ..mechanics.scales import magnitude

Units: TypeAlias = Mapping[str, tuple[float, str]]  # by SI unit the factor to the unit shown, and the name of that

RATES = ("m/s", "m/s^2")  # whose scale, of errors, is what a steady drive would make of the travel
ALONE: Units = {"": (1.0, ""), "rad": (180 / pi, "°")}  # those that take no prefix
DIGITS, OF_LENGTHS = 3, 4  # significant ones
MOST = 1e4  # what a peak reads less than, in the units of a page
PLAIN = 1e-3, 1e6  # from here to there a number needs no power of ten
PLAIN_PERCENT = 1e-6  # what is less is no longer told apart, %
TINY = 1e-4  # in its unit: what is less has a power of ten


def units(reference: Reference) -> Units:
    """Units of a page: one for each kind of quantity, in which its peak over the cycle reads between 1 and 10,000.

    Lengths and their rates are in the unit of the scene's file where it suits them; work is not among them. The size of
    places is their travel, that of rates and forces their peak.
    """
    cycle, drive, sizes = reference.cycle, reference.scene.drive, list[tuple[str, float]]()
    for channel, size in reference.scale.items():
        unit = UNITS[quantity(channel)]
        sizes.append((unit, float(magnitude(cycle, channel).max()) if unit in RATES and channel in cycle else size))
    if (effort := reference.scene.effort_channel) in cycle:
        sizes.append(("W", float(np.abs(cycle[effort] * drive.at(cycle["time"]).rate).max())))
    return suited(reference.scene.units["length"], sizes)


def suited(length: tuple[str, float], sizes: Iterable[tuple[str, float]]) -> Units:
    """The same by a file's unit of length, and sizes in SI, each with its unit."""
    name, size = length
    of_the_file = {"m": name, "m/s": f"{name}/s", "m/s^2": f"{name}/s²"}
    peaks, shown = dict.fromkeys((*of_the_file, "N", "N*m", "W"), 0.0), dict(ALONE)
    for unit, value in sizes:
        peaks |= {unit: max(peaks[unit], abs(value))} if unit in peaks else {}
    for si, peak in peaks.items():
        own = si in of_the_file and (not peak or 1 <= peak / size < MOST)
        shown[si] = (1 / size, of_the_file[si]) if own else prefixed(peak, si)
    return shown


def written(value: float, unit: str, units: Units, *, digits: int = 0, sign: str = "") -> str:
    """A quantity in SI in the unit of the page, or else with the prefix that suits it: `84.2 kN`.

    Digits are significant ones, 0 for as many as such a quantity mostly has; `+` is a sign for positive ones too.
    """
    if not isfinite(value):
        return "–"
    if value == 0:
        return "0"
    factor, name = units.get(unit) or prefixed(abs(float(f"{value:.{DIGITS - 1}e}")), unit)
    shown, digits = factor * value, digits or (OF_LENGTHS if unit == "m" else DIGITS)
    if abs(shown) >= TINY:
        number = _significant(shown, digits, sign)
    else:
        mantissa, power = f"{shown:{sign}.{digits - 1}e}".split("e")
        number = f"{mantissa.replace('-', '−')}e{int(power)}"
    return f"{number}{' ' * (name not in ('', '°'))}{name}"


def capital(text: str) -> str:
    """A text with a capital letter."""
    return text[:1].upper() + text[1:]


def percent(share: float) -> str:
    """A share in per cent, to one digit: `0.0004 %`."""
    value = 100 * share
    if isnan(value):
        return "–"
    if 0 < value < PLAIN_PERCENT:
        return f"< {PLAIN_PERCENT:f} %"
    return f"{_significant(value, 1) if PLAIN_PERCENT <= value < 1 else short(value)} %"


def short(value: float) -> str:
    """A number in few characters: `0.125`, `84,213`, `9e-8`."""
    if isnan(value):
        return "–"
    if isinf(value):
        return "∞" if value > 0 else "−∞"
    if value == 0 or PLAIN[0] <= abs(value) < PLAIN[1]:
        whole = float(value).is_integer() or abs(value) >= 10**DIGITS
        return (f"{value:,.0f}" if whole else f"{value:.{DIGITS}g}").replace("-", "−")
    mantissa, power = f"{value:.0e}".split("e")
    return f"{mantissa}e{int(power)}"


def _significant(value: float, digits: int, sign: str = "") -> str:
    decimals = max(digits - 1 - floor(log10(abs(value))), 0)
    return f"{value:{sign},.{decimals}f}".replace("-", "−")

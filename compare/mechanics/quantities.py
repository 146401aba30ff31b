"""Quantities for a reader: one unit for each kind, the file's, and one rounding, on pages and in the terminal alike.

A kind is named by its SI unit. The unit shown is the file's, or another prefix of it where the largest value would not
read from 1 to 10 000; one that takes no prefix, as an inch or a pound-force, stays. Work and power are in joules and
watts, or by the moment's unit where the force's takes no prefix. A number has four significant digits, five after a
leading 1.
"""

import re
from collections.abc import Iterable, Mapping
from math import isfinite
from typing import TypeAlias

import numpy as np

from scenes import Scene
from scenes.model.inputs import inputs_of
from scenes.units import SI

from .axis import fixed, prefixed
from .reference import Reference
from .scales import magnitude

Units: TypeAlias = Mapping[str, tuple[float, str]]  # by SI unit the factor to the unit shown, and the name of that
FileUnits: TypeAlias = Mapping[str, tuple[str, float]]  # by dimension the name of a file's unit, and its size in SI

RATES = ("m/s", "m/s^2")  # whose scale, of errors, is what a steady drive would make of the travel
MAX_READ = 1e4  # what a peak reads less than, in the units of a page
MIN_PLAIN, MAX_PLAIN = 1e-4, 1e9  # from here to there a number needs no power of ten
DIGITS = 4  # significant ones, and one more after a leading 1
MAX_DIGITS = 7  # of two numbers that fewer do not tell apart
_PREFIXABLE = re.compile(r"(da|\w)?(m|N|N\*(da|\w)?m)(/s(\^2)?)?")
_POWERS = str.maketrans("23", "²³")


def units(reference: Reference) -> Units:
    """Units of a page: one for each kind of quantity.

    The size of places is their travel, of rates and forces their peak, of work what the drive's power amounts to.
    """
    cycle, scene, sizes = reference.cycle, reference.scene, list[tuple[str, float]]()
    for channel, size in reference.scale.items():
        row = reference.scene.channels[channel]
        unit = row.unit
        sizes.append((unit, float(magnitude(cycle, row).max()) if unit in RATES and channel in cycle else size))
    if (effort := reference.scene.channels.drive.effort) in cycle:
        power = np.abs(cycle[effort] * inputs_of(scene, cycle["time"]).driven().rate)
        sizes += [("W", float(power.max())), ("J", float(power.mean()) * scene.cycle)]
    return suited(reference.scene.units, sizes)


def suited(file_units: FileUnits, sizes: Iterable[tuple[str, float]]) -> Units:
    """Units of a page by those of a file, and by sizes in SI, each with its SI unit."""
    of_file = _of_file(file_units)
    peaks = dict.fromkeys(of_file, 0.0)
    for si, value in sizes:
        peaks |= {si: max(peaks[si], abs(value))} if si in peaks else {}
    shown: dict[str, tuple[float, str]] = {"": (1.0, "")}
    for si, peak in peaks.items():
        name, size = of_file[si]
        # A unit that takes no prefix is kept whatever the size; others where the peak reads from 1 to MAX_READ.
        is_suited = not _PREFIXABLE.fullmatch(name) or not peak or 1 <= peak / size < MAX_READ
        shown[si] = (1 / size, named(name)) if is_suited and name else prefixed(peak, si)
    return shown


def _of_file(file_units: FileUnits) -> dict[str, tuple[str, float]]:
    """By SI unit the name and size of a file's; no name where it is SI's with a prefix."""
    file_units = {**SI, **file_units}
    (length, metre), (force, newton) = file_units["length"], file_units["force"]
    moment, newton_metre = file_units.get("moment", (f"{force}*m", newton))
    work = ("", 1.0) if _PREFIXABLE.fullmatch(force) else (moment, newton_metre)
    return {
        "m": (length, metre),
        "m/s": (f"{length}/s", metre),
        "m/s^2": (f"{length}/s^2", metre),
        "N": (force, newton),
        "N*m": (moment, newton_metre),
        "rad": file_units["angle"],
        "J": work,
        "W": (work[0] and f"{work[0]}/s", work[1]),
    }


def named(unit: str) -> str:
    """A unit beside a number: `N m` of a file's `N*m`, `m/s²`, `°`."""
    return "°" if unit == "deg" else spelled(unit)


def spelled(unit: str) -> str:
    """A unit by itself: `N m`, `m/s²`, `deg`."""
    return re.sub(r"(?:\^|\*\*)([23])(?!\d)", lambda power: power[1].translate(_POWERS), unit).replace("*", " ")


def limited(scene: Scene, name: str, shown: Units) -> tuple[float, str]:
    """The factor from SI to the unit shown of a channel or magnitude, and its name; else those of the file's."""
    if (known := shown.get(scene.channels[name].unit)) is not None:
        return known
    unit, size = scene.unit_of(name)
    return 1 / size, named(unit)


def written(value: float, si: str, shown: Units, *, digits: int = 0, sign: str = "") -> str:
    """A quantity in SI in the unit shown, or else with the prefix that suits it: `84.20 kN`; zero as `0`.

    Digits are significant ones, 0 for the house's; `+` is a sign for positive ones too.
    """
    if not isfinite(value):
        return "–"
    factor, name = shown.get(si) or prefixed(abs(float(f"{value:.{DIGITS - 1}e}")), si)
    return with_unit(number(factor * value, digits, sign), name) if value else "0"


def with_unit(text: str, name: str) -> str:
    """A number with its unit, by a space but for degrees."""
    return f"{text}{' ' * (name not in ('', '°'))}{name}"


def number(value: float, digits: int = 0, sign: str = "") -> str:
    """A number to some significant digits, or to the house's: `382.0`, `10.329`, `10 004`, `6.030e-5`, `−0.3310`."""
    if not isfinite(value):
        return "–" if value != value else "∞" if value > 0 else "−∞"
    mantissa, exponent = f"{value:.{DIGITS}e}".split("e")
    digits = digits or DIGITS + (mantissa.lstrip("-")[0] == "1")
    if value and not MIN_PLAIN <= abs(value) < MAX_PLAIN:
        return by_power(value, digits, sign)
    return fixed(value, max(digits - 1 - int(exponent), 0), sign)


def by_power(value: float, digits: int = 1, sign: str = "") -> str:
    """A number to some significant digits with a power of ten: `9e-8`."""
    mantissa, exponent = f"{value:{sign}.{digits - 1}e}".split("e")
    return f"{mantissa.replace('-', '−')}e{int(exponent)}"


def apart(value: float, other: float) -> str:
    """A number to as many digits as tell it from another one, but no more than `MAX_DIGITS`."""
    for digits in (0, *range(DIGITS + 1, MAX_DIGITS + 1)):
        if value == other or number(value, digits) != number(other, digits):
            break
    return number(value, digits)

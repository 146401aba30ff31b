"""Units: a plain product of powers of unit names, read by a grammar; what a name means is pint's.

The usual ones are known here: to import pint, and have it read its definitions, takes as long as to solve a linkage.
"""

import re
from collections.abc import Iterable, Mapping
from functools import cache, lru_cache
from math import nan, pi
from typing import Any

from ..errors import InputError, nearest, one_line
from ..units import units_of_all
from .format import Units

_USUAL = {  # how many of the SI unit, the first, which a file has where it names none, each is
    "length": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3, "in": 0.0254, "ft": 0.3048},
    "mass": {"kg": 1.0, "g": 1e-3, "t": 1e3, "lb": 0.45359237},
    "force": {"N": 1.0, "kN": 1e3, "MN": 1e6, "lbf": 4.4482216152605},
    "angle": {"rad": 1.0, "deg": pi / 180},
}
_TURNING = {"rad/s": 1.0, "deg/s": pi / 180, "rpm": pi / 30}
_TWISTING = {"N*m": 1.0, "kN*m": 1e3, "N*mm": 1e-3, "lbf*ft": 4.4482216152605 * 0.3048}
_SLIDING = {"m/s": 1.0, "mm/s": 1e-3, "m/min": 1 / 60, "in/s": 0.0254}
_ALL = (*_USUAL.values(), _TURNING, _SLIDING, _TWISTING)
_FACTORS = {(unit, next(iter(usual))): size for usual in _ALL for unit, size in usual.items()}
_POWER = r"(?:°|[^\W\d]\w{0,31})(?: ?(?:\*\*|\^) ?-?\d{1,2}(?:\.\d{1,2})?)?"
_PRODUCT = re.compile(rf"{_POWER}(?: ?[*/] ?{_POWER}){{0,7}}")
_SMALLEST, _LARGEST = 1e-30, 1e30  # of a unit in SI: between quecto and quetta, and its square is a double


LONGEST = 20  # characters of a unit's name in a message


def si_units(units: Units, driven: str, *, slides: bool) -> dict[str, tuple[str, float]]:
    """The unit of each quantity, and what to multiply its number by to have it in SI; of the speed as it slides."""
    factors = {}
    speed, other = (_SLIDING, "rad/s") if slides else (_TURNING, "m/s")
    for name, usual in (_USUAL | {"speed": speed}).items():
        si = next(iter(usual))
        unit = getattr(units, name) or si
        if name == "speed" and unit not in usual and _PRODUCT.fullmatch(unit) and _factor(unit, other) > 0:
            kind, is_driven = ("crank", "slides") if slides else ("slider", "does not slide")
            why = f"'{driven}' {is_driven}, and units.speed, '{unit}', is of a {kind}"
            instead = f"expected a {kind} here, or units.speed as one of {', '.join(sorted(usual))}"
            raise InputError(f"drive.body: {why}; {instead}")
        factors[name] = unit, factor(unit, si, name, f"units.{name}", usual)
    if units.moment is not None:
        factors["moment"] = units.moment, factor(units.moment, "N*m", "moment", "units.moment", _TWISTING)
    return factors


def unit_named(tables: Mapping[str, Any], dimension: str) -> str:
    """The unit of a dimension that a file names, before it is checked, for messages."""
    given, drive, bodies = (_inner(tables, key) for key in ("units", "drive", "bodies"))
    names = {name: field.default for name, field in Units.model_fields.items() if field.default}
    units = {"speed": "rad/s", **names, **{name: unit for name, unit in given.items() if isinstance(unit, str)}}
    slides = "slides" in _inner(bodies, drive.get("body"))
    name, _ = units_of_all({name: (unit, 1.0) for name, unit in units.items()}, slides=slides)[dimension]
    return one_line(name, LONGEST)


def _inner(table: Mapping[str, Any], key: object) -> Mapping[str, Any]:
    """A table in another one; an empty one where there is none."""
    inner = table.get(key) if isinstance(key, str) else None
    return inner if isinstance(inner, dict) else {}


def factor(unit: str, si: str, name: str, place: str, usual: Iterable[str] = ()) -> float:
    """How many of the SI unit a unit is; InputError, with its place and the nearest, where it is none of that name."""
    shown, expected = one_line(unit, 40), "a product of powers of unit names, such as kg*m**2 or kN/mm"
    # The grammar is narrower than pint's own, on purpose: pint evaluates numbers in brackets and powers too, and a text
    # such as "9**9**9" would keep it busy for hours.
    if _PRODUCT.fullmatch(unit):
        expected = f"a known unit of {name}"
        if _SMALLEST <= (size := _factor(unit, si)) <= _LARGEST:
            return size
    raise InputError(f"{place}: '{shown}' is not {expected}{nearest(shown, usual) if usual else ''}")


@lru_cache(100)
def _factor(unit: str, si: str) -> float:
    """How many of the SI unit a unit is; NaN where it is none of the same quantity."""
    if (unit, si) in _FACTORS:
        return _FACTORS[unit, si]
    try:
        parsed = _registry().parse_units(unit)  # to pint 1 Hz is 1 rad/s, to others a turn a second
        return nan if "hertz" in str(parsed) else float((1.0 * parsed).to(si).magnitude)
    except Exception:  # pint raises its own, ValueError, AssertionError or OverflowError, by kind of nonsense
        return nan


@cache
def _registry() -> Any:
    from pint import UnitRegistry  # late, and once: by far the slowest import here

    return UnitRegistry()

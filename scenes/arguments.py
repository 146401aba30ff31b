"""Validate arguments from Python: each error is one line that names the argument and what was expected."""

from collections.abc import Iterable, Mapping
from numbers import Integral
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from .errors import InputError, nearest, one_line
from .scene import Scene

MAX_COUNT = 10**12  # of what is counted: nobody waits for more


def refuse(argument: str, expected: str, value: object) -> NoReturn:
    """Raise InputError for an argument that is not as expected."""
    raise InputError(f"{argument}: expected {expected}, found {shown(value)}")


def shown(value: object) -> str:
    """A value as messages show it, whatever it is."""
    try:
        return one_line(repr(value), 60)
    except Exception:  # of anybody's classes, and of integers of thousands of digits
        return f"a value of {type(value).__name__} without a text"


def scene_of(value: object) -> Scene:
    """The argument `scene`, or raise InputError."""
    if not isinstance(value, Scene):
        refuse("scene", "a Scene, as scenes.load(...) returns it", value)
    return value


def check_changes(value: object) -> None:
    """Raise InputError for changes that are not by path."""
    if not isinstance(value, Mapping) or not all(isinstance(path, str) for path in value):
        refuse("changes", "values by path, as {'bodies.rod.mass': 2}", value)


def single_values(changes: object) -> dict[str, float | int | str]:
    """Changes of one scene: texts and single numbers by path, or raise InputError."""
    check_changes(changes)
    assert isinstance(changes, Mapping)
    return {path: _single(path, value) for path, value in changes.items()}


def _single(path: str, value: object) -> float | int | str:
    if isinstance(value, str):
        return value
    number = one_number(path, value)
    return value if type(value) is int else number


def names(argument: str, value: object) -> tuple[str, ...]:
    """Several names, or raise InputError; one text is not several."""
    several = tuple(value) if isinstance(value, Iterable) and not isinstance(value, str | bytes) else (None,)
    if not all(isinstance(name, str) for name in several):
        refuse(argument, f"several names{f', as {shown([value])}' * isinstance(value, str)}", value)
    return several


def known_names(argument: str, value: object, known: Iterable[str]) -> frozenset[str]:
    """Several names, or raise InputError, which names the one nearest to one that is unknown."""
    several, valid = names(argument, value), frozenset(known)
    for name in several:
        if name not in valid:
            raise InputError(f"{argument}: no '{name}'{nearest(name, valid)}")
    return frozenset(several)


def unmasked(argument: str, value: object) -> NDArray[Any]:
    """An array of any kind, or raise InputError for one with a mask, which no model knows of."""
    if isinstance(value, np.ndarray) and hasattr(value, "mask"):  # numpy.ma, which it is of, takes long to import
        raise InputError(f"{argument}: expected plain numbers, found a masked array; its .filled(...) gives some")
    return np.asarray(value)


def doubles(argument: str, value: object) -> NDArray[np.float64]:
    """Real numbers as an array of their own, of the same shape, or raise InputError."""
    try:
        given = unmasked(argument, value)
        if given.dtype.kind == "O":
            given = np.vectorize(float, otypes=[np.float64])(given)  # NumPy itself would make NaN of None
        if given.dtype.kind in "biuf":
            return given.astype(np.float64)
    except (TypeError, ValueError):  # of ragged lists, and what is no number among others
        pass
    except OverflowError:
        refuse(argument, "numbers that fit a double, 1.8e308 at most", value)
    refuse(argument, "real numbers", value)


def one_number(argument: str, value: object) -> float:
    """A single real number that fits a double, or raise InputError."""
    if isinstance(value, bool) or np.ndim(numbers := doubles(argument, value)):
        refuse(argument, "a number", value)
    return float(numbers)


def whole_number(argument: str, value: object, *, most: int = MAX_COUNT) -> int:
    """A whole number from 1, or raise InputError."""
    if isinstance(value, bool) or not isinstance(value, Integral) or not 1 <= int(value) <= most:
        refuse(argument, f"a whole number from 1 to {most}", value)
    return int(value)


def finite_numbers(argument: str, value: object) -> NDArray[np.float64]:
    """Finite real numbers as an array of their own, of the same shape, or raise InputError."""
    numbers = doubles(argument, value)
    if not np.isfinite(numbers).all():
        refuse(argument, "finite numbers", value)
    return numbers

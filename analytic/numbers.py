"""A scene's numbers: plain ones, or arrays of shape (m, 1), one of each of m machines.

Plain numbers take the precision of the positions that they meet, as NumPy has it of Python's own.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from copy import copy
from dataclasses import is_dataclass
from functools import reduce
from math import ceil, sqrt
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

Number: TypeAlias = Any  # float, or real samples of shape (m, 1)
Vector: TypeAlias = Any  # complex, or complex samples of shape (m, 1)
PLAIN = (float, int)
LEAVES = {float, str, int, bool, complex}


def largest(*numbers: Number) -> Number:
    """Return the largest number, machine by machine."""
    return reduce(np.maximum, _plain_first(max, numbers))


def least(*numbers: Number) -> Number:
    """Return the least number, machine by machine."""
    return reduce(np.minimum, _plain_first(min, numbers))


def chosen(condition: Any, yes: Any, no: Any) -> Any:
    """Return the one or the other, machine by machine, samples too."""
    if isinstance(condition, bool | np.bool_):
        return yes if condition else no
    return np.where(condition, yes, no)


def root(number: Number) -> Number:
    """Return the square root, zero of what is negative."""
    return sqrt(max(number, 0.0)) if isinstance(number, PLAIN) else np.sqrt(np.maximum(number, 0.0))


def alike(numbers: Number) -> Number:
    """Return numbers of machines as a plain one where they are all the same."""
    return numbers.item(0) if isinstance(numbers, np.ndarray) and (numbers == numbers[0]).all() else numbers


@contextmanager
def row_by_row(n: int) -> Iterator[None]:
    """Have NumPy meet numbers of shape (m, 1) with samples of shape (m, n) without a copy of them for each sample.

    It makes copies where its buffer holds several rows; short rows are better off with them.
    """
    before = np.setbufsize(16 * ceil(n / 16) if 100 <= n <= np.getbufsize() else np.getbufsize())
    try:
        yield
    finally:
        np.setbufsize(before)


def samples(number: Any) -> NDArray[Any]:
    """Return a plain number as samples of shape (); what are samples already stays as it is."""
    return cast("NDArray[Any]", number) if hasattr(number, "astype") else np.asarray(number)


def of_machines(whole: Any) -> Callable[[Any], Any]:
    """Return the function of rows that takes what holds numbers of shape (m, 1, ...) to the same of some machines.

    What those numbers are not in is looked at only once, and stays as it is.
    """
    parts = _parts(whole)
    return parts if parts is not None else lambda _: whole


def _parts(whole: Any) -> Callable[[Any], Any] | None:
    if whole is None or type(whole) in LEAVES:  # most of what there is
        return None
    if isinstance(whole, np.ndarray):
        return whole.__getitem__ if whole.ndim > 1 and whole.shape[1] == 1 else None
    if isinstance(whole, tuple):
        found = _differing(enumerate(whole))
        return (lambda rows: tuple(_changed(dict(enumerate(whole)), found, rows).values())) if found else None
    if isinstance(whole, Mapping):
        found = _differing(whole.items())
        return (lambda rows: _changed(dict(whole), found, rows)) if found else None
    if is_dataclass(whole) and (found := _differing(vars(whole).items())):

        def some(rows: Any) -> Any:
            part = copy(whole)
            _changed(vars(part), found, rows)
            return part

        return some
    return None


def _differing(items: Iterable[tuple[Any, Any]]) -> dict[Any, Callable[[Any], Any]]:
    return {key: parts for key, value in items if (parts := _parts(value)) is not None}


def _changed(values: dict[Any, Any], found: Mapping[Any, Callable[[Any], Any]], rows: Any) -> dict[Any, Any]:
    for key, parts in found.items():
        values[key] = parts(rows)
    return values


def _plain_first(one: Callable[[Iterable[float]], float], numbers: Sequence[Number]) -> list[Number]:
    """Return the one of the plain numbers, if there are any, and the others."""
    plain = [number for number in numbers if isinstance(number, PLAIN)]
    others = [number for number in numbers if not isinstance(number, PLAIN)]
    return [one(plain), *others] if plain else others

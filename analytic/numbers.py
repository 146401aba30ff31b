"""A scene's numbers: plain ones, or arrays of shape (m, 1), one of each of m machines.

Plain numbers take the precision of the positions that they meet, as NumPy has it of Python's own.
"""

from collections.abc import Mapping
from copy import copy
from dataclasses import is_dataclass
from functools import reduce
from math import sqrt
from operator import is_
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

Number: TypeAlias = Any  # float, or real samples of shape (m, 1)
Vector: TypeAlias = Any  # complex, or complex samples of shape (m, 1)


def largest(*numbers: Number) -> Number:
    """Return the largest number, machine by machine."""
    return max(numbers) if _plain(*numbers) else reduce(np.maximum, numbers)


def least(*numbers: Number) -> Number:
    """Return the least number, machine by machine."""
    return min(numbers) if _plain(*numbers) else reduce(np.minimum, numbers)


def chosen(condition: Any, yes: Any, no: Any) -> Any:
    """Return the one or the other, machine by machine, samples too."""
    if isinstance(condition, bool | np.bool_):
        return yes if condition else no
    return np.where(condition, yes, no)


def root(number: Number) -> Number:
    """Return the square root, zero of what is negative."""
    return sqrt(max(number, 0.0)) if _plain(number) else np.sqrt(np.maximum(number, 0.0))


def samples(number: Any) -> NDArray[Any]:
    """Return a plain number as samples of shape (); what are samples already stays as it is."""
    return cast("NDArray[Any]", number) if hasattr(number, "astype") else np.asarray(number)


def of_machines(whole: Any, rows: Any) -> Any:
    """Return what holds numbers of shape (m, 1), with those of some machines; what they are not in stays as it is."""
    if isinstance(whole, np.ndarray):
        return whole[rows] if whole.ndim == 2 and whole.shape[1] == 1 else whole
    if isinstance(whole, tuple):
        parts = [of_machines(part, rows) for part in whole]
        return whole if all(map(is_, parts, whole)) else tuple(parts)
    if isinstance(whole, Mapping):
        parts = [of_machines(part, rows) for part in whole.values()]
        return whole if all(map(is_, parts, whole.values())) else dict(zip(whole, parts, strict=True))
    if is_dataclass(whole):
        changed = {name: part for name, old in vars(whole).items() if (part := of_machines(old, rows)) is not old}
        if changed:
            whole = copy(whole)
            vars(whole).update(changed)
    return whole


def _plain(*numbers: Number) -> bool:
    return all(isinstance(number, int | float) for number in numbers)

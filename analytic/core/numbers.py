"""A scene's numbers: plain ones, or expressions of them while the formulas are recorded.

Plain numbers take the precision of the positions that they meet, as NumPy has it of Python's own.
"""

from functools import reduce
from math import sqrt
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import NDArray

Number: TypeAlias = Any  # float, or what is recorded of one
Vector: TypeAlias = Any  # complex, or what is recorded of one


def largest(*numbers: Number) -> Number:
    """The largest number."""
    return max(numbers) if _plain(numbers) else reduce(np.maximum, numbers)


def least(*numbers: Number) -> Number:
    """The least number."""
    return min(numbers) if _plain(numbers) else reduce(np.minimum, numbers)


def chosen(condition: Any, yes: Any, no: Any) -> Any:
    """The one or the other; of samples each by its own condition."""
    if isinstance(condition, bool | np.bool_):
        return yes if condition else no
    return np.where(condition, yes, no)


def root(number: Number) -> Number:
    """The square root, zero of what is negative."""
    return sqrt(max(number, 0.0)) if _plain((number,)) else np.sqrt(np.maximum(number, 0.0))


def samples(number: Any) -> NDArray[Any]:
    """A plain number as samples of shape (); what are samples already stays as it is."""
    return cast("NDArray[Any]", number) if hasattr(number, "astype") else np.asarray(number)


def real(vectors: NDArray[Any]) -> NDArray[Any]:
    """The parts along x, of objects too."""
    return vectors.real if vectors.dtype != object else np.array([each.real for each in vectors], object)


def imag(vectors: NDArray[Any]) -> NDArray[Any]:
    """The parts along y, of objects too."""
    return vectors.imag if vectors.dtype != object else np.array([each.imag for each in vectors], object)


def _plain(numbers: tuple[Number, ...]) -> bool:
    return all(isinstance(number, float | int) for number in numbers)

"""What numbers of a scene have to be: of one machine, or of many at once."""

from typing import Any, NamedTuple

import numpy as np


class Demand(NamedTuple):
    """Something that numbers have to be, and may not be."""

    text: str  # `<path in the file>: <what was expected>, found {}`
    fits: Any  # whether they are: of many machines an array of shape (m, 1)
    numbers: tuple[Any, ...]  # for the text, in the units of the file

    def refusal(self, machine: int = 0) -> str:
        """The text, of one machine of many."""
        return self.text.format(*(np.broadcast_to(n, np.shape(self.fits)).ravel()[machine] for n in self.numbers))


def of_size(expected: str, value: Any, unit: str = "") -> Demand:
    """The demand that a number is of a size that all models can take."""
    text = f"{expected} from 1e-15{unit} to 1e15{unit}, found {{:g}}{unit}"
    return Demand(text, np.logical_and(value >= 1e-15, value <= 1e15), (value,))

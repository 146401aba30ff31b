"""What the workshop may deviate: numbers of the scene file, by their paths."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any, Literal

from .changes import numbers
from .errors import InputError, nearest

VARIED = ("ground", "bodies", "drive.speed", "loads", "springs", "gravity")  # what machines of one drive may differ in


@dataclass(frozen=True)
class Variation:
    """One number of the scene file that is not always made as drawn, in the units of the file."""

    path: str
    plus_minus: float
    distribution: Literal["normal", "uniform"] = "normal"

    @property
    def deviation(self) -> float:
        """The standard deviation, in the unit of the number: `plus_minus` is three of a normal distribution."""
        return self.plus_minus / (3 if self.distribution == "normal" else sqrt(3))


def check_variations(tables: Mapping[str, Any], variations: Sequence[Variation]) -> None:
    """Check that each variation is of a number of the linkage, and none of the same as another.

    Raises:
        InputError: `variations.<its number>.path: <what was expected>`, for the first that is not.
    """
    paths = [variation.path for variation in variations]
    for number, path in enumerate(paths):
        try:
            if not path.startswith(VARIED):
                raise InputError(f"{path}: expected a number of the linkage{nearest(path, VARIED)}")
            numbers(tables, paths[: number + 1])
        except InputError as error:
            raise InputError(f"variations.{number}.path: {error}") from None

"""The variations of a family: numbers of the scene file by their paths, over a grid of values."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import isfinite, prod

import numpy as np

from scenes import InputError
from scenes.errors import one_line

MAX_MEMBERS = 200  # each takes a second or more, a curve in every figure


@dataclass(frozen=True)
class VariedNumber:
    """One number of the scene file and the values it takes, in the units of the file."""

    path: str
    values: tuple[float, ...]


def variation(text: str) -> VariedNumber:
    """Read `PATH=FROM:TO:COUNT`, evenly spaced values, both ends included; InputError where it is not that."""
    path, _, span = text.partition("=")
    shown = one_line(text, 100)
    try:
        first, last, count = span.split(":")
        start, stop, members = float(first), float(last), int(count)
    except ValueError:
        example = "bodies.rocker.lengths.O-P3=280:320:5"
        raise InputError(f"--vary {shown}: expected PATH=FROM:TO:COUNT, as in {example}") from None
    if not 2 <= members <= MAX_MEMBERS:
        raise InputError(f"--vary {shown}: expected a COUNT from 2 to {MAX_MEMBERS}, found {members}")
    values = np.linspace(start, stop, members).tolist() if isfinite(stop - start) else []
    if len({*values}) < members:
        raise InputError(f"--vary {shown}: expected two different values, FROM and TO, and COUNT of them in all")
    return VariedNumber(path, tuple(values))


def grid(variations: Sequence[VariedNumber]) -> list[Mapping[str, float]]:
    """Every member's changes, path -> value: all combinations, the last path fastest; InputError for too many."""
    count = prod(len(variation.values) for variation in variations)
    if count > MAX_MEMBERS:
        raise InputError(f"--vary: expected {MAX_MEMBERS} members at most, found {count}")
    paths = [variation.path for variation in variations]
    if twice := [path for path in paths if paths.count(path) > 1]:
        raise InputError(f"--vary {one_line(twice[0], 100)}: expected each number once")
    return [dict(zip(paths, values, strict=True)) for values in product(*(v.values for v in variations))]

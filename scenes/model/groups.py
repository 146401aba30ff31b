"""Which of a linkage's equations are solved together, and in what order: for those who solve all of them at once.

The rows and columns of a square matrix can be ordered so that it is lower block triangular (Dulmage and Mendelsohn). Of
the constraints of a linkage the diagonal blocks are the bodies that move together, a crank, a dyad, a larger Assur
group, each solved when those before it are: the work is linear in their number. No number of the matrix is looked at.
"""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import NamedTuple, TypeAlias

import numpy as np

Pattern: TypeAlias = Sequence[Sequence[int]]  # by row the columns where an entry may be other than zero


class DiagonalBlock(NamedTuple):
    """A diagonal block: its rows and columns, and the columns to the left where those rows have entries too."""

    rows: Sequence[int]
    columns: Sequence[int]
    left: Sequence[int]


def groups(pattern: Pattern) -> list[DiagonalBlock]:
    """The diagonal blocks of a square matrix in their order; one for all where there is none.

    Every unknown is matched to an equation that has it. It needs the other unknowns of that equation, and those that
    they need; unknowns that need each other are one block.
    """
    count = len(pattern)
    equation = _matched(pattern)
    if len(equation) < count:
        return [DiagonalBlock(range(count), range(count), [])]
    needs = np.eye(count, dtype=np.float32)
    for unknown, row in equation.items():
        needs[unknown, pattern[row]] = 1
    for _ in range(count.bit_length()):
        needs = np.minimum(needs @ needs, 1)
    first = np.argmax(needs * needs.T, axis=1)  # of the unknowns that need each other
    order = sorted(range(count), key=lambda unknown: (needs[unknown].sum(), first[unknown]))
    blocks = []
    for columns in ([*members] for _, members in groupby(order, key=lambda unknown: first[unknown])):
        rows = [equation[unknown] for unknown in columns]
        left = {column for row in rows for column in pattern[row]}.difference(columns)
        blocks.append(DiagonalBlock(rows, columns, sorted(left)))
    return blocks


def _matched(pattern: Pattern) -> Mapping[int, int]:
    """By column a row of its own that has an entry there, for as many as possible: by augmenting paths."""
    owner, owned = dict[int, int](), dict[int, int]()  # by column its row, by row its column
    for start in range(len(pattern)):
        came, reached = dict[int, int](), [start]  # by column the row that leads to it
        for row in reached:
            new = [column for column in pattern[row] if column not in came]
            came |= dict.fromkeys(new, row)
            free = next((column for column in new if column not in owner), None)
            if free is None:
                reached += [owner[column] for column in new]
                continue
            while free is not None:  # every row on the way gives up its column for the one that it led to
                row = came[free]
                owner[free], (owned[row], free) = row, (free, owned.get(row))
            break
    return owner

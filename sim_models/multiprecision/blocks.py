"""A linkage's Jacobian in block triangular form, and the solution of its equations block by block.

A constraint is between two or three bodies. Rows and columns can be ordered so that the matrix is lower block
triangular (Dulmage and Mendelsohn): the diagonal blocks are the groups of bodies that move together, a crank, a dyad, a
larger Assur group, each solved when those before it are. The work is linear in the number of groups.
"""

from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from flint import arb, arb_mat

Pattern: TypeAlias = Sequence[Sequence[int]]  # by row the columns where an entry may be other than zero


Group: TypeAlias = tuple[Sequence[int], Sequence[int]]  # rows and columns of a diagonal block


class Block(NamedTuple):
    """A diagonal block: its rows and columns, and by row the columns to the left of it."""

    rows: Sequence[int]
    columns: Sequence[int]
    left: Pattern


class Blocks:
    """How square matrices of one pattern are solved."""

    def __init__(self, pattern: Pattern) -> None:
        self.blocks = _ordered(pattern, _groups(pattern))
        transposed = [[i for i, row in enumerate(pattern) if j in row] for j in range(len(pattern))]
        self._transposed = _ordered(transposed, [(block.columns, block.rows) for block in reversed(self.blocks)])

    def solve(self, matrix: arb_mat, right: arb_mat, **how: Any) -> arb_mat:
        """Return the solution for a column, `how` as for FLINT's matrices.

        Raises:
            ZeroDivisionError: a block is singular, or is not proven to be regular.
        """
        return _solved(self.blocks, matrix, right, **how)

    def solve_transposed(self, matrix: arb_mat, right: arb_mat) -> arb_mat:
        """Return the solution for a column with the transpose of a matrix, see `solve`."""
        return _solved(self._transposed, matrix.transpose(), right)


def _solved(blocks: Sequence[Block], matrix: arb_mat, right: arb_mat, **how: Any) -> arb_mat:
    """Return the solution by forward substitution."""
    found = arb_mat(right.nrows(), 1)
    for rows, columns, left in blocks:
        known = (sum((matrix[i, j] * found[j, 0] for j in row), arb(0)) for i, row in zip(rows, left, strict=True))
        diagonal = arb_mat(len(rows), len(columns), [matrix[i, j] for i in rows for j in columns])
        given = arb_mat(len(rows), 1, [right[i, 0] - done for i, done in zip(rows, known, strict=True)])
        for j, value in zip(columns, diagonal.solve(given, **how).entries(), strict=True):
            found[j, 0] = value
    return found


def _ordered(pattern: Pattern, groups: Sequence[Group]) -> list[Block]:
    """Return the blocks of groups of rows and columns that are in their order."""
    return [
        Block(rows, columns, [[j for j in pattern[i] if j not in columns] for i in rows]) for rows, columns in groups
    ]


def _groups(pattern: Pattern) -> list[Group]:
    """Return rows and columns of the diagonal blocks in their order; one for all where there is none.

    Every unknown is matched to an equation that has it. It needs the other unknowns of that equation, and those that
    they need; unknowns that need each other are one block.
    """
    count = len(pattern)
    equation = _matched(pattern)
    if len(equation) < count:
        return [(range(count), range(count))]
    needs = np.eye(count, dtype=np.float32)
    for unknown, row in equation.items():
        needs[unknown, pattern[row]] = 1
    for _ in range(count.bit_length()):
        needs = np.minimum(needs @ needs, 1)
    first = np.argmax(needs * needs.T, axis=1)  # of the unknowns that need each other
    order = sorted(range(count), key=lambda unknown: (needs[unknown].sum(), first[unknown]))
    blocks = ([*members] for _, members in groupby(order, key=lambda unknown: first[unknown]))
    return [([equation[unknown] for unknown in members], members) for members in blocks]


def _matched(pattern: Pattern) -> Mapping[int, int]:
    """Return by column a row of its own that has an entry there, for as many as possible: by augmenting paths."""
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

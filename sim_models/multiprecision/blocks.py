"""The solution of a linkage's equations group by group, see `scenes.groups`, in balls."""

from collections.abc import Sequence
from typing import Any

from flint import arb_mat

from scenes.groups import Group

AT_ONCE = 16  # equations: of so few at 50 digits, FLINT eliminates all in less time than their blocks are taken apart


def solved(groups: Sequence[Group], matrix: arb_mat, right: arb_mat, **how: Any) -> arb_mat:
    """Return the solution for a column by forward substitution, `how` as for FLINT's matrices.

    Raises:
        ZeroDivisionError: a block is singular, or is not proven to be regular.
    """
    if right.nrows() <= AT_ONCE:
        return matrix.solve(right, **how)
    found = arb_mat(right.nrows(), 1)
    for rows, columns, left in groups:
        given = arb_mat(len(rows), 1, [right[i, 0] for i in rows])
        if left:
            given -= _part(matrix, rows, left) * arb_mat(len(left), 1, [found[j, 0] for j in left])
        for j, value in zip(columns, _part(matrix, rows, columns).solve(given, **how).entries(), strict=True):
            found[j, 0] = value
    return found


def _part(matrix: arb_mat, rows: Sequence[int], columns: Sequence[int]) -> arb_mat:
    return arb_mat(len(rows), len(columns), [matrix[i, j] for i in rows for j in columns])

"""Equations solved block by block: the dense solution, and a work that grows with the number of groups alone."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenes
from scenes import Scene
from scenes.model.constraints import groups
from tests import scene_files
from tests.chain import chain

flint = pytest.importorskip("flint")

from sim_models.multiprecision.constraints import LinkageEquations  # noqa: E402
from sim_models.multiprecision.rows import MAX_AT_ONCE, solved  # noqa: E402

SIZES = (1, 3, 6, 1, 2, 5)  # of diagonal blocks: more equations than are solved at once


def shuffled() -> Any:
    """Return a lower block triangular matrix with its rows and its columns in another order, without zero blocks."""
    draw, ends = np.random.default_rng(3), np.repeat(np.cumsum(SIZES), SIZES)
    values = draw.normal(size=(ends[-1], ends[-1]))
    values[np.arange(ends[-1]) >= ends[:, np.newaxis]] = 0
    rows, columns = draw.permutation(ends[-1]), draw.permutation(ends[-1])
    return values[rows][:, columns]


def pattern(values: Any) -> list[list[int]]:
    return [[*map(int, np.flatnonzero(row))] for row in values]


def test_solutions_are_those_of_the_whole_matrix() -> None:
    values = shuffled()
    found = groups(pattern(values))
    assert [len(group.rows) for group in found] == [*SIZES]
    with flint.ctx.workdps(50):
        matrix, right = flint.arb_mat(values.tolist()), flint.arb_mat([[k] for k in range(len(values))])
        solution = solved(found, matrix, right)
        assert solution.overlaps(matrix.solve(right))  # both are proven
        assert max(float(ball.rad()) for ball in solution.entries()) <= 1e-40


def test_a_matrix_without_an_order_is_one_block_and_singular_where_it_is() -> None:
    for count in (3, MAX_AT_ONCE + 1):
        values = np.ones((count, count))
        values[:2, 1:] = 0  # two equations for one unknown
        found = groups(pattern(values))
        assert [len(group.rows) for group in found] == [count]
        with pytest.raises(ZeroDivisionError):
            solved(found, flint.arb_mat(values.tolist()), flint.arb_mat([[1]] * count))


def group_sizes(scene: Scene) -> list[int]:
    return [len(group.rows) for group in LinkageEquations(scene).groups]


def test_a_linkage_of_dyads_is_solved_dyad_by_dyad(tmp_path: Path) -> None:
    assert sorted(group_sizes(scenes.load(chain(9, tmp_path)))) == [1, 1, 1] + [6] * 9


def test_bodies_that_need_each_other_are_one_group() -> None:
    assert max(group_sizes(scene_files.load("class_iii"))) == 12  # a triangle on three links

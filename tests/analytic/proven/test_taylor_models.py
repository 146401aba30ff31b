"""Taylor models against exact arithmetic: no true value outside an enclosure, known where it can be, of third order."""

from collections.abc import Callable, Sequence
from functools import partial
from math import isqrt, pi
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

from analytic.recorded.arithmetics.box_line import BoxLine
from analytic.recorded.arithmetics.systems import Matrices, Matrix, stacked
from analytic.recorded.arithmetics.taylor_models import RULES, TaylorModel, hull, parabola_most, point
from analytic.recorded.expressions import Recorder
from tests.comparisons import sampled

from .exact_values import BITS, LIKE, Escape, Place, drawn, drawn_places, escapes, of_box, parabola
from .rules import TRUE, found, known, operands

BOXES = 320  # of a rule, forty of each kind


def test_every_rule_is_tried() -> None:
    """But `middle`, of which any number near is as right: what is made of it is bounded by other rules."""
    assert {*TRUE, "middle"} == set(RULES)


@sampled(6)
@pytest.mark.parametrize("name", TRUE)
def test_no_true_value_escapes(name: str) -> None:
    assert found(name, BOXES) == []


@pytest.mark.study
@pytest.mark.parametrize("name", TRUE)
def test_no_true_value_escapes_from_many_boxes(name: str) -> None:
    assert [escape for seed in range(1, 9) for escape in found(name, 4000, seed)] == []


@pytest.mark.parametrize("name", TRUE)
def test_it_is_known_wherever_it_can_be(name: str) -> None:
    """All is but a quotient by what may be zero, and what has a size at which doubles end."""
    given = operands(name, np.random.default_rng(1), BOXES)
    sizes = np.array([model.most + model.rest for model in given])
    expected: Any = ((sizes == 0) | (sizes > 1e-60)).all(axis=0)  # the fourth power of a divisor has to be a double
    if name == "divide":
        expected &= np.abs(given[1].c[0]) > given[1].radius * (1 + 1e-6)
    assert expected.sum() > BOXES / 2
    assert known(name, given)[expected].all()


def test_a_quotient_by_what_may_be_zero_is_not_known() -> None:
    one = point(np.ones(4), LIKE)
    x = TaylorModel(np.zeros((LIKE, 4)), np.array([1.0, 0.0, 0.5, 0.0]))
    x.c[:3] = [[1.0, 0.0, 1e-9, -1.0], [0.0, 1e-9, 0.0, 0.5], [0.0, 0.0, 0.0, 0.5]]
    assert not known("divide", [one, x]).any()


CURVED: dict[str, Callable[[TaylorModel], TaylorModel]] = {
    "multiply": lambda x: x * x,
    "divide": lambda x: point(1.0, len(x.c)) / x,
    "arctan2": lambda x: RULES["arctan2"](x * x, x),
    **{name: RULES[name] for name in ("sqrt", "sin", "cos", "tanh")},
    "a system": lambda x: _first(solution([x, x * x, -x, point(2.0, len(x.c)), x, x * x * x])),
}


def _first(x: TaylorModel) -> TaylorModel:
    return TaylorModel(x.c[:, 0], x.rest[0])


@pytest.mark.parametrize("name", CURVED)
def test_half_the_box_has_an_eighth_of_the_rest(name: str) -> None:
    """Parabolas leave a rest of the third order."""
    width = 2.0 ** -np.arange(3, 9)
    x = TaylorModel(np.array([0.7 + 0 * width, width, 0.4 * width**2]), np.zeros(len(width)))
    rest = CURVED[name](x).rest
    order = np.log2(rest[:-1] / rest[1:])
    assert np.abs(order[-1] - 3) <= 0.1  # of terms of higher order, which halve too, in a box of 1/128
    assert (order >= 2.8).all()


def test_constants_are_meant_as_they_are_in_mathematics() -> None:
    make = Recorder(proven=True)
    values: dict[float, Callable[[], Any]] = {pi: arb.pi, 1 / 36: lambda: arb(1) / 36, 0.25: lambda: arb(1) / 4}
    models = BoxLine([make.constant(value) for value in values], 3, {})({})
    with ctx.workprec(BITS):
        for true, model in zip(values.values(), models, strict=True):
            assert abs(true() - arb(float(model.c[0, 0]))) <= arb(float(model.rest[0]))
    assert models[-1].rest[0] == 0  # a whole number of 4096ths is that number


@pytest.mark.parametrize("width", [1.0, 1e-3, 1e-9])
def test_what_lies_between_bounds_is_in_their_hull(width: float) -> None:
    chance = np.random.default_rng(0)
    low = chance.uniform(-1, 1, 300) * 10.0 ** chance.uniform(-9, 9, 300)
    high = low + np.abs(low) * width * chance.uniform(0, 1, 300)
    model = hull(low, high, 3)
    with ctx.workprec(BITS):
        for n, ends in enumerate(zip(low.tolist(), high.tolist(), strict=True)):
            c, rest = of_box(model, n)
            assert all(abs(arb(end) - arb(c[0])) <= arb(rest) for end in ends)


def test_the_most_of_a_parabola() -> None:
    """Against values at many places; doubles' roundings are far below 1e-12 of its terms."""
    c = drawn(np.random.default_rng(3), BOXES).c[:3]
    s = np.linspace(-1, 1, 2001)[:, np.newaxis]
    values = c[0] + c[1] * s + c[2] * s * s
    sizes = np.abs(c).sum(axis=0)
    most = parabola_most(c)
    assert (most >= values.max(axis=0) - 1e-12 * sizes).all()
    assert (
        most <= values.max(axis=0) + 1e-6 * sizes
    ).all()  # a top between places: a quarter of their distance squared


WIDE = 1.0  # where a matrix' rest is most of it


def systems(chance: np.random.Generator, k: int, count: int, least: float) -> list[TaylorModel]:
    """The entries of A, which most have an inverse, and of b."""
    entries = [drawn(chance, count) for _ in range(k * k + k)]
    share = 10.0 ** chance.uniform(-9, -0.3, count)
    for number, one in enumerate(entries):
        size = 10.0 ** chance.uniform(-2, 1, count)
        one.c[0] = size * chance.choice([-1, 1], count) * (3 if number % (k + 1) == 0 and number < k * k else 1)
        one.c[1:] = chance.uniform(-1, 1, (LIKE - 1, count)) * size * share ** np.array([[1], [2], [1], [1]])
        one.rest = size * np.maximum(share, least) * chance.uniform(0, 1, count) * chance.integers(0, 2, count)
    return [TaylorModel(one.c, one.rest) for one in entries]


def solution(entries: Sequence[TaylorModel]) -> TaylorModel:
    """The x of A x = b, given the entries of A, row by row, and of b."""
    k, make = isqrt(len(entries)), Recorder()
    places = Matrix([make.input(str(number), sampled=True) for number in range(k * k)])
    return Matrices(places, stacked(entries[: k * k])).solution(stacked(entries[k * k :]))


def solution_row(k: int, row: int, *values: Any) -> Any:
    """One of the unknowns of a system by its entries, exactly."""
    A, b = arb_mat(k, k, values[: k * k]), arb_mat(k, 1, values[k * k :])
    return A.solve(b).entries()[row]


def escapes_of_systems(k: int, least: float = 0.0) -> list[Escape]:
    """The escapes of solutions of k equations."""
    chance = np.random.default_rng(k)
    given = systems(chance, k, 60, least)
    with np.errstate(all="ignore"):
        made = solution(given)
    places = {box: drawn_places(chance, len(given), 4) for box in range(60)}
    rows = [TaylorModel(made.c[:, row], made.rest[row]) for row in range(k)]
    assert all(np.isfinite(one.rest).sum() > 30 for one in rows)  # the others may be singular in their boxes
    return [
        escape for row, one in enumerate(rows) for escape in escapes(one, partial(solution_row, k, row), given, places)
    ]


@pytest.mark.parametrize("k", [1, 2, 4])
def test_linear_equations(k: int) -> None:
    assert escapes_of_systems(k) == []


def test_an_equation_of_a_wide_rest() -> None:
    assert escapes_of_systems(1, WIDE) == []


def maybe_singular() -> bool:
    """Whether equations with zero among their matrices' determinants are not known.

    Each entry of the diagonal may be zero, so that all bounds of the matrix have the wrong sign.
    """
    maybe = point(np.ones(3), 3, np.full(3, 3.0))
    zero, one = point(0.0, 3), point(1.0, 3)
    return bool(np.isnan(solution([maybe, zero, zero, maybe, one, one]).rest).all())


def test_equations_that_may_be_singular_are_not_known() -> None:
    assert maybe_singular()


def test_a_model_holds_its_own_values() -> None:
    """The check itself: a rest that is too small by a share of 1e-15 is an escape, at the place where it is."""
    x = TaylorModel(np.array([[1.0], [0.5], [0.25], [0.0], [0.0]]), np.array([0.125]))
    end = Place(1.0, (0.0, 0.0), (1.0,))
    assert [*escapes(x, lambda x: x, [x], [end])] == []
    assert [one.place for one in escapes(TaylorModel(x.c, x.rest * (1 - 1e-15)), lambda x: x, [x], [end])] == [end]
    assert float(parabola(x.c[:, 0].tolist(), end)) == 1.75

"""What the tests are worth: arithmetic with a term left out lets a true value escape, which the same checks find."""

import inspect
from textwrap import dedent
from typing import Any, NamedTuple

import pytest

from analytic.recorded.arithmetics import systems, taylor_models
from analytic.recorded.arithmetics.taylor_models import RULES, TaylorModel
from tests.comparisons import sampled

from .exact_values import Escape
from .rules import TRUE, found
from .test_taylor_models import WIDE, escapes_of_systems, maybe_singular

BOXES = 1600  # at most, a few hundred at a time


class Mutation(NamedTuple):
    """A part of a function's text, and what is there instead."""

    of: Any  # a module, or a class
    name: str
    text: str
    instead: str


def mutate(monkeypatch: pytest.MonkeyPatch, mutation: Mutation) -> None:
    """Put a mutated function in its place, and in that of the rule that it is."""
    before: Any = inspect.getattr_static(mutation.of, mutation.name)
    function: Any = before.fget if isinstance(before, property) else before
    source = dedent(inspect.getsource(function))
    assert source.count(mutation.text) == 1, source
    made: dict[str, Any] = {}
    module = mutation.of if inspect.ismodule(mutation.of) else inspect.getmodule(mutation.of)
    exec(source.replace(mutation.text, mutation.instead), vars(module), made)
    monkeypatch.setattr(mutation.of, mutation.name, made[mutation.name])
    for rule, function in RULES.items():
        if function is before:
            monkeypatch.setitem(RULES, rule, made[mutation.name])


def escaped(rule: str) -> list[Escape]:
    """The first escapes of a rule that are found."""
    return next((escapes for seed in range(BOXES // 200) if (escapes := found(rule, 200, seed))), [])


MODEL = TaylorModel
LEFT_OUT: dict[str, tuple[tuple[Any, str, str, str], tuple[str, ...]]] = {
    "a sum's rounding": ((taylor_models, "_rounded", "ROUNDED * made.most", "0.0"), ("add", "subtract")),
    "a product's rounding": ((MODEL, "__mul__", "ROUNDED * other_most", "0.0"), ("multiply",)),
    "what a product drops": ((MODEL, "__mul__", "dropped + ", ""), ("multiply",)),
    "a product of two slopes": ((MODEL, "__mul__", "c[2] += a[1] * b[1]", "pass"), ("multiply",)),
    "a product of parameters": ((MODEL, "__mul__", " + bent * other_moving", ""), ("multiply",)),
    "a product of two rests": ((MODEL, "__mul__", "(other_most + other.rest)", "other_most"), ("multiply",)),
    "what underflows": ((MODEL, "__mul__", " + UNDERFLOW", ""), ("multiply",)),
    "the third derivative": (
        (taylor_models, "_composed", " + third * D**3", ""),
        ("sin", "cos", "tanh", "sqrt", "divide", "arctan2"),
    ),
    "what the square drops": ((taylor_models, "_composed", "2 * sizes[1] + k", "k"), ("sin", "divide")),
    "the square of a rest": ((taylor_models, "_composed", "2 * moving + rest", "0.0"), ("sin", "divide")),
    "a function's last place": (
        (taylor_models, "_composed", " + FUNCTION * np.abs(f0)", ""),
        ("sin", "cos", "tanh"),
    ),
    "a slope's last place": ((taylor_models, "_composed", "rest + FUNCTION * D)", "rest)"), ("tanh",)),
    "a divisor that may be zero": ((taylor_models, "_reciprocal", "least > 0", "c0 != 0"), ("divide",)),
    "a divisor's least": ((taylor_models, "_reciprocal", "1 / least**4", "1 / c0**4"), ("divide",)),
    "a radicand's least": ((taylor_models, "_sqrt", "(16 * low**2 * np.sqrt(low))", "(16 * high**2.5)"), ("sqrt",)),
    "a bound's rounding": ((MODEL, "range", " + ROUNDED * self.sizes[0]", ""), ("floor", "sqrt")),
    "the branch cut": ((taylor_models, "_arctan2", "(low > -np.pi) & (high < np.pi)", "low == low"), ("arctan2",)),
    "both signs of an absolute value": ((taylor_models, "_absolute", "low >= 0", "x.c[0] >= 0"), ("absolute",)),
    "both of two that may be larger": (
        (taylor_models, "_largest", "_either(low >= 0", "_either(apart.c[0] >= 0"),
        ("maximum", "minimum"),
    ),
    "a part of their distance": ((taylor_models, "_largest", "/ 4", "/ 5"), ("maximum", "minimum")),
    "what is not decided": (
        (taylor_models, "_truth", "yes | no, 0.0, 0.5", "yes | no, 0.0, 0.0"),
        ("less", "less_equal"),
    ),
    "one of two that are chosen from": ((taylor_models, "_where", "np.minimum(a, c)", "a"), ("where",)),
}
CONSTANTS = {"ROUNDED": (0.0, "add"), "FUNCTION": (0.0, "sin"), "UP": (1.0, "add"), "UNDERFLOW": (0.0, "multiply")}
SYSTEMS = {
    "the rest of a matrix": (systems, "gains", " + rest + ", " + "),
    "the rest of what is open": (systems, "contracted", "left.most + left.rest", "left.most"),
}


@sampled(8)
@pytest.mark.parametrize("what", LEFT_OUT)
def test_what_is_left_out_is_an_escape(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    mutation, rules = LEFT_OUT[what]
    mutate(monkeypatch, Mutation(*mutation))
    assert [rule for rule in rules if not escaped(rule)] == []


@sampled(2)
@pytest.mark.parametrize("name", CONSTANTS)
def test_no_constant_is_for_nothing(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    value, rule = CONSTANTS[name]
    monkeypatch.setattr(taylor_models, name, value)
    if name == "UP":  # what underflows is more than its share of small rests
        monkeypatch.setattr(taylor_models, "UNDERFLOW", 0.0)
    assert escaped(rule)


def test_what_is_within_something_is_an_escape_without_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(RULES, "within", lambda x, _: x)
    assert escaped("within")


@pytest.mark.parametrize("what", SYSTEMS)
def test_what_is_left_out_of_equations_is_an_escape(what: str, monkeypatch: pytest.MonkeyPatch) -> None:
    mutate(monkeypatch, Mutation(*SYSTEMS[what]))
    assert escapes_of_systems(2) or escapes_of_systems(1, WIDE)


def test_bounds_of_the_wrong_sign_are_no_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the sign's check a matrix that may be singular has a solution."""
    assert maybe_singular()
    mutate(monkeypatch, Mutation(systems, "contracted", "(d > 0) & ", ""))
    assert not maybe_singular()


def test_every_rule_has_a_mutation() -> None:
    """But what has nothing to leave out: a sign."""
    tried = {rule for _, rules in LEFT_OUT.values() for rule in rules} | {"within"}
    assert set(TRUE) - tried == {"negative"}

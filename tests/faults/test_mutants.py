"""Wrong lines are put in place and taken away again."""

import numpy as np
import pytest

from scenes.elements.loads import PressForce
from tests.faults.mutants import Mutant, applied, mutants

PRESS = PressForce("slider", "P5", (0.0, 1.0), last=1.0, closing=-1)
ACTS = mutants("scenes.elements.loads", ("PressForce.acts",))


def acts() -> list[bool]:
    return list(PRESS.acts(np.array([0.0, 0.5, 2.0]), np.array([-1.0, 1.0, -1.0]), end=0.0))


@pytest.mark.parametrize("mutant", [one for one in ACTS if one.kind == "comparison"], ids=lambda one: str(one.number))
def test_a_wrong_line_changes_what_is_called_and_nothing_stays_of_it(mutant: Mutant) -> None:
    with applied(mutant):
        assert acts() != [True, False, False]
    assert acts() == [True, False, False]


def test_every_kind_of_wrong_line() -> None:
    modules = (
        "scenes.elements.loads",
        "scenes.drive",
        "compare.judge.checks",
        "compare.judge.errors",
        "compare.engines.runner",
    )
    kinds = {one.kind for module in modules for one in mutants(module)}
    assert kinds == {
        "operator",
        "sign dropped",
        "comparison",
        "constant",
        "condition",
        "abs dropped",
        "name",
        "result",
        "row",
    }

"""Every engine on loads, springs and drives of every kind, against the formulas of the tables."""

import re
from functools import cache

import numpy as np
import pytest

from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.elements import ALL_KINDS, LISTS, PLAIN_KINDS
from tests.comparisons import SLOW, sampled

from .drives import DRIVES
from .elements import ELEMENTS
from .engines import ENGINES, Held, by_name, every, on_each
from .row import Row, difference, without_elements
from .springs import SPRINGS

ROWS: dict[str, Row] = {**ELEMENTS, **SPRINGS, **DRIVES}
SAMPLES = 24


@cache
def before(held: Held, scene: Scene, sampling: Sampling) -> Motion:
    return held.run(scene, sampling)


def check(held: Held, row: Row, scene: Scene) -> None:
    """Of scenes that another setting runs, one may say what it lacks."""
    sampling = Sampling(SAMPLES, row.turns)
    motion = held.outcome(scene, sampling)
    if isinstance(motion, Failure):
        assert held.refuses, motion.reason
        assert motion.status is Status.unsupported
        assert re.search(held.refuses, motion.reason)
        return
    assert set(motion.samples) >= set(scene.channels.names())
    for place, apart in row.places(motion).items():
        assert not np.abs(apart).max() > held.places, place
    added = difference(motion, before(held, without_elements(scene), sampling), scene) if row.added else motion
    for force, (apart, size) in row.forces(motion, added).items():
        tolerance = min(max(held.forces, row.least), row.most.get(force, np.inf))
        assert not np.abs(apart).max() > tolerance * size, (force, np.abs(apart).max() / size)


@sampled(40)
@on_each(ROWS, [held for held in ENGINES if held.knows_all])
def test_channels_are_those_of_the_formulas(held: Held, name: str) -> None:
    check(held, ROWS[name], ROWS[name].scene())


@every(held for held in ENGINES if not held.knows_all)
def test_channels_of_the_kinds_that_an_engine_knows_are_those_of_the_formulas(held: Held) -> None:
    rows = [row for row in ROWS.values() if row.scene().kinds <= held.module.KINDS]
    assert len(rows) >= 2
    for row in rows:
        check(held, row, row.scene())


def test_the_table_has_every_kind() -> None:
    kinds = frozenset.union(*(row.scene().kinds for row in ROWS.values()))
    assert kinds >= ALL_KINDS - PLAIN_KINDS - {"friction"}


def another(scene: Scene) -> Scene:
    """The scene with each number of its loads and springs off by a thousandth; where it has none, of its bodies."""
    named = [path for path in scene.numbers if path.startswith((*LISTS,))]
    of = named or [path for path in scene.numbers if path.startswith("bodies")]
    return scene.with_numbers({path: 1.001 * scene.numbers[path].value or 0.01 for path in of})


@SLOW
@pytest.mark.parametrize("name", ROWS)
def test_a_scene_that_is_another_is_noticed(name: str) -> None:
    row, (held,) = ROWS[name], by_name("analytic")
    with pytest.raises(AssertionError):
        check(held, row, another(row.scene()))

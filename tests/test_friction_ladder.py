"""Ladders of coefficients from 0 to beyond the jam: every engine's status, place and factor, and its values.

What is expected is by the tests' own equations, or by a formula. A pin has r sin(arctan(factor mu)), so how far a
position is followed from no friction on depends on the product alone: one jam, by its coefficient, at each position.
"""

import re
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from compare.engines import registry
from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.fields import put
from scenes.model.motion import Samples
from tests import absolute_forces, scene_files
from tests.absolute_coordinates import solve
from tests.absolute_friction import SEVERAL, JammedError, resisted
from tests.agreement import FORCES, errors, worst
from tests.friction_scenes import everywhere

SAMPLING = Sampling(8)
TOP = 16.0  # a coefficient with which all of the scenes jam somewhere
RUNGS = (0.0, 0.5, 0.95, 1.05, 2.0)  # times the least coefficient that jams


class Held(NamedTuple):
    """An engine, its setting, and what it can be held to."""

    engine: str
    setting: str
    tolerance: float  # without friction, of forces, on the scale of `errors`
    digits: float  # relative, of the jam's factor: half of the last digit of its reason, or none is named


ENGINES = (
    Held("analytic", "DEFAULT", FORCES, 5e-6),
    Held("multiprecision", "DEFAULT", FORCES, 5e-6),
    Held("exudyn", "EXACT", 1e-9, 5e-4),  # as of its own tests, as the next two are
    Held("exudyn", "DEFAULT", 1e-4, 5e-4),
    Held("pymunk", "DEFAULT", 2e-3, np.inf),
    Held("pymunk", "EXACT", 2e-6, np.inf),
)


def each(*engines: Held) -> pytest.MarkDecorator:
    """Each of some engines; a second setting of one is left to the study."""
    first = {held.engine: held for held in reversed(engines)}.values()
    marks = [() if held in first else (pytest.mark.study,) for held in engines]
    names = [f"{held.engine} {held.setting.lower()}" for held in engines]
    every = (pytest.param(held, id=name, marks=mark) for held, name, mark in zip(engines, names, marks, strict=True))
    return pytest.mark.parametrize("held", [*every])


SLOW = ("double_toggle_clamp", "wedge")
STUDY = ("carried_block", "toggle_press", "crank_press", "rocking_guide", "lift", "three_at_a_pin", "quick_return")
MARKED = [pytest.param(name, marks=pytest.mark.slow) for name in SLOW]
MARKED += [pytest.param(name, marks=pytest.mark.study) for name in STUDY]
by_scene = pytest.mark.parametrize("name", ["two_rods", *MARKED])  # it jams in two parts of its own


def run(held: Held, scene: Scene) -> Motion:
    pytest.importorskip(registry.ENTRIES[held.engine].package)
    engine = registry.engine(held.engine)
    simulation = engine.build(scene, getattr(engine, held.setting), SAMPLING)
    simulation.solve()
    motion: Motion = simulation.read()
    return motion


def outcome(held: Held, scene: Scene) -> Motion | Failure:
    try:
        return run(held, scene)
    except Failure as failure:
        return failure


def own(scene: Scene, rows: slice = slice(None)) -> dict[str, Any]:
    """Its motion at some samples from equations written in the tests."""
    times = SAMPLING.times(scene)[rows]
    return solve(scene, *scene.drive.law.at(times), times)


@cache
def referred(name: str, coefficient: float) -> dict[str, Any]:
    return own(everywhere(scene_files.load(name), coefficient))


@cache
def jams(name: str) -> Samples:
    """The coefficient in all joints from which friction holds the linkage, by sample; infinite where none does."""
    scene, found = everywhere(scene_files.load(name), TOP), np.full(SAMPLING.count, np.inf)
    for row in range(SAMPLING.count):
        try:
            own(scene, slice(row, row + 1))
        except JammedError as jam:
            found[row] = TOP * jam.factor
    return found


def several(scene: Scene, where: str) -> bool:
    """Whether the tests' own equations have more than one solution at the first sample of that name."""
    found: list[float] = []

    def searched(A: Any, b: Any, joints: Any) -> Any:
        x, acting = resisted(A, b, joints)
        found.append(acting[SEVERAL])
        return x, acting

    row = [scene.where(float(at)) for at in SAMPLING.commanded(scene)].index(where)
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(absolute_forces, "resisted", searched)
        own(scene, slice(row, row + 1))
    return found == [True]


@pytest.mark.slow
@each(*ENGINES)
@by_scene
def test_every_rung(held: Held, name: str) -> None:
    """Where the core finds several solutions, the tests' equations do; the others have that which is followed."""
    jam, plain = jams(name), scene_files.load(name)
    assert jam.min() < np.inf
    for rung in RUNGS:
        coefficient = rung * float(jam.min())
        scene = everywhere(plain, coefficient)
        if rung < 1:
            ended = outcome(held, scene)
            if isinstance(ended, Failure):
                assert (held.engine, ended.status) == ("analytic", Status.undetermined), rung
                assert several(scene, ended.reason.partition(" forces at ")[2]), rung
                continue
            off = max(worst(errors(ended, referred(name, coefficient))).values())
            # Forces grow as 1 / (1 - rung), and so does what they are relatively off by.
            assert not off > held.tolerance / (1 - rung), rung
            continue
        ended = outcome(held, scene)
        assert isinstance(ended, Failure), rung
        assert ended.status is Status.jammed, rung
        first = int(np.argmax(jam < coefficient))
        assert scene.where(float(SAMPLING.commanded(scene)[first])) in ended.reason, rung
        named = re.search(r"(?:past|from|passes with) ([0-9.e-]+) of", ended.reason)
        assert (named is None) == (held.digits == np.inf)
        assert named is None or not abs(float(named[1]) * coefficient / jam[first] - 1) > held.digits, rung


@pytest.mark.slow
@by_scene
def test_the_joint_that_the_core_names_frees_it(name: str) -> None:
    """By that coefficient alone, as by the tests' own equations; where two parts jam, none is named."""
    jam = jams(name)
    for rung in RUNGS[3:]:
        scene = everywhere(scene_files.load(name), rung * float(jam.min()))
        ended = outcome(ENGINES[0], scene)
        assert isinstance(ended, Failure)
        first = int(np.argmax(jam < rung * jam.min()))
        found = re.search(r"with ([0-9.e-]+) instead of \S+ at (\S+) alone", ended.reason)
        joints = {one.channel(scene).rpartition(".")[0]: number for number, one in enumerate(scene.friction)}

        def passes(number: int, coefficient: float, scene: Scene = scene, row: int = first) -> bool:
            try:
                own(put(scene, {("friction", number, "coefficient"): coefficient}), slice(row, row + 1))
            except JammedError:
                return False
            return True

        if found is None:
            assert not any(passes(number, 0.0) for number in joints.values()), rung
        else:
            share = float(found[1])  # of four digits
            assert passes(joints[found[2]], (1 - 1e-3) * share), rung
            assert not passes(joints[found[2]], (1 + 1e-3) * share), rung

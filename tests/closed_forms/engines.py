"""The engines, at the settings that the tables hold, and how near each comes to a formula."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import pytest

from compare.engines import registry
from scenes import Failure, Motion, Request, Scene, Settings
from tests.comparisons import SLOW


class Held(NamedTuple):
    """An engine at a setting, and what it is held to."""

    name: str
    engine: str
    setting: Callable[[Any], Settings]  # of the engine's module
    forces: float  # of a row's size: what roundings, differences or steps leave of loads, springs and drives
    places: float  # m and rad
    friction: float = np.inf  # on the scale of `tests.agreement.errors`; infinite where it is not held to any
    slow: bool = False  # a second setting of an engine
    refuses: str = ""  # a part of the reason with which it refuses scenes that others run
    knows_all: bool = True  # kinds

    @property
    def module(self) -> Any:
        pytest.importorskip(registry.ENTRIES[self.engine].package)
        return registry.engine(self.engine)

    def run(self, scene: Scene, request: Request) -> Motion:
        simulation = self.module.build(scene, self.setting(self.module), request)
        simulation.solve()
        motion: Motion = simulation.read()
        return motion

    def outcome(self, scene: Scene, request: Request) -> Motion | Failure:
        try:
            return self.run(scene, request)
        except Failure as failure:
            return failure


LIGHT = "cannot (move|turn) a body"  # of no mass, at this setting

ENGINES = (
    Held("50 digits", "multiprecision", lambda of: of.DEFAULT, 1e-14, 1e-14, 1e-12),
    Held("analytic", "analytic", lambda of: of.DEFAULT, 1e-12, 1e-13, 1e-12),
    Held("exudyn pointwise", "exudyn", lambda of: of.EXACT, 1e-9, 1e-12, 1e-9),  # measured 1e-10, by differences
    Held("exudyn steps", "exudyn", lambda of: of.DEFAULT, 1e-5, 1e-12, 1e-4, slow=True),
    Held("exudyn reduced", "exudyn", lambda of: replace(of.DEFAULT, reduced=True), 1e-5, 1e-12, slow=True),
    Held("exudyn in space", "exudyn", lambda of: of.ABLATIONS[-1], 2e-4, 1e-12, slow=True, refuses="no joint in space"),
    Held("pymunk", "pymunk", lambda of: of.DEFAULT, 1e-5, 1e-5, 2e-3, refuses=LIGHT),  # measured 2e-6, by extrapolation
    Held("pymunk exact", "pymunk", lambda of: of.EXACT, 1e-7, 1e-7, 2e-6, slow=True),
    Held("casadi", "casadi", lambda of: of.DEFAULT, 1e-11, 1e-12, knows_all=False),
    Held("pinocchio", "pinocchio", lambda of: of.DEFAULT, 1e-11, 1e-12, knows_all=False),
    Held("mujoco", "mujoco", lambda of: of.DEFAULT, 1e-2, 1e-2, knows_all=False),  # its promise
)


def every(engines: Iterable[Held] = ENGINES) -> pytest.MarkDecorator:
    """Each of some engines, as the argument `held`."""
    return pytest.mark.parametrize(
        "held", [pytest.param(held, id=held.name, marks=SLOW if held.slow else ()) for held in engines]
    )


def on_each(names: Iterable[str], engines: Iterable[Held]) -> pytest.MarkDecorator:
    """Each of some engines on each scene, as `held` and `name`.

    A second setting of an engine is on every third scene, each setting on others, and on the rest in the study.
    """
    cases = [
        pytest.param(held, name, id=f"{held.name}-{name}", marks=_second(number + shift) if held.slow else ())
        for shift, held in enumerate(engines)
        for number, name in enumerate(names)
    ]
    return pytest.mark.parametrize(("held", "name"), cases)


def _second(number: int) -> pytest.MarkDecorator:
    return SLOW if number % 3 == 0 else pytest.mark.study


def by_name(*names: str) -> tuple[Held, ...]:
    return tuple(held for held in ENGINES if held.name in names)

"""A simulation that starts with wrong velocities heals before its first sample, or says that it did not."""

from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

from compare.engines.reference import Reference
from compare.judge.measure import Measurement, measure
from scenes import Sampling, Settings, Status
from sim_models.exudyn import engine as exudyn_model
from sim_models.exudyn import stepping as exudyn_stepping
from sim_models.exudyn.system import ExudynSystem, engine
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk import start as pymunk_start
from sim_models.pymunk import stepping as pymunk_run

SAMPLING = Sampling(72)
WORTH = {"exudyn": 1e-3, "pymunk": 1e-2}  # what an engine that says ok is worth, as in the hard cases


def spoil_exudyn(monkeypatch: pytest.MonkeyPatch, factor: float) -> None:
    set_initial = exudyn_stepping._set_initial

    def spoilt(model: ExudynSystem, *begin: Any) -> None:
        set_initial(model, *begin)
        state, initial = model.state, engine().ConfigurationType.Initial
        state.SetODE2Coordinates_t(factor * state.GetODE2Coordinates_t(initial), initial)

    monkeypatch.setattr(exudyn_stepping, "_set_initial", spoilt)


def spoil_pymunk(monkeypatch: pytest.MonkeyPatch, factor: float) -> None:
    rates = pymunk_start.rates
    monkeypatch.setattr(pymunk_run, "rates", lambda *of: factor * rates(*of))


Spoil = Callable[[pytest.MonkeyPatch, float], None]
SPOILT: list[tuple[str, Spoil, Settings]] = [
    *(("exudyn", spoil_exudyn, settings) for settings in (exudyn_model.DEFAULT, *exudyn_model.WORK_PRECISION[:5])),
    *(("pymunk", spoil_pymunk, settings) for settings in (pymunk_model.DEFAULT, pymunk_model.EXACT)),
]


@pytest.fixture(scope="module")
def clean(reference: Reference) -> Callable[[str, Settings], Measurement]:
    """Return a function that runs an engine as it is, at each of its settings once."""
    return cache(lambda engine, settings: measure(reference, engine, SAMPLING, settings))


@pytest.mark.parametrize(("engine", "spoil", "settings"), SPOILT, ids=lambda of: getattr(of, "label", ""))
@pytest.mark.parametrize("factor", [1 + 1e-6, 1.1, 0.0, -1.0])
def test_a_wrong_start_is_forgotten_or_told(
    reference: Reference,
    clean: Callable[[str, Settings], Measurement],
    engine: str,
    spoil: Spoil,
    settings: Settings,
    factor: float,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    unspoilt = clean(engine, settings)
    assert unspoilt.run.status is Status.ok
    spoil(monkeypatch, factor)
    spoilt = measure(reference, engine, SAMPLING, settings)
    if spoilt.run.status is Status.ok:  # what has not died away by the first sample is in the estimate, to a tenth
        worth = max(WORTH[engine], 2 * unspoilt.largest, 1.1 * spoilt.estimate)
        assert spoilt.largest <= worth

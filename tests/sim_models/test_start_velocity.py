"""A simulation that starts with wrong velocities heals before its first sample, or says that it did not."""

from collections.abc import Callable
from typing import Any

import pytest

from compare.judge.measure import measure
from compare.mechanics.reference import Reference
from scenes import Sampling, Settings, Status
from sim_models.exudyn import engine as exudyn_model
from sim_models.exudyn.runs import stepping as exudyn_stepping
from sim_models.exudyn.system import ExudynSystem, exudyn
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk import start as pymunk_start
from sim_models.pymunk.runs import stepping as pymunk_run
from tests.comparisons import estimated, sampled

SAMPLING = Sampling(72)
WORTH = {"exudyn": 1e-3, "pymunk": 1e-2}  # what an engine that says ok is worth, as in the hard cases


def spoil_exudyn(monkeypatch: pytest.MonkeyPatch, factor: float) -> None:
    set_initial = exudyn_stepping._set_initial

    def spoilt(model: ExudynSystem, *begin: Any) -> None:
        set_initial(model, *begin)
        state, initial = model.state, exudyn.ConfigurationType.Initial
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


@sampled(1)
@pytest.mark.parametrize(("engine", "spoil", "settings"), SPOILT, ids=lambda of: getattr(of, "label", ""))
def test_a_wrong_start_is_forgotten_or_told(
    reference: Reference, engine: str, spoil: Spoil, settings: Settings
) -> None:
    clean = measure(reference, engine, SAMPLING, settings)
    assert clean.run.status is Status.ok
    for factor in (1 + 1e-6, 1.1, 0.0, -1.0):
        with pytest.MonkeyPatch.context() as patch:
            spoil(patch, factor)
            spoilt = measure(reference, engine, SAMPLING, settings)
        if spoilt.run.status is Status.ok:  # what has not died away by the first sample is in the estimate, to a tenth
            assert spoilt.largest <= max(WORTH[engine], 2 * clean.largest, 1.1 * estimated(spoilt)), factor

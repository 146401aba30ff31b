"""Runs of a speed table that the reference alone shows to be right, which need no checks of their own output."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from compare.engines.registry import settings_of
from compare.engines.runner import HERE, Run
from compare.judge.measure import Standard, assess
from compare.measure.speed import speed_table as table
from compare.measure.speed.speed_table import NO_CLOCK, confirmed, speed_table
from compare.mechanics.reference import Reference
from scenes import Motion, Sampling, Status

from .stubs import quiet

FEW = Sampling(36)


def run_of(reference: Reference, engine: str, label: str, promise: float = 0.1) -> Run:
    (settings,) = (each for each in settings_of(engine, full=False) if each.label == label)
    return HERE.run(engine, reference.scene, FEW, replace(settings, promise=promise))


def held(standard: Standard, run: Run) -> bool:
    return confirmed(standard, assess(standard, run, lambda _: []))


@pytest.mark.parametrize(
    ("engine", "label", "found"),
    [  # largest errors of 2e-6, 1.4e-4, 1e-4, 1.8e-3 of positions, 4e-2 of accelerations; a tenth of 0.1 is enough
        ("analytic", "single precision", True),
        ("analytic", "differences 360", True),
        ("exudyn", "generalised-alpha 0.5, 72+144", True),
        ("exudyn", "trapezoidal, loose Newton, 72", False),
        ("pymunk", "72 steps, 100 sweeps", False),
    ],
)
def test_checks_find_nothing_in_what_is_confirmed(reference: Reference, engine: str, label: str, found: bool) -> None:
    run, standard = run_of(reference, engine, label), Standard.of(reference, FEW)
    assert held(standard, run) is found
    assert assess(standard, run).run.status is Status.ok


def shifted(motion: Motion, channel: str, by: float) -> Motion:
    return Motion({**motion.samples, channel: motion[channel] + by})


@pytest.mark.parametrize(
    "harm",
    [
        lambda motion: shifted(motion, "crank_angle", 1e-8),  # of the drive 1e-9 is promised
        lambda motion: shifted(motion, "P5.y", 3e-3),  # of a travel of 0.15 m: joints may gape by a hundredth
        lambda motion: shifted(motion, "P3.fx", 3e4),  # of a peak of 3e5 N: a hundredth is within a tenth of 0.1
        lambda motion: Motion({**motion.samples, "slider.guide_force": -motion["slider.guide_force"]}),
    ],
    ids=["drive", "place", "force", "sign"],
)
def test_what_is_off_is_not(reference: Reference, harm: Callable[[Motion], Motion]) -> None:
    run, standard = run_of(reference, "analytic", "differences 360"), Standard.of(reference, FEW)
    assert run.motion is not None
    assert not held(standard, replace(run, motion=harm(run.motion)))


def test_nothing_is_where_the_reference_is_not_certified(reference: Reference) -> None:
    run, standard = run_of(reference, "analytic", "differences 360"), Standard.of(reference, FEW)
    assert held(standard, run)
    for floor in (replace(reference.floor, by_channel={}), replace(reference.floor, doubt="a doubt")):
        assert not held(standard._replace(reference=replace(reference, floor=floor)), run)


def test_a_setting_that_promises_more_is_checked(reference: Reference) -> None:
    """Differences of 360 positions leave 1.4e-4 of the accelerations: more than a tenth of 1e-3."""
    run, standard = run_of(reference, "analytic", "differences 360", promise=1e-3), Standard.of(reference, FEW)
    assert not held(standard, run)


def test_what_is_not_confirmed_has_the_status_that_checks_give(
    reference: Reference, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of every row, whether it is checked or not, the status and the errors are those of a row that is."""

    def rows() -> list[tuple[str, str, str, str]]:
        speed = speed_table(reference, ["analytic", "exudyn"], NO_CLOCK, quiet)
        return [(row.setting, row.status, row.reason, str(row.errors)) for row in speed]

    some, checked = rows(), list[int]()
    monkeypatch.setattr(table, "confirmed", lambda *_: checked.append(1))
    assert rows() == some
    assert len(checked) == len(some)

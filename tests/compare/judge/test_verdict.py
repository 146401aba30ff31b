"""Verdicts, statuses and gates: an engine that is wrong must not look right."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

import analytic
from compare.engines import registry
from compare.engines.runner import Run, run
from compare.judge.measure import Measurement, gates, measure
from compare.measure.speed.speed_table import Budget
from compare.mechanics.reference import Reference
from compare.study import study
from scenes import Failure, Motion, Sampling, Settings, Status
from scenes.model.inputs import passing
from tests import scene_files
from tests.comparisons import SAMPLING, Outcome, Plug, Stub, changed, rows_of, sampled, size_of

Measured = Callable[..., Measurement]


@pytest.fixture
def measured(reference: Reference, plug: Plug) -> Measured:
    """Return a function that measures an engine that ends as told."""

    def by_stub(outcome: Outcome, sampling: Sampling = SAMPLING) -> Measurement:
        plug(outcome)
        return measure(reference, "stub", sampling)

    return by_stub


# --- verdicts and statuses --------------------------------------------------------------------------------------------


def test_a_mirrored_linkage_is_a_wrong_branch(reference: Reference, measured: Measured) -> None:
    """The rod assembled upwards: every joint is closed, every law holds, and it is the wrong machine."""
    mirrored = scene_files.load("toggle_press", {"sketch.P5": [0, -400]})
    run = measured(analytic.solve(mirrored, SAMPLING.commanded(reference.scene))).run
    assert run.status is Status.wrong_branch
    assert "P5" in run.reason


@pytest.mark.parametrize(
    ("channel", "by", "status", "of"),
    [("P4.x", 0.05, Status.diverged, "joints of rod"), ("P3.fx", np.nan, Status.nonfinite, "P3.fx")],
)
def test_a_sample_that_is_wrong_is_named(
    motion: Motion, measured: Measured, channel: str, by: float, status: Status, of: str
) -> None:
    run = measured(changed(motion, channel, by)).run
    assert run.status is status
    assert of in run.reason
    assert "at crank angle 200.0000 deg" in run.reason


@sampled(1)
@pytest.mark.parametrize(
    ("outcome", "status", "reason"),
    [
        (Failure(Status.not_converged, "residual 3e-2"), Status.not_converged, "residual 3e-2"),
        (RuntimeError("first line\nsecond line"), Status.crashed, "RuntimeError: first line"),
        (MemoryError(), Status.crashed, "it needed more memory than there is"),
    ],
)
def test_a_failure_is_a_row(reference: Reference, plug: Plug, outcome: Exception, status: Status, reason: str) -> None:
    plug(outcome)
    result = study(reference.scene, ["stub", "analytic"], SAMPLING, Budget(1, 0.0), lambda _: None)
    failed, solved = result.measurements
    assert failed.run.status is status
    assert failed.run.reason.startswith(reason)
    assert solved.run.status is Status.ok
    assert [row.status for row in result.speed][:2] == [status.name, "ok"]


def test_a_dropped_channel_is_noticed(motion: Motion, measured: Measured) -> None:
    rest = {channel: values for channel, values in motion.samples.items() if channel != "P3.fx"}
    assert measured(Motion(rest)).run.status is Status.crashed
    missing = measured(Motion(rest, {"P3.fx": "this engine has no such sensor"})).run
    assert missing.status is Status.unsupported
    assert missing.reason == "P3.fx is missing, which the engine gives elsewhere: this engine has no such sensor"


def test_what_an_engine_gives_nowhere_may_be_missing(
    motion: Motion, measured: Measured, monkeypatch: pytest.MonkeyPatch
) -> None:
    rest = {channel: values for channel, values in motion.samples.items() if channel != "drive.torque"}
    without = Motion(rest, {"drive.torque": "it knows no motor"})
    assert measured(without).run.status is Status.ok
    monkeypatch.setitem(registry.OWN, "stub", registry.ENTRIES["stub"])
    assert measured(without).run.status is Status.unsupported


@pytest.mark.parametrize("spoilt", [("crank_angle",), ("time",), ()])
@pytest.mark.parametrize("row", [1, 40, 72])
def test_a_repeated_row_is_noticed(motion: Motion, measured: Measured, spoilt: tuple[str, ...], row: int) -> None:
    """With the drive's channel or the time as they should be, or repeated too."""
    kept, rows = {"time", "crank_angle"} - {*spoilt}, np.arange(SAMPLING.count)
    repeated = np.where(rows == row, row - 1, rows)
    samples = {c: values if c in kept else values[repeated] for c, values in motion.samples.items()}
    assert measured(Motion(samples)).run.status is Status.inconsistent


@pytest.mark.parametrize("late", [1e-8, 1e-3, 0.05])
def test_a_motion_that_is_late_is_noticed(reference: Reference, measured: Measured, late: float) -> None:
    """All of it, the crank angle too: consistent, and not where it was asked to be."""
    scene = reference.scene
    run = measured(reference.at(passing(scene, SAMPLING.commanded(scene) - late, SAMPLING.times(scene)))).run
    assert run.status is Status.inconsistent
    assert f"crank deviates from the commanded position by {late:.1%}"[:52] in run.reason or late < 1e-2


@pytest.mark.parametrize(("share", "status"), [(0.9, Status.ok), (1.1, Status.inaccurate)])
def test_a_run_is_held_to_its_promise(
    reference: Reference,
    motion: Motion,
    measured: Measured,
    monkeypatch: pytest.MonkeyPatch,
    share: float,
    status: Status,
) -> None:
    """By the checks, which know of accelerations, and by the reference alone, where few channels are asked for."""
    monkeypatch.setattr(Stub, "DEFAULT", Settings("stub", promise=1e-3))
    wrong = changed(motion, "P5.ay", share * 1e-3 * size_of(motion, "P5.ay", reference.scale["P5.ay"]))
    assert measured(wrong).run.status is status
    few = replace(SAMPLING, channels=frozenset({"P5.ay"}))
    run = measured(Motion({channel: wrong[channel] for channel in few.wanted(reference.scene)}), few).run
    assert (run.status, run.found_by) == (status, "reference" if status is Status.inaccurate else "")


def test_an_engine_not_installed_is_a_row(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = replace(registry.ENTRIES["pymunk"], package="no_such_package")
    monkeypatch.setitem(registry.ENTRIES, "pymunk", missing)
    outcome = run("pymunk", reference.scene, SAMPLING)
    assert outcome.status is Status.unsupported
    assert "pip install" in outcome.reason


# --- gates ------------------------------------------------------------------------------------------------------------


def missed(reference: Reference, tolerances: Mapping[str, float], measured: Measurement) -> list[bool]:
    scene = replace(reference.scene, tolerances={"stub": tolerances})
    return [gate.missed for gate in gates(scene, [measured])]


GATED = {  # a channel of each quantity, and the group whose tolerance it is held to
    "position": ("P4.x", "P4.y", "rod.angle"),
    "velocity": ("P4.vx", "P4.vy", "rod.omega"),
    "acceleration": ("P4.ax", "P4.ay", "rod.alpha"),
    "reaction": ("P4.fx", "P4.fy", "slider.guide_force", "slider.guide_moment"),
    "torque": ("drive.torque",),
}


@pytest.mark.parametrize(("group", "channel"), [(group, channel) for group, of in GATED.items() for channel in of])
def test_every_channel_is_held_to_its_group(reference: Reference, motion: Motion, group: str, channel: str) -> None:
    rows = rows_of(reference, changed(motion, channel, 1e-3 * reference.scale[channel]))
    held = {other: 0.9e-3 if other == group else 1e-12 for other in GATED}
    of = Measurement(Run("stub", None, Status.ok), None, [], rows)
    assert missed(reference, held, of) == [other == group for other in GATED]
    assert missed(reference, held | {group: 1.1e-3}, of) == [False] * len(GATED)


def test_what_has_no_error_misses_its_gate(reference: Reference, motion: Motion, measured: Measured) -> None:
    assert missed(reference, {"position": 1e9}, measured(Failure(Status.timed_out, "too slow"))) == [True]
    right = measured(motion)
    spoilt = [row._replace(unexplained=np.nan) if row.channel == "P4.y" else row for row in right.errors]
    assert missed(reference, {"position": 1e9}, replace(right, errors=spoilt)) == [True]
    without = replace(right, errors=[row for row in right.errors if row.group != "torque"])
    assert missed(reference, {"torque": 1e9}, without) == [True]


def test_a_gate_shows_the_error_of_the_tables_and_weighs_what_is_unexplained(
    reference: Reference, motion: Motion, measured: Measured
) -> None:
    right = measured(motion)
    errors = [row._replace(max=3e-5 if row.channel == "P4.y" else 1e-6, unexplained=1e-6) for row in right.errors]
    scene = replace(reference.scene, tolerances={"stub": {"position": 2e-6, "velocity": 5e-7}})
    position, velocity = gates(scene, [replace(right, errors=errors)])
    assert (position.error, position.worst, position.missed) == (3e-5, "P4.y", False)
    assert (velocity.error, velocity.missed) == (1e-6, True)
    assert [position.met, velocity.met] == ["met: round-off explains the error", "missed"]


def test_what_an_engine_refused_stays_refused(motion: Motion, measured: Measured) -> None:
    """Its motion is measured all the same, so that one sees whether it was right to refuse; not what is no number."""
    of = measured(Failure(Status.not_converged, "it did not like it", motion))
    assert of.run.status is Status.not_converged
    assert of.largest <= 1e-12
    run = measured(Failure(Status.not_converged, "it did not like it", changed(motion, "P3.fx", np.nan))).run
    assert run.status is Status.not_converged
    assert run.motion is None

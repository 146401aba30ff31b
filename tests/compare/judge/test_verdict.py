"""Verdicts, statuses and gates: an engine that is wrong must not look right."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import analytic
from compare.engines import registry
from compare.engines.runner import Run, run
from compare.judge.errors import compare, error_table
from compare.judge.gates import gates
from compare.judge.measure import Measurement, checked_run, measure
from compare.measure.speed.timing import Budget
from compare.mechanics.reference import Reference
from compare.study import study
from scenes import Failure, Motion, Settings, Status
from tests.comparisons import SAMPLING, Plug, Stub, changed, size_of

# --- verdicts and statuses --------------------------------------------------------------------------------------------


def test_a_mirrored_linkage_is_a_wrong_branch(reference: Reference, plug: Plug) -> None:
    """The rod assembled upwards: every joint is closed, every law holds, and it is the wrong machine."""
    upward = replace(reference.scene.sketch, points={**reference.scene.sketch.points, "P5": (0.0, -0.4)})
    plug(analytic.solve(replace(reference.scene, sketch=upward), SAMPLING.commanded(reference.scene)))
    measured = measure(reference, "stub", SAMPLING)
    assert measured.run.status is Status.wrong_branch
    assert "P5" in measured.run.reason


def test_an_open_joint_is_diverged(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(changed(motion, "P4.x", 0.05))
    measured = measure(reference, "stub", SAMPLING)
    assert measured.run.status is Status.diverged
    assert "at crank angle 200.0000 deg" in measured.run.reason


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


def test_nan_is_nonfinite(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(changed(motion, "P3.fx", np.nan))
    outcome = measure(reference, "stub", SAMPLING).run
    assert outcome.status is Status.nonfinite
    assert "P3.fx" in outcome.reason
    assert "crank angle 200.0000 deg" in outcome.reason


def test_a_dropped_channel_is_noticed(reference: Reference, motion: Motion, plug: Plug) -> None:
    rest = {channel: values for channel, values in motion.samples.items() if channel != "P3.fx"}
    plug(Motion(rest))
    assert measure(reference, "stub", SAMPLING).run.status is Status.crashed
    plug(Motion(rest, {"P3.fx": "this engine has no such sensor"}))
    missing = measure(reference, "stub", SAMPLING).run
    assert missing.status is Status.unsupported
    assert missing.reason == "P3.fx is missing, which the engine gives elsewhere: this engine has no such sensor"


def test_what_an_engine_gives_nowhere_may_be_missing(
    reference: Reference, motion: Motion, plug: Plug, monkeypatch: pytest.MonkeyPatch
) -> None:
    rest = {channel: values for channel, values in motion.samples.items() if channel != "drive.torque"}
    plug(Motion(rest, {"drive.torque": "it knows no motor"}))
    assert measure(reference, "stub", SAMPLING).run.status is Status.ok
    monkeypatch.setitem(registry.ENTRIES, "stub", replace(registry.ENTRIES["stub"], everything=True))
    assert measure(reference, "stub", SAMPLING).run.status is Status.unsupported


@pytest.mark.parametrize("spoilt", [("crank_angle",), ("time",), ()])
@pytest.mark.parametrize("row", [1, 40, 72])
def test_a_repeated_row_is_noticed(
    reference: Reference, motion: Motion, plug: Plug, spoilt: tuple[str, ...], row: int
) -> None:
    """With the drive's channel or the time as they should be, or repeated too."""
    kept = {"time", "crank_angle"} - {*spoilt}
    rows = np.arange(SAMPLING.count)
    repeated = np.where(rows == row, row - 1, rows)
    samples = {c: values if c in kept else values[repeated] for c, values in motion.samples.items()}
    plug(Motion(samples))
    assert measure(reference, "stub", SAMPLING).run.status is Status.inconsistent


@pytest.mark.parametrize("late", [1e-8, 1e-3, 0.05])
def test_a_motion_that_is_late_is_noticed(reference: Reference, plug: Plug, late: float) -> None:
    """All of it, the crank angle too: consistent, and not where it was asked to be."""
    plug(reference.at(SAMPLING.commanded(reference.scene) - late, SAMPLING.times(reference.scene)))
    run = measure(reference, "stub", SAMPLING).run
    assert run.status is Status.inconsistent
    assert f"crank is off where the drive asks it to be by {late:.1%}"[:52] in run.reason or late < 1e-2


@pytest.mark.parametrize(("share", "status"), [(0.9, Status.ok), (1.1, Status.inaccurate)])
def test_a_run_is_held_to_its_promise(
    reference: Reference, motion: Motion, plug: Plug, monkeypatch: pytest.MonkeyPatch, share: float, status: Status
) -> None:
    """By the checks, which know of accelerations, and by the reference alone, where few channels are asked for."""
    monkeypatch.setattr(Stub, "DEFAULT", Settings("stub", promise=1e-3))
    wrong = changed(motion, "P5.ay", share * 1e-3 * size_of(motion, "P5.ay", reference.scale["P5.ay"]))
    plug(wrong)
    assert measure(reference, "stub", SAMPLING).run.status is status
    few = replace(SAMPLING, channels=frozenset({"P5.ay"}))
    plug(Motion({channel: wrong[channel] for channel in few.wanted(reference.scene)}))
    run = measure(reference, "stub", few).run
    assert (run.status, run.found_by) == (status, "reference" if status is Status.inaccurate else "")


def test_an_engine_not_installed_is_a_row(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = replace(registry.ENTRIES["pymunk"], package="no_such_package")
    monkeypatch.setitem(registry.ENTRIES, "pymunk", missing)
    outcome = run("pymunk", reference.scene, SAMPLING)
    assert outcome.status is Status.unsupported
    assert "pip install" in outcome.reason


# --- gates ------------------------------------------------------------------------------------------------------------


def judged(reference: Reference, tolerances: Mapping[str, float], measured: Measurement) -> list[bool]:
    scene = replace(reference.scene, tolerances={"stub": tolerances})
    return [gate.missed for gate in gates(scene, [measured])]


def test_gates(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(changed(motion, "P3.fx", 1e-3 * reference.scale["P3.fx"]))
    measured = measure(reference, "stub", SAMPLING)
    assert judged(reference, {"reaction": 1.1e-3, "position": 1e-12}, measured) == [False, False]
    assert judged(reference, {"reaction": 0.9e-3, "position": 1e-12}, measured) == [True, False]


GATED = {  # a channel of each quantity, and the group whose tolerance it is held to
    "position": ("P4.x", "P4.y", "rod.angle"),
    "velocity": ("P4.vx", "P4.vy", "rod.omega"),
    "acceleration": ("P4.ax", "P4.ay", "rod.alpha"),
    "reaction": ("P4.fx", "P4.fy", "slider.guide_force", "slider.guide_moment"),
    "torque": ("drive.torque",),
}


@pytest.mark.parametrize(("group", "channel"), [(group, channel) for group, of in GATED.items() for channel in of])
def test_every_channel_is_held_to_its_group(reference: Reference, motion: Motion, group: str, channel: str) -> None:
    wrong = changed(motion, channel, 1e-3 * reference.scale[channel])
    measured = Measurement(
        Run("stub", None, Status.ok), None, [], error_table("stub", compare(reference, SAMPLING, wrong), reference)
    )
    held = {other: 0.9e-3 if other == group else 1e-12 for other in GATED}
    assert judged(reference, held, measured) == [other == group for other in GATED]


def test_what_has_no_error_misses_its_gate(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(Failure(Status.timed_out, "too slow"))
    assert judged(reference, {"position": 1e9}, measure(reference, "stub", SAMPLING)) == [True]
    plug(motion)
    measured = measure(reference, "stub", SAMPLING)
    spoilt = [row._replace(unexplained=np.nan) if row.channel == "P4.y" else row for row in measured.errors]
    assert judged(reference, {"position": 1e9}, replace(measured, errors=spoilt)) == [True]
    without = replace(measured, errors=[row for row in measured.errors if row.group != "torque"])
    assert judged(reference, {"torque": 1e9}, without) == [True]


def test_a_gate_shows_the_error_of_the_tables_and_weighs_what_is_unexplained(
    reference: Reference, motion: Motion, plug: Plug
) -> None:
    plug(motion)
    measured = measure(reference, "stub", SAMPLING)
    errors = [row._replace(max=3e-5 if row.channel == "P4.y" else 1e-6, unexplained=1e-6) for row in measured.errors]
    scene = replace(reference.scene, tolerances={"stub": {"position": 2e-6, "velocity": 5e-7}})
    met, missed = gates(scene, [replace(measured, errors=errors)])
    assert (met.error, met.worst, met.missed) == (3e-5, "P4.y", False)
    assert (missed.error, missed.missed) == (1e-6, True)
    assert [met.met, missed.met] == ["met: round-off explains the error", "missed"]


def test_what_an_engine_refused_stays_refused(reference: Reference, motion: Motion, plug: Plug) -> None:
    """Its motion is measured all the same, so that one sees whether it was right to refuse."""
    plug(Failure(Status.not_converged, "it did not like it", motion))
    measured = measure(reference, "stub", SAMPLING)
    assert measured.run.status is Status.not_converged
    assert measured.largest <= 1e-12


def test_what_is_no_number_is_not_handed_on(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(Failure(Status.not_converged, "it did not like it", changed(motion, "P3.fx", np.nan)))
    outcome = checked_run("stub", reference.scene, SAMPLING)
    assert outcome.status is Status.not_converged
    assert outcome.motion is None

"""Verdicts, statuses and gates: an engine that is wrong must not look right."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import analytic
from compare.engines import registry
from compare.engines.reference import Reference
from compare.engines.runner import Run, run
from compare.judge.errors import compare, error_table
from compare.judge.gates import gates
from compare.judge.measure import Measurement, measure
from compare.speed.timing import Budget
from compare.study import study
from scenes import Failure, Motion, Status
from tests.comparisons import SAMPLING, Plug, changed

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
        (MemoryError(), Status.crashed, "MemoryError"),
    ],
)
def test_a_failure_is_a_row(reference: Reference, plug: Plug, outcome: Exception, status: Status, reason: str) -> None:
    plug(outcome)
    result = study(reference.scene, ["stub", "analytic"], SAMPLING, Budget(1, 0.0), lambda _: None)
    failed, solved = result.measurements
    assert failed.run.status is status
    assert failed.run.reason.startswith(reason)
    assert solved.run.status is Status.ok
    assert result.speed["status"].tolist()[:2] == [status.name, "ok"]


def test_nan_is_nonfinite(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(changed(motion, "P3.fx", np.nan))
    outcome = run("stub", reference.scene, SAMPLING)
    assert outcome.status is Status.nonfinite
    assert "P3.fx" in outcome.reason
    assert "crank angle 200.0000 deg" in outcome.reason


def test_a_dropped_channel_is_noticed(reference: Reference, motion: Motion, plug: Plug) -> None:
    rest = {channel: values for channel, values in motion.samples.items() if channel != "P3.fx"}
    plug(Motion(rest))
    assert run("stub", reference.scene, SAMPLING).status is Status.crashed
    plug(Motion(rest, {"P3.fx": "this engine has no such sensor"}))
    assert run("stub", reference.scene, SAMPLING).status is Status.ok


def test_a_short_run_is_noticed(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(Motion({channel: values[:-1] for channel, values in motion.samples.items()}))
    assert run("stub", reference.scene, SAMPLING).status is Status.crashed


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
    unexplained = measured.errors["unexplained"].where(measured.errors["channel"] != "P4.y")
    spoilt = measured.errors.assign(unexplained=unexplained)
    assert judged(reference, {"position": 1e9}, replace(measured, errors=spoilt)) == [True]
    without = replace(measured, errors=measured.errors[measured.errors["group"] != "torque"])
    assert judged(reference, {"torque": 1e9}, without) == [True]


def test_what_an_engine_refused_stays_refused(reference: Reference, motion: Motion, plug: Plug) -> None:
    """Its motion is measured all the same, so that one sees whether it was right to refuse."""
    plug(Failure(Status.not_converged, "it did not like it", motion))
    measured = measure(reference, "stub", SAMPLING)
    assert measured.run.status is Status.not_converged
    assert measured.errors["max"].max() <= 1e-12


def test_what_is_no_number_is_not_handed_on(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(Failure(Status.not_converged, "it did not like it", changed(motion, "P3.fx", np.nan)))
    outcome = run("stub", reference.scene, SAMPLING)
    assert outcome.status is Status.not_converged
    assert outcome.motion is None

"""The comparison itself: every check, error figure, gate and verdict must go red on a result that deserves it."""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

import analytic
import scenes
from compare import registry
from compare.checks import checks
from compare.errors import compare, error_table
from compare.gates import gates
from compare.measure import Measurement, measure
from compare.reference import Floor, Reference, establish
from compare.runner import run
from compare.speed import Budget
from compare.study import study
from scenes import Failure, Motion, Sampling, Scene, Settings, Status
from scenes.motion import channels

SAMPLING = Sampling(72)
Outcome = Motion | Exception


@pytest.fixture(scope="module")
def reference() -> Reference:
    return establish(scenes.load("toggle_press"))


@pytest.fixture
def motion(reference: Reference) -> Motion:
    return reference.at(SAMPLING.commanded(reference.scene))


class Stub:
    """An engine, and its simulation, with a given outcome."""

    DEFAULT = Settings("stub")
    LADDER = (DEFAULT,)
    LONG_LADDER: tuple[Settings, ...] = ()
    counters: Mapping[str, int] = {}
    residuals: Mapping[str, float] = {}

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome

    def version(self) -> str:
        return "stub"

    def build(self, scene: Scene, settings: Settings, sampling: Sampling) -> "Stub":  # noqa: ARG002
        return self

    def solve(self) -> None:
        if isinstance(self.outcome, Exception):
            raise self.outcome

    def read(self) -> Motion:
        assert isinstance(self.outcome, Motion)
        return self.outcome


Plug = Callable[[Outcome], None]


@pytest.fixture
def plug(monkeypatch: pytest.MonkeyPatch) -> Plug:
    """Return a function that makes the engine named `stub` end as told."""
    real = registry.engine
    entry = registry.Entry("a stub", "", "numpy", "numpy", "")
    monkeypatch.setitem(registry.ENTRIES, "stub", entry)

    def plug(outcome: Outcome) -> None:
        monkeypatch.setattr(registry, "engine", lambda name: Stub(outcome) if name == "stub" else real(name))

    return plug


def changed(motion: Motion, channel: str, by: float, row: int = 40) -> Motion:
    """Return the motion with one sample of one channel moved."""
    samples = motion[channel].copy()
    samples[row] += by
    return Motion({**motion.samples, channel: samples})


def row_of(table: pd.DataFrame, channel: str) -> dict[Hashable, Any]:
    return next(row for row in table.to_dict("records") if row["channel"] == channel)


# --- errors -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "channel", [c for c in channels(scenes.load("toggle_press")) if c not in ("time", "crank_angle")]
)
def test_an_error_in_any_channel_is_found(reference: Reference, motion: Motion, channel: str) -> None:
    scale = reference.scale[channel]
    table = error_table("x", compare(reference, SAMPLING, changed(motion, channel, -1e-3 * scale)), reference)
    row = row_of(table, channel)
    assert row["max"] == pytest.approx(1e-3, rel=1e-9)
    assert row["max_at_deg"] == pytest.approx(200.0)
    assert row["rms"] == pytest.approx(1e-3 / np.sqrt(SAMPLING.count), rel=1e-9)
    others = table[table["channel"] != channel]
    assert (others["max"] <= 1e-14).all()


def test_scales(reference: Reference) -> None:
    S, w = 0.1836316, 2 * np.pi
    assert reference.stroke == pytest.approx(S, abs=5e-8)
    assert reference.scale["P4.vx"] == pytest.approx(S * w, rel=1e-6)
    assert reference.scale["P5.ay"] == pytest.approx(S * w**2, rel=1e-6)
    assert reference.scale["drive.torque"] == pytest.approx(13888, abs=0.5)
    assert reference.scale["slider.guide_moment"] == pytest.approx(S * reference.scale["slider.guide_force"], rel=1e-6)
    assert reference.scale["P3.fx"] == reference.scale["P3.fy"]


def test_angles_count_modulo_a_turn(reference: Reference, motion: Motion) -> None:
    turned = Motion({**motion.samples, "rod.angle": motion["rod.angle"] + 2 * np.pi})
    table = error_table("x", compare(reference, SAMPLING, turned), reference)
    assert row_of(table, "rod.angle")["max"] <= 1e-14


def test_the_drives_error_is_told_apart(reference: Reference) -> None:
    """A crank that lags by 1e-4 rad, everything else right for where it is."""
    lagging = reference.at(SAMPLING.commanded(reference.scene) - 1e-4)
    table = error_table("x", compare(reference, SAMPLING, lagging), reference)
    assert row_of(table, "P5.y")["max"] <= 1e-14
    assert row_of(table, "P5.y")["commanded_max"] == pytest.approx(1e-4 * 0.865 / (2 * np.pi) / 0.18363, rel=1e-2)
    assert row_of(table, "crank_angle")["commanded_max"] == pytest.approx(1e-4, rel=1e-9)


def test_toggle_windows_and_last_turn(reference: Reference) -> None:
    sampling = Sampling(360, turns=2)
    plain = reference.at(sampling.commanded(reference.scene))
    first_turn = changed(plain, "P5.y", 1e-3, row=100)  # at 100 degrees the slider moves
    row = row_of(error_table("x", compare(reference, sampling, first_turn), reference), "P5.y")
    assert row["max"] > 1e-3
    assert row["last_turn_max"] <= 1e-14
    assert row["toggle_max"] <= 1e-14
    at_bottom = changed(plain, "P5.y", 1e-3, row=373)
    row = row_of(error_table("x", compare(reference, sampling, at_bottom), reference), "P5.y")
    assert row["last_turn_max"] == row["toggle_max"] == row["max"]


def test_no_error_is_shown_below_the_floor(reference: Reference, motion: Motion) -> None:
    assert reference.floor.by_channel, "the certify extra is part of the test extra"
    high = replace(reference, floor=replace(reference.floor, by_channel=dict.fromkeys(motion.samples, 1e-9)))
    table = error_table("x", compare(high, SAMPLING, motion), high)
    assert (table["max"] == 1e-9).all()


def test_an_uncertified_reference_has_no_error_to_show(reference: Reference, motion: Motion) -> None:
    uncertified = replace(reference, floor=Floor({}, "not certified"))
    comparison = compare(uncertified, SAMPLING, motion)
    assert error_table("analytic", comparison, uncertified)["max"].isna().all()
    assert (error_table("stub", comparison, uncertified)["max"] == 0).all()


# --- checks without a reference ---------------------------------------------------------------------------------------

WHAT_NOTICES = {  # a channel, by how much it is moved, the check and body that must notice
    "P2.x": (1e-6, "closure", "crank"),
    "P3.y": (1e-6, "closure", "rocker"),
    "P4.x": (1e-6, "closure", "toggle"),
    "P5.x": (1e-6, "closure", "slider"),
    "P5.y": (1e-6, "closure", "rod"),
    "P3.fx": (1.0, "Newton", "rocker"),
    "P4.fy": (1.0, "Newton", "rod"),
    "P5.ay": (1e-3, "Newton", "slider"),
    "slider.guide_force": (1.0, "Newton", "slider"),
    "slider.guide_moment": (1.0, "Euler", "slider"),
    "drive.torque": (1.0, "Euler", "crank"),
    "toggle.alpha": (1e-1, "Euler", "toggle"),
    "rod.alpha": (1e-1, "Euler", "rod"),
    "P5.vy": (1e-3, "power", "mechanism"),
    "rocker.omega": (1e-1, "power", "mechanism"),
}


@pytest.mark.parametrize("channel", WHAT_NOTICES)
def test_a_check_notices(reference: Reference, motion: Motion, channel: str) -> None:
    by, name, of = WHAT_NOTICES[channel]
    before = {(c.check, c.of): c.worst for c in checks(reference.scene, motion, reference.stroke)}
    found = checks(reference.scene, changed(motion, channel, by), reference.stroke)
    noticed = next(c for c in found if (c.check, c.of) == (name, of))
    assert before[name, of] <= 1e-13
    assert noticed.worst > 1e-9
    assert noticed.at_deg == pytest.approx(200.0)


def test_checks_with_gravity_and_given_inertia(scene_from: Callable[[str], Scene]) -> None:
    """A spinning crank alone has nothing but its pivot force and its torque; both by hand."""
    from .test_analytic import SLIDER_CRANK

    text = SLIDER_CRANK.replace("mass = 0", "mass = 3\ncom = [0.4, 0.1]\ninertia = 0.2", 1)
    scene = scene_from(text.replace("name =", "gravity = [1, -9.81]\nname ="))
    motion = analytic.solve(scene, np.linspace(0, 6, 100))
    for check in checks(scene, motion, 2.0):
        assert check.worst <= 1e-13, check


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
    assert "at crank angle 200 deg" in measured.run.reason


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
    assert result.speed["status"].tolist() == [status.name, "ok"]


def test_nan_is_nonfinite(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(changed(motion, "P3.fx", np.nan))
    outcome = run("stub", reference.scene, SAMPLING)
    assert outcome.status is Status.nonfinite
    assert "P3.fx" in outcome.reason
    assert "200 deg" in outcome.reason


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


def test_what_has_no_error_misses_its_gate(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(Failure(Status.timed_out, "too slow"))
    assert judged(reference, {"position": 1e9}, measure(reference, "stub", SAMPLING)) == [True]
    plug(motion)
    measured = measure(reference, "stub", SAMPLING)
    spoilt = measured.errors.assign(max=measured.errors["max"].where(measured.errors["channel"] != "P4.y"))
    assert judged(reference, {"position": 1e9}, replace(measured, errors=spoilt)) == [True]
    without = replace(measured, errors=measured.errors[measured.errors["group"] != "torque"])
    assert judged(reference, {"torque": 1e9}, without) == [True]

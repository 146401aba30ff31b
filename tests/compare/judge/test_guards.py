"""Guards that need no reference: each alone must refuse what it is for, on either side, and what is not a number."""

import numpy as np
import pytest

from compare.engines.runner import Run
from compare.judge.checks import checks
from compare.judge.verdict import judged, limits
from compare.mechanics.reference import Reference
from scenes import Motion, Settings, Status
from tests import scene_files
from tests.comparisons import SAMPLING, References, changed, commanded, of_scene, sampled, size_of

INCONSISTENT, INACCURATE = Status.inconsistent, Status.inaccurate
GUARDS = {  # what alone must refuse: by which channel, moved by how much of its scale, and how that ends
    ("drive", "crank_angle"): (3.6e-9, INCONSISTENT, "crank deviates"),  # 3.5 rad on its way
    ("closure", "P4.x"): (0.02, Status.diverged, "joints of"),
    ("position", "P4.x"): (0.2, INCONSISTENT, "is off by"),
    ("velocity", "P4.vx"): (0.5, INCONSISTENT, "P4.vx is off by"),
    ("velocity", "rocker.omega"): (1.0, INCONSISTENT, "rocker.omega is off by"),
    ("acceleration", "P5.ay"): (1.0, INCONSISTENT, "P5.ax is off by"),  # of the vector
    ("acceleration", "rod.alpha"): (2.0, INCONSISTENT, "rod.alpha is off by"),
    ("reaction", "P4.fx"): (0.3, INCONSISTENT, "P4.fx is off by"),
    ("reaction", "slider.guide_moment"): (0.3, INCONSISTENT, "slider.guide_moment is off by"),
    ("torque", "drive.torque"): (0.3, INCONSISTENT, "drive.torque is off by"),
    ("Newton", "P4.fx"): (2e-2, INCONSISTENT, "forces and m a of"),
    ("Euler", "slider.guide_moment"): (0.3, INCONSISTENT, "moments and I alpha of slider"),
    ("power", "drive.torque"): (0.5, INCONSISTENT, "power of the mechanism"),
}
BROKEN = {"closure": "P5.x", "position": "rod.angle", "velocity": "P5.vy", "acceleration": "P5.ay"}
BROKEN |= {"reaction": "P4.fx", "torque": "drive.torque"}  # what breaks a promise alone, though not by a tenth
NOT_A_NUMBER = {  # a channel, and the guards that look at it
    "crank_angle": {"drive"},
    "P4.x": {"closure", "position", "Euler"},
    "toggle.angle": {"branch", "position"},
    "P4.vx": {"velocity"},
    "P5.vy": {"velocity", "power"},
    "P5.ay": {"acceleration", "Newton", "power"},
    "rod.alpha": {"acceleration", "Euler", "power"},
    "P3.fx": {"reaction", "Newton", "Euler"},
    "slider.guide_moment": {"reaction", "Euler"},
    "drive.torque": {"torque", "Euler", "power"},
}
PROMISE = Settings("stub", promise=1e-3)


def verdict(reference: Reference, motion: Motion, guard: str = "") -> Run:
    """Return the verdict on a motion by all guards, or by one alone."""
    found = checks(reference.mechanics, motion, reference.travel)
    return judged(Run("stub", PROMISE, Status.ok), [check for check in found if guard in ("", check.check)])


@sampled(13)
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("guard", "channel"), GUARDS)
def test_each_guard_alone(reference: Reference, motion: Motion, guard: str, channel: str, sign: int) -> None:
    by, status, reason = GUARDS[guard, channel]
    run = verdict(reference, changed(motion, channel, sign * by * reference.scale[channel]), guard)
    assert (run.status, run.found_by) == (status, "checks")
    assert reason in run.reason
    assert run.reason.endswith("at crank angle 200.0000 deg" if guard != "drive" else " deg")
    assert verdict(reference, motion).status is Status.ok


@sampled(4)
@pytest.mark.parametrize("share", [0.9, 1.1])
@pytest.mark.parametrize("guard", BROKEN)
def test_a_promise_alone(reference: Reference, motion: Motion, guard: str, share: float) -> None:
    """Of the size there, whichever is the larger."""
    channel = BROKEN[guard]
    wrong = changed(motion, channel, share * 1e-3 * size_of(motion, channel, reference.scale[channel]))
    assert verdict(reference, wrong, guard).status is (Status.ok if share < 1 else INACCURATE)


@pytest.mark.parametrize(("by", "status"), [(0.9e-3, Status.ok), (1.1e-3, INACCURATE), (0.3, INCONSISTENT)])
def test_the_force_of_a_driven_slider(references: References, by: float, status: Status) -> None:
    reference = references("driven_toggle")
    motion = commanded(reference)
    wrong = changed(motion, "drive.force", by * size_of(motion, "drive.force", reference.scale["drive.force"]))
    assert verdict(reference, wrong, "force").status is status


def test_every_guard_is_tested() -> None:
    assert {guard for guard, _ in GUARDS} | {"branch", "force"} == {limit.check for limit in limits(PROMISE)}
    promised = {limit.check for limit in limits(PROMISE) if limit.status is INACCURATE}
    assert promised == {*BROKEN, "force"}


@sampled(4)
@pytest.mark.parametrize("channel", NOT_A_NUMBER)
def test_what_is_not_a_number_passes_no_guard(reference: Reference, motion: Motion, channel: str) -> None:
    wrong = changed(motion, channel, np.nan)
    assert all(verdict(reference, wrong, guard).reason for guard in NOT_A_NUMBER[channel])


def test_a_flip_on_the_way_is_a_wrong_branch(reference: Reference, motion: Motion) -> None:
    """From the other assembly on half a turn long: closed joints, right rates, balanced forces, and a jump."""
    other = commanded(of_scene(reference, scene_files.load("toggle_press", {"sketch.P5": [0, -400]})))
    half = np.arange(SAMPLING.count) < 30
    flipped = Motion({c: np.where(half, motion[c], other[c]) for c in motion.samples if c in other})
    run = verdict(reference, flipped)
    assert run.status is Status.wrong_branch
    assert run.reason.endswith("flips to another branch at crank angle 150.0000 deg")


@pytest.mark.parametrize("row", [0, 7])
def test_a_singular_pose_breaks_nothing_but_its_joints(reference: Reference, motion: Motion, row: int) -> None:
    """A rod folded flat on a point of its own: nothing can be solved there, and nothing is refused for that."""
    at = np.arange(SAMPLING.count) == row
    flat = {f"P5.{q}": np.where(at, motion[f"P4.{q}"], motion[f"P5.{q}"]) for q in ("x", "y")}
    flat |= {f"{p}.{q}": np.where(at, 0.0, motion[f"{p}.{q}"]) for p in ("P3", "P2") for q in ("x", "y")}
    found = {c.check: c for c in checks(reference.mechanics, Motion({**motion.samples, **flat}), reference.travel)}
    assert found["closure"].worst > 0.1
    assert all(np.isfinite(c.worst) for c in found.values())
    assert found["branch"].worst == 0.0

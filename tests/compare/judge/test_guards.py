"""Guards that need no reference: each alone must refuse what it is for, on either side, and what is not a number."""

from dataclasses import replace

import numpy as np
import pytest

from compare.engines.reference import Reference, magnitude
from compare.engines.runner import Run
from compare.judge.checks import Check, checks
from compare.judge.verdict import LIMITS, judged
from scenes import Motion, Status
from scenes.motion import quantity
from tests.comparisons import SAMPLING, changed, commanded, of_scene

GUARDS = {  # what alone must refuse: by which channel, moved by how much of its scale, and how that ends
    ("drive", "crank_angle"): (0.07, Status.diverged, "crank is off"),  # a hundredth of a turn
    ("closure", "P4.x"): (0.02, Status.diverged, "joints of"),
    ("estimate", "P4.x"): (0.2, Status.not_converged, "is off by"),
    ("estimate", "P4.vx"): (0.5, Status.not_converged, "P4.vx is off by"),
    ("estimate", "rocker.omega"): (1.0, Status.not_converged, "rocker.omega is off by"),
    ("estimate", "P5.ay"): (1.0, Status.not_converged, "P5.ay is off by"),
    ("estimate", "rod.alpha"): (2.0, Status.not_converged, "rod.alpha is off by"),
    ("estimate", "P4.fx"): (0.3, Status.not_converged, "P4.fx is off by"),
    ("estimate", "slider.guide_moment"): (0.3, Status.not_converged, "slider.guide_moment is off by"),
    ("estimate", "drive.torque"): (0.3, Status.not_converged, "drive.torque is off by"),
    ("Newton", "P4.fx"): (0.3, Status.not_converged, "forces and m a of"),
    ("Euler", "slider.guide_moment"): (0.3, Status.not_converged, "moments and I alpha of slider"),
    ("power", "drive.torque"): (0.5, Status.not_converged, "power of the mechanism"),
}
NOT_A_NUMBER = {  # a channel, and the guards that look at it
    "crank_angle": {"drive", "estimate"},
    "P4.x": {"closure", "estimate", "Euler"},
    "toggle.angle": {"branch", "estimate"},
    "P4.vx": {"estimate"},
    "P5.vy": {"estimate", "power"},
    "P5.ay": {"estimate", "Newton", "power"},
    "rod.alpha": {"estimate", "Euler", "power"},
    "P3.fx": {"estimate", "Newton", "Euler"},
    "slider.guide_moment": {"estimate", "Euler"},
    "drive.torque": {"estimate", "Euler", "power"},
}


def verdict(found: list[Check]) -> Run:
    return judged(Run("stub", None, Status.ok), found)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(("guard", "channel"), GUARDS)
def test_each_guard_alone(reference: Reference, motion: Motion, guard: str, channel: str, sign: int) -> None:
    by, status, reason = GUARDS[guard, channel]
    wrong = changed(motion, channel, sign * by * reference.scale[channel])
    found = [check for check in checks(reference.scene, wrong, reference.stroke) if check.check == guard]
    run = verdict(found)
    assert (run.status, run.found_by) == (status, "checks")
    assert reason in run.reason
    assert run.reason.endswith("at crank angle 200.0000 deg" if guard != "drive" else " deg")
    assert verdict(checks(reference.scene, motion, reference.stroke)).status is Status.ok


def test_every_guard_is_tested() -> None:
    assert {guard for guard, _ in GUARDS} | {"branch"} == set(LIMITS)


@pytest.mark.parametrize("channel", NOT_A_NUMBER)
def test_what_is_not_a_number_passes_no_guard(reference: Reference, motion: Motion, channel: str) -> None:
    found = checks(reference.scene, changed(motion, channel, np.nan), reference.stroke)
    refused = {guard for guard in LIMITS if verdict([check for check in found if check.check == guard]).reason}
    assert refused >= NOT_A_NUMBER[channel]


@pytest.mark.parametrize("share", [0.09, 0.11])
@pytest.mark.parametrize("channel", ["P4.x", "rocker.angle", "P4.vy", "rocker.omega", "P5.ay", "rod.alpha", "O.fx"])
def test_a_tenth_is_too_much(reference: Reference, motion: Motion, channel: str, share: float) -> None:
    """Of the scale or, of a rate, of the magnitude there, whichever is the larger."""
    size = 0.0 if quantity(channel) in ("x", "angle") else float(magnitude(motion, channel)[40])
    wrong = changed(motion, channel, share * max(reference.scale[channel], size))
    found = [check for check in checks(reference.scene, wrong, reference.stroke) if check.check == "estimate"]
    assert (verdict(found).status is Status.ok) == (share < 0.1)


def test_a_flip_on_the_way_is_a_wrong_branch(reference: Reference, motion: Motion) -> None:
    """From the other assembly on half a turn long: closed joints, right rates, balanced forces, and a jump."""
    upward = replace(reference.scene.sketch, points={**reference.scene.sketch.points, "P5": (0.0, -0.4)})
    other = commanded(of_scene(reference, replace(reference.scene, sketch=upward)))
    half = np.arange(SAMPLING.count) < 30
    flipped = Motion({c: np.where(half, motion[c], other[c]) for c in motion.samples if c in other})
    run = verdict(checks(reference.scene, flipped, reference.stroke))
    assert run.status is Status.wrong_branch
    assert run.reason.endswith("flips to another branch at crank angle 150.0000 deg")


@pytest.mark.parametrize("row", [0, 7])
def test_a_singular_pose_breaks_nothing_but_its_joints(reference: Reference, motion: Motion, row: int) -> None:
    """A rod folded flat on a point of its own: nothing can be solved there, and nothing is refused for that."""
    at = np.arange(SAMPLING.count) == row
    flat = {f"P5.{q}": np.where(at, motion[f"P4.{q}"], motion[f"P5.{q}"]) for q in ("x", "y")}
    flat |= {f"{p}.{q}": np.where(at, 0.0, motion[f"{p}.{q}"]) for p in ("P3", "P2") for q in ("x", "y")}
    found = {c.check: c for c in checks(reference.scene, Motion({**motion.samples, **flat}), reference.stroke)}
    assert found["closure"].worst > 0.1
    assert all(np.isfinite(c.worst) for c in found.values())
    assert found["branch"].worst == 0.0

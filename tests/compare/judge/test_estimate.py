"""Errors that are known without a reference: they are the true ones."""

from dataclasses import replace

import numpy as np
import pytest

import scenes
from compare.engines import registry
from compare.engines.runner import run
from compare.judge.checks import checks, estimate
from compare.judge.measure import checked_run, measure
from compare.mechanics.constraints import Constraints
from compare.mechanics.elements import magnitudes
from compare.mechanics.mechanics import EPS, SHOWN_GROUPS, Mechanics
from compare.mechanics.projection import projected
from compare.mechanics.reference import Reference, uncertified
from compare.mechanics.scales import scales
from scenes import Motion, Sampling, Settings, Status, hard
from scenes.channels import Role, named
from scenes.model.inputs import passing
from tests import scene_files
from tests.comparisons import SAMPLING, References, changed, commanded, estimated, sampled, size_of, vector_of


def largest(reference: Reference, motion: Motion) -> dict[str, float]:
    """Return the largest estimated error by channel."""
    return {c: float(e.max()) for c, e in estimate(reference.mechanics, motion, reference.travel).errors.items()}


def settings(engine: str) -> list[Settings]:
    module = registry.engine(engine)
    return [module.FAST, module.DEFAULT, module.EXACT]


ENGINES = [(engine, of) for engine in ("exudyn", "pymunk") for of in settings(engine)]


@sampled(5)
@pytest.mark.parametrize("name", ["toggle_press", "walking_leg", "double_toggle_clamp", "quick_return"])
@pytest.mark.parametrize(("engine", "of"), ENGINES, ids=lambda of: getattr(of, "label", of))
def test_the_estimate_is_the_error(name: str, engine: str, of: Settings) -> None:
    """But for where an error ends in rounding, or in what the step onto the constraints leaves, its square."""
    measured = measure(uncertified(scenes.load(name)), engine, SAMPLING, of)
    worst = max(row.max for row in measured.errors if row.group in SHOWN_GROUPS)
    assert estimated(measured) == pytest.approx(worst, rel=0.02, abs=1e-9)


@sampled(1)
@pytest.mark.parametrize("name", scene_files.MECHANISMS)
def test_a_moved_channel_is_off_by_as_much(references: References, name: str) -> None:
    """Rates and forces one after the other, and nothing else is; by the scales of the motion itself."""
    reference = references(name)
    motion = commanded(reference)
    own = scales(reference.mechanics, motion, reference.travel, magnitudes(reference.mechanics, motion))
    for channel in own:
        if (named(channel).group or "drive") not in ("drive", "position"):
            off = largest(reference, changed(motion, channel, -1e-3 * own[channel]))
            expected = 1e-3 * own[channel] / size_of(motion, channel, own[channel])
            assert [off.pop(part) for part in vector_of(channel)] == pytest.approx([expected] * len(vector_of(channel)))
            assert max(off.values()) <= 1e-12


@sampled(1)
@pytest.mark.parametrize("name", scene_files.MECHANISMS)
def test_an_open_joint_is_closed_in_the_estimate(references: References, name: str) -> None:
    """A place that is off by 1e-6 of the stroke is known to be, up to the condition times the square of it."""
    reference = references(name)
    motion = commanded(reference)
    for channel in motion.samples:
        if named(channel).name in ("x", "y"):
            off = largest(reference, changed(motion, channel, 1e-6 * reference.stroke))
            assert max(off.values()) >= 0.5e-6, channel
            errors = {c: e for c, e in off.items() if named(c).group != "position"}
            assert max(errors.values()) <= 1e-8, channel


@pytest.mark.parametrize("name", ["toggle_press", "crank_press"])
@pytest.mark.parametrize("lag", [1e-2, -1e-2])
def test_a_drive_that_lags_is_off_alone(name: str, lag: float) -> None:
    reference = uncertified(scenes.load(name))
    scene = reference.scene
    motion = reference.at(passing(scene, SAMPLING.commanded(scene) - lag, SAMPLING.times(scene)))
    assert max(largest(reference, motion).values()) <= 1e-12
    (drive,) = (check for check in checks(Mechanics(scene), motion, reference.travel) if check.check == "drive")
    assert drive.worst == pytest.approx(1e-2)


def test_a_body_that_is_mirrored_is_another(reference: Reference, motion: Motion) -> None:
    """All its lengths are right, and nothing but the sketch shows on which side its third point is."""
    points = reference.scene.sketch.points
    P2, P3, P4 = (complex(*points[name]) for name in ("P2", "P3", "P4"))
    mirrored = P2 + ((P4 - P2) / (P3 - P2)).conjugate() * (P3 - P2)
    sketch = replace(reference.scene.sketch, points={**points, "P4": (mirrored.real, mirrored.imag)})
    other = replace(reference.scene, sketch=sketch)
    assert max(largest(replace(reference, mechanics=Mechanics(other)), motion).values()) > 0.1


def near_lock(rung: str) -> Reference:
    return uncertified(next(of for of in hard.ladder("dead_centre_driven").rungs if of.label == rung).scene())


def test_what_rounding_explains_is_no_error() -> None:
    """The condition is 2e5, and the last acceleration 1e12 times its scale."""
    reference = near_lock("1e-9")
    motion = run("exudyn", reference.scene, Sampling(), registry.engine("exudyn").EXACT).motion
    assert motion is not None
    true = projected(reference.mechanics, motion).closed
    assert np.abs(motion["A.ay"] - true["A.ay"])[-1] > reference.scale["A.ay"]
    assert max(largest(reference, motion).values()) <= 1e-7  # elsewhere, of the engine's own


@pytest.mark.parametrize(("channel", "power"), [("A.y", 1), ("A.vy", 2), ("A.ay", 2), ("O.fx", 2)])
def test_it_explains_no_more_than_the_condition_allows(channel: str, power: int) -> None:
    """Of the largest of its kind at the sample."""
    reference = near_lock("1e-5")
    scene, motion = reference.scene, commanded(reference)
    constraints = Constraints(scene)
    J = constraints.jacobian(constraints.poses(motion))[-1]
    kappa = float(np.linalg.norm(J) * np.linalg.norm(np.linalg.inv(J)))
    own = scales(reference.mechanics, motion, reference.travel, magnitudes(reference.mechanics, motion))
    forces = scene.channels.names(Role.force)
    kind = forces if channel in forces else [c for c in own if named(c).group == named(channel).group]
    allowed = EPS * kappa**power * max(abs(motion[c][-1]) / own[c] for c in kind)
    for share, excused in ((0.3, True), (3.0, False)):
        off = largest(reference, changed(motion, channel, share * allowed * own[channel], row=-1))
        assert (off[channel] == 0.0) is excused, share


def test_a_crank_that_has_turned_a_thousand_times_is_rounded_as_much_more(reference: Reference) -> None:
    """Its angle is known to 1e-12 of a turn; what follows from it may be off by that, not by a hundred times that."""
    long = Sampling(8, turns=1000)
    motion = reference.at(long.inputs(reference.scene))
    promise = Settings("").promise
    assert max(largest(reference, motion).values()) <= promise
    off = changed(motion, "P5.ax", 100 * promise * reference.scale["P5.ax"], row=-1)
    assert not largest(reference, off)["P5.ax"] <= promise


def test_a_long_motion_is_taken_in_blocks(
    reference: Reference, motion: Motion, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = projected(reference.mechanics, motion)
    monkeypatch.setattr("scenes.model.constraints.BLOCK", 10 * 15**2)
    blocks = projected(reference.mechanics, motion)
    assert np.array_equal(whole.branch, blocks.branch)
    assert np.array_equal(whole.condition, blocks.condition)
    for channel, samples in whole.closed.samples.items():
        assert np.array_equal(blocks.closed[channel], samples), channel


def test_forces_that_an_engine_cannot_give_are_left_out(reference: Reference, motion: Motion) -> None:
    forces = reference.scene.channels.names(Role.force)
    rest = Motion({channel: samples for channel, samples in motion.samples.items() if channel not in forces})
    assert set(largest(reference, rest)).isdisjoint(forces)
    assert {c.check for c in checks(reference.mechanics, rest, reference.travel)}.isdisjoint(("reaction", "torque"))


def test_nothing_to_compare_with_is_judged_all_the_same() -> None:
    coarse = registry.engine("exudyn").WORK_PRECISION[2]
    wrong = checked_run("exudyn", scenes.load("walking_leg"), Sampling(72), coarse)
    assert (wrong.status, wrong.found_by) == (Status.inconsistent, "checks")
    assert checked_run("exudyn", scenes.load("walking_leg"), Sampling(72)).status is Status.ok

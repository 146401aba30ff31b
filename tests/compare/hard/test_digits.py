"""How many digits the core loses near locks, and that the problem itself explains them."""

from collections.abc import Mapping
from dataclasses import replace
from math import log10, pi

import numpy as np
import pytest

from analytic.core import kinematics
from compare.measure.hard.digits import STEP, digits_lost, inputs_off, nearest_lock, positions
from compare.mechanics.mechanics import EPS
from compare.mechanics.reference import Reference, uncertified
from scenes import Failure, Positions, Scene, Status, hard
from scenes.channels import named
from scenes.model.inputs import passing
from scenes.scene import ConstantSpeed
from tests import scene_files
from tests.comparisons import SLOW, sampled

pytest.importorskip("flint")

CASES = [("lock_rrp", "1e-1"), ("lock_rrr", "1e-3"), ("lock_rpr", "1e-2")]
LATER = [("lock_rrp", f"1e-{decade}") for decade in (3, 5, 7, 9)]
LATER += [("lock_rrr", "1e-5"), ("lock_rrr", "1e-9"), ("lock_rrr_folded", "1e-9"), ("lock_rpr", "1e-9")]


def rung(name: str, label: str) -> Scene:
    return next(step for step in hard.ladder(name).rungs if step.label == label).scene()


def explained(digits: Mapping[str, Mapping[str, float]]) -> bool:
    return bool(digits) and all(of["lost"] <= of["allowed"] for of in digits.values())


def conditions(digits: Mapping[str, Mapping[str, float]]) -> dict[str, float]:
    """By group the condition that allows so many digits."""
    return {group: 10 ** (of["allowed"] - 1) for group, of in digits.items()}


def to_lock(reference: Reference, position: float) -> float:
    """How near the nearest group is to a lock at a position, m."""
    there = reference.at(passing(reference.scene, [position], [0.0]))
    return min(float(samples[0]) for channel, samples in there.samples.items() if named(channel).name == "to_lock")


@sampled(1)
@pytest.mark.parametrize(("name", "label"), [*CASES, *(pytest.param(*case, marks=SLOW) for case in LATER)])
def test_no_digit_more_is_lost_than_the_condition_explains(name: str, label: str) -> None:
    reference = uncertified(rung(name, label))
    digits, nearest = digits_lost(reference), nearest_lock(reference)
    assert explained(digits), digits
    assert to_lock(reference, nearest) == pytest.approx(float(label), rel=0.2)  # m; the links of 1 m, or so
    # kappa goes like the root of the distance, and so does position; all else like its square. Each to a factor of 20.
    there = reference.at(passing(reference.scene, [nearest], [0.0]))
    kappa = reference.mechanics.constraints.condition(there).max()
    assert abs(log10(kappa) + 0.5 * log10(float(label))) <= 1.3
    powers = {"position": 1, "velocity": 2, "acceleration": 2, "reaction": 2, "torque": 2}
    assert digits.keys() == powers.keys()
    for group, condition in conditions(digits).items():
        assert abs(log10(condition) + 0.5 * powers[group] * log10(float(label))) <= 1.3, group


@sampled(1)
@pytest.mark.parametrize(("name", "formula"), [("lock_rrr", "rrr_reach"), ("lock_rrp", "slide_reach")])
def test_a_worse_formula_is_seen(monkeypatch: pytest.MonkeyPatch, name: str, formula: str) -> None:
    """Three digits less than a formula may lose there, where the condition is ten."""
    good = getattr(kinematics, formula)
    monkeypatch.setattr(kinematics, formula, lambda *of: good(*of) * (1 + 1e4 * EPS))
    assert not explained(digits_lost(uncertified(rung(name, "1e-1"))))


def test_the_condition_of_a_crank_by_hand() -> None:
    """The tip's place moves with r along itself, with θ and the tip's place across, φ, across itself: by r each.

    A velocity goes with the speed w too, an acceleration with w^2, and the force that turns the mass with that mass.
    """
    digits = digits_lost(uncertified(scene_files.load("crank")))  # in which nothing locks
    by_hand = {"position": 3.0, "velocity": 4.0, "acceleration": 5.0, "reaction": 6.0, "torque": 1.0}  # of none at all
    assert conditions(digits) == pytest.approx(by_hand, rel=1e-3)  # doubles over a STEP
    assert digits["torque"]["lost"] == 0


def test_the_nearest_lock_is_looked_at_from_close_by() -> None:
    scene = rung("lock_rrp", "1e-6")
    reference = uncertified(scene)
    nearest = nearest_lock(reference)
    assert nearest == pytest.approx(pi / 2, abs=4e-8)  # where the distance is flat to two roundings: x^2 / 4 < 2 eps
    assert to_lock(reference, nearest) == pytest.approx(1e-6, abs=4 * EPS)
    stops = positions(scene, nearest)
    assert nearest in stops
    assert (np.sort(np.abs(stops - nearest))[1:5] < 1e-4).all()
    assert (np.diff(stops) > 0).all()
    assert isinstance(scene.drive.law, ConstantSpeed)
    back = scene.with_law(replace(scene.drive.law, speed=-scene.drive.law.speed))
    assert (np.diff(positions(back, nearest)) < 0).all()  # as the drive comes by
    part = scene_files.load("slider_crank", {"drive.start": 0.5, "drive.end": 1.5})
    assert positions(part, 0.5).min() == 0.5  # a way that ends is not left
    assert np.array_equal(Positions(tuple(stops)).commanded(scene), stops)


def test_every_input_is_off_by_a_step() -> None:
    """Zeros, as O and two of the masses, are exact; a vector is off twice, along itself and across, a guide across."""
    scene = scene_files.load("slider_crank")
    others = list(inputs_off(scene))
    off = {
        name: [other.bodies[name] for other in others if other.bodies[name] != body]
        for name, body in scene.bodies.items()
    }
    assert {name: len(bodies) for name, bodies in off.items()} == {"crank": 2, "rod": 1, "slider": 2}
    assert sum(other.loads != scene.loads for other in others) == 2
    assert sum(other.drive != scene.drive for other in others) == 1
    assert len(others) == 8
    (rod,) = off["rod"]
    assert rod.lengths is not None
    assert rod.lengths[frozenset("AB")] == 3 * (1 + STEP)
    tips = [body.local["A"] for body in off["crank"] if body.local is not None]
    assert tips == [(1 + STEP, 0), (1, STEP)]


@SLOW
def test_a_switch_of_a_press_force_has_no_condition() -> None:
    """The start is the dead point, where the force comes or goes with the last digit."""
    ladder = hard.ladder("dead_point_press")
    (at_it,) = (step.scene() for step in ladder.rungs if step.label == "lower")
    digits = digits_lost(uncertified(at_it))
    assert explained(digits)
    assert max(conditions(digits).values()) < 1e3


def test_what_has_no_certified_truth_is_told() -> None:
    with pytest.raises(Failure, match="reached at crank angle") as failure:
        digits_lost(uncertified(scene_files.load("slider_crank", {"bodies.rod.lengths.A-B": 0.5})))
    assert failure.value.status is Status.cannot_assemble

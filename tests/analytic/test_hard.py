"""The core where it is hard: after many turns, small forces beside large ones, larger groups close to their lock."""

from dataclasses import replace

import numpy as np
import pytest

import analytic
import scenes
from analytic.core.groups import continuation
from analytic.solve import prepared
from compare.mechanics.reference import uncertified
from scenes import Failure, Positions, Sampling, hard
from tests.agreement import off_50_digits
from tests.comparisons import sampled

from .newton import as_one_group

EPS = 2.0**-52


@sampled(1)
@pytest.mark.parametrize("name", ["toggle_press", "class_iii", "quick_return"])
def test_the_error_is_the_same_in_every_turn(name: str) -> None:
    """10,000 turns and not a digit less: 6e4 rad off by one in their last place would be 7e-12, 30,000 times eps."""
    pytest.importorskip("flint")
    scene = scenes.load(name)
    position = Sampling(8, 10_000).commanded(scene)
    for turn in (0, 9_999):
        there = position[8 * turn : 8 * turn + 9].tolist()
        near = scene.with_law(replace(scene.drive.law, start=there[0]))  # nobody follows it through all the turns
        for channel, error in off_50_digits(uncertified(near), Positions(tuple(there))).items():
            assert error.max() <= 100 * EPS, (turn, channel)  # a few dozen roundings; which, is by chance


def test_a_block_without_inertia_takes_no_moment() -> None:
    """The lever's balance, of some hundred N m, would leave a rounding of its own over."""
    scene = scenes.load("quick_return")
    assert scene.bodies["block"].inertia is None
    assert len(scene.bodies["block"].points) == 1  # a point mass
    assert (analytic.solve(scene, np.linspace(0, 2 * np.pi, 73))["block.guide_moment"] == 0).all()


@sampled(3)
@pytest.mark.parametrize("name", ["lock_rrp", "lock_rrr", "lock_rrr_folded"])
@pytest.mark.parametrize("label", ["1e-5", "1e-7", "1e-9"])
def test_newton_passes_close_by_a_lock(name: str, label: str) -> None:
    """The dyad as a group, against its closed form: the branch is followed through where it turns in no time."""
    scene = next(step for step in hard.ladder(name).rungs if step.label == label).scene()
    by_newton = as_one_group(scene)
    least, most = scene.drive.law.extent
    position = np.linspace(least, most, 3601)
    nearest = position[analytic.solve(scene, position)["B.to_lock"].argmin()]
    width = np.sqrt(float(label))  # rad, or so: where the lock is felt
    position = np.concatenate([position, nearest + width * np.linspace(-5, 5, 101)])
    found, true = prepared(scene, by_newton)(position), analytic.solve(scene, position)
    for quantity, power in (("", 0.5), ("v", 1), ("a", 1)):  # of the distance: `compare.digits`
        for axis in "xy":
            error = np.abs(found[f"B.{quantity}{axis}"] - true[f"B.{quantity}{axis}"])
            peak = np.hypot(true[f"B.{quantity}x"], true[f"B.{quantity}y"]).max()
            assert error.max() <= 20 * EPS * peak / float(label) ** power


@sampled(1)
@pytest.mark.parametrize("guard", ["branch", "parabola"])
def test_what_keeps_newton_on_its_branch(monkeypatch: pytest.MonkeyPatch, guard: str) -> None:
    """Without the sign of the determinant it ends on the other branch; without looking back it leaps over the lock."""
    scene = next(step for step in hard.ladder("lock_rrr_folded").rungs if step.label == "1e-7").scene()
    by_newton = as_one_group(scene)
    position = np.linspace(*scene.drive.law.extent, 3601)
    prepared(scene, by_newton)(position)
    monkeypatch.setattr(continuation, "STRIDE", 1)  # so that steps meet the lock where it can be leapt over
    prepared(scene, by_newton)(position)
    monkeypatch.setattr(continuation, "PARABOLA_TOL", 1e3)
    if guard == "branch":
        monkeypatch.setattr(np.linalg, "slogdet", lambda J: (np.ones(len(J)), None))
    try:
        found = prepared(scene, by_newton)(position)
    except Failure:
        return
    assert np.abs(found["B.y"] - analytic.solve(scene, position)["B.y"]).max() > 1e-3

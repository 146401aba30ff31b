"""Friction in the core: where there is no solution or two, many machines, derivatives: the drawer of `closed_forms`."""

import numpy as np
import pytest

import analytic
from scenes import Failure, Scene, Status
from scenes.channels import Role
from tests import scene_files
from tests.closed_forms.friction import CRITICAL, LENGTH, MU, Q

AT = [0.7, 0.9, 1.1]  # of the hand, m
PUSHED: scene_files.Changes = {"loads.0.force": [Q, 0]}
ROUNDING = 4e-15  # of a sum of three terms, times 1 / (1 - c) = 1.7


def drawer(coefficient: float = MU, changes: scene_files.Changes = scene_files.NONE) -> Scene:
    return scene_files.load("drawer", {**changes, "friction.0.coefficient": coefficient})


@pytest.mark.parametrize("coefficient", [CRITICAL * (1 + 1e-9), 0.9, 3.0, 100.0])
def test_a_drawer_that_is_pushed_beyond_the_jam_has_two_solutions(coefficient: float) -> None:
    """P < 0 solves it whatever c is; but P > 0 does too, P (c - 1) = Q, as soon as c > 1."""
    with pytest.raises(Failure, match=r"several sets of forces at hand at 0\.7 m") as caught:
        analytic.solve(drawer(coefficient, PUSHED), AT)
    assert caught.value.status is Status.undetermined


def test_a_jam_says_what_would_free_it() -> None:
    """With c = 1.6, 1 / 1.6 of the coefficients pass, or with the one coefficient there is, its critical one."""
    with pytest.raises(Failure, match=r"0\.625 of all coefficients, or with 0\.75 instead of 1\.2 at drawer alone"):
        analytic.solve(drawer(1.6 * CRITICAL), AT)


def test_many_drawers_and_one_that_jams() -> None:
    """P = Q / (1 - c) of each that does not jam, and as a file of its own has it; one that jams spoils no other."""
    coefficient = np.array([0.0, 0.2, 0.8, 0.6, 0.74])
    many = analytic.solve_many(drawer(), {"friction.0.coefficient": coefficient}, AT)
    assert [status is Status.jammed for status in many.status] == [False, False, True, False, False]
    assert "0.9375 of all coefficients" in many.reason[2]
    assert np.isnan(many["drive.force"][2]).all()
    for machine in (0, 1, 3, 4):
        pull, c = many["drive.force"][machine], coefficient[machine] / CRITICAL
        assert np.abs(pull * (1 - c) / Q - 1).max() <= ROUNDING / (1 - c)
        alone = analytic.solve(drawer(float(coefficient[machine])), AT)["drive.force"]
        assert np.abs(pull / alone - 1).max() <= ROUNDING / (1 - c)


def test_many_presses_with_coefficients_far_apart() -> None:
    """From none to three times as much: each as alone, but for roundings in another order."""
    scene, angle = scene_files.load("toggle_press_friction"), np.arange(24) * np.pi / 12
    changes = {f"friction.{n}.coefficient": np.array([0.0, 0.03, 0.1, 0.3]) * (1 + n % 3) / 3 for n in range(7)}
    many = analytic.solve_many(scene, changes, angle)
    for machine in range(4):
        own = {path: float(values[machine]) for path, values in changes.items()}
        alone = analytic.solve(scene_files.load("toggle_press_friction", {**own}), angle)
        for channel in (*scene.channels.names(Role.force), *scene.channels.names(Role.friction)):
            size = np.abs(alone[channel]).max()
            assert not np.abs(many[channel][machine] - alone[channel]).max() > 1e-12 * size, (machine, channel)


def test_derivatives_of_a_pull() -> None:
    """By mu Q (2 e / length) / (1 - c)^2; by the length -mu / length times that; by Q, of a force -Q, 1 / (c - 1)."""
    free = 1 - MU / CRITICAL
    expected = {
        "friction.0.coefficient": Q / CRITICAL / free**2,
        "friction.0.length": -MU / LENGTH * Q / CRITICAL / free**2,
        "loads.0.force.0": -1 / free,
    }
    found = analytic.derivatives(drawer(), [*expected], AT)["drive.force"]
    for row, value in zip(found, expected.values(), strict=True):
        assert np.abs(row / value - 1).max() <= ROUNDING


def test_derivatives_by_a_coefficient_and_a_radius_against_differences() -> None:
    """Of a press, by central differences, their step's square extrapolated away; steps of a thousandth, so to 1e-9."""
    scene, angle = scene_files.load("toggle_press_friction"), np.arange(24) * np.pi / 12
    paths = {"friction.2.coefficient": 0.1, "friction.1.radius": 40.0, "friction.6.coefficient": 0.1}
    found = analytic.derivatives(scene, [*paths], angle)["drive.torque"]
    for row, (path, value) in zip(found, paths.items(), strict=True):

        def slope(step: float, path: str = path, value: float = value) -> np.ndarray:
            ahead, back = (
                analytic.solve(scene_files.load(scene.name, {path: value * (1 + s)}), angle)["drive.torque"]
                for s in (step, -step)
            )
            return np.asarray((ahead - back) / (2 * step * value))

        better = (4 * slope(1e-3) - slope(2e-3)) / 3
        assert np.abs(row - better).max() <= 1e-9 * np.abs(row).max(), path

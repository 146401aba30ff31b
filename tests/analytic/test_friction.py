"""Friction in the core: where there is no solution, one or two; without friction, at rest, smooth; many; derivatives.

The drawer of `tests/scenes` has formulas: its link pulls with P, a lever e beside the first point, against Q there. The
guide has no force but the moment e P, so P = Q + c |P| with c = 2 mu e / length.
"""

from math import atan, sin, tanh

import numpy as np
import pytest

import analytic
from scenes import Failure, Sampling, Scene, Status
from scenes.model.motion import force_channels, friction_channels
from scenes.scene import PinFriction
from tests import scene_files
from tests.agreement import errors
from tests.friction_scenes import everywhere

Q, LEVER, MU, LENGTH, SPEED = 20.0, 0.1, 0.3, 0.15, 0.4  # N, m, its coefficient, m, m/s
CRITICAL = LENGTH / (2 * LEVER)  # the coefficient with c = 1
AT = [0.7, 0.9, 1.1]  # of the hand, m
PUSHED: scene_files.Changes = {"loads.0.force": [Q, 0]}
ROUNDING = 4e-15  # of a sum of three terms, times 1 / (1 - c) = 1.7


def drawer(coefficient: float = MU, changes: scene_files.Changes = scene_files.NONE) -> Scene:
    return scene_files.load("drawer", {**changes, "friction.0.coefficient": coefficient})


@pytest.mark.parametrize("coefficient", [0.1, 0.7, CRITICAL * (1 - 1e-9)])
def test_a_drawer_that_is_pushed_is_held_back(coefficient: float) -> None:
    """With Q along the motion P < 0, so P (1 + c) = -Q; and c < 1 leaves no other."""
    pull = analytic.solve(drawer(coefficient, PUSHED), AT)["drive.force"]
    assert np.abs(pull * (1 + coefficient / CRITICAL) / Q + 1).max() <= ROUNDING


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


@pytest.mark.parametrize("name", ["toggle_press", "rocking_guide", "class_iii"])
def test_friction_to_zero(name: str) -> None:
    """The forces' difference to those without friction falls as mu over four decades, and is none at mu = 0."""
    scene = scene_files.load(name)
    angle = np.arange(24) * np.pi / 12
    without, off = analytic.solve(scene, angle), []
    for mu in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0):
        off.append(max(e.max() for e in errors(analytic.solve(everywhere(scene, mu), angle), without.samples).values()))
    # The next term is mu times some ten joints: a tenth at 1e-2, of the logarithm a twentieth.
    assert np.abs(np.diff(np.log10(off[:-1])) + 1).max() <= 0.05
    assert off[-1] == 0


def test_a_smooth_sense_is_that_of_a_tanh() -> None:
    """Of tanh(speed / smooth) times what c is; `viscous` adds to Q what it has by the speed."""
    changes = {"friction.0.smooth": 0.5, "friction.0.viscous": 15}
    motion = analytic.solve(drawer(MU, changes), AT)
    pull = (Q + 15 * SPEED) / (1 - MU / CRITICAL * tanh(SPEED / 0.5))
    assert np.abs(motion["drive.force"] / pull - 1).max() <= ROUNDING
    assert np.abs(motion["friction.power"] / (SPEED * (Q - pull)) - 1).max() <= 2 * ROUNDING


def test_nothing_rubs_where_the_drive_dwells() -> None:
    """The crank waits from 0.5 to 0.7 s: no friction there, and the forces are those without any; before, others."""
    plain = scene_files.load("swinging_segments")
    scene, time = everywhere(plain), np.array([0.1, 0.3, 0.55, 0.65])
    motion, without = (analytic.solve(of, of.drive.law.at(time).position, time) for of in (scene, plain))
    assert all((motion[channel][2:] == 0).all() for channel in friction_channels(scene))
    assert all((motion[channel][2:] == without[channel][2:]).all() for channel in force_channels(plain))
    assert (motion["friction.power"][:2] < 0).all()


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
        for channel in (*force_channels(scene), *friction_channels(scene)):
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


@pytest.mark.parametrize("name", ["rocking_guide", "three_at_a_pin", "class_iii"])
def test_a_pin_s_force_touches_its_circle_and_opposes_the_turning(name: str) -> None:
    """|moment| = r sin(arctan mu) |R|, against the rate of its bodies on each other; at the samples of one turn."""
    scene = everywhere(scene_files.load(name), 0.2)
    motion = analytic.solve(scene, Sampling(24).commanded(scene))
    pins = {pin.channel: pin for pin in scene.pins}
    for friction in scene.friction:
        if not isinstance(friction, PinFriction):
            continue
        pin = pins[friction.channel(scene).rpartition(".")[0]]
        moment, force = motion[friction.channel(scene)], np.hypot(*(motion[f"{pin.channel}.f{axis}"] for axis in "xy"))
        rates = (motion[f"{body}.omega"] if body in scene.turning else 0.0 for body in (pin.second, pin.first))
        second, first = rates
        rate = second - first
        arm = friction.radius * sin(atan(0.2))
        assert np.all(moment * rate <= 0)
        assert not np.abs(np.abs(moment) - arm * force).max() > 1e-12 * np.abs(moment).max()  # roundings of a group

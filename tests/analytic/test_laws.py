"""Laws of mechanics, and of programs that know them: what must hold of the analytic core for every linkage."""

from dataclasses import replace

import numpy as np
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import analytic
from analytic.core.decomposition import decompose
from analytic.solve import prepared
from compare.judge.checks import checks
from compare.mechanics.mechanics import SHOWN_GROUPS, Mechanics
from compare.mechanics.scales import travels
from scenes import Sampling, Scene
from scenes.channels import Role
from tests import absolute_coordinates, scene_files
from tests.agreement import FORCES, MOTION, assert_agree, exact, instants, solve
from tests.comparisons import SLOW, all_checks
from tests.linkage_scenes import by_formula, linkages

from .newton import as_one_group

SOLVED = ("estimate", *SHOWN_GROUPS)

often = settings(max_examples=12, deadline=None, derandomize=True)
seldom = settings(max_examples=6, deadline=None, derandomize=True, phases=[Phase.generate])  # shrinking took minutes


@SLOW
@often
@given(linkages())
def test_masses_do_not_change_the_motion(scene: Scene) -> None:
    """A kinematic scene has the very same motion, to the bit, and no force at all."""
    bare = replace(scene, bodies={n: replace(b, mass=None, com=None, inertia=None) for n, b in scene.bodies.items()})
    motion, moved = solve(scene), solve(replace(bare, loads=(), springs=(), gravity=None))
    assert set(scene.channels.names()) - set(moved.samples) == set(scene.channels.names(Role.force))
    for channel in moved.samples:
        assert np.array_equal(moved[channel], motion[channel]), channel


@often
@given(linkages())
def test_joints_close_and_forces_and_power_balance(scene: Scene) -> None:
    motion = solve(scene)
    found = checks(Mechanics(scene), motion, travels(scene, motion))
    assert {c.check for c in found} == all_checks(scene)
    for c in found:  # what is summed up rounds, at 5e-15; what is solved for, by its condition
        assert c.worst <= (FORCES if c.check in SOLVED else MOTION), c


@SLOW
@often
@given(scene=linkages(), data=st.data())
def test_what_is_asked_does_not_change_what_is_answered(scene: Scene, data: st.DataObject) -> None:
    """A few channels, or forces alone, to the bit as among all of them, and no others."""
    whole = solve(scene)
    known = data.draw(st.sampled_from((list(whole.samples), list(scene.channels.names(Role.force)))))
    asked = data.draw(st.frozensets(st.sampled_from(known), min_size=1, max_size=3))
    time = instants(scene)
    part = analytic.solve(scene, scene.drive.law.at(time).position, time, asked)
    assert set(part.samples) == asked | {"time", scene.channels.drive.position}
    for channel in part.samples:
        assert np.array_equal(part[channel], whole[channel]), channel


@seldom
@given(linkages())
def test_against_absolute_coordinates(scene: Scene) -> None:
    """Points and unit vectors, Newton's and Euler's equations of all bodies at once: nothing in common."""
    time = np.linspace(0.003, 0.997, 13) * scene.cycle  # off the ends, where a press force may go
    driven = scene.drive.law.at(time)
    expected = absolute_coordinates.solve(scene, *driven)
    assert_agree(scene, analytic.solve(scene, driven.position, time), expected | {"time": time})


@seldom
@given(scene=linkages(), first=st.integers(0, 1))
def test_closed_form_and_newton_agree(scene: Scene, first: int) -> None:
    """The last dyads as one larger group, on what the others have placed: no formula in common but the bodies' own."""
    linkage, time = as_one_group(scene, min(first, len(decompose(scene).groups) - 1)), instants(scene)
    by_newton = prepared(scene, linkage)(scene.drive.law.at(time).position, time)
    motion = solve(scene)
    assert_agree(scene, by_newton, {c: motion[c] for c in scene.channels.names()})


@seldom
@given(linkages())
def test_against_50_digits(scene: Scene) -> None:
    """Newton from the sketch, then multipliers: another formulation with 50 digits agrees in every channel."""
    true = exact(scene, Sampling(24))
    motion = analytic.solve(scene, true[scene.channels.drive.position], true["time"])
    # By the peaks of all forces: a joint that hardly carries anything still has the roundings of those beside it.
    assert_agree(scene, motion, {channel: true[channel] for channel in scene.channels.names()})


@SLOW
@seldom
@given(by_formula())
def test_drives_by_formula_against_50_digits(scene: Scene) -> None:
    true = exact(scene, Sampling(24))
    motion = analytic.solve(scene, true[scene.channels.drive.position], true["time"])
    assert_agree(scene, motion, {channel: true[channel] for channel in scene.channels.names()})


def test_where_the_ends_of_a_spring_meet() -> None:
    """Without a free length it pulls by nothing there, whatever way the core is asked; with one it has no direction.

    A spring from S, 1 m along the lever at rest, to the lever's end: the moment of k (S - C) is -k sin(angle) by 1 m^2.
    """
    spring = {"between": ["ground.S", "lever.C"], "stiffness": 3, "length": 0}  # N/mm
    scene = scene_files.load("lever", {"ground.points.S": [1000, 0], "springs": [spring], "gravity": None})
    angles = np.array([0.0, 0.5])
    torque = [0, 3000 * np.sin(0.5)]
    for motion in (analytic.solve(scene, angles), analytic.fast_solver(scene)(angles)):
        assert np.abs(motion["drive.torque"] - torque).max() <= 1e-11  # N m, roundings of 3 kN at a metre
    lengths = {"springs.0.length": [0.0, 200.0]}
    without, pushing = analytic.solve_many(scene, lengths, angles)["drive.torque"]
    assert np.abs(without - torque).max() <= 1e-11
    assert np.isnan(pushing).tolist() == [True, False]
    by = analytic.derivatives(scene, ["bodies.lever.points.C.0"], angles)["drive.torque"]
    assert np.abs(by[0] - 3 * np.sin(angles)).max() <= 1e-14  # of k S l sin(angle) by l, N m a mm

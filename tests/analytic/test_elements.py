"""Loads and springs of every kind at once, in every way to solve; what counts over whole turns; what has no direction.

Each kind by itself is in `tests/closed_forms`.
"""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import analytic
from analytic import engine
from analytic.engine import WORK_PRECISION, AnalyticSettings
from analytic.recorded.arithmetics.machine_code import COMPILES
from analytic.solve import prepared
from scenes import Failure, Sampling, Scene, Status
from scenes.channels import Role
from scenes.elements import PLAIN_KINDS
from tests import scene_files
from tests.agreement import exact
from tests.closed_forms.elements import ON_CARRIED
from tests.closed_forms.row import CARRIED, FIRST_KINDS
from tests.comparisons import SLOW, sampled

from .newton import as_one_group, assert_close

CLOSE = 1e-12  # of a channel's peak: roundings
STEP = 1e-5  # of a number, by which it differs: central differences are off by its square, and roundings over it
# One of each kind of load and spring on the carried block.
KINDS = (
    *("moment", "periodic moment by the drive", "moment by the drive", "force by a slider's displacement"),
    *("turning force", "force by the time", "turning force by the time", "force along a guide"),
    *("force along a guide by displacement", "spring and damper", "spring that twists", "spring that is wound up"),
    "spring that the drive winds up",
)


def test_a_spring_that_twists_holds_a_weight() -> None:
    """A crank of 4 kg, its centre 1 m from the pin: the drive holds k (phi - angle) + m g l cos(phi)."""
    spring = {"at": "O", "between": ["ground", "crank"], "stiffness": 7.0, "angle": 0.3}
    scene = scene_files.load("crank", {"gravity": [0, -9.81], "torsion_springs": [spring]})
    phi = np.linspace(-20, 20, 50)  # seven turns: those of the drive itself all count
    torque = 7 * (phi - 0.3) + 4 * 9.81 * np.cos(phi)
    assert np.abs(analytic.solve(scene, phi)["drive.torque"] - torque).max() <= CLOSE * 150


def test_whole_turns_count_from_the_start_wherever_a_law_goes() -> None:
    """A crank that swings by more than a turn, forth and back, winds a spring."""
    law = [[0, 0], [0.5, 300], [1.0, 500], [1.5, 100], [2.0, -200]]
    changes, power_of_twist = ON_CARRIED["spring that is wound up"]
    scene = machine({**changes, "drive.law": law, "drive.speed": None})
    time = np.linspace(0, 2, 400)
    driven = scene.drive.law.at(time)
    m = analytic.solve(scene, driven.position, time)
    bare = analytic.solve(replace(scene, torsion_springs=()), driven.position, time)
    off = (m["drive.torque"] - bare["drive.torque"]) * driven.rate + power_of_twist(bare)
    assert np.abs(off).max() <= CLOSE * np.abs(bare["drive.torque"] * driven.rate).max()


@pytest.mark.parametrize("between", [("crank", "rod"), ("rod", "crank")])
def test_half_a_turn_at_the_start_is_counter_clockwise(between: tuple[str, str]) -> None:
    """Whichever side of it rounding leaves: a crank against its rod, and the rod against it."""
    spring = {"at": "A", "between": between, "stiffness": 5.0, "angle": 0.7}
    scene = scene_files.load("slider_crank", {"drive.start": np.pi, "torsion_springs": [spring]})
    m = analytic.solve(scene, [np.pi])
    rate = m[f"{between[1]}.omega"] - m[f"{between[0]}.omega"]
    bare = analytic.solve(replace(scene, torsion_springs=()), [np.pi])
    assert (m["drive.torque"] - bare["drive.torque"]) * 10 == pytest.approx(5 * (np.pi - 0.7) * rate, rel=CLOSE)


def machine(changes: scene_files.Changes) -> Scene:
    return scene_files.load(CARRIED.scene, {**CARRIED.changes, **changes})


def busy() -> Scene:
    """A machine with all of these at once."""
    every = [ON_CARRIED[name][0] for name in KINDS]
    together: dict[str, Any] = {"ground.points.S": [50, 0]}
    for key in ("loads", "springs", "torsion_springs"):
        together[key] = [element for changes in every for element in changes.get(key, ())]
    return machine(together | {"drive.start": -30})


def asked(scene: Scene) -> tuple[Any, Any]:
    sampling = Sampling(samples=37, turns=2)
    return sampling.commanded(scene), sampling.times(scene)


def test_samples_come_in_any_order() -> None:
    scene = busy()
    position, time = asked(scene)
    shuffled = np.random.default_rng(0).permutation(len(position))
    motion = analytic.solve(scene, position[shuffled], time[shuffled])
    expected = analytic.solve(scene, position, time)
    assert_close(motion.samples, {name: expected[name][shuffled] for name in scene.channels.names()}, CLOSE)


@sampled(2)
@pytest.mark.parametrize("settings", WORK_PRECISION)
def test_against_50_digits(settings: AnalyticSettings) -> None:
    """Every setting within what a rounding or a difference leaves of it."""
    scene = busy()
    assert scene.kinds >= FIRST_KINDS - PLAIN_KINDS - {"friction"}
    simulation = engine.build(scene, settings, Sampling(samples=24))
    simulation.solve()
    found, tolerance = simulation.read(), {"single precision": 1e-5, "differences 360": 1e-3}  # some of a step squared
    true = exact(scene, Sampling(24))
    assert_close(
        found.samples,
        {name: true[name] for name in scene.channels.names(Role.force)},
        tolerance.get(settings.label, CLOSE),
    )


@pytest.mark.parametrize("compiled", [False, *COMPILES * [pytest.param(True, marks=SLOW)]])
def test_the_straight_line_has_what_the_formulas_have(*, compiled: bool) -> None:
    scene = busy()
    motion = analytic.solve(scene, *asked(scene))
    assert_close(analytic.fast_solver(scene, compiled=compiled)(*asked(scene)).samples, motion.samples, CLOSE)


def test_a_larger_group_has_what_dyads_have() -> None:
    scene = busy()
    by_newton = prepared(scene, as_one_group(scene))
    motion = analytic.solve(scene, *asked(scene))
    for one in (by_newton, replace(by_newton, at_hand=by_newton.recorded)):
        found = one(*asked(scene)).samples
        assert_close(found, {name: motion[name] for name in scene.channels.names()}, 1e-11)  # Newton's roundings


def numbers_of_elements(scene: Scene) -> list[str]:
    return [path for path in scene.numbers if path.startswith(("loads", "springs", "torsion_springs"))]


def test_machines_and_derivatives() -> None:
    """Each number of an element up and down: as a file of its own would have it, and as the derivative says."""
    scene = busy()
    position, _ = asked(scene)
    paths = ["drive.speed", "bodies.rocker.lengths.B-C", *numbers_of_elements(scene)]
    values = {path: scene.numbers[path].value / scene.size(scene.numbers[path]) for path in paths}
    steps = {path: STEP * max(abs(value), 0.1) for path, value in values.items()}
    changes = {path: np.full(2 * len(paths), value) for path, value in values.items()}
    for row, path in enumerate(paths):
        changes[path][2 * row] += steps[path]
        changes[path][2 * row + 1] -= steps[path]
    many = analytic.solve_many(scene, changes, position)
    assert many.ok.all(), many.reason
    by = analytic.derivatives(scene, paths, position)
    for channel, samples in by.items():
        ahead, back = many[channel][::2], many[channel][1::2]
        peak = np.abs(many[channel]).max()
        for row, path in enumerate(paths):
            difference = (ahead[row] - back[row]) / (2 * steps[path])
            allowed = 1e-9 * max(np.abs(difference).max(), peak / max(abs(values[path]), 0.1))
            assert np.abs(samples[row] - difference).max() <= allowed, (channel, path)
    for row in (0, len(paths), 2 * len(paths) - 1):
        one = scene.with_numbers({p: float(changes[p][row]) * scene.size(scene.numbers[p]) for p in paths})
        single = analytic.solve(one, position)
        assert_close({name: many[name][row] for name in many.samples}, single.samples, 1e-11)


def lever_on_a_damper() -> Scene:
    """At 0 deg both ends of the damper are at one place."""
    damper = {"between": ["ground.S", "lever.C"], "damping": 3}
    return scene_files.load("lever", {"ground.points.S": [1000, 0], "springs": [damper], "gravity": None})


@SLOW
def test_where_the_ends_of_a_damper_meet_machine_code_has_no_number() -> None:
    motion = analytic.fast_solver(lever_on_a_damper())(np.array([0.0, 0.5]))
    assert np.isnan(motion["drive.torque"]).tolist() == [True, False]


def test_where_the_ends_of_a_damper_meet() -> None:
    """It has no direction there; the engine names it and the place, also where round-off keeps its ends apart."""
    scene = lever_on_a_damper()
    motion = analytic.solve(scene, [0.0, 0.5])
    assert np.isnan(motion["drive.torque"]).tolist() == [True, False]
    near = replace(scene, ground={**scene.ground, "S": (1.0, 1e-14)})
    for one in (scene, near):
        simulation = engine.build(one, engine.DEFAULT, Sampling(samples=8))
        simulation.solve()
        with pytest.raises(Failure, match=r"ground\.S and lever\.C meet at crank angle 0.0000 deg") as failure:
            simulation.read()
        assert failure.value.status is Status.nonfinite

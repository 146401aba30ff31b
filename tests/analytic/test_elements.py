"""Moments, forces that turn, along guides and by tables, dampers, springs that twist: by virtual work, in every way.

What an element does shows in the drive's torque: its power and that of the drive are opposite, whatever the masses.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import analytic
from analytic import engine
from analytic.engine import WORK_PRECISION, AnalyticSettings
from analytic.recorded.arithmetics.machine_code import COMPILES
from analytic.solve import prepared
from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.elements import ALL_KINDS, PLAIN_KINDS
from scenes.model.motion import channels, force_channels
from tests import scene_files
from tests.agreement import exact

from .newton import as_one_group, assert_close

CLOSE = 1e-12  # of a channel's peak: roundings
STEP = 1e-5  # of a number, by which it differs: central differences are off by its square, and roundings over it
TURN = 2 * np.pi
TABLE = [[-90, 2], [40, -3], [360, 7], [630, 2]]  # of 720 degrees
CYCLE = np.radians([-90, 40, 360, 630]), [2, -3, 7, 2]


def load(**keys: Any) -> scene_files.Changes:
    return {"loads": [keys]}


def twisted(at: str, *between: str, **keys: Any) -> scene_files.Changes:
    return {"torsion_springs": [{"at": at, "between": between, "stiffness": 0.4, "angle": 20, **keys}]}


def v(m: Motion, point: str) -> Any:
    return m[f"{point}.vx"] + 1j * m[f"{point}.vy"]


def z(m: Motion, point: str) -> Any:
    return m[f"{point}.x"] + 1j * m[f"{point}.y"]


def machine(changes: scene_files.Changes) -> Scene:
    return scene_files.load("carried_block", {"bodies.block.slides.through": [40, 30]} | changes)


def along_coupler(m: Motion) -> tuple[Any, Any]:
    """How far the block is along the coupler, and how fast it slips."""
    u, d = np.exp(1j * m["coupler.angle"]), z(m, "P") - z(m, "A")
    return (u.conjugate() * d).real - 0.04, (u.conjugate() * (v(m, "P") - v(m, "A") - 1j * m["coupler.omega"] * d)).real


def power_of_twist(m: Motion, first: str, second: str, damping: float = 0.0) -> Any:
    phi = np.unwrap(m[f"{second}.angle"] - m[f"{first}.angle"])
    rate = m[f"{second}.omega"] - m[f"{first}.omega"]
    phi = phi - TURN * np.ceil((phi[0] - np.pi) / TURN)
    return -(np.degrees(0.4) * (phi - np.radians(20)) + np.degrees(damping) * rate) * rate


def power_of_damper(m: Motion) -> Any:
    d, dd = z(m, "B") - 0.05, v(m, "B")  # from the ground at 50 mm
    stretched = np.abs(d)
    rate = (d.conjugate() * dd).real / stretched
    return -(2000.0 * (stretched - 0.25) + 300.0 * rate) * rate


def dot(a: Any, b: Any) -> Any:
    return (np.conj(a) * b).real


# On the carried block, whose crank turns at 90 rpm, 3 pi rad/s: mm, N, degrees. By hand, of its motion: power, W.
KINDS: dict[str, tuple[scene_files.Changes, Callable[[Motion], Any]]] = {
    "moment": (load(body="rocker", moment=5), lambda m: 5 * m["rocker.omega"]),
    "periodic moment by the drive": (
        load(body="crank", over="drive", table=TABLE, periodic=True),
        lambda m: np.interp(m["crank_angle"], *CYCLE, period=2 * TURN) * 3 * np.pi,
    ),
    "moment by the drive": (
        load(body="coupler", over="drive", table=TABLE),
        lambda m: np.interp(m["crank_angle"], *CYCLE) * m["coupler.omega"],
    ),
    "force by a slider's displacement": (
        load(body="block", at="P", along=[0, 3], over="displacement", table=[[150, 20], [250, -10]]),
        lambda m: np.interp(along_coupler(m)[0], [0.15, 0.25], [20, -10]) * m["P.vy"],
    ),
    "turning force": (
        load(body="coupler", at="B", force=[30, -20], frame="body"),
        lambda m: dot((30 - 20j) * np.exp(1j * m["coupler.angle"]), v(m, "B")),
    ),
    "force by the time": (
        load(body="rocker", at="B", along=[3, 4], over="time", table=[[0.1, 50], [0.7, -20]]),
        lambda m: np.interp(m["time"], [0.1, 0.7], [50, -20]) * dot(0.6 + 0.8j, v(m, "B")),
    ),
    "turning force by the time": (
        load(body="bar", at="P", along=[3, -4], over="time", table=[[0.1, 50], [0.3, 0], [0.5, 50]], periodic=True)
        | {"loads.0.frame": "body"},
        lambda m: (
            np.interp(m["time"], [0.1, 0.3, 0.5], [50, 0, 50], period=0.4)
            * dot((0.6 - 0.8j) * np.exp(1j * m["bar.angle"]), v(m, "P"))
        ),
    ),
    "force along a guide": (load(body="block", at="P", force=12), lambda m: 12 * along_coupler(m)[1]),
    "force along a guide by displacement": (
        load(body="block", at="P", table=[[150, -30], [250, 10]]),
        lambda m: np.interp(along_coupler(m)[0], [0.15, 0.25], [-30, 10]) * along_coupler(m)[1],
    ),
    "spring and damper": (
        {"ground.points.S": [50, 0]}
        | {"springs": [{"between": ["ground.S", "rocker.B"], "stiffness": 2, "length": 250, "damping": 0.3}]},
        power_of_damper,
    ),
    "spring that twists": (
        twisted("B", "rocker", "coupler", damping=0.01),
        lambda m: power_of_twist(m, "rocker", "coupler", 0.01),
    ),
    "spring that is wound up": (twisted("A", "crank", "coupler"), lambda m: power_of_twist(m, "crank", "coupler")),
    "spring that the drive winds up": (
        twisted("O", "crank", "ground") | {"drive.start": 400},
        lambda m: -np.degrees(0.4) * (-m["crank_angle"] - np.radians(20)) * -3 * np.pi,
    ),
}


@pytest.mark.parametrize("kind", KINDS)
def test_virtual_work(kind: str) -> None:
    """Over three turns, whose samples are asked for in any order."""
    changes, power_of = KINDS[kind]
    scene = machine(changes)
    position, time = Sampling(samples=120, turns=3).commanded(scene), Sampling(samples=120, turns=3).times(scene)
    bare = analytic.solve(replace(scene, loads=(), springs=(), torsion_springs=()), position, time)
    power = power_of(bare)
    shuffled = np.random.default_rng(0).permutation(len(position))
    torque = np.empty(len(position))
    torque[shuffled] = analytic.solve(scene, position[shuffled], time[shuffled])["drive.torque"]
    assert np.ptp(power) > 0.1
    off = (torque - bare["drive.torque"]) * 3 * np.pi + power
    assert np.abs(off).max() <= CLOSE * max(np.abs(power).max(), np.abs(bare["drive.torque"]).max() * 3 * np.pi)


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
    changes = {"drive.law": law, "drive.speed": None} | twisted("A", "crank", "coupler")
    scene = machine(changes)
    time = np.linspace(0, 2, 400)
    driven = scene.drive.law.at(time)
    m = analytic.solve(scene, driven.position, time)
    bare = analytic.solve(replace(scene, torsion_springs=()), driven.position, time)
    off = (m["drive.torque"] - bare["drive.torque"]) * driven.rate + power_of_twist(bare, "crank", "coupler")
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


def busy() -> Scene:
    """A machine with all of these at once."""
    every = [changes for changes, _ in KINDS.values()]
    together: dict[str, Any] = {"ground.points.S": [50, 0]}
    for key in ("loads", "springs", "torsion_springs"):
        together[key] = [element for changes in every for element in changes.get(key, ())]
    return machine(together | {"drive.start": -30})


def asked(scene: Scene) -> tuple[Any, Any]:
    sampling = Sampling(samples=37, turns=2)
    return sampling.commanded(scene), sampling.times(scene)


@pytest.mark.parametrize("settings", WORK_PRECISION)
def test_against_50_digits(settings: AnalyticSettings) -> None:
    """Every setting within what a rounding or a difference leaves of it."""
    scene = busy()
    assert scene.kinds >= ALL_KINDS - PLAIN_KINDS - {"cylinders that drive", "drives between moving bodies", "friction"}
    simulation = engine.build(scene, settings, Sampling(samples=24))
    simulation.solve()
    found, tolerance = simulation.read(), {"single precision": 1e-5, "differences 360": 1e-3}  # some of a step squared
    true = exact(scene, Sampling(24))
    assert_close(
        found.samples, {name: true[name] for name in force_channels(scene)}, tolerance.get(settings.label, CLOSE)
    )


@pytest.mark.parametrize("compiled", [False] + COMPILES * [True])
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
        assert_close(found, {name: motion[name] for name in channels(scene)}, 1e-11)  # Newton's roundings


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


def test_where_the_ends_of_a_damper_meet() -> None:
    """It has no direction there; the engine names it and the place, also where round-off keeps its ends apart."""
    damper = {"between": ["ground.S", "lever.C"], "damping": 3}
    scene = scene_files.load("lever", {"ground.points.S": [1000, 0], "springs": [damper], "gravity": None})
    for motion in (analytic.solve(scene, [0.0, 0.5]), analytic.fast_solver(scene)(np.array([0.0, 0.5]))):
        assert np.isnan(motion["drive.torque"]).tolist() == [True, False]
    near = replace(scene, ground={**scene.ground, "S": (1.0, 1e-14)})
    for one in (scene, near):
        simulation = engine.build(one, engine.DEFAULT, Sampling(samples=8))
        simulation.solve()
        with pytest.raises(Failure, match=r"ground\.S and lever\.C meet at crank angle 0.0000 deg") as failure:
            simulation.read()
        assert failure.value.status is Status.nonfinite

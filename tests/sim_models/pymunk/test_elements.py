"""Loads, springs and drives of every kind, against formulas by hand and absolute coordinates."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenes
from scenes import Failure, Motion, Sampling, Status
from sim_models.pymunk.engine import DEFAULT, EXACT, FAST
from sim_models.pymunk.settings import PymunkSettings, TextbookSettings
from sim_models.pymunk.sweeps import enough_sweeps
from tests import scene_files
from tests.agreement import errors, worst

from .runs import Array, off, reference, solve

SAMPLING = Sampling(36)
# A crank alone that does not move what is on it: all other bodies without mass.
HEAVY_CRANK: scene_files.Changes = {
    "bodies.crank": {"points": {"O": [0, 0], "A": [0.1, 0]}, "mass": 20, "com": [0.1, 0], "inertia": 0}
}
HEAVY_CRANK |= {"bodies.cylinder.mass": 0, "bodies.rod.mass": 0}


def vector(motion: Motion, point: str, rate: str = "") -> Array:
    """A point's place or velocity, as complex numbers."""
    return np.asarray(motion[f"{point}.{rate}x"] + 1j * motion[f"{point}.{rate}y"])


def along_guide(motion: Motion) -> tuple[Array, Array]:
    """How far the block is along the coupler, m, and how fast it moves there, m/s."""
    back, omega = np.exp(-1j * motion["coupler.angle"]), motion["coupler.omega"]
    apart = vector(motion, "P") - vector(motion, "A")
    slip = vector(motion, "P", "v") - vector(motion, "A", "v") - 1j * omega * apart
    return (back * apart).real, (back * slip).real


def power(force: Any, motion: Motion, point: str = "B") -> Array:
    return np.asarray((np.conj(force) * vector(motion, point, "v")).real)


def damped(motion: Motion) -> Array:
    """What a spring of 2000 N/m and 200 mm with a damper of 500 N s/m from F, (150, 500) mm, to B does to it."""
    apart = vector(motion, "B") - (0.15 + 0.5j)
    rate = (np.conj(apart) * vector(motion, "B", "v")).real / np.abs(apart)
    return np.asarray(-(2000 * (np.abs(apart) - 0.2) + 500 * rate) * rate)


def twisted(motion: Motion) -> Array:
    """What a spring of 5 N m/deg, without moment at 20 deg, and 3 N m s/deg does between coupler and rocker."""
    phi = motion["rocker.angle"] - motion["coupler.angle"]
    phi, rate = phi - 2 * np.pi * np.round(phi[0] / (2 * np.pi)), motion["rocker.omega"] - motion["coupler.omega"]
    return np.asarray(-(5 * (np.rad2deg(phi) - 20) + 3 * np.rad2deg(rate)) * rate)


def saw(x: Array) -> Array:
    """Up from 0 to 30 at a third of a period and down again."""
    return np.interp(x % 1, [0, 1 / 3, 1], [0, 30, 0])


TABLE = [[0, 0], [1, 30], [3, 0]]
# What acts on the carried block's linkage, and its power: by hand, from the places and rates of a run without it.
ELEMENTS: dict[str, tuple[dict[str, list[dict[str, Any]]], Callable[[Motion], Array]]] = {
    "a force that turns": (
        {"loads": [{"body": "coupler", "at": "B", "force": [30, -20], "frame": "body"}]},
        lambda motion: power((30 - 20j) * np.exp(1j * motion["coupler.angle"]), motion),
    ),
    "a force along a moving guide": (
        {"loads": [{"body": "block", "force": 40}]},
        lambda motion: 40 * along_guide(motion)[1],
    ),
    "a gas spring": (
        {"loads": [{"body": "block", "table": [[0, 100], [100, 20], [300, 10]]}]},
        lambda motion: np.interp(along_guide(motion)[0], [0, 0.1, 0.3], [100, 20, 10]) * along_guide(motion)[1],
    ),
    "a force over the drive": (
        {"loads": [{"body": "rocker", "at": "B", "along": [3, 4], "over": "drive", "table": [[-90, 5], [270, 41]]}]},
        lambda motion: power(
            (0.6 + 0.8j) * np.interp(motion["crank_angle"], [-np.pi / 2, 1.5 * np.pi], [5, 41]), motion
        ),
    ),
    "a moment": ({"loads": [{"body": "rocker", "moment": 7}]}, lambda motion: 7 * motion["rocker.omega"]),
    "a periodic moment over the time": (
        {"loads": [{"body": "bar", "over": "time", "periodic": True, "table": [[10 * t, m] for t, m in TABLE]}]},
        lambda motion: saw(motion["time"] / 30) * motion["bar.omega"],
    ),
    "a turning force over two turns of the drive": (
        {
            "loads": [
                {"body": "coupler", "at": "B", "along": [0, 1], "over": "drive", "frame": "body", "periodic": True}
                | {"table": [[240 * x, f] for x, f in TABLE]}
            ]
        },
        lambda motion: power(
            1j * saw(motion["crank_angle"] / (4 * np.pi)) * np.exp(1j * motion["coupler.angle"]), motion
        ),
    ),
    "a spring with a damper": (
        {"springs": [{"between": ["ground.F", "rocker.B"], "stiffness": 2, "length": 200, "damping": 0.5}]},
        damped,
    ),
    "a spring that twists": (
        {"torsion_springs": [{"at": "B", "between": ["coupler", "rocker"], "stiffness": 5, "angle": 20, "damping": 3}]},
        twisted,
    ),
}


@pytest.mark.parametrize("name", ELEMENTS)
def test_the_drive_does_what_an_element_takes(name: str) -> None:
    element, work = ELEMENTS[name]
    sampling = Sampling(36, turns=2)
    without = solve(scene_files.load("carried_block"), sampling=sampling)
    motion = solve(scene_files.load("carried_block", dict(element)), sampling=sampling)  # its impulses are checked
    expected = -work(without) / (90 * 2 * np.pi / 60)
    # Measured: 2e-6 of the motion, which the extrapolation leaves.
    assert off(motion["drive.torque"] - without["drive.torque"], expected) <= 1e-5


def test_a_spring_winds_up_over_whole_turns() -> None:
    """On a crank with its weight at 0.1 m: m g l cos(angle), less the spring's -k (phi - angle) - c omega."""
    spring = {"at": "O", "stiffness": 5, "angle": 100, "damping": 2}
    for order, start in ((["ground", "crank"], 3.0), (["crank", "ground"], 9.0)):
        drive = {"body": "crank", "speed": -4, "start": start}
        turned = {"drive": drive, "gravity": [0, -10], "torsion_springs": [spring | {"between": order}]}
        motion = solve(scene_files.load("telescope", {**turned, **HEAVY_CRANK}), FAST, Sampling(36, turns=3))
        phi, sign = motion["crank_angle"], 1 if order[0] == "ground" else -1
        assert phi[0] == pytest.approx(start)
        expected = 20 * 10 * 0.1 * np.cos(phi) + 5 * (phi - sign * 100) + 2 * -4
        assert off(motion["drive.torque"], expected) <= 1e-9  # rounding: on nothing else does a force act


# At time zero a spring's angle lies within half a turn of zero: the rocker's, wherever its sketch may have begun.
@pytest.mark.parametrize("angle", [-400, 20, 400])
def test_a_wound_spring_keeps_its_turns(angle: float) -> None:
    spring = {"at": "C", "between": ["ground", "rocker"], "stiffness": 5, "angle": angle}
    motion = solve(scene_files.load("carried_block", {"torsion_springs": [spring]}), FAST, SAMPLING)
    without = solve(scene_files.load("carried_block"), FAST, SAMPLING)
    phi = np.rad2deg(without["rocker.angle"])
    assert np.all(np.abs(phi) < 180)
    expected = 5 * (phi - angle) * without["rocker.omega"] / (90 * 2 * np.pi / 60)
    assert off(motion["drive.torque"] - without["drive.torque"], expected) <= 1e-4


def test_forces_by_rates_are_second_order() -> None:
    both = {
        key: table
        for name in ("a spring with a damper", "a spring that twists")
        for key, table in ELEMENTS[name][0].items()
    }
    scene = scene_files.load("carried_block", both)
    exact = solve(scene, EXACT, SAMPLING)["drive.torque"]
    coarse, fine = (
        off(solve(scene, PymunkSettings("", n, 1, 2000), SAMPLING)["drive.torque"], exact) for n in (144, 288)
    )
    assert np.log2(coarse / fine) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize("name", ELEMENTS)
def test_the_textbook_set_up_refuses_what_it_does_not_know(name: str) -> None:
    with pytest.raises(Failure, match="constant loads only"):
        solve(scene_files.load("carried_block", dict(ELEMENTS[name][0])), TextbookSettings("", 60))


# --- drives between moving bodies ------------------------------------------------------------------------------------

ROD_ON_THE_GROUND = {
    "bodies.rod.points": {"A": [10, 20]},
    "bodies.cylinder.points": {"B": [0, 0]},
    "bodies.bucket.points": {"B": [0, 300], "D": [0, 0], "T": [500, 0]},
}
STICK_FIRST = {"drive.body": "boom", "drive.on": "stick", "drive.speed": -20, "drive.start": 110, "drive.end": 60}
# A law with jumps of the acceleration.
JUMPS = [{"to": 700, "within": 0.6, "law": "harmonic"}, {"within": 0.1}, {"to": 560, "within": 0.5, "law": "harmonic"}]
BY_LAW = {"drive": {"body": "rod", "start": 560, "periodic": True, "segments": JUMPS}}
DRIVES: list[tuple[str, scene_files.Changes]] = [
    *((name, scene_files.NONE) for name in ("bucket", "busy_bucket", "swung_bucket", "elbow", "sleeved_elbow", "lift")),
    *(("bucket", ROD_ON_THE_GROUND), ("bucket", BY_LAW), ("elbow", {**STICK_FIRST, "sketch.angle": 90})),
]


@pytest.mark.parametrize(("name", "changes"), DRIVES)
def test_moving_drives_against_the_reference(name: str, changes: scene_files.Changes) -> None:
    scene = scene_files.load(name, changes)
    motion, expected = solve(scene, DEFAULT, SAMPLING), reference(scene, SAMPLING)
    # Rounding: the joint is the last that a sweep solves, and it is told where the step leads.
    assert off(motion[scene.drive_channel], SAMPLING.commanded(scene)) <= 1e-12
    # Measured: 4e-5 of accelerations of the elbow, which the extrapolation leaves, and less of all others.
    assert max(worst(errors(motion, expected)).values()) <= 2e-4


@pytest.mark.parametrize("name", ["swung_bucket", "elbow"])
def test_moving_drives_are_second_order(name: str) -> None:
    scene = scene_files.load(name, {"drive.speed": 0.5} if name == "swung_bucket" else scene_files.NONE)
    expected = reference(scene, SAMPLING)
    coarse, fine = (worst(errors(solve(scene, PymunkSettings("", n, 1, 2000), SAMPLING), expected)) for n in (144, 288))
    for order in ("x", "vx", "ax", "angle", "omega", "alpha"):
        # Measured: within 0.05. A cylinder that aims at the position itself is as good, but for the drive's.
        assert np.log2(coarse[order] / fine[order]) == pytest.approx(2, abs=0.1), order


def test_a_lifts_cylinder_carries_the_weight_by_its_way() -> None:
    """All but the table without mass: force times the cylinder's rate is m (g + a) times the table's."""
    parts: scene_files.Changes = {f"bodies.{name}.mass": 0 for name in ("block", "roller")}
    parts |= {f"bodies.{name}.{key}": 0 for name in ("one", "two", "cylinder", "rod") for key in ("mass", "inertia")}
    motion = solve(scene_files.load("lift", parts), DEFAULT, SAMPLING)
    # Measured: 1e-8.
    assert off(motion["drive.force"] * 0.02, 200 * (9.81 + motion["D.ay"]) * motion["D.vy"]) <= 1e-6
    # The massless cylinder, an aligned pair, only pushes: its pins carry what the drive and the guide do together.
    force = np.abs(motion["drive.force"] + 1j * motion["rod.guide_force"])
    assert off(np.hypot(motion["Q.fx"], motion["Q.fy"]), force) <= 1e-9


def test_an_elbows_torque_by_virtual_work() -> None:
    """With a mass in the stick alone: the torque's power is that of its inertia and weight; the bars only push."""
    scene = scene_files.load("elbow", {"bodies.boom.mass": 0, "bodies.bar.mass": 0})
    motion = solve(scene, DEFAULT, SAMPLING)
    omega, alpha, arm = motion["stick.omega"], motion["stick.alpha"], 0.25 * np.exp(1j * motion["stick.angle"])
    rate = vector(motion, "P", "v") + 1j * omega * arm
    acceleration = vector(motion, "P", "a") + (1j * alpha - omega**2) * arm
    taken = 5 * (np.conj(acceleration + 9.81j) * rate).real + 0.2 * alpha * omega  # 5 kg, 0.2 kg m^2
    assert off(motion["drive.torque"] * 20 * 2 * np.pi / 60, taken) <= 1e-4  # measured: 2e-5 of accelerations
    # What turns the stick turns the boom back, which has a pin at A alone: the moment of its pin at P about A.
    at_boom = (np.conj(vector(motion, "P")) * (motion["P.fx"] + 1j * motion["P.fy"])).imag
    assert off(at_boom, -motion["drive.torque"]) <= 1e-9


# A rod on the crank's pin in a cylinder that swings, each shown by one point, 0.06 m of the guide from the pin.
SWUNG = {"bodies.cylinder.points": {"C": [0, 0]}, "bodies.rod.slides.through": [0, 0.06], "sketch": {"A": [0.1, 0.02]}}
HELD = """
format = 1
name = "held"
ground.points = { A = [0, 0], D = [2, 0] }
bodies.boom = { points = { A = [0, 0], B = [1, 1] } }
bodies.strut = { points = { B = [0, 0], D = [1, -1] } }
bodies.stick = { points = { B = [0, 0], T = [1, 0] } }
drive = { body = "stick", on = "boom", speed = 1, start = 2 }
sketch = { angle = 9, B = [1.1, 0.9] }
output = { point = "T" }
"""


def test_the_sketch_turns_cylinders_and_elbows(tmp_path: Path) -> None:
    """Of a passive cylinder the displacement is positive; a stick without a point of its own is as the boom shows."""
    motion = solve(scene_files.load("telescope", SWUNG), FAST, SAMPLING)
    apart = vector(motion, "A") - 0.3
    further = np.sqrt(np.abs(apart) ** 2 - 0.06**2)
    assert np.exp(1j * motion["rod.angle"]) == pytest.approx(apart / (further + 0.06j), abs=1e-5)
    (tmp_path / "held.toml").write_text(HELD)
    motion = solve(scenes.load(tmp_path / "held.toml"), FAST, SAMPLING)
    assert motion["crank_angle"] == pytest.approx(2 + motion["time"], abs=1e-12)
    assert vector(motion, "T") == pytest.approx(1 + 1j + np.exp(1j * (2 + motion["time"])), abs=1e-5)


def test_what_cannot_drive_between_moving_bodies_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    motor = PymunkSettings("", 72, 1, 10, extra="motor")
    for name, settings, reason in (
        ("bucket", TextbookSettings("", 60), "the textbook set-up has a motor on the ground only"),
        ("elbow", motor, "pymunk has motors for cranks at a constant speed only"),
        ("bucket", PymunkSettings("", 72, 1, 10, correction=0.5), "a drive between moving bodies lags"),
    ):
        with pytest.raises(Failure, match=reason) as caught:
            solve(scene_files.load(name), settings)
        assert caught.value.status is Status.unsupported
    monkeypatch.setattr("sim_models.pymunk.sweeps.MOST", 50)
    enough_sweeps.cache_clear()
    with pytest.raises(Failure, match="a step would need") as caught:
        solve(scene_files.load("lift"))
    assert caught.value.status is Status.not_converged

"""Moments, forces along guides, turning and by tables, dampers and springs that twist, against formulas by hand."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from scenes import Failure, Motion, Sampling
from sim_models.pymunk.engine import EXACT, FAST
from sim_models.pymunk.settings import PymunkSettings, TextbookSettings
from tests import scene_files

from .runs import Array, off, solve

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

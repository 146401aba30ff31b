"""Loads, springs and drives of all kinds: where nothing has a mass, the drive does the work against all that acts."""

from collections.abc import Callable
from math import pi, tau
from typing import Any, TypeAlias

import numpy as np
import pytest

from scenes import Failure, Motion, Sampling
from tests import scene_files
from tests.agreement import where

from .runs import EPS, Array, run

flint = pytest.importorskip("flint")

from sim_models.multiprecision import engine as model  # noqa: E402  (its engine is there)

A, D, SPEED = 0.4j, 0.6, 0.1  # of the bucket
ROUNDED = 1e-14  # of the largest power: what doubles leave of a sum of ten terms

Power: TypeAlias = Callable[[Motion], Any]  # W, of what a motion's forces do to the bodies
ROWS = [[0.1, 2.0], [0.2, -1.0], [0.45, 2.0]]
BENT = [[0.5, 2.0], [0.6, -1.0], [0.7, 1.0]]


def along(motion: Motion, name: str) -> Any:
    """Return the unit vector of a body's x axis."""
    return np.exp(1j * motion[f"{name}.angle"])


def dot(force: Any, motion: Motion, point: str) -> Any:
    return (np.conj(force) * (motion[f"{point}.vx"] + 1j * motion[f"{point}.vy"])).real


def tabled(argument: Array, rows: list[list[float]] = ROWS, *, periodic: bool = True) -> Any:
    x, f = np.array(rows).T
    return np.interp(argument, x, f, period=x[-1] - x[0] if periodic else None)


def pull(motion: Motion) -> Any:
    """Return the power of a spring and damper between A and T."""
    way = where(SCENE, motion, "T") - A
    length = np.abs(way)
    rate = dot(way / length, motion, "T")
    return -(40 * (length - 0.2) + 7 * rate) * rate


def twist(motion: Motion) -> Any:
    """Return the power of a torsion spring between rod and bucket."""
    phi, rate = (motion[f"bucket.{of}"] - motion[f"rod.{of}"] for of in ("angle", "omega"))
    return -(3 * (phi - 1) + 0.5 * rate) * rate


SCENE = scene_files.load("swung_bucket")
FORCE = {"body": "bucket", "at": "T", "force": [3, -5], "frame": "body"}
TABLE = {"body": "bucket", "at": "T", "along": [3, 4], "periodic": True, "table": ROWS}
DAMPER = {"between": ["ground.A", "bucket.T"], "stiffness": 40, "length": 0.2, "damping": 7}
TORSION = {"at": "B", "between": ["rod", "bucket"], "stiffness": 3, "angle": 1, "damping": 0.5}
ELEMENTS: dict[str, tuple[str, dict[str, Any], Power]] = {
    "body's force": ("loads", FORCE, lambda m: dot((3 - 5j) * along(m, "bucket"), m, "T")),
    "table over time": ("loads", {**TABLE, "over": "time"}, lambda m: dot(tabled(m["time"]) * (0.6 + 0.8j), m, "T")),
    "body's table over the drive": (
        "loads",
        {**TABLE, "over": "drive", "frame": "body"},
        lambda m: dot(tabled(m["drive.displacement"]) * (0.6 + 0.8j) * along(m, "bucket"), m, "T"),
    ),
    "moment": ("loads", {"body": "bucket", "moment": -4}, lambda m: -4 * m["bucket.omega"]),
    "moment's table": (
        "loads",
        {"body": "bucket", "over": "time", "table": ROWS},
        lambda m: tabled(m["time"], periodic=False) * m["bucket.omega"],
    ),
    "guide's force": ("loads", {"body": "rod", "force": 3}, lambda _: 3 * SPEED),
    "guide's table": (
        "loads",
        {"body": "rod", "table": BENT},
        lambda m: SPEED * tabled(m["drive.displacement"], BENT, periodic=False),
    ),
    "damper": ("springs", DAMPER, pull),
    "torsion spring": ("torsion_springs", TORSION, twist),
}


@pytest.mark.parametrize("element", ELEMENTS)
def test_the_cylinder_does_the_work_against_every_element(element: str) -> None:
    table, keys, power = ELEMENTS[element]
    motion = run(scene_files.load("swung_bucket", {table: [keys]}), 24)
    against = power(motion) + 0 * motion["time"]
    assert np.abs(motion["drive.force"] * SPEED + against).max() <= ROUNDED * np.abs(against).max()


def test_a_cylinder_is_as_long_as_its_drive_asks() -> None:
    """B is beside A by the guide's offset from A and ahead by the displacement from there, and turns about D."""
    motion = run(SCENE)
    B, e = where(SCENE, motion, "B"), 0.8 + 0.6j
    way = 0.06j - (0.1 - 0.05j) + e * motion["drive.displacement"]
    np.testing.assert_allclose(B - A, way * along(motion, "rod"), rtol=0, atol=4 * EPS)
    np.testing.assert_allclose(np.abs(B - D), 0.3, rtol=0, atol=4 * EPS)
    assert motion["drive.displacement"][-1] == 0.75


def test_forces_along_a_guide_act_at_their_point() -> None:
    """A force at C, beside B, turns rod and cylinder apart, which their guide's moment about B holds."""
    at_B, at_C = (
        run(scene_files.load("swung_bucket", {"loads": [{"body": "rod", "at": at, "force": 3}]})) for at in ("B", "C")
    )
    beside = ((0.18 + 0.07j) * (0.8 - 0.6j)).imag
    np.testing.assert_allclose(at_C["rod.guide_moment"] - at_B["rod.guide_moment"], 3 * beside, atol=1e-14)
    np.testing.assert_allclose(at_C["drive.force"], at_B["drive.force"], atol=1e-14)


def test_damper_whose_ends_meet_is_refused() -> None:
    damper = {"between": ["ground.A", "rod.C"], "damping": 2}
    at = {"bodies.cylinder.points.A": [0, 0], "bodies.rod.points": {"B": [0, 0], "C": [-0.625, 0]}, "drive.start": 0.5}
    at["bodies.rod.slides"] = {"on": "cylinder", "through": [0, 0], "along": [1, 0]}
    with pytest.raises(Failure, match=r"ground\.A and rod\.C meet at rod at 0\.625 m"):
        run(scene_files.load("swung_bucket", {"springs": [damper], **at}), 2)


def test_an_elbow_turns_the_stick_from_the_boom() -> None:
    """The sketch shows the boom alone; either may be what the drive turns."""
    load = {"loads": [{"body": "stick", "at": "T", "force": [2, -3]}]}
    scene = scene_files.load("sleeved_elbow", load)
    motion = run(scene, 24)
    apart = motion["stick.angle"] - motion["boom.angle"]
    np.testing.assert_allclose(np.remainder(apart - motion["crank_angle"] + pi, tau), pi, rtol=0, atol=4 * EPS)
    assert (motion["crank_angle"][0], motion["crank_angle"][-1]) == (-0.9, -2.2)
    power = dot(2 - 3j, motion, "T")
    assert np.abs(motion["drive.torque"] * -0.5 + power).max() <= ROUNDED * np.abs(power).max()
    beside = (1.5 + 0.2j - where(scene, motion, "E")) / along(motion, "stick")  # of the pin P, in the stick's frame
    np.testing.assert_allclose(beside.imag, 0.1, rtol=0, atol=4 * EPS)
    assert beside.real.min() > 0
    other = {"drive": {"body": "boom", "on": "stick", "speed": 0.5, "start": 0.9, "end": 2.2}, "sketch.angle": 1.5}
    turned = run(scene_files.load("sleeved_elbow", load | other), 24)
    np.testing.assert_allclose(turned["drive.torque"], -motion["drive.torque"], rtol=0, atol=1e-13)
    np.testing.assert_allclose(where(scene, turned, "T"), where(scene, motion, "T"), rtol=0, atol=1e-14)


def test_twists_go_on_over_whole_turns() -> None:
    """Between crank and ground from where the drive is, and between the coupler and the crank from half a turn."""
    spring = {"stiffness": 2, "angle": 1, "damping": 0.1}
    springs = [{"at": "A", "between": ["ground", "crank"]}, {"at": "B", "between": ["crank", "coupler"]}]
    changes: dict[str, Any] = {
        "bodies.coupler.mass": 0,
        "bodies.crank.mass": 0,
        "bodies.rocker.mass": 0,
        "drive.start": 9,
    }
    changes |= {"bodies.coupler.inertia": 0, "loads": [], "torsion_springs": [spring | place for place in springs]}
    scene = scene_files.load("loaded_four_bar", {**changes, "gravity": None})
    simulation = model.build(scene, model.DEFAULT, Sampling(24, turns=2))
    simulation.solve()
    motion = simulation.read()
    apart = np.unwrap(motion["coupler.angle"] - motion["crank.angle"])
    phi = {"ground": motion["crank_angle"], "crank": apart - tau * np.ceil(apart[0] / tau - 0.5)}
    rate = {"ground": motion["crank.omega"], "crank": motion["coupler.omega"] - motion["crank.omega"]}
    against = sum((2 * (phi[on] - 1) + 0.1 * rate[on]) * rate[on] for on in phi)
    assert np.ptp(phi["crank"]) > 3 * pi
    assert np.abs(motion["drive.torque"] * -7 - against).max() <= 10 * ROUNDED * np.abs(against).max()


@pytest.mark.parametrize("sketched", [(0.9, 0.1), (0.06, 0.05)])
def test_a_cylinder_that_does_not_drive_is_pushed_out(sketched: tuple[float, float]) -> None:
    """A gas spring between the ground and the crank: of two displacements as long it is the positive one."""
    guide = {"on": "cylinder", "through": [0, 0.1], "along": [-1, 0]}
    bodies = {
        "cylinder": {"points": {"C": [0, 0]}, "mass": 0},
        "rod": {"points": {"B": [0, 0]}, "mass": 0, "slides": guide},
        "crank": {"lengths": {"A-B": 0.6}, "mass": 0},
    }
    pushed = {"body": "rod", "over": "displacement", "table": [[0.2, 50], [1, 20]]}
    changes = {"ground.points": {"A": [0.8, 0], "C": [0, 0]}, "bodies": bodies, "gravity": None, "drive.start": 0}
    sketch = {"angle": 3.0, "B": [*sketched]}
    scene = scene_files.load("loaded_four_bar", {**changes, "loads": [pushed], "sketch": sketch, "output.point": "B"})
    motion = run(scene, 24)
    B = where(scene, motion, "B")
    s = np.sqrt(np.abs(B) ** 2 - 0.1**2)
    np.testing.assert_allclose(along(motion, "rod") * (0.1j - s), B, rtol=0, atol=4 * EPS)
    rate = dot(B / s, motion, "B")
    power = tabled(s, [[0.2, 50], [1, 20]], periodic=False) * rate
    assert np.abs(motion["drive.torque"] * -7 + power).max() <= ROUNDED * np.abs(power).max()

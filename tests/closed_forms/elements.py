"""Loads and springs of every kind, each on a machine whose drive does the work against it.

A power is written by hand, of the places and rates of the motion itself.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from scenes import Motion
from tests.scene_files import Changes

from .row import CARRIED, CRANK, CYLINDER, Row, dot, heading, place, velocity

Power = Callable[[Motion], Any]  # W, of an element
TURN = 2 * np.pi


def load(**keys: Any) -> Changes:
    return {"loads": [keys]}


def spring(*between: str, **keys: Any) -> Changes:
    return {"springs": [{"between": between, **keys}]}


def twisted(at: str, *between: str, **keys: Any) -> Changes:
    return {"torsion_springs": [{"at": at, "between": between, **keys}]}


def twist(motion: Motion, first: str, second: str) -> tuple[Any, Any]:
    """The angle from a body to another, which begins within half a turn and goes on over whole turns, and its rate."""
    angle = np.unwrap(motion[f"{second}.angle"] - motion[f"{first}.angle"])
    return angle - TURN * np.ceil(angle[0] / TURN - 0.5), motion[f"{second}.omega"] - motion[f"{first}.omega"]


def of_twist(first: str, second: str, stiffness: float, rest: float, damping: float = 0.0) -> Power:
    """Of a torsion spring: N m/rad, rad, N m s/rad."""

    def power(motion: Motion) -> Any:
        angle, rate = twist(motion, first, second)
        return -(stiffness * (angle - rest) + damping * rate) * rate

    return power


def of_pull(anchor: complex, point: str, stiffness: float, length: float, damping: float) -> Power:
    """Of a spring with a damper from a place to a point: N/m, m, N s/m."""

    def power(motion: Motion) -> Any:
        apart = place(motion, point) - anchor
        stretched = np.abs(apart)
        rate = dot(apart / stretched, velocity(motion, point))
        return -(stiffness * (stretched - length) + damping * rate) * rate

    return power


# --- a crank of 2 m, which turns at 3 rad/s from 0.1 rad: its powers are those of moments about its pivot -------------

WAVE = [[-1.0, 2.0], [0.5, -3.0], [2.0, 4.0], [3.0, 2.0]]
RISING = {"over": "time", "table": [[0, 1], [9, 10]]}  # 1 + t, N


def wave(x: Any) -> Any:
    arguments, values = np.array(WAVE).T
    return np.interp((x + 1) % 4 - 1, arguments, values)


def crank(against: Callable[[Any, Any], Any], **keys: Any) -> tuple[Changes, Power]:
    return load(body="crank", **keys), lambda m: 3 * against(m["crank_angle"], m["time"])


ON_CRANK: dict[str, tuple[Changes, Power]] = {
    "moment": crank(lambda a, _: 5 + 0 * a, moment=5),
    "no moment": crank(lambda a, _: 0 * a, moment=0),
    "periodic moment over the drive": crank(lambda a, _: wave(a), over="drive", periodic=True, table=WAVE),
    "periodic moment over time": crank(lambda _, t: wave(t), over="time", periodic=True, table=WAVE),
    "turning force": crank(lambda a, _: 4 + 0 * a, at="T", force=[1, 2], frame="body"),
    "force over time": crank(lambda a, t: 2 * np.cos(a) * (1 + t), at="T", along=[0, 3], **RISING),
    "turning force over time": crank(lambda _, t: 2**0.5 * (1 + t), at="T", along=[-2, 2], frame="body", **RISING),
    "torsion spring": (
        twisted("O", "ground", "crank", stiffness=2, angle=0.5, damping=0.3),
        lambda m: -3 * (2 * (m["crank_angle"] - 0.5) + 0.9),
    ),
    "torsion spring, turned round": (
        twisted("O", "crank", "ground", stiffness=2, angle=0.5, damping=0.3),
        lambda m: -3 * (2 * (m["crank_angle"] + 0.5) + 0.9),
    ),
    "spring and damper": (
        spring("ground.P", "crank.T", stiffness=3, length=4, damping=2) | {"ground.points.P": [5, 1]},
        of_pull(5 + 1j, "T", 3, 4, 2),
    ),
    "constant-force spring": (
        {"constant_force_springs": [{"between": ["ground.P", "crank.T"], "force": 6}], "ground.points.P": [5, 1]},
        lambda m: -6 * dot((apart := place(m, "T") - 5 - 1j) / np.abs(apart), velocity(m, "T")),
    ),
}

# --- the carried block, whose crank turns at 90 rpm: mm, N and degrees in the file -----------------------------------

TABLE = [[-90, 2], [40, -3], [360, 7], [630, 2]]  # of 720 degrees
CYCLE = np.radians([-90, 40, 360, 630]), [2, -3, 7, 2]
SAW = [[0, 0], [1, 30], [3, 0]]
AT_B = {"body": "coupler", "at": "B"}


def saw(x: Any) -> Any:
    """Up from 0 to 30 at a third of a period and down again."""
    return np.interp(x % 1, [0, 1 / 3, 1], [0, 30, 0])


def along_coupler(m: Motion) -> tuple[Any, Any]:
    """How far the block is along the coupler, m, and how fast it slips there."""
    u, apart = heading(m, "coupler"), place(m, "P") - place(m, "A")
    slip = velocity(m, "P") - velocity(m, "A") - 1j * m["coupler.omega"] * apart
    return dot(u, apart) - 0.04, dot(u, slip)


def by_displacement(rows: list[list[float]]) -> Power:
    """Of a force along the guide by a table over the displacement, mm."""
    x, force = np.array(rows).T
    return lambda m: np.interp(along_coupler(m)[0], 1e-3 * x, force) * along_coupler(m)[1]


def wound_up(angle: float) -> tuple[Changes, Power]:
    """At time zero a spring's angle lies within half a turn of zero: the rocker's, wherever its sketch began."""
    return (
        twisted("C", "ground", "rocker", stiffness=5, angle=angle),
        lambda m: -5 * (np.rad2deg(m["rocker.angle"]) - angle) * m["rocker.omega"],
    )


GAS: list[list[float]] = [[0, 100], [100, 20], [300, 10]]
ON_CARRIED: dict[str, tuple[Changes, Power]] = {
    "moment": (load(body="rocker", moment=5), lambda m: 5 * m["rocker.omega"]),
    "force": (load(body="rocker", at="B", force=[30, -20]), lambda m: dot(30 - 20j, velocity(m, "B"))),
    "spring": (
        {"ground.points.S": [50, 0]} | spring("ground.S", "rocker.B", stiffness=2, length=250),
        of_pull(0.05, "B", 2000, 0.25, 0),
    ),
    "periodic moment by the drive": (
        load(body="crank", over="drive", table=TABLE, periodic=True),
        lambda m: np.interp(m["crank_angle"], *CYCLE, period=2 * TURN) * 3 * np.pi,
    ),
    "moment by the drive": (
        load(body="coupler", over="drive", table=TABLE),
        lambda m: np.interp(m["crank_angle"], *CYCLE) * m["coupler.omega"],
    ),
    "periodic moment by the time": (
        load(body="bar", over="time", periodic=True, table=[[10 * t, moment] for t, moment in SAW]),
        lambda m: saw(m["time"] / 30) * m["bar.omega"],
    ),
    "force by a slider's displacement": (
        load(body="block", at="P", along=[0, 3], over="displacement", table=[[150, 20], [250, -10]]),
        lambda m: np.interp(along_coupler(m)[0], [0.15, 0.25], [20, -10]) * m["P.vy"],
    ),
    "force by the drive": (
        load(body="rocker", at="B", along=[3, 4], over="drive", table=[[-90, 5], [270, 41]]),
        lambda m: np.interp(m["crank_angle"], [-np.pi / 2, 1.5 * np.pi], [5, 41]) * dot(0.6 + 0.8j, velocity(m, "B")),
    ),
    "turning force": (
        load(**AT_B, force=[30, -20], frame="body"),
        lambda m: dot((30 - 20j) * heading(m, "coupler"), velocity(m, "B")),
    ),
    "turning force over two turns of the drive": (
        load(**AT_B, along=[0, 1], over="drive", frame="body", periodic=True, table=[[240 * x, f] for x, f in SAW]),
        lambda m: saw(m["crank_angle"] / (2 * TURN)) * dot(1j * heading(m, "coupler"), velocity(m, "B")),
    ),
    "force by the time": (
        load(body="rocker", at="B", along=[3, 4], over="time", table=[[0.1, 50], [0.7, -20]]),
        lambda m: np.interp(m["time"], [0.1, 0.7], [50, -20]) * dot(0.6 + 0.8j, velocity(m, "B")),
    ),
    "turning force by the time": (
        load(body="bar", at="P", along=[3, -4], over="time", table=[[0.1, 50], [0.3, 0], [0.5, 50]], periodic=True)
        | {"loads.0.frame": "body"},
        lambda m: (
            np.interp(m["time"], [0.1, 0.3, 0.5], [50, 0, 50], period=0.4)
            * dot((0.6 - 0.8j) * heading(m, "bar"), velocity(m, "P"))
        ),
    ),
    "force along a guide": (load(body="block", at="P", force=12), lambda m: 12 * along_coupler(m)[1]),
    "force along a guide by displacement": (
        load(body="block", at="P", table=[[150, -30], [250, 10]]),
        by_displacement([[150, -30], [250, 10]]),
    ),
    "gas spring": (load(body="block", table=GAS), by_displacement(GAS)),
    "spring and damper": (
        {"ground.points.S": [50, 0]} | spring("ground.S", "rocker.B", stiffness=2, length=250, damping=0.3),
        of_pull(0.05, "B", 2000, 0.25, 300),
    ),
    "spring that twists": (
        twisted("B", "rocker", "coupler", stiffness=0.4, angle=20, damping=0.01),
        of_twist("rocker", "coupler", np.degrees(0.4), np.radians(20), np.degrees(0.01)),
    ),
    "spring that twists, stiff and damped": (
        twisted("B", "coupler", "rocker", stiffness=5, angle=20, damping=3),
        of_twist("coupler", "rocker", np.degrees(5), np.radians(20), np.degrees(3)),
    ),
    "spring that is wound up": (
        twisted("A", "crank", "coupler", stiffness=0.4, angle=20),
        of_twist("crank", "coupler", np.degrees(0.4), np.radians(20)),
    ),
    "spring that the drive winds up": (
        twisted("O", "crank", "ground", stiffness=0.4, angle=20) | {"drive.start": 400},
        lambda m: -np.degrees(0.4) * (-m["crank_angle"] - np.radians(20)) * -3 * np.pi,
    ),
    **{f"spring that is wound up by {angle} degrees": wound_up(angle) for angle in (-400, 20, 400)},
}

# --- a cylinder without masses, which goes out at 0.1 m/s and tilts a bucket: m, N and rad ---------------------------

ROWS = [[0.1, 2.0], [0.2, -1.0], [0.45, 2.0]]
BENT = [[0.5, 2.0], [0.6, -1.0], [0.7, 1.0]]
AT_T = {"body": "bucket", "at": "T", "along": [3, 4], "periodic": True, "table": ROWS}


def tabled(argument: Any, rows: list[list[float]] = ROWS, *, periodic: bool = True) -> Any:
    x, f = np.array(rows).T
    return np.interp(argument, x, f, period=x[-1] - x[0] if periodic else None)


ON_CYLINDER: dict[str, tuple[Changes, Power]] = {
    "turning force": (
        load(body="bucket", at="T", force=[3, -5], frame="body"),
        lambda m: dot((3 - 5j) * heading(m, "bucket"), velocity(m, "T")),
    ),
    "force over time": (
        load(**AT_T, over="time"),
        lambda m: tabled(m["time"]) * dot(0.6 + 0.8j, velocity(m, "T")),
    ),
    "turning force over the drive": (
        load(**AT_T, over="drive", frame="body"),
        lambda m: tabled(m["drive.displacement"]) * dot((0.6 + 0.8j) * heading(m, "bucket"), velocity(m, "T")),
    ),
    "moment": (load(body="bucket", moment=-4), lambda m: -4 * m["bucket.omega"]),
    "moment over time": (
        load(body="bucket", over="time", table=ROWS),
        lambda m: tabled(m["time"], periodic=False) * m["bucket.omega"],
    ),
    "force along the guide": (load(body="rod", force=3), lambda m: 0.3 + 0 * m["time"]),
    "force along the guide by displacement": (
        load(body="rod", table=BENT),
        lambda m: 0.1 * tabled(m["drive.displacement"], BENT, periodic=False),
    ),
    "spring and damper": (
        spring("ground.A", "bucket.T", stiffness=40, length=0.2, damping=7),
        of_pull(0.4j, "T", 40, 0.2, 7),
    ),
    "spring that twists": (
        twisted("B", "rod", "bucket", stiffness=3, angle=1, damping=0.5),
        of_twist("rod", "bucket", 3, 1, 0.5),
    ),
}

ELEMENTS: dict[str, Row] = {
    f"{name} on the {of}": machine.row(changes, power)
    for of, machine, table in (
        ("crank", CRANK, ON_CRANK),
        ("carried block", CARRIED, ON_CARRIED),
        ("cylinder", CYLINDER, ON_CYLINDER),
    )
    for name, (changes, power) in table.items()
}

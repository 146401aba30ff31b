"""Gas springs, springs that wind up and one in resonance, on linkages whose channels are known by themselves."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from scenes import Motion
from tests import scene_files
from tests.scene_files import Changes

from .elements import TURN, of_twist, tabled, twist
from .row import ROUNDED, TWO_ROUNDED, Off, Row, dot, heading, off, place, velocity

# A gas spring: a rod on a crank slides in a block that swings about C. Of each the sketch has the pin alone.
GAS: Changes = {
    **{"springs": None, "sketch": {"angle": -90, "A": [80, 0]}},
    "loads": [{"body": "rod", "at": "T", "table": [[200, 100], [300, 300], [400, 200]]}],
}


def gas_spring(motion: Motion, added: Motion) -> Mapping[str, Off]:
    """Its power is the drive's, and on the block it acts where it acts on the rod, 45 mm above the pin at C."""
    apart = place(motion, "A") - (0.3 + 0.05j)
    s = np.sqrt(np.abs(apart) ** 2 - 0.015**2)  # the rod is out; its guide is 15 mm above C
    force = np.interp(s, [0.2, 0.3, 0.4], [100, 300, 200])
    about_C = 0.045 * force - s * added["rod.guide_force"] - added["rod.guide_moment"]
    power = off(added["drive.torque"] * motion["crank.omega"], -force * dot(apart, velocity(motion, "A")) / s)
    return {"power": power, "about C": (about_C, 90.0)}  # N m


# Between crank and rod for two turns, from 4 rad.
UNWINDING: Changes = {
    **{"drive.start": 4, "bodies.slider.mass": 0, "loads": []},
    "torsion_springs": [
        {"at": "A", "between": ["crank", "rod"], "stiffness": 200, "angle": 0.5, "damping": 30},
        {"at": "B", "between": ["slider", "rod"], "stiffness": 700, "angle": 0.1},
    ],
}


def unwinding(motion: Motion, _: Motion) -> Mapping[str, Off]:
    angle, omega, torque = motion["rod.angle"], motion["rod.omega"], motion["drive.torque"]
    phi, rate = angle - motion["crank_angle"] + TURN, omega - 10
    power = off(10 * torque, (200 * (phi - 0.5) + 30 * rate) * rate + 700 * (angle - 0.1) * omega)
    about_O = torque + motion["B.x"] * motion["slider.guide_force"] + motion["slider.guide_moment"]
    return {"power": power, "about O": (about_O, power[1])}


def wound(order: list[str], start: float) -> Row:
    """A spring on a crank with its weight at 0.1 m: m g l cos(angle), less the spring's -k (phi - angle) - c omega."""
    spring = {"at": "O", "stiffness": 5, "angle": 100, "damping": 2, "between": order}
    changes: Changes = {
        **{"drive": {"body": "crank", "speed": -4, "start": start}, "gravity": [0, -10], "torsion_springs": [spring]},
        "bodies.crank": {"points": {"O": [0, 0], "A": [0.1, 0]}, "mass": 20, "com": [0.1, 0], "inertia": 0},
        **{"bodies.cylinder.mass": 0, "bodies.rod.mass": 0},
    }
    rest = 100 if order[0] == "ground" else -100

    def forces(motion: Motion, _: Motion) -> Mapping[str, Off]:
        phi = motion["crank_angle"]
        return {"torque": off(motion["drive.torque"], 20 * 10 * 0.1 * np.cos(phi) + 5 * (phi - rest) + 2 * -4)}

    return Row(
        lambda: scene_files.load("telescope", changes),
        forces,
        lambda motion: {"drive": motion["crank_angle"] - (start - 4 * motion["time"])},
        turns=3,
        most={"torque": ROUNDED},
    )


def two_springs() -> Row:
    """Between crank and ground from where the drive is, and between the coupler and the crank from half a turn."""
    spring = {"stiffness": 2, "angle": 1, "damping": 0.1}
    springs = [{"at": "A", "between": ["ground", "crank"]}, {"at": "B", "between": ["crank", "coupler"]}]
    changes: Changes = {f"bodies.{name}.mass": 0 for name in ("coupler", "crank", "rocker")}
    changes |= {"drive.start": 9, "bodies.coupler.inertia": 0, "loads": [], "gravity": None}
    changes["torsion_springs"] = [spring | between for between in springs]

    def forces(motion: Motion, _: Motion) -> Mapping[str, Off]:
        turning, phi = motion["crank.omega"], motion["crank_angle"]
        assert np.ptp(twist(motion, "crank", "coupler")[0]) > 3 * np.pi
        power = of_twist("crank", "coupler", 2, 1, 0.1)(motion) - (2 * (phi - 1) + 0.1 * turning) * turning
        return {"power": off(-7 * motion["drive.torque"], -power)}

    return Row(lambda: scene_files.load("loaded_four_bar", changes), forces, turns=2, least=TWO_ROUNDED)


def pushed_out(sketched: tuple[float, float]) -> Row:
    """A gas spring between the ground and the crank: of two displacements as long it is the positive one."""
    guide = {"on": "cylinder", "through": [0, 0.1], "along": [-1, 0]}
    rows: list[list[float]] = [[0.2, 50], [1, 20]]
    changes: Changes = {
        **{"ground.points": {"A": [0.8, 0], "C": [0, 0]}, "gravity": None, "drive.start": 0, "output.point": "B"},
        "bodies": {
            "cylinder": {"points": {"C": [0, 0]}, "mass": 0},
            "rod": {"points": {"B": [0, 0]}, "mass": 0, "slides": guide},
            "crank": {"lengths": {"A-B": 0.6}, "mass": 0},
        },
        "loads": [{"body": "rod", "over": "displacement", "table": rows}],
        "sketch": {"angle": 3.0, "B": [*sketched]},
    }

    def forces(motion: Motion, _: Motion) -> Mapping[str, Off]:
        B = place(motion, "B")
        s = np.sqrt(np.abs(B) ** 2 - 0.1**2)
        power = tabled(s, rows, periodic=False) * dot(B / s, velocity(motion, "B"))
        return {"power": off(-7 * motion["drive.torque"], -power)}

    def places(motion: Motion) -> Mapping[str, Any]:
        B = place(motion, "B")
        s = np.sqrt(np.abs(B) ** 2 - 0.1**2)
        return {"along": np.abs(heading(motion, "rod") * (0.1j - s) - B)}

    return Row(lambda: scene_files.load("loaded_four_bar", changes), forces, places)


def resonance(motion: Motion, _: Motion) -> Mapping[str, Off]:
    """A mass of 1 kg on 100 N/m goes to and fro by 0.1 m and 10 rad/s by itself: its drive has nothing to do."""
    return {"force": off(motion["drive.force"], 0 * motion["time"], 10.0)}


SPRINGS: dict[str, Row] = {
    "gas spring on a swinging block": Row(
        lambda: scene_files.load("swinging_block", GAS), gas_spring, added=True, least=TWO_ROUNDED
    ),
    "torsion spring that unwinds": Row(lambda: scene_files.load("slider_crank", UNWINDING), unwinding, turns=2),
    "spring of the crank, wound up": wound(["ground", "crank"], 3.0),
    "spring of the crank, wound up the other way": wound(["crank", "ground"], 9.0),
    "springs over whole turns": two_springs(),
    "gas spring that is pushed out": pushed_out((0.9, 0.1)),
    "mass on a spring in resonance": Row(lambda: scene_files.load("mass_on_spring"), resonance),
}

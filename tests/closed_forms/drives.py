"""Drives of every kind, on linkages whose channels are known by themselves."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from scenes import Motion
from tests import scene_files
from tests.scene_files import Changes

from .elements import TURN
from .row import ROUNDED, Off, Row, described, dot, heading, off, place, velocity, within_a_turn

# A cylinder pulls a lever with a weight down at the angle t, 13 - 12 sin t = |AB|^2, too slowly for inertia to matter.
LIFT = """
format = 1
name = "lift"
gravity = [0, -10]
ground.points = { A = [0, 0], D = [3, 0] }
bodies.cylinder = { points = { A = [0, 0] }, mass = 0 }
bodies.rod = { points = { B = [0, 0] }, mass = 0, slides = { on = "cylinder", through = [5.5, 0.2], along = [1, 0] } }
bodies.lever = { points = { D = [0, 0], B = [0, 2], W = [4, 0] }, mass = 7, com = [4, 0], inertia = 0 }
drive = { body = "rod", speed = 1e-7, start = -2.7, end = -1.7 }
sketch = { displacement = -2.5, B = [3, 2], W = [7, 0] }
output = { point = "W" }
"""


def lift(motion: Motion, _: Motion) -> Mapping[str, Off]:
    """The cylinder's force is the weight times dh/ds, -2/3 of how far it is out."""
    out = 5.5 + motion["drive.displacement"]  # of the guide, which passes A at 0.2 m
    force = -70 * 2 / 3 * out
    across = 0.2 / out * force  # else the cylinder would turn about A
    at_B = place(motion, "B") / (out + 0.2j) * (force + 1j * across)  # along the guide
    expected = {
        **{"drive.force": force, "rod.guide_force": across, "rod.guide_moment": 0 * out},
        **{"B.fx": at_B.real, "A.fy": at_B.imag, "D.fy": 70 - at_B.imag},
    }
    return {channel: off(motion[channel], values, 200.0) for channel, values in expected.items()}  # N


def lift_places(motion: Motion) -> Mapping[str, Any]:
    s = motion["drive.displacement"]
    sine = (13 - (5.5 + s) ** 2 - 0.2**2) / 12
    return {"W.y": motion["W.y"] - 4 * sine, "drive": s - (1e-7 * motion["time"] - 2.7)}


# Two bars with the drive at their elbow push a slider; positions are nearly a turn more than where they are drawn.
ELBOW = """
format = 1
name = "elbow"
ground.points = { A = [0, 0] }
bodies.boom = { points = { A = [0, 0], P = [1, 0] }, mass = 0 }
bodies.stick = { points = { P = [0, 0], S = [1, 0] }, mass = 0 }
bodies.slider = { points = { S = [0, 0] }, mass = 0, slides = { through = [0, 0], along = [1, 0] } }
drive = { body = "stick", on = "boom", speed = -2, start = 5.28, end = 4.28 }
loads = [{ body = "slider", force = -30 }]
sketch = { angle = 5, P = [0.9, 0.5], S = [1.7, 0] }
output = { slider = "S" }
"""


def elbow(motion: Motion, _: Motion) -> Mapping[str, Off]:
    """The slider is 2 cos(p / 2) from A; the boom takes the reaction, so the guide has nothing to hold."""
    half = motion["crank_angle"] / 2 - np.pi
    expected = {"drive.torque": -30 * np.sin(half), "A.fx": 30 + 0 * half, "P.fx": 30 + 0 * half}
    expected |= dict.fromkeys(("A.fy", "P.fy", "slider.guide_force", "slider.guide_moment"), 0 * half)
    return {channel: off(motion[channel], values, 30.0) for channel, values in expected.items()}


def elbow_places(motion: Motion) -> Mapping[str, Any]:
    half = (5.28 - 2 * motion["time"]) / 2 - np.pi
    return {
        "crank_angle": motion["crank_angle"] - 2 * (half + np.pi),
        "S.x": motion["S.x"] - 2 * np.cos(half),
        "boom.angle": motion["boom.angle"] + half,
    }


# A wheel turns on a triangle of bars, 7 rad and more, which a torsion spring counts too; the sketch does not show it.
WHEEL = """
format = 1
name = "wheel"
ground.points = { A = [0, 0], D = [2, 0] }
bodies.bar = { lengths = { "A-P" = 1.5 }, mass = 1 }
bodies.other = { lengths = { "D-P" = 1.5 }, mass = 1 }
bodies.wheel = { points = { P = [0, 0], W = [0.5, 0] }, mass = 1, com = [0, 0], inertia = 3 }
drive = { body = "wheel", on = "bar", speed = 3, start = 7 }
torsion_springs = [{ at = "P", between = ["bar", "wheel"], stiffness = 2, angle = 0.5 }]
sketch = { angle = 0, P = [1, 1] }
output = { point = "W" }
"""


def wheel(motion: Motion, _: Motion) -> Mapping[str, Off]:
    return {"torque": off(motion["drive.torque"], 2 * (7 + 3 * motion["time"] - 0.5), 30.0)}


def wheel_places(motion: Motion) -> Mapping[str, Any]:
    position = 7 + 3 * motion["time"]
    return {
        "crank_angle": motion["crank_angle"] - position,
        "W.x": motion["W.x"] - 1 - 0.5 * np.cos(np.arccos(1 / 1.5) + position),
        "wheel.angle": within_a_turn(motion["wheel.angle"] - motion["bar.angle"] - position),
    }


PARTS: Changes = {f"bodies.{name}.mass": 0 for name in ("block", "roller")}
PARTS |= {f"bodies.{name}.{key}": 0 for name in ("one", "two", "cylinder", "rod") for key in ("mass", "inertia")}


def table_lift(motion: Motion, _: Motion) -> Mapping[str, Off]:
    """All but the table without mass: force times the cylinder's rate is m (g + a) times the table's.

    The massless cylinder, an aligned pair, only pushes: its pins carry what the drive and the guide do together.
    """
    power = off(0.02 * motion["drive.force"], 200 * (9.81 + motion["D.ay"]) * motion["D.vy"])
    pushed = np.hypot(motion["drive.force"], motion["rod.guide_force"])
    return {"power": power, "pin": off(np.hypot(motion["Q.fx"], motion["Q.fy"]), pushed)}


def heavy_stick(motion: Motion, _: Motion) -> Mapping[str, Off]:
    """With a mass in the stick alone the torque's power is that of its inertia and weight; the bars only push.

    What turns the stick turns the boom back, which has a pin at A alone: the moment of its pin at P about A.
    """
    omega, alpha, arm = motion["stick.omega"], motion["stick.alpha"], 0.25 * heading(motion, "stick")
    rate = velocity(motion, "P") + 1j * omega * arm
    acceleration = motion["P.ax"] + 1j * motion["P.ay"] + (1j * alpha - omega**2) * arm
    taken = 5 * dot(acceleration + 9.81j, rate) + 0.2 * alpha * omega  # 5 kg, 0.2 kg m^2
    at_boom = dot(1j * place(motion, "P"), motion["P.fx"] + 1j * motion["P.fy"])
    power = motion["drive.torque"] * 20 * TURN / 60
    return {"power": off(power, taken), "moment about A": off(at_boom, -motion["drive.torque"])}


def driven_cylinder(motion: Motion) -> Mapping[str, Any]:
    """B is beside A by the guide's offset from A and ahead by the displacement from there, and turns about D."""
    way = 0.06j - (0.1 - 0.05j) + (0.8 + 0.6j) * motion["drive.displacement"]
    apart = place(motion, "B") - 0.4j - way * heading(motion, "rod")
    return {
        "B": np.abs(apart),
        "about D": np.abs(place(motion, "B") - 0.6) - 0.3,
        "drive": motion["drive.displacement"] - (0.55 + 0.1 * motion["time"]),
    }


STICK_FIRST: Changes = {"loads": [{"body": "stick", "at": "T", "force": [2, -3]}]}
BOOM_FIRST: Changes = STICK_FIRST | {
    **{"drive": {"body": "boom", "on": "stick", "speed": 0.5, "start": 0.9, "end": 2.2}, "sketch.angle": 1.5}
}


def sleeved(changes: Changes, sign: int) -> Row:
    """The sketch shows the boom alone; either may be what the drive turns, by 0.5 rad/s from the other."""

    def forces(motion: Motion, _: Motion) -> Mapping[str, Off]:
        power = dot(2 - 3j, velocity(motion, "T"))
        return {"power": off(motion["drive.torque"] * 0.5 * sign, -power)}

    def places(motion: Motion) -> Mapping[str, Any]:
        apart = motion["boom.angle"] - motion["stick.angle"]
        beside = (1.5 + 0.2j - place(motion, "E")) / heading(motion, "stick")  # of the pin P, in the stick's frame
        assert beside.real.min() > 0
        return {
            "apart": within_a_turn(apart - sign * motion["crank_angle"]),
            "drive": motion["crank_angle"] - sign * (0.9 + 0.5 * motion["time"]),
            "beside": beside.imag - 0.1,
        }

    return Row(lambda: scene_files.load("sleeved_elbow", changes), forces, places)


def hanging(motion: Motion, _: Motion) -> Mapping[str, Off]:
    """A crank of 4 kg, its centre 1 m from the pin: m g l cos(phi), and the pin carries its weight and its pull."""
    phi, pull = motion["crank_angle"], 4 * 9.0
    return {
        "torque": off(motion["drive.torque"], 4 * 9.81 * np.cos(phi)),
        "O.fx": off(motion["O.fx"], -pull * np.cos(phi), pull),
        "O.fy": off(motion["O.fy"], 4 * 9.81 - pull * np.sin(phi)),
    }


def nothing(_: Motion, __: Motion) -> Mapping[str, Off]:
    return {}


DRIVES: dict[str, Row] = {
    "cylinder that lifts a weight": Row(lambda: described(LIFT), lift, lift_places),
    "elbow that pushes a slider": Row(lambda: described(ELBOW), elbow, elbow_places),
    "wheel on a bar": Row(lambda: described(WHEEL), wheel, wheel_places),
    "table on scissors": Row(lambda: scene_files.load("lift", PARTS), table_lift, most={"power": 1e-6, "pin": ROUNDED}),
    "elbow with a heavy stick": Row(
        lambda: scene_files.load("elbow", {"bodies.boom.mass": 0, "bodies.bar.mass": 0}),
        heavy_stick,
        most={"moment about A": ROUNDED},
    ),
    "cylinder that tilts a bucket": Row(lambda: scene_files.load("swung_bucket"), nothing, driven_cylinder),
    "elbow with a sleeve, its stick driven": sleeved(STICK_FIRST, -1),
    "elbow with a sleeve, its boom driven": sleeved(BOOM_FIRST, 1),
    "crank with a weight": Row(lambda: scene_files.load("crank", {"gravity": [0, -9.81]}), hanging),
}

"""The shipped presses: geometry and figures from their sources, a law, and a force at the end of the stroke; clamps."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

import scenes
from scenes import Scene
from scenes.scene import PressForce
from tests.agreement import solve as moving
from tests.comparisons import sampled

from .test_library import turned

SERVO_LAW = ((0, 209), (0.15, 274), (0.3, 325), (0.45, 348), (0.6, 371), (0.75, 424), (0.9, 515), (1, 569))  # s, deg


class Press(NamedTuple):
    """A slider that closes against an axis once a cycle and meets a force in the last part of that stroke."""

    scene: Scene
    point: str
    axis: str
    mass: float  # kg, of the slider
    force: float  # N
    last: float  # m

    @property
    def position(self) -> str:
        return f"{self.point}.{self.axis}"


PRESSES = {
    "crank_press": Press(scenes.load("crank_press"), "B", "y", 800, 1600e3, 0.006),
    "servo_press": Press(scenes.load("servo_press"), "P5", "y", 800, 1600e3, 0.006),
    "quick_return": Press(scenes.load("quick_return"), "E", "x", 150, 6e3, 0.400),
}


def stroke(press: Press) -> tuple[float, float]:
    """When the slider meets the force and when its closing stroke ends, s."""
    scene = press.scene

    def at(time: float, channel: str) -> float:
        return float(moving(scene, np.array([time]))[channel][0])

    time = np.linspace(0, scene.cycle, 361)
    way = moving(scene, time)[press.position]
    lowest = int(way.argmin())
    velocity = f"{press.point}.v{press.axis}"
    end = float(brentq(lambda t: at(t, velocity), time[lowest - 1], time[lowest + 1], xtol=1e-15))
    left = at(end, press.position) + press.last
    before = int(np.flatnonzero(way[:lowest] > left)[-1])
    met = float(brentq(lambda t: at(t, press.position) - left, time[before], time[before + 1], xtol=1e-15))
    return met, end


def test_crank_press() -> None:
    dead = turned("crank_press", np.radians([90, 270]))["B.y"]
    assert abs(dead[1] + 1.390 + 0.090) <= 1e-14  # m, rounding; the rod in line below the crank
    assert abs(dead[0] - dead[1] - 0.180) <= 1e-14  # m, rounding; in line, the stroke is twice the crank's radius
    # Where the paper's force begins, 20.40 deg before the lower dead centre; 209.1 mm/s by r, l and the sine law.
    there = turned("crank_press", np.radians([270 - 20.40, 270 - 20.39]))
    assert abs(there["B.y"][0] - dead[1] - 0.006) <= 3e-6  # m; as much as 0.005 deg are
    assert abs(there["B.vy"][0] + 0.2091) <= 1e-4  # m/s; the digits given
    assert abs(there["drive.torque"][1] - 53e3) <= 500  # N m; the digits of the scene's head


def test_servo_press_goes_down_fast_and_presses_slowly() -> None:
    scene, press, plain = scenes.load("servo_press"), PRESSES["servo_press"], scenes.load("toggle_press")
    assert (scene.ground, scene.bodies) == (plain.ground, plain.bodies)
    on_table = moving(scene, np.array([time for time, _ in SERVO_LAW]))["crank_angle"]
    assert np.abs(np.degrees(on_table) - [angle for _, angle in SERVO_LAW]).max() <= 1e-12  # deg, rounding
    rate = np.degrees(scene.drive.law.at(np.linspace(0, 1, 10_001)).rate)
    assert 113 <= rate.min() <= rate.max() <= 638  # deg/s; as the head says, and never backwards
    met, end = stroke(press)
    there = moving(scene, np.array([met, end]))
    constant = turned("toggle_press", there["crank_angle"])
    assert abs(np.degrees(there["crank_angle"][1]) - 372.8) <= 0.05  # deg; this and the rest to the head's digits
    assert abs(there["P5.vy"][0] + 0.054) <= 5e-4  # m/s
    assert abs(constant["P5.vy"][0] + 0.158) <= 5e-4
    upper = turned("toggle_press", np.radians([208.55, 208.65]))
    assert upper["P5.vy"][0] > 0 > upper["P5.vy"][1]


@sampled(1)
@pytest.mark.parametrize("press", PRESSES.values(), ids=PRESSES)
def test_a_force_in_the_last_part_of_the_stroke_acts_there_and_nowhere_else(press: Press) -> None:
    """What the slider's own balance leaves when its inertia and its pin are taken away."""
    switches = np.array(stroke(press))
    end = moving(press.scene, switches)[press.position][1]
    hair = 1e-9  # s, beside the switches: ten thousand times what rounding leaves of them
    time = np.sort([*np.linspace(0, press.scene.cycle, 361), *(switches - hair), *(switches + hair)])
    motion = moving(press.scene, time)
    inertia = press.mass * motion[f"{press.point}.a{press.axis}"]
    load = inertia - motion[f"{press.point}.f{press.axis}"]
    acts = (motion[press.position] - end <= press.last) & (motion[f"{press.point}.v{press.axis}"] < 0)
    assert np.abs(load - press.force * acts).max() <= 1e-12 * (press.force + np.abs(inertia).max())  # rounding
    assert np.count_nonzero(np.diff(acts)) == 2  # on once and off once in a cycle


@pytest.mark.parametrize("name", ["double_toggle_clamp", "double_toggle_clamp_scheme4"])
def test_clamp_locks(name: str) -> None:
    scene = scenes.load(name)
    motion = moving(scene, scene.cycle * np.array([0.9, 1.0]))
    B, C = (motion[f"{point}.x"] + 1j * motion[f"{point}.y"] for point in "BC")
    assert abs((B.conjugate() * C).imag[1]) <= 1e-15  # m^2, rounding; A, B and C are in line,
    assert motion["C.vx"][0] >= 1e-3 >= 1e12 * abs(motion["C.vx"][1])  # m/s; so the platen stands, not as before,
    assert abs(motion["C.fx"][1] - 2e6) <= 1e3  # N; holds half of 4000 kN, to the digits of the table,
    assert abs(motion["drive.force"][1]) <= 10  # N; and takes no thrust but that of inertia


def test_a_force_that_is_turned_round_meets_the_slider_on_its_other_way() -> None:
    """Whether a file has the force, or one machine or many are made of another file's."""
    scene, turned_round = PRESSES["crank_press"].scene, {"loads.0.force.1": -PRESSES["crank_press"].force}
    of_file = scenes.load("crank_press", {path: force / 1e3 for path, force in turned_round.items()})
    of_many = scene.with_numbers({path: np.array([[force]]) for path, force in turned_round.items()})
    loads = (of.loads[0] for of in (scene, of_file, scene.with_numbers(turned_round), of_many))
    assert [np.asarray(load.closing).item() for load in loads if isinstance(load, PressForce)] == [-1, 1, 1, 1]

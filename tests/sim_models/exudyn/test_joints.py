"""The Exudyn model on every joint, drive and load, against equations of motion written in the tests."""

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

from scenes import Failure, Sampling, Status
from scenes.motion import channels
from scenes.scene import MotionLaw, PressForce
from sim_models.exudyn import engine as model
from sim_models.exudyn.drive import Course
from sim_models.exudyn.engine import DEFAULT, EXACT, ExudynSettings, TimeStepping
from sim_models.exudyn.loads import PressStroke
from sim_models.exudyn.poses import Poses
from sim_models.exudyn.start import start
from sim_models.exudyn.stepping import SteppedRun
from sim_models.exudyn.system import System

from .helpers import BOTH_ROUTES, check, errors, locking, referred, run, write
from .mechanisms import SCENES, SLIDER_CRANK

# Time steps: positions are exact but for round-off; the rest is h^3 of the extrapolation, measured 2e-8 in velocities,
# 1.2e-6 in accelerations and 1.9e-6 in the rest, both where slotted_class_iii starts near a lock. A law's jerk jumps at
# its knots, and for some twenty steps after that the extrapolation does not cancel h: measured 1.1e-6, 3.6e-3 and 8e-4.
SMOOTH = {"position": 1e-13, "velocity": 1e-7, "acceleration": 5e-6, "force": 5e-6, "moment": 5e-6}
KNOTTED = {"position": 1e-13, "velocity": 5e-6, "acceleration": 1e-2, "force": 3e-3, "moment": 3e-3}
# Pointwise: positions and velocities are round-off; accelerations and with them forces are what a difference over 1e-5
# of a turn leaves, measured 6e-11.
DIFFERENCED = {"position": 1e-14, "velocity": 2e-14, "acceleration": 5e-10, "force": 5e-10, "moment": 5e-10}


@pytest.mark.parametrize("name", SCENES)
def test_mechanism_by_time_steps(name: str) -> None:
    scene, reference = referred(name)
    motion = run(scene, DEFAULT, samples=60)
    assert set(motion.samples) == set(channels(scene))
    check(errors(scene, motion, reference), KNOTTED if isinstance(scene.drive, MotionLaw) else SMOOTH)


@pytest.mark.parametrize("name", SCENES)
def test_mechanism_pointwise(name: str) -> None:
    scene, reference = referred(name)
    motion = run(scene, EXACT, samples=60)
    assert set(motion.samples) == set(channels(scene))
    check(errors(scene, motion, reference), DIFFERENCED)


def test_law_costs_the_order_only_after_its_knots() -> None:
    scene, reference = referred("swinging_law")
    assert isinstance(scene.drive, MotionLaw)
    times, settled = Sampling(60).times(scene), np.ones(61, dtype=bool)
    for knot in scene.drive.times[1:-1]:
        settled &= (times < knot - 1e-9) | (times > knot + 40 * scene.drive.cycle / 360)
    assert settled.sum() == 33

    def error(steps: int) -> float:
        motion = run(scene, TimeStepping("", steps=steps), samples=60)
        return float(np.abs(motion["O.fx"] - reference["O.fx"])[settled].max())

    assert np.log2(error(360) / error(720)) == pytest.approx(3, abs=0.3)  # measured 3.05


@pytest.mark.parametrize("name", ["swinging_law", "turning_law", "wedge", "driven_toggle"])
def test_trapezoidal_steps_follow_the_drive(name: str) -> None:
    """They hold velocities only, so where the drive's rate varies their position drifts by a share of h^2."""
    scene, reference = referred(name)
    motion = run(scene, TimeStepping("", steps=360, richardson=False, solver="TrapezoidalIndex2"), samples=60)
    found = errors(scene, motion, reference)
    # measured 6e-5, 7e-5 and 5e-3, the last where turning_law's knots lie between steps
    assert found["position"] <= 3e-4
    assert found["velocity"] <= 3e-4
    assert max(found["acceleration"], found["force"], found["moment"]) <= 2e-2


@BOTH_ROUTES
def test_law_repeats(settings: ExudynSettings) -> None:
    scene, _ = referred("turning_law")
    motion = run(scene, settings, samples=60, turns=3)
    assert motion["crank_angle"][-1] == pytest.approx(6 * np.pi, rel=1e-12)
    for channel in ("E.x", "E.vx", "E.ax", "drive.torque", "block.guide_moment"):
        first, last = motion[channel][1:61], motion[channel][121:]
        # the same steps on the same law, but for round-off, which accelerations take over h^2
        assert np.abs(last - first).max() <= 1e-6 * np.abs(first).max()


@BOTH_ROUTES
def test_press_load_at_the_dead_point(settings: ExudynSettings, tmp_path: Path) -> None:
    """The slider turns back on a sample, the first and the last of a turn: from there on, the load is off."""
    motion = run(write(tmp_path, pressing(0.1).replace("speed = 2", "speed = 7.3")), settings, samples=36, turns=3)
    inertia = motion["C.ax"] * 1.0  # all that acts along the guide besides is the load
    load = inertia - motion["C.fx"]
    before_end = 1.3 - motion["C.x"]
    closing = (np.arange(109) % 36 > 18) & (before_end <= 0.1)
    assert closing.sum() == 12
    assert np.abs(load + 100 * closing).max() <= 1e-4  # N; accelerations are good to 1e-6 of 21 m/s^2, forces as well


def pressing(last: float) -> str:
    """Return the slider-crank with bodies of 1 kg and a press load."""
    return SLIDER_CRANK.replace("mass = 0", "mass = 1").replace(
        "force = [-100, 0]", f"force = [-100, 0]\nlast = {last}"
    )


@pytest.mark.parametrize("direction", [1, -1])
def test_press_load_switches_where_the_scene_says(direction: int, tmp_path: Path) -> None:
    """The load acts for far less than the time between the poses that look for it, which miss the dead point."""
    text = (
        pressing(1e-6).replace("along = [1, 0]", f"along = [{direction}, 0]").replace("[sketch]", "[sketch]\nangle = 0")
    )
    for begin in (0.3, -1e-3):
        scene = write(tmp_path, text.replace("speed = 2", f"speed = 2\nstart = {begin}"))
        load = scene.loads[0]
        assert isinstance(load, PressForce)
        assert load.closing == direction
        system = System(scene)
        poses = Poses(system)
        found = PressStroke(system, poses, start(poses), load).switches()
        on = brentq(lambda a: 0.3 * np.cos(a) + np.sqrt(1 - (0.3 * np.sin(a)) ** 2) - 1.3 + 1e-6, -0.01, 0, xtol=1e-15)
        dead, on = (-begin % (2 * np.pi)) / 2, ((on - begin) % (2 * np.pi)) / 2
        # s; displacements of 1.3 m are good to 2e-16, and at that instant change by 8e-4 m/s; half as steep a velocity
        assert found == pytest.approx([on, dead] if begin > 0 else [0.0, dead, on], abs=1e-12)


def test_course_between_its_steps() -> None:
    """Exudyn asks at its steps, of which there is a table; whatever else it asks for comes from the law."""
    drive = referred("turning_law")[0].drive
    course = Course(drive)
    course.run(lead=0.05, step=0.01, steps=100)
    for clock in (0.0, 0.05, 0.37, 0.374, 0.9999, 1.0, 1.3):
        position, rate, _ = drive.at(clock - 0.05)
        assert course.position(clock) == pytest.approx(float(position), abs=1e-14)
        assert course.rate(clock) == pytest.approx(float(rate), abs=1e-13)


def test_way_to_the_start_stays_in_the_range(tmp_path: Path) -> None:
    """From 160 to -94 deg it is nearer through 180 deg, where this press cannot go."""
    scene = locking(tmp_path, start=-94, end=160)
    motion = run(scene, EXACT, samples=60)
    places = {p: [1e3 * float(motion[f"{p}.{c}"][-1]) for c in "xy"] for p in scene.sketch.points}
    sketch = "".join(f"{p} = {place}\n" for p, place in places.items())
    text = Path(scene.file).read_text()
    other = re.sub(r"\[sketch\]\n.*?\n\n", f"[sketch]\nangle = 160\n{sketch}\n", text, flags=re.DOTALL)
    assert other != text
    again = run(write(tmp_path, other), EXACT, samples=60)
    assert np.abs(again["P5.y"] - motion["P5.y"]).max() <= 1e-12  # m, round-off


@pytest.mark.parametrize("name", ["tangent", "wedge"])
def test_slip_of_the_drive_is_seen(name: str) -> None:
    scene, _ = referred(name)
    simulation = model.build(scene, DEFAULT, Sampling(60))
    simulation.solve()
    assert isinstance(simulation, SteppedRun)
    crank = list(scene.bodies).index("crank") if name == "tangent" else None
    # rad, more than 1e-9; or m along the guide [-1, 2], more than 1e-9 of 0.15 m and less than 1e-9
    column, slip = (0, -5e-10) if crank is None else (3 * crank + 2, 2e-9)
    for samples in simulation._runs:
        samples[0, 30, column] += slip
    with pytest.raises(Failure) as raised:
        simulation.read()
    assert raised.value.status is Status.diverged
    assert raised.value.motion is not None


@pytest.mark.parametrize("start", [165.0, 165.9])
def test_start_near_a_lock_takes_smaller_steps(start: float, tmp_path: Path) -> None:
    scene = locking(tmp_path, start)
    simulation = model.build(scene, DEFAULT, Sampling(60))
    simulation.solve()
    assert simulation.counters["steps"] > 4000  # of 2232 where nothing is in the way
    exact = run(scene, EXACT, samples=60).samples
    found = errors(scene, simulation.read(), {name: exact[name] for name in channels(scene) if name != "time"})
    check(found, SMOOTH | {"acceleration": 2e-5, "force": 2e-5, "moment": 2e-5})  # measured 5e-6 at 165.9 deg

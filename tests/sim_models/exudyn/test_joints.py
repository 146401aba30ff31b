"""The Exudyn model on every joint, drive and load, whole or reduced, against equations of motion of the tests' own."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import scenes
from scenes import Sampling, Scene
from scenes.scene import ConstantSpeed, MotionLaw, PressForce
from sim_models.exudyn import engine as model
from sim_models.exudyn import poses as exudyn_poses
from sim_models.exudyn.ablations import ReducedSystem
from sim_models.exudyn.drive import ExudynDrive, pieces
from sim_models.exudyn.engine import DEFAULT, EXACT
from sim_models.exudyn.loads import press_switches
from sim_models.exudyn.poses import Equations, PoseSolver
from sim_models.exudyn.settings import ExudynSettings, TimeStepping
from sim_models.exudyn.start import start
from tests import scene_files
from tests.comparisons import sampled

from .helpers import BOTH_ROUTES, NAMES, by_level, check, locking, referred, run

# Time steps: positions are exact but for round-off; the rest is h^3 of the extrapolation, measured 2e-8 in velocities,
# 1.2e-6 in accelerations and forces and 4e-7 in moments, all where slotted_class_iii starts near a lock; under a law,
# whose pieces are integrated one by one, no more.
SMOOTH = {"position": 1e-13, "velocity": 1e-7, "acceleration": 5e-6, "force": 5e-6, "moment": 1e-6}
# Pointwise: positions and velocities are round-off; accelerations and with them forces are what a difference over 1e-5
# of a turn leaves, measured 6e-11.
DIFFERENCED = {"position": 1e-14, "velocity": 2e-14, "acceleration": 5e-10, "force": 5e-10, "moment": 1e-10}


ROUTES: dict[str, tuple[ExudynSettings, dict[str, float]]] = {
    "steps": (DEFAULT, SMOOTH),
    "steps of reduced coordinates": (replace(DEFAULT, reduced=True), SMOOTH),
    "pointwise": (EXACT, DIFFERENCED),
}


@sampled(4)
@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("name", NAMES)
def test_mechanism(name: str, route: str) -> None:
    scene, reference = referred(name)
    settings, limits = ROUTES[route]
    motion = run(scene, settings, samples=60)
    assert set(motion.samples) == set(scene.channels.names())
    check(by_level(motion, reference), limits)


def test_a_law_keeps_the_order() -> None:
    """Its jerk jumps at its knots, of which two are between samples; its pieces are smooth."""
    scene, reference = referred("swinging_law")

    def error(steps: int) -> float:
        motion = run(scene, TimeStepping("", steps=steps), samples=60)
        return float(np.abs(motion["O.fx"] - reference["O.fx"]).max())

    assert np.log2(error(360) / error(720)) == pytest.approx(3, abs=0.3)


def test_more_knots_than_samples() -> None:
    """Pieces without a sample are not integrated; those with one only up to it."""
    scene, _ = referred("swinging_law")
    exact = run(scene, EXACT, samples=3).samples
    found = by_level(
        run(scene, DEFAULT, samples=3), {name: exact[name] for name in scene.channels.names() if name != "time"}
    )
    check(found, SMOOTH)


@sampled(2)
@pytest.mark.parametrize("name", ["swinging_law", "turning_law", "wedge", "driven_toggle"])
def test_trapezoidal_steps_follow_the_drive(name: str) -> None:
    """They hold velocities only, so where the drive's rate varies their position drifts by a share of h^2."""
    scene, reference = referred(name)
    motion = run(scene, TimeStepping("", steps=360, richardson=False, solver="TrapezoidalIndex2"), samples=60)
    found = by_level(motion, reference)
    # measured 6e-5, 7e-5 and 5e-3, the last where turning_law's knots lie between steps
    assert found["position"] <= 3e-4
    assert found["velocity"] <= 3e-4
    assert max(found["acceleration"], found["force"], found["moment"]) <= 2e-2


@BOTH_ROUTES
def test_press_load_at_the_dead_point(settings: ExudynSettings) -> None:
    """The slider turns back on a sample, the first and the last of a turn: from there on, the load is off."""
    motion = run(pressing(0.35, {"drive.speed": 7.3}), settings, samples=36, turns=3)
    inertia = motion["B.ax"] * 1.0  # all that acts along the guide besides is the load
    load = inertia - motion["B.fx"]
    before_end = 4 - motion["B.x"]
    closing = (np.arange(109) % 36 > 18) & (before_end <= 0.35)
    assert closing.sum() == 12
    assert np.abs(load + 100 * closing).max() <= 1e-4  # N; accelerations are good to 1e-6 of 71 m/s^2, forces as well


def pressing(last: float, changes: scene_files.Changes) -> Scene:
    """The slider-crank with bodies of 1 kg and a press load."""
    masses = {f"bodies.{body}.mass": 1 for body in ("crank", "rod", "slider")}
    loads = [{"body": "slider", "at": "B", "force": [-100, 0], "last": last}]
    return scene_files.load("slider_crank", {**masses, "loads": loads, **changes})


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("begin", [0.3, -1e-3])
def test_press_load_switches_where_the_scene_says(direction: int, begin: float) -> None:
    """The load acts for far less than the time between the poses that look for it, which miss the dead point."""
    drive = {"drive.speed": 2, "drive.start": begin}
    sketch = {"sketch": {"angle": 0, "A": [1, 0], "B": [4, 0]}}
    scene = pressing(1e-6, {"bodies.slider.slides.along": [direction, 0], **drive, **sketch})
    load = scene.loads[0]
    assert isinstance(load, PressForce)
    assert load.closing == direction
    poses = PoseSolver(scene)
    (found,) = press_switches(poses, start(poses)).values()
    on = brentq(lambda a: np.cos(a) + np.sqrt(9 - np.sin(a) ** 2) - 4 + 1e-6, -0.01, 0, xtol=1e-15)
    dead, on = (-begin % (2 * np.pi)) / 2, ((on - begin) % (2 * np.pi)) / 2
    # s; displacements of 4 m are good to 4e-16, and at that instant change by 3e-3 m/s; half as steep a velocity
    assert found == pytest.approx([on, dead] if begin > 0 else [0.0, dead, on], abs=1e-12)


@pytest.mark.parametrize("name", ["turning_law", "swinging_law"])
def test_pieces_are_the_law(name: str) -> None:
    law = referred(name)[0].drive.law
    end = (2.5 if law.periodic else 1.0) * law.cycle
    running = ExudynDrive()
    parts = pieces(law, end)
    running.run(parts, 0.05)
    for clock in np.linspace(0, end - 0.05, 57):
        position, rate, acceleration = map(float, law.at(clock + 0.05))
        assert running.position(clock) == pytest.approx(position, abs=1e-13)
        assert running.rate(clock) == pytest.approx(rate, abs=1e-12)
        alone = ExudynDrive()
        last = next(piece for piece in reversed(parts) if piece.begin <= clock + 0.05)
        alone.run([last], 0.05)
        assert (alone.position(clock), alone.rate(clock)) == pytest.approx((position, rate), abs=1e-12)
        assert last.at(clock + 0.05)[2] == pytest.approx(acceleration, abs=1e-10)


def test_pieces_end_where_the_jerk_jumps() -> None:
    """At the last knots but one of a spline that is not periodic it does not."""
    law = MotionLaw((0.0, 0.1, 0.3, 0.5, 0.9, 1.0), (0.0, 1.0, 0.5, 2.0, 2.0, 0.0), periodic=False)
    assert [piece.begin for piece in pieces(law, 1.0)] == [0.0, 0.3, 0.5]
    periodic = replace(law, periodic=True)
    assert [piece.begin for piece in pieces(periodic, 1.7)] == [*law.times[:-1], *(1 + t for t in law.times[:-1])]
    assert len(pieces(ConstantSpeed(2.0, 0.0, None), 100.0)) == 1


@sampled(1)
@pytest.mark.parametrize("start", [165.0, 165.9])
def test_start_near_a_lock_takes_smaller_steps(start: float) -> None:
    scene = locking(start)
    simulation = model.build(scene, DEFAULT, Sampling(60))
    simulation.solve()
    assert simulation.counters["steps"] > 4000  # of 2232 where nothing is in the way
    exact = run(scene, EXACT, samples=60).samples
    found = by_level(simulation.read(), {name: exact[name] for name in scene.channels.names() if name != "time"})
    check(found, SMOOTH | {"acceleration": 2e-5, "force": 2e-5, "moment": 2e-5})  # measured 5e-6 at 165.9 deg


@pytest.mark.parametrize("knots", [exudyn_poses.KNOTS, 1])
def test_poses_found_together_are_those_found_one_by_one(knots: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """From a single knot they are too far to be guessed, and each has to be followed."""
    monkeypatch.setattr(exudyn_poses, "KNOTS", knots)
    poses = PoseSolver(scene_files.load("loaded_four_bar"))
    first = start(poses)
    there, rest = np.linspace(2.0, -1.5, 80), np.full(5, -1.5)
    positions = np.concatenate([there, rest, there[::-1] + 0.01, [0.0, 0.3, 0.3]])  # it rests, turns back, and jumps
    together, state = poses.through(first, positions), first
    assert (together.position == positions).all()
    for row, position in enumerate(positions):
        state = poses.follow(state, float(position))
        assert np.abs(together.q[row] - state.q).max() <= 1e-13
        assert np.abs(together.tangent[row] - state.tangent).max() <= 1e-13
        assert np.abs(together.curvature[row] - state.curvature).max() <= 1e-9  # round-off over its difference of 1e-5


@pytest.mark.parametrize(
    ("name", "left", "pivots", "sliders"),
    [
        ("toggle_press", 9, {"crank", "rocker"}, {"slider"}),  # of 15 each
        ("shared_pivot", 9, {"crank", "rocker", "other"}, set()),
        ("wedge", 7, set(), {"follower"}),  # on the wedge another body slides
        ("oldham", 7, {"crank"}, set()),  # a disc slides on what turns
        ("swinging_block", 5, {"crank", "block"}, set()),
        ("three_at_a_pin", 9, {"crank", "rocker"}, {"slider"}),  # a coupler turns about no pin of the ground
    ],
)
def test_what_is_left(name: str, left: int, pivots: set[str], sliders: set[str]) -> None:
    system = ReducedSystem(scene_files.load(name), ExudynDrive(0.0))
    assert system.unknowns == system.counts()["coordinates"] == system.counts()["constraints"] == left
    assert (set(system.pivots), set(system.sliders)) == (pivots, sliders)


def test_no_force_is_found_where_none_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Equations, "forces", None)
    motion = run(scenes.load("toggle_press"), replace(DEFAULT, reduced=True), channels=frozenset({"P5.ay"}))
    assert set(motion.samples) == {"time", "crank_angle", "P5.ay"}

"""The arbitrary-precision model against hand calculations, an independent solve and the laws of mechanics."""

import re
from math import acos, degrees, pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import scenes
from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.motion import channels

flint = pytest.importorskip("flint")

from sim_models import multiprecision_linkage, multiprecision_march  # noqa: E402  (their engine is there)
from sim_models import multiprecision_model as model  # noqa: E402

EPS = 2.0**-52
Array = NDArray[np.float64]

SLIDER_CRANK = """
format = 1
name = "slider_crank"
ground.points = { O = [0, 0] }
drive = { body = "crank", speed = 2.0 }
output = { slider = "B" }
[bodies.crank]
points = { O = [0, 0], A = [1, 0] }
mass = 0
[bodies.rod]
lengths = { "A-B" = 2 }
mass = 0
[bodies.slider]
points = { B = [0, 0], C = [0, 0.5] }
slides = { through = [0, 0], along = [1, 0] }
mass = 0
[sketch]
A = [1, 0]
B = [3, 0]
"""

FOUR_BAR = """
format = 1
name = "four_bar"
gravity = [0.3, -9.81]
ground.points = { O = [0, 0], D = [4, 0.5] }
drive = { body = "crank", speed = -7.0, start = 0.4 }
output = { point = "T" }
[bodies.crank]
lengths = { "A-O" = 1.0 }  # its x axis points at its pivot
mass = 2.0
[bodies.coupler]
lengths = { "A-B" = 3.5, "B-T" = 1.5, "A-T" = 3.0 }
mass = 3.0
[bodies.rocker]
points = { D = [0.1, -0.2], B = [2.4, 0.3], Q = [1.0, 1.0] }
mass = 1.5
com = [0.7, 0.4]
inertia = 0.9
[[loads]]
body = "coupler"
at = "T"
force = [3, -5]
[[loads]]
body = "rocker"
at = "Q"
force = [-2, 4]
[sketch]
angle = 3.14
A = [1, 0.1]
B = [3.6, 2.5]
T = [2.2, 3.0]
"""

# Two rods on one crank pin, to sliders on either side: both come near their lock at the same crank angle.
TWO_RODS = """
format = 1
name = "two_rods"
ground.points = { O = [0, 0] }
drive = { body = "crank", speed = 3.0 }
output = { slider = "B" }
[bodies.crank]
points = { O = [0, 0], A = [1, 0] }
mass = 1.0
[bodies.right]
lengths = { "A-B" = ROD }
mass = 0.5
[bodies.left]
lengths = { "A-C" = ROD }
mass = 0.7
[bodies.slider]
points = { B = [0, 0], E = [0.2, 0.3] }
slides = { through = [0, 0], along = [1, 0] }
mass = 2.0
com = [0.1, 0.2]
inertia = 0.3
[bodies.other]
points = { C = [0, 0] }
slides = { through = [0, 0], along = [-1, 0] }
mass = 3.0
[[loads]]
body = "slider"
at = "E"
force = [7, -2]
[sketch]
angle = 0.5
A = [0.9, 0.5]
B = [2, 0]
C = [-0.5, 0]
"""


def scene_of(tmp_path: Path, text: str) -> Scene:
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return scenes.load(path)


def run(scene: Scene, samples: int = 36, digits: int = 50) -> Motion:
    simulation = model.build(scene, model.MultiprecisionSettings("test", digits), Sampling(samples))
    simulation.solve()
    return simulation.read()


@pytest.fixture(scope="module")
def toggle() -> Motion:
    return run(scenes.load("toggle_press"), samples=720)


@pytest.fixture(scope="module", params=["toggle_press", "four_bar", "two_rods"])
def scene(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Scene:
    texts = {"four_bar": FOUR_BAR, "two_rods": TWO_RODS.replace("ROD", "1.4")}
    if request.param in texts:
        return scene_of(tmp_path_factory.mktemp("scenes"), texts[request.param])
    return scenes.load(request.param)


@pytest.fixture(scope="module")
def motion(scene: Scene) -> Motion:
    return run(scene)


# --- the toggle press ------------------------------------------------------------------------------------------------


def test_toggle_press_has_the_known_extremes(toggle: Motion) -> None:
    y, angle = toggle["P5.y"], np.degrees(toggle["crank_angle"])
    assert abs(np.ptp(y) - 183.6316e-3) <= 3e-6  # a sample misses a dead point by a quarter degree: a t^2 / 2, m
    assert abs(angle[y.argmin()] - 12.9) <= 0.5  # one sample
    assert abs(angle[y.argmax()] - 208.5) <= 0.5
    # Known to four or five digits; a sample may miss an extreme by the curvature over a quarter of a degree.
    np.testing.assert_allclose([toggle["P5.vy"].min(), toggle["P5.vy"].max()], [-0.7166, 0.8650], rtol=2e-4)
    np.testing.assert_allclose([toggle["P5.ay"].min(), toggle["P5.ay"].max()], [-10.328, 5.473], rtol=2e-4)
    assert abs(np.abs(toggle["drive.torque"]).max() / 13888 - 1) <= 2e-4


def test_toggle_press_agrees_with_distances_between_points(toggle: Motion) -> None:
    """Natural coordinates: the points are the unknowns, the lengths the equations, and no body has an angle."""
    points = ("P2", "P3", "P4", "P5")
    lengths = {(0, 1): 0.49, (1, 2): 0.49, (0, 2): 0.76, (2, 3): 0.3}
    speed, P1 = 2 * pi, np.array([0.404709, -0.217661])

    def jacobian(p: Array) -> Array:
        """Return half the derivative of the squared lengths, of |P3|^2 and of 2 P5.x in the coordinates."""
        J = np.zeros((6, 8))
        for row, (i, j) in enumerate(lengths):
            J[row, 2 * i : 2 * i + 2], J[row, 2 * j : 2 * j + 2] = p[i] - p[j], p[j] - p[i]
        J[4, 2:4], J[5, 6] = p[1], 1
        return J

    def squares(p: Array) -> Array:
        return np.array([*(np.sum((p[i] - p[j]) ** 2) for i, j in lengths), p[1] @ p[1], 0])

    for k in range(0, 721, 60):
        mine = {
            q: np.array([[toggle[f"{point}.{q}{axis}"][k] for axis in "xy"] for point in points])
            for q in ("", "v", "a")
        }
        arm = 0.077 * np.array([np.cos(toggle["crank_angle"][k]), np.sin(toggle["crank_angle"][k])])
        p = mine[""] + 1e-3
        p[0] = P1 + arm
        for _ in range(6):
            error = squares(p) - np.square([*lengths.values(), 0.3, 0])
            error[5] = 2 * p[3, 0]
            p[1:] -= np.linalg.solve(jacobian(p)[:, 2:], error / 2).reshape(3, 2)
        J = jacobian(p)
        v, a = np.zeros((4, 2)), np.zeros((4, 2))
        v[0], a[0] = speed * np.array([-arm[1], arm[0]]), -(speed**2) * arm
        v[1:] = np.linalg.solve(J[:, 2:], -J[:, :2] @ v[0]).reshape(3, 2)
        a[1:] = np.linalg.solve(J[:, 2:], -J[:, :2] @ a[0] - squares(v)).reshape(3, 2)
        # Doubles times the condition of the linkage, some hundreds; once more for each derivative.
        assert np.abs(p - mine[""]).max() <= 1e-13
        assert np.abs(v - mine["v"]).max() <= 1e-12
        assert np.abs(a - mine["a"]).max() <= 1e-10


def test_doubles_do_not_change_with_more_digits() -> None:
    scene = scenes.load("toggle_press")
    fifty, eighty = run(scene), run(scene, digits=80)
    for channel in channels(scene):
        # Rounded to nearest both times: equal, unless true value is zero (P5.x) and only the last digits of 50 remain.
        assert np.abs(fifty[channel] - eighty[channel]).max() <= 1e-40


# --- laws that hold for every scene ----------------------------------------------------------------------------------


def inertia(scene: Scene, motion: Motion, name: str) -> float:
    body = scene.bodies[name]
    if body.inertia is not None:
        return body.inertia
    assert body.mass is not None
    p = [point_motion(scene, motion, point)[0][0] for point in body.points]
    squares = sum(abs(p[i] - p[j]) ** 2 for i in range(len(p)) for j in range(i))
    return body.mass * float(squares) / {1: 1, 2: 12, 3: 36}[len(p)]


def point_motion(scene: Scene, motion: Motion, point: str) -> list[NDArray[np.complex128]]:
    """Return position, velocity and acceleration as complex numbers."""
    if point in scene.ground:
        still = np.zeros(len(motion["time"]), complex)
        return [still + complex(*scene.ground[point]), still, still]
    return [motion[f"{point}.{q}x"] + 1j * motion[f"{point}.{q}y"] for q in ("", "v", "a")]


def turning(motion: Motion, name: str) -> tuple[Array, Array, Array]:
    if f"{name}.angle" in motion:
        return motion[f"{name}.angle"], motion[f"{name}.omega"], motion[f"{name}.alpha"]
    still = np.zeros(len(motion["time"]))
    return still, still, still


def mass_centre(scene: Scene, motion: Motion, name: str) -> list[NDArray[np.complex128]]:
    body = scene.bodies[name]
    if body.com is None:
        every = [point_motion(scene, motion, point) for point in body.points]
        return [sum(derivatives) / len(every) for derivatives in zip(*every, strict=True)]
    assert body.local is not None
    first = body.points[0]
    angle, omega, alpha = turning(motion, name)
    arm = (complex(*body.com) - complex(*body.local[first])) * np.exp(1j * angle)
    p, v, a = point_motion(scene, motion, first)
    return [p + arm, v + 1j * omega * arm, a + (1j * alpha - omega**2) * arm]


def test_every_channel_is_there_and_finite(scene: Scene, motion: Motion) -> None:
    assert set(motion.samples) == set(channels(scene))
    assert all(values.shape == (37,) and np.isfinite(values).all() for values in motion.samples.values())


def test_every_body_obeys_newton_and_euler(scene: Scene, motion: Motion) -> None:
    gravity = complex(*(scene.gravity or (0, 0)))
    for name, body in scene.bodies.items():
        assert body.mass is not None
        c, _, a = mass_centre(scene, motion, name)
        force, moment = body.mass * (gravity - a), -inertia(scene, motion, name) * turning(motion, name)[2]
        size = np.abs(force) + np.abs(moment)
        none = np.zeros(len(c))
        acting = [(load.at, complex(*load.force) + none, none) for load in scene.loads if load.body == name]
        for pin in scene.pins:
            if name in (pin.first, pin.second):
                of_first = motion[f"{pin.channel}.fx"] + 1j * motion[f"{pin.channel}.fy"]
                acting.append((pin.point, of_first if name == pin.second else -of_first, none))
        if body.slide is not None:
            normal = 1j * complex(*body.slide.along)
            acting.append((body.points[0], normal * motion[f"{name}.guide_force"], motion[f"{name}.guide_moment"]))
        if name == scene.drive.body:
            moment = moment + motion["drive.torque"]
        for point, f, couple in acting:
            force = force + f
            moment = moment + couple + (np.conj(point_motion(scene, motion, point)[0] - c) * f).imag
            size = size + np.abs(f) * (1 + np.abs(c)) + np.abs(couple)
        # Rounded channels: a dozen terms, each to half a unit in its last place, and arms to as much.
        assert np.max(np.abs(force) / size) <= 16 * EPS
        assert np.max(np.abs(moment) / size) <= 16 * EPS


def test_power_of_drive_loads_and_weight_is_the_rate_of_kinetic_energy(scene: Scene, motion: Motion) -> None:
    power = motion["drive.torque"] * motion[f"{scene.drive.body}.omega"]
    size = np.abs(power)
    for load in scene.loads:
        power = power + (np.conj(complex(*load.force)) * point_motion(scene, motion, load.at)[1]).real
    for name, body in scene.bodies.items():
        assert body.mass is not None
        _, v, a = mass_centre(scene, motion, name)
        _, omega, alpha = turning(motion, name)
        power = power + body.mass * (np.conj(v) * (complex(*(scene.gravity or (0, 0))) - a)).real
        power = power - inertia(scene, motion, name) * omega * alpha
    assert np.abs(power).max() <= 64 * EPS * size.max()  # rounded channels, some twenty products


def test_velocity_and_acceleration_are_the_derivatives(scene: Scene) -> None:
    """Central differences are of second order: the error falls by four when the step is halved."""
    coarse, fine = run(scene, 90), run(scene, 180)

    def error(motion: Motion, of: str, derivative: str) -> float:
        value, time = motion[f"{scene.output}.{of}"], motion["time"]
        slope = (value[2:] - value[:-2]) / (time[2:] - time[:-2])
        return float(np.abs(slope - motion[f"{scene.output}.{derivative}"][1:-1]).max())

    axes = ("y",) if scene.name == "toggle_press" else ("x",) if scene.name == "two_rods" else ("x", "y")
    for axis in axes:  # the sliders move along one only
        assert abs(error(coarse, axis, f"v{axis}") / error(fine, axis, f"v{axis}") - 4) <= 0.4  # the next order
        assert abs(error(coarse, f"v{axis}", f"a{axis}") / error(fine, f"v{axis}", f"a{axis}") - 4) <= 0.4


# --- hand calculations -----------------------------------------------------------------------------------------------


def test_slider_crank_statics_by_hand(tmp_path: Path) -> None:
    """At 90 deg the massless rod of length 2 pushes along (√3, -1)/2 from the crank pin (0, 1)."""
    loads = '[[loads]]\nbody = "slider"\nat = "C"\nforce = [-100, 0]\n'
    motion = run(scene_of(tmp_path, SLIDER_CRANK.replace("[sketch]", loads + "[sketch]")), samples=4)
    push = 100 / sqrt(3)
    expected = {
        "crank_angle": pi / 2,
        "B.x": sqrt(3),
        "B.vx": -2.0,
        "rod.angle": -pi / 6,
        "B.fx": 100.0,  # of the rod on the slider
        "B.fy": -push,
        "A.fx": 100.0,  # of the crank on the rod
        "O.fx": 100.0,  # of the ground on the crank
        "O.fy": -push,
        "slider.guide_force": push,
        "slider.guide_moment": -50.0,  # against the load, half a metre above B
        "drive.torque": -100.0,  # the load helps: 100 N at 1 m/rad
    }
    for channel, value in expected.items():
        assert abs(motion[channel][1] / value - 1) <= 4 * EPS  # pi/2 as a double, and the roots in this list


def test_unbalanced_crank_by_hand(tmp_path: Path) -> None:
    """One body backwards in its weight: the torque holds the weight, the pivot holds it on its circle."""
    text = """
format = 1
name = "crank"
gravity = [0, -10]
ground.points = { O = [1, 2] }
drive = { body = "crank", speed = -3.0, start = 0.5 }
output = { point = "T" }
[bodies.crank]
points = { O = [0, 0], T = [2, 0] }
mass = 4
com = [0.5, 0]
inertia = 0.2
[sketch]
angle = 7
"""
    motion = run(scene_of(tmp_path, text), samples=8)
    angle = 0.5 - np.arange(9) * pi / 4
    expected = {
        "crank_angle": angle,
        "crank.angle": (angle + pi) % (2 * pi) - pi,
        "T.y": 2 + 2 * np.sin(angle),
        "O.fx": -4 * 9 * 0.5 * np.cos(angle),
        "O.fy": 40 - 4 * 9 * 0.5 * np.sin(angle),
        "drive.torque": 40 * 0.5 * np.cos(angle),
    }
    for channel, values in expected.items():
        assert np.abs(motion[channel] - values).max() <= 100 * EPS  # of values up to 60, in numpy


def test_scene_without_masses_moves_alike_and_has_no_forces(tmp_path: Path) -> None:
    with_masses = scene_of(tmp_path, SLIDER_CRANK)
    without = scene_of(tmp_path, SLIDER_CRANK.replace("mass = 0\n", ""))
    motion = run(without)
    assert set(motion.samples) == set(channels(without))
    assert "drive.torque" not in motion
    assert np.array_equal(motion["B.ax"], run(with_masses)["B.ax"])


# --- branches --------------------------------------------------------------------------------------------------------


def test_mirrored_sketch_gives_the_mirrored_branch(tmp_path: Path) -> None:
    below = FOUR_BAR.replace("B = [3.6, 2.5]", "B = [3.6, -1.5]")

    def elbow(motion: Motion) -> Array:
        A, B = (motion[f"{point}.x"] + 1j * motion[f"{point}.y"] for point in "AB")
        return np.asarray((np.conj(B - A) * (4 + 0.5j - B)).imag)

    assert (elbow(run(scene_of(tmp_path, FOUR_BAR))) < 0).all()
    assert (elbow(run(scene_of(tmp_path, below))) > 0).all()


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9])
def test_two_links_near_their_lock_at_once_stay_on_their_branches(tmp_path: Path, gap: float) -> None:
    """The determinant would not tell: both flips together keep its sign."""
    motion = run(scene_of(tmp_path, TWO_RODS.replace("ROD", repr(1 + gap))), samples=10)
    angle, rod = motion["crank_angle"], 1 + gap
    reach = np.sqrt((rod - 1) * (rod + 1) + np.cos(angle) ** 2)
    # cos^2 in doubles, at worst 0.3 here
    np.testing.assert_allclose(motion["B.x"], np.cos(angle) + reach, rtol=0, atol=1e-14)
    np.testing.assert_allclose(motion["C.x"], np.cos(angle) - reach, rtol=0, atol=1e-14)


def test_contraction_of_newton_alone_keeps_the_branch(monkeypatch: pytest.MonkeyPatch, toggle: Motion) -> None:
    """The other guards off, a third of a turn is offered as one step; uncontracted Newton then flips the press."""
    monkeypatch.setattr(multiprecision_march, "HOMOTOPY", np.inf)
    monkeypatch.setattr(multiprecision_march, "LARGEST_TURN", 10.0)
    leaping = run(scenes.load("toggle_press"), samples=3)
    assert np.abs(leaping["P5.y"] - toggle["P5.y"][::240]).max() <= 4 * EPS  # the angles differ by rounding


def test_result_does_not_depend_on_the_way_there(tmp_path: Path) -> None:
    """A start at another angle, the same angles visited backwards: the same pose, and the same force if as fast."""
    scene = scenes.load("toggle_press")
    text = Path(scenes.LIBRARY / "toggle_press.toml").read_text()
    back = run(scene_of(tmp_path, text.replace("speed = 60\n", "speed = -60\n").replace("start = 0", "start = 360")))
    there = run(scene)
    for channel in ("P5.y", "P5.ay", "P3.fx", "drive.torque"):
        # The crank angles agree to a few units in the last place of a turn; the torque goes with dx/dθ.
        error = np.abs(back[channel][::-1] - there[channel]).max()
        assert error <= 100 * EPS * np.abs(there[channel]).max()


# --- failures and manners --------------------------------------------------------------------------------------------


def test_lock_is_found_where_the_cosine_rule_puts_it(tmp_path: Path) -> None:
    """Coupler 1.5 and rocker 2 are in line when the crank pin is 3.5 from D.

    The sketch is a turn ahead of the start: the long way round leads through the lock at the other side.
    """
    text = """
format = 1
name = "locking"
ground.points = { O = [0, 0], D = [3, 0] }
drive = { body = "crank", speed = 1.0, start = 1.0 }
output = { point = "B" }
bodies.crank.points = { O = [0, 0], A = [2, 0] }
bodies.coupler.lengths = { "A-B" = 1.5 }
bodies.rocker.lengths = { "D-B" = 2 }
[sketch]
angle = 7.0
A = [1.5, 1.3]
B = [2.9, 2]
"""
    lock = degrees(acos((2**2 + 3**2 - 3.5**2) / (2 * 2 * 3)))
    simulation = model.build(scene_of(tmp_path, text), model.DEFAULT, Sampling(36))
    with pytest.raises(Failure) as failure:
        simulation.solve()
    assert failure.value.status is Status.cannot_assemble
    found = re.search(r"crank angle ([\d.]+) deg", failure.value.reason)
    assert found
    assert abs(float(found[1]) - lock) <= 1e-6  # as printed


def test_lengths_that_cannot_meet_are_refused(tmp_path: Path) -> None:
    apart = SLIDER_CRANK.replace("through = [0, 0]", "through = [0, 5]")
    with flint.ctx.workprec(77):
        with pytest.raises(Failure, match="crank angle 0") as failure:
            model.build(scene_of(tmp_path, apart), model.DEFAULT, Sampling(36))
        assert flint.ctx.prec == 77
    assert failure.value.status is Status.cannot_assemble


def test_flat_sketch_of_a_triangle_is_refused(tmp_path: Path) -> None:
    flat = FOUR_BAR.replace("T = [2.2, 3.0]", "T = [5.42, 4.18]")  # A + 1.7 (B - A), but for rounding
    with pytest.raises(Failure, match="coupler") as failure:
        model.build(scene_of(tmp_path, flat), model.DEFAULT, Sampling(36))
    assert failure.value.status is Status.cannot_assemble


def test_too_few_digits_are_not_passed_off_as_proof(tmp_path: Path) -> None:
    near_lock = scene_of(tmp_path, TWO_RODS.replace("ROD", repr(1 + 1e-9)))
    with pytest.raises(Failure) as failure:
        run(near_lock, samples=4, digits=16)
    assert failure.value.status is Status.not_converged


def test_pose_that_is_no_solution_is_not_enclosed() -> None:
    scene = scenes.load("toggle_press")
    with flint.ctx.workdps(50):
        linkage = multiprecision_linkage.Linkage(scene)
        march, goal = multiprecision_march.March(linkage, 50), linkage.goal(scene.sketch.angle)
        pose = march.follow(linkage.sketched_pose(scene.sketch.angle), goal)
        march.enclose(pose, goal)
        pose[2, 0] += 1e-9
        with pytest.raises(Failure) as failure:
            march.enclose(pose, goal)
    assert failure.value.status is Status.not_converged


def test_no_step_is_longer_than_two_degrees() -> None:
    simulation = model.build(scenes.load("toggle_press"), model.DEFAULT, Sampling(1))
    simulation.solve()
    assert simulation.counters["steps"] >= 180


def test_run_leaves_the_precision_and_says_what_it_did() -> None:
    with flint.ctx.workprec(77):
        simulation = model.build(scenes.load("toggle_press"), model.DEFAULT, Sampling(36))
        assert flint.ctx.prec == 77
        simulation.solve()
        simulation.read()
        assert flint.ctx.prec == 77
    first = dict(simulation.counters)
    simulation.solve()
    assert simulation.counters == first
    assert first["steps"] >= 36
    assert all(0 < residual <= 1e-40 for residual in simulation.residuals.values())  # 50 digits less the condition
    assert "flint" in model.version()

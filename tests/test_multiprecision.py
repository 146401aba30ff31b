"""The arbitrary-precision model against hand calculations, an independent solve and the laws of mechanics."""

import re
from dataclasses import replace
from math import acos, cos, degrees, pi, sin, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import root

import scenes
from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.loads import Force, PressForce
from scenes.motion import channels
from scenes.scene import GROUND, MotionLaw

from .mechanisms import DRIVEN_TOGGLE, MECHANISMS, QUICK_RETURN, SWINGING_BLOCK

flint = pytest.importorskip("flint")

from sim_models import multiprecision_linkage, multiprecision_march, multiprecision_stroke  # noqa: E402  (their engine is there)
from sim_models import multiprecision_model as model  # noqa: E402

EPS = 2.0**-52
Array = NDArray[np.float64]
Complex = NDArray[np.complexfloating[Any, Any]]

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


SMOOTH = {"four_bar": FOUR_BAR, "two_rods": TWO_RODS.replace("ROD", "1.4")}
ALL = ["toggle_press", *SMOOTH, *MECHANISMS]


def named(folder: Path, name: str) -> Scene:
    texts = SMOOTH | MECHANISMS
    return scene_of(folder, texts[name]) if name in texts else scenes.load(name)


@pytest.fixture(scope="module", params=ALL)
def scene(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Scene:
    return named(tmp_path_factory.mktemp("scenes"), request.param)


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


def point_motion(scene: Scene, motion: Motion, point: str) -> list[Complex]:
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


def carried(scene: Scene, motion: Motion, name: str, at: complex) -> list[Complex]:
    """Return the motion of what a body carries at a place of its own frame; the ground's frame stands still."""
    if name == GROUND:
        still = np.zeros(len(motion["time"]), complex)
        return [still + at, still, still]
    body = scene.bodies[name]
    angle, omega, alpha = turning(motion, name)
    arm = (at - (complex(*body.local[body.points[0]]) if body.local is not None else 0)) * np.exp(1j * angle)
    p, v, a = point_motion(scene, motion, body.points[0])
    return [p + arm, v + 1j * omega * arm, a + (1j * alpha - omega**2) * arm]


def mass_centre(scene: Scene, motion: Motion, name: str) -> list[Complex]:
    body = scene.bodies[name]
    if body.com is not None:
        return carried(scene, motion, name, complex(*body.com))
    every = [point_motion(scene, motion, point) for point in body.points]
    return [sum(derivatives) / len(every) for derivatives in zip(*every, strict=True)]


def slid(scene: Scene, motion: Motion, name: str) -> list[Complex]:
    """Return a slider's first point less `through`, over `along`, and its derivatives, as the guide's frame has them.

    The real part is the displacement, the imaginary one the offset; by the rule of Coriolis.
    """
    slide = scene.bodies[name].slide
    assert slide is not None
    angle, omega, alpha = turning(motion, slide.on)
    p, v, a = (
        point - guide
        for point, guide in zip(
            point_motion(scene, motion, scene.bodies[name].points[0]),
            carried(scene, motion, slide.on, complex(*slide.through)),
            strict=True,
        )
    )
    guide = complex(*slide.along) * np.exp(1j * angle)
    seen = v - 1j * omega * p
    return [p / guide, seen / guide, (a - (1j * alpha - omega**2) * p - 2j * omega * seen) / guide]


def size_of(scene: Scene, motion: Motion, q: str) -> float:
    """Return the largest coordinate of any point, or its derivative."""
    return max(float(np.abs(motion[f"{point}.{q}{axis}"]).max()) for point in scene.moving_points for axis in "xy")


def test_every_channel_is_there_and_finite(scene: Scene, motion: Motion) -> None:
    assert set(motion.samples) == set(channels(scene))
    assert all(values.shape == (37,) and np.isfinite(values).all() for values in motion.samples.values())


def test_the_drive_is_where_it_is_to_be(scene: Scene, motion: Motion) -> None:
    sampling = Sampling(36)
    _, rate, acceleration = scene.drive.at(sampling.times(scene))
    none = 1e-40  # of digits that a zero keeps
    if scene.driven_slide is None:
        assert np.abs(motion["crank_angle"] - sampling.commanded(scene)).max() <= none
        assert np.abs(motion[f"{scene.drive.body}.omega"] - rate).max() <= none
        assert np.abs(motion[f"{scene.drive.body}.alpha"] - acceleration).max() <= none
    else:
        x, v, a = (values.real for values in slid(scene, motion, scene.drive.body))
        assert np.abs(motion["drive.displacement"] - sampling.commanded(scene)).max() <= none
        assert np.abs(x - sampling.commanded(scene)).max() <= 4 * EPS  # of metres: points rounded, products
        assert np.abs(v - rate).max() <= 4 * EPS * np.abs(rate).max()
        assert np.abs(a - acceleration).max() <= none


def test_bodies_are_rigid_and_joints_closed_at_all_three_levels(scene: Scene, motion: Motion) -> None:
    """Lengths, frames and guides as the file has them; of rounded channels, hence to rounding of their sizes."""
    for name, body in scene.bodies.items():
        mine = [point_motion(scene, motion, point) for point in body.points]
        for point, (p, v, a) in zip(body.points[1:], mine[1:], strict=True):
            first = body.points[0]
            if body.local is not None:
                expected = carried(scene, motion, name, complex(*body.local[point]))
            else:
                # Its place in the frame, from the very first pose.
                at = (p - mine[0][0])[0] * np.exp(-1j * turning(motion, name)[0][0])
                expected = carried(scene, motion, name, at)
                assert body.lengths is not None
                for base in body.bases(point):
                    distance = np.abs(p - point_motion(scene, motion, base)[0])
                    assert np.abs(distance - body.lengths[frozenset((base, point))]).max() <= 16 * EPS
                assert point != body.points[1] or (abs(at.imag) <= 16 * EPS and at.real > 0), first
            for q, got, wanted in zip(("", "v", "a"), (p, v, a), expected, strict=True):
                assert np.abs(got - wanted).max() <= 32 * EPS * size_of(scene, motion, q)
        if body.slide is not None:
            for q, seen in zip(("", "v", "a"), slid(scene, motion, name), strict=True):
                assert np.abs(seen.imag).max() <= 32 * EPS * size_of(scene, motion, q)
            for mine_too, others in zip(turning(motion, name), turning(motion, body.slide.on), strict=True):
                assert np.array_equal(mine_too, others)


def independently_assembled(scene: Scene) -> dict[str, complex]:
    """Return where the points are at the start: their places and the bodies' angles are the unknowns, to doubles.

    The branch is the one that Newton's method finds from the sketch, followed in steps of a hundredth of the way.
    """
    names, bodies = list(scene.moving_points), list(scene.bodies)
    ground = {name: complex(*at) for name, at in scene.ground.items()}

    def equations(unknowns: Array, drive: float) -> Array:
        places = unknowns[: 2 * len(names)].view(complex)
        p = ground | dict(zip(names, places, strict=True))
        turn = {GROUND: 1 + 0j} | dict(zip(bodies, np.exp(1j * unknowns[2 * len(names) :]), strict=True))
        angle = {GROUND: 0.0} | dict(zip(bodies, unknowns[2 * len(names) :], strict=True))
        left: list[float] = []
        for name, body in scene.bodies.items():
            first, *others = body.points
            for point in others:
                if body.local is not None:
                    arm = complex(*body.local[point]) - complex(*body.local[first])
                elif point == body.points[1]:
                    assert body.lengths is not None
                    arm = complex(body.lengths[frozenset((first, point))])
                else:
                    assert body.lengths is not None
                    left += [abs(p[point] - p[q]) - body.lengths[frozenset((q, point))] for q in body.bases(point)]
                    continue
                off = p[point] - p[first] - turn[name] * arm
                left += [off.real, off.imag]
            if body.slide is not None:
                on = scene.bodies.get(body.slide.on)
                origin = 0j
                if on is not None:
                    own = complex(*on.local[on.points[0]]) if on.local is not None else 0j
                    origin = p[on.points[0]] - turn[on.name] * own
                seen = (p[first] - origin) / turn[body.slide.on] - complex(*body.slide.through)
                left += [(seen / complex(*body.slide.along)).imag, angle[name] - angle[body.slide.on]]
        driven = scene.bodies[scene.drive.body]
        if driven.slide is None:
            left.append(angle[driven.name] - drive)
        else:
            seen = (p[driven.points[0]] - complex(*driven.slide.through)) / complex(*driven.slide.along)
            left.append(seen.real - drive)
        return np.array(left)

    known = ground | {name: complex(*at) for name, at in scene.sketch.points.items()}
    middle = sum(known.values()) / len(known)
    guess = {}
    for name in bodies:
        shown = next((b for b in (name, *scene.aligned[name]) if b != GROUND and shows(scene, b)), None)
        if scene.drive.body in scene.aligned[name] and scene.driven_slide is None:
            guess[name] = scene.sketch.drive
        elif GROUND in scene.aligned[name] or shown is None:
            guess[name] = 0.0
        else:
            points = [point for point in scene.bodies[shown].points if point in known][:2]
            local = scene.bodies[shown].local or {points[0]: (0.0, 0.0), points[1]: (1.0, 0.0)}
            own = complex(*local[points[1]]) - complex(*local[points[0]])
            guess[name] = float(np.angle((known[points[1]] - known[points[0]]) / own))
    at = scene.sketch.drive
    start = scene.drive.start
    if scene.driven_slide is None:
        at = start + (at - start + pi) % (2 * pi) - pi
        turned = at - scene.sketch.drive
        guess |= {b: guess[b] + turned for b in scene.aligned[scene.drive.body] if b in guess}
    places = np.array([known.get(name, middle) for name in names])
    unknowns = np.concatenate([places.view(float), [guess[name] for name in bodies]])
    for drive in np.linspace(at, start, 101):
        solution = root(equations, unknowns, args=(drive,), tol=1e-13)
        assert np.abs(solution.fun).max() <= 1e-12  # doubles, of metres
        unknowns = solution.x
    return dict(zip(names, unknowns[: 2 * len(names)].view(complex), strict=True))


def shows(scene: Scene, name: str) -> bool:
    return len(set(scene.bodies[name].points) & {*scene.ground, *scene.sketch.points}) > 1


@pytest.mark.parametrize("name", MECHANISMS)
def test_the_linkage_is_assembled_as_sketched(tmp_path: Path, name: str) -> None:
    scene = named(tmp_path, name)
    motion = run(scene, samples=4)
    for point, at in independently_assembled(scene).items():
        assert (
            abs(complex(motion[f"{point}.x"][0], motion[f"{point}.y"][0]) - at) <= 1e-14
        )  # doubles, of metres, by the condition


def acting(scene: Scene, motion: Motion) -> list[tuple[str, str, Complex, Array]]:
    """Return body, point, force and the size of its terms for every load and spring."""
    none = np.zeros(len(motion["time"]))
    found: list[tuple[str, str, Complex, Array]] = []
    for load in scene.loads:
        if isinstance(load, Force):
            force = complex(*load.force) + none
        elif isinstance(load, PressForce):
            x, v, _ = (values.real for values in slid(scene, motion, load.body))
            fine = slid(scene, run(scene, 720), load.body)[0].real * load.closing
            acts = load.acts(x, v, load.closing * float(fine.max()))  # no sample is so near to where it begins
            assert 0 < acts.sum() < len(acts)
            force = complex(*load.force) * acts
        else:
            slide = scene.bodies[load.body].slide
            assert slide is not None
            force = complex(*slide.along) * load.along(np.asarray(slid(scene, motion, load.body)[0].real, float))
        found.append((load.body, load.at, force, none + np.abs(force).max()))
    for spring in scene.springs:
        ends = [point_motion(scene, motion, point)[0] for _, point in (spring.first, spring.second)]
        length = np.abs(ends[1] - ends[0])
        pull = spring.stiffness * (length - spring.length) * (ends[1] - ends[0]) / length
        size = spring.stiffness * (length + spring.length)
        found += [(*spring.first, pull, size), (*spring.second, -pull, size)]
    return found


def reactions(scene: Scene, motion: Motion, name: str) -> list[tuple[str, Complex, Array]]:
    """Return point, force and couple of every joint and the drive on a body."""
    none = np.zeros(len(motion["time"]))
    found: list[tuple[str, Complex, Array]] = []
    for pin in scene.pins:
        if name in (pin.first, pin.second):
            of_first = motion[f"{pin.channel}.fx"] + 1j * motion[f"{pin.channel}.fy"]
            found.append((pin.point, of_first if name == pin.second else -of_first, none))
    for slider in scene.bodies.values():
        if slider.slide is not None and name in (slider.name, slider.slide.on):
            guide = complex(*slider.slide.along) * np.exp(1j * turning(motion, slider.slide.on)[0])
            sign = 1 if name == slider.name else -1
            force = sign * 1j * guide * motion[f"{slider.name}.guide_force"]
            found.append((slider.points[0], force, sign * motion[f"{slider.name}.guide_moment"]))
    if name == scene.drive.body:
        if scene.driven_slide is None:
            found.append((scene.bodies[name].points[0], none + 0j, motion["drive.torque"]))
        else:
            along = complex(*scene.driven_slide.along)
            found.append((scene.bodies[name].points[0], along * motion["drive.force"], none))
    return found


def test_every_body_obeys_newton_and_euler(scene: Scene, motion: Motion) -> None:
    gravity = complex(*(scene.gravity or (0, 0)))
    loads = acting(scene, motion)
    for name, body in scene.bodies.items():
        assert body.mass is not None
        c, _, a = mass_centre(scene, motion, name)
        force, moment = body.mass * (gravity - a), -inertia(scene, motion, name) * turning(motion, name)[2]
        size = np.abs(force) + np.abs(moment) + body.mass * size_of(scene, motion, "a")  # what `carried` sums up
        on = [(point, f, 0 * s, s) for owner, point, f, s in loads if owner == name]
        on += [(point, f, couple, np.abs(f) + np.abs(couple)) for point, f, couple in reactions(scene, motion, name)]
        for point, f, couple, terms in on:
            force = force + f
            moment = moment + couple + (np.conj(point_motion(scene, motion, point)[0] - c) * f).imag
            size = size + terms * (1 + np.abs(c))
        # Rounded channels: a dozen terms, each to half a unit in its last place, and arms to as much.
        assert np.max(np.abs(force) / size) <= 16 * EPS
        assert np.max(np.abs(moment) / size) <= 16 * EPS


def test_power_of_drive_loads_and_weight_is_the_rate_of_kinetic_energy(scene: Scene, motion: Motion) -> None:
    if scene.driven_slide is None:
        power = motion["drive.torque"] * motion[f"{scene.drive.body}.omega"]
    else:
        power = motion["drive.force"] * slid(scene, motion, scene.drive.body)[1].real
    size = np.abs(power)
    for _, point, force, terms in acting(scene, motion):
        v = point_motion(scene, motion, point)[1]
        power, size = power + (np.conj(force) * v).real, size + terms * np.abs(v)
    for name, body in scene.bodies.items():
        assert body.mass is not None
        _, v, a = mass_centre(scene, motion, name)
        _, omega, alpha = turning(motion, name)
        power = power + body.mass * (np.conj(v) * (complex(*(scene.gravity or (0, 0))) - a)).real
        power = power - inertia(scene, motion, name) * omega * alpha
    assert np.abs(power).max() <= 64 * EPS * size.max()  # rounded channels, some twenty products


@pytest.mark.parametrize("name", ["toggle_press", *SMOOTH])
def test_velocity_and_acceleration_are_the_derivatives(tmp_path: Path, name: str) -> None:
    """Central differences are of second order: the error falls by four when the step is halved."""
    scene = named(tmp_path, name)
    coarse, fine = run(scene, 90), run(scene, 180)

    def error(motion: Motion, of: str, derivative: str) -> float:
        value, time = motion[f"{scene.output}.{of}"], motion["time"]
        slope = (value[2:] - value[:-2]) / (time[2:] - time[:-2])
        return float(np.abs(slope - motion[f"{scene.output}.{derivative}"][1:-1]).max())

    axes = ("y",) if scene.name == "toggle_press" else ("x",) if scene.name == "two_rods" else ("x", "y")
    for axis in axes:  # the sliders move along one only
        assert abs(error(coarse, axis, f"v{axis}") / error(fine, axis, f"v{axis}") - 4) <= 0.4  # the next order
        assert abs(error(coarse, f"v{axis}", f"a{axis}") / error(fine, f"v{axis}", f"a{axis}") - 4) <= 0.4


def test_differences_of_poses_are_the_derivatives_in_multiple_precision(scene: Scene) -> None:
    """A step of 1e-10 leaves 1e-20 of the third and fourth derivatives, which are below 1e4 here."""
    with flint.ctx.workdps(50):
        linkage = multiprecision_linkage.Linkage(scene)
        march, rows = multiprecision_march.March(linkage, 50), linkage.constraints
        at, h = flint.arb(scene.drive.start), flint.arb("1e-10").mid()
        q = march.follow(closed(linkage, march), linkage.drive(at))
        after, before = (march.follow(q, linkage.drive(at + step)) for step in (h, -h))
        J = rows.jacobian(q)
        slope = J.solve(linkage.drive(1.0))
        curvature = J.solve(rows.centripetal(q, slope))
        first = (after - before) * (1 / (2 * h)) - slope
        second = (after - q * flint.arb(2) + before) * (1 / (h * h)) - curvature
        assert max(abs(float(entry)) for entry in first.entries()) <= 1e-16
        assert max(abs(float(entry)) for entry in second.entries()) <= 1e-16


def closed(linkage: multiprecision_linkage.Linkage, march: multiprecision_march.March) -> Any:
    at = linkage.scene.sketch.drive
    return march.follow(linkage.sketched_pose(at), linkage.drive(at))


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


def test_bodies_that_slides_align_start_with_one_angle(tmp_path: Path) -> None:
    """Near half a turn, where the roundings of two sketches would put their angles a whole turn apart."""
    turned = SWINGING_BLOCK.replace("points = { C = [0, 0] }", "points = { C = [0, 0], Q = [-100, 0] }")
    turned = turned.replace("C = [300, 50]", "C = [-300, 1]").replace("along = [1, 0]", "along = [-1, 0]")
    turned = turned.replace("A = [80, 0]\nT = [570, 120]", "A = [80, 0]\nT = [-420, -25]\nQ = [-200, 2]")
    turned = turned.replace("speed = -120", "speed = -120\nstart = -90")
    scene = scene_of(tmp_path, turned)
    with flint.ctx.workdps(50):
        q = multiprecision_linkage.Linkage(scene).sketched_pose(scene.sketch.drive)
    assert abs(float(q[5, 0])) > 3
    assert float(q[5, 0]) == float(q[8, 0])
    motion = run(scene, samples=4)
    assert np.array_equal(motion["rod.angle"], motion["block.angle"])


def test_a_slider_that_no_sketch_shows_is_found(tmp_path: Path) -> None:
    """A cross slide: a carriage on the ground, and on it what the crank pin moves up and down."""
    text = """
format = 1
name = "cross_slide"
ground.points = { O = [0, 0] }
drive = { body = "crank", speed = 2.0, start = 1.0 }
output = { point = "A" }
sketch = { angle = 0.0, A = [1, 0] }
bodies.crank.points = { O = [0, 0], A = [1, 0] }
bodies.block.points = { A = [0, 0] }
bodies.block.slides = { on = "carriage", through = [0, 0], along = [0, 1] }
bodies.carriage.points = { K = [0, 0.5] }
bodies.carriage.slides = { through = [0, 3], along = [1, 0] }
"""
    motion = run(scene_of(tmp_path, text))
    np.testing.assert_allclose(motion["K.x"], np.cos(motion["crank_angle"]), rtol=0, atol=2 * EPS)
    np.testing.assert_allclose(motion["K.y"], 3.0, rtol=0, atol=0)


def test_a_unit_of_length_changes_nothing(tmp_path: Path) -> None:
    """Steps and proof are relative to the linkage's size, from picometres to petametres."""
    head, _, tail = QUICK_RETURN.replace("gravity = [0, -9.81]\n", "").partition("[[loads]]")
    kinematic = re.sub(r"(?m)^(mass|com|inertia) = .*\n", "", head + tail[tail.index("[sketch]") :])
    counters, tracks = [], []
    for unit in ("pm", "mm", "Tm"):
        scene = scene_of(tmp_path, kinematic.replace('length = "mm"', f'length = "{unit}"'))
        simulation = model.build(scene, model.DEFAULT, Sampling(36))
        simulation.solve()
        counters.append({**simulation.counters})
        tracks.append(simulation.read()["E.ax"] / scene.bodies["link"].lengths[frozenset("DE")])  # type: ignore[index]
    assert counters[0] == counters[1] == counters[2]
    np.testing.assert_allclose(tracks[0], tracks[1], rtol=0, atol=1e-12 * np.ptp(tracks[1]))  # lengths were rounded
    np.testing.assert_allclose(tracks[2], tracks[1], rtol=0, atol=1e-12 * np.ptp(tracks[1]))


# --- loads -----------------------------------------------------------------------------------------------------------


def stroke_end(scene: Scene, force: float) -> float:
    load = PressForce("slider", "B", (force, 0.0), 0.1, -1 if force > 0 else 1)
    with flint.ctx.workdps(50):
        linkage = multiprecision_linkage.Linkage(scene)
        march = multiprecision_march.March(linkage, 50)
        q = march.follow(closed(linkage, march), linkage.drive(scene.drive.start))
        return multiprecision_stroke.end_of_stroke(linkage, march, q, load)


def test_a_closing_stroke_ends_at_the_dead_point(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SLIDER_CRANK)
    offset = scene_of(tmp_path, SLIDER_CRANK.replace("through = [0, 0]", "through = [0.5, 0.3]"))
    for force, closed_by in ((-1.0, 3.0), (1.0, 1.0)):
        assert abs(stroke_end(scene, force) - closed_by) <= 4 * EPS
        assert abs(stroke_end(offset, force) - (sqrt(closed_by**2 - 0.3**2) - 0.5)) <= 4 * EPS


def reach(angle: float) -> float:
    return cos(angle) + sqrt(4 - sin(angle) ** 2)


def test_a_closing_stroke_ends_where_a_run_does(tmp_path: Path) -> None:
    """Away from the dead points: at the run's ends, or where the law turns round, there also between two samples."""
    way = scene_of(tmp_path, SLIDER_CRANK.replace("speed = 2.0", "speed = 2.0, start = 0.5, end = 2.5"))
    assert abs(stroke_end(way, -1.0) - reach(0.5)) <= 4 * EPS
    assert abs(stroke_end(way, 1.0) - reach(2.5)) <= 4 * EPS
    law = MotionLaw("crank", (0.0, 1.0, 2.0, 3.0), (1.0, 1.0 + 4 / 9, 1.0 + 2 / 9, 1.0), periodic=False)
    a, b, c = np.polyfit(law.times, law.positions, 3)[:3]  # four entries: the spline is one cubic
    turn = (-b - sqrt(b * b - 3 * a * c)) / (3 * a)
    farthest = float(law.at(turn).position)
    assert abs(stroke_end(replace(way, drive=law), 1.0) - reach(farthest)) <= 4 * EPS
    assert abs(stroke_end(replace(way, drive=law), -1.0) - reach(float(law.extent[0]))) <= 4 * EPS


def test_table_in_a_press_by_hand(tmp_path: Path) -> None:
    """Massless: the drive's power is the load's. Below, between and beyond the entries."""
    loads = '[[loads]]\nbody = "slider"\nat = "C"\ntable = [[1.5, -10], [2, -50], [2.5, 40]]\n'
    motion = run(scene_of(tmp_path, SLIDER_CRANK.replace("[sketch]", loads + "[sketch]")), samples=24)
    force = np.interp(motion["B.x"], [1.5, 2, 2.5], [-10, -50, 40])
    assert {-10.0, 40.0} < set(force)
    assert np.abs(motion["drive.torque"] * 2 + force * motion["B.vx"]).max() <= 1e-12  # of 100 W, in doubles


def test_spring_without_a_direction_is_refused(tmp_path: Path) -> None:
    """The slider's corner C, half a metre above B, meets the ground point P at the start."""
    text = SLIDER_CRANK.replace("O = [0, 0] }", "O = [0, 0], P = [3, 0.5] }", 1)
    spring = '[[springs]]\nbetween = ["ground.P", "slider.C"]\nstiffness = 5\nlength = LENGTH\n'
    text = text.replace("[sketch]", spring + "[sketch]")
    with pytest.raises(Failure, match=r"ground\.P and slider\.C meet at crank angle 0\.0000 deg") as failure:
        run(scene_of(tmp_path, text.replace("LENGTH", "0.1")))
    assert failure.value.status is Status.nonfinite
    motion = run(scene_of(tmp_path, text.replace("LENGTH", "0")))
    assert np.abs(motion["A.fx"] + 5 * (3 - motion["B.x"])).max() <= 16 * EPS  # of 10 N; the crank holds it


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
    assert abs(float(found[1]) - lock) <= 1e-4  # as printed


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


def test_driven_slider_out_of_reach_is_found_where_the_rods_line_up(tmp_path: Path) -> None:
    """D is 300 mm from A and 120 from E, which runs 235 above A: they line up at sqrt(420^2 - 235^2)."""
    outward = DRIVEN_TOGGLE.replace("speed = -150", "speed = 150").replace("end = -150", "end = 400")
    simulation = model.build(scene_of(tmp_path, outward), model.DEFAULT, Sampling(36))
    with pytest.raises(Failure) as failure:
        simulation.solve()
    assert failure.value.status is Status.cannot_assemble
    found = re.search(r"crosshead at ([\d.]+) m", failure.value.reason)
    assert found
    assert abs(float(found[1]) - sqrt(0.42**2 - 0.235**2)) <= 1e-6  # as printed


def test_lengths_of_a_body_that_do_not_meet_are_refused(tmp_path: Path) -> None:
    """K hangs on D and M, whose distance no length gives."""
    within = '"A-D" = 300, "B-D" = 120, "A-M" = 340, "B-M" = 40, "D-K" = 5, "M-K" = 5'
    apart = re.sub('"A-D".* }', f"{within} }}", DRIVEN_TOGGLE).replace("K = [230", "M = [260, 240]\nK = [230")
    with pytest.raises(Failure, match="'plate' cannot be put together: the lengths from D and M to K") as failure:
        model.build(scene_of(tmp_path, apart), model.DEFAULT, Sampling(36))
    assert failure.value.status is Status.cannot_assemble


@pytest.mark.parametrize(("name", "coordinate"), [("toggle_press", 2), *(("quick_return", k) for k in (3, 4, 5))])
def test_pose_that_is_no_solution_is_not_enclosed(tmp_path: Path, name: str, coordinate: int) -> None:
    scene = named(tmp_path, name)
    with flint.ctx.workdps(50):
        linkage = multiprecision_linkage.Linkage(scene)
        march, goal = multiprecision_march.March(linkage, 50), linkage.drive(scene.sketch.drive)
        pose = closed(linkage, march)
        march.enclose(pose, goal)
        pose[coordinate, 0] += 1e-9
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

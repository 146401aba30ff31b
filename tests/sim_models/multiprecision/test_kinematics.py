"""Laws of motion that hold for every scene: rigid bodies, closed joints, derivatives, and an independent assembly."""

from math import pi

import numpy as np
import pytest
from scipy.optimize import root

from scenes import Motion, Sampling, Scene
from scenes.motion import channels
from scenes.scene import GROUND
from tests import scene_files

from .motion import carried, point_motion, size_of, slid, turning
from .runs import ALL, EPS, SMOOTH, Array, closed, continuing, named, run

flint = pytest.importorskip("flint")

from sim_models.multiprecision import constraints as multiprecision_constraints  # noqa: E402  (their engine is there)


@pytest.fixture(scope="module", params=ALL)
def scene(request: pytest.FixtureRequest) -> Scene:
    return scene_files.load(request.param)


@pytest.fixture(scope="module")
def motion(scene: Scene) -> Motion:
    return named(scene.name)


def test_every_channel_is_there_and_finite(scene: Scene, motion: Motion) -> None:
    assert set(motion.samples) == set(channels(scene))
    assert all(values.shape == (37,) and np.isfinite(values).all() for values in motion.samples.values())


def test_the_drive_is_where_it_is_to_be(scene: Scene, motion: Motion) -> None:
    """Where the doubles of the scene's own drive have it, to their rounding."""
    sampling = Sampling(36)
    _, rate, acceleration = scene.drive.at(sampling.times(scene))
    if scene.driven_slide is None:
        have = [motion[name] for name in ("crank_angle", f"{scene.drive.body}.omega", f"{scene.drive.body}.alpha")]
    else:
        have = [np.asarray(values.real, float) for values in slid(scene, motion, scene.drive.body)]
        assert np.abs(have[0] - motion["drive.displacement"]).max() <= 4 * EPS  # of metres: points rounded, products
    for asked, found in zip((sampling.commanded(scene), rate, acceleration), have, strict=True):
        # A spline's second derivatives lose the shortest step's share of the table, squared; zeros keep other digits.
        assert np.abs(found - asked).max() <= 100 * EPS * np.abs(asked).max() + 1e-40


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

    The branch is the one that Newton's method finds from the sketch, followed in steps of a twentieth of the way.
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
    for drive in np.linspace(at, start, 21):
        solution = root(equations, unknowns, args=(drive,), tol=1e-13)
        assert np.abs(solution.fun).max() <= 1e-12  # doubles, of metres
        unknowns = solution.x
    return dict(zip(names, unknowns[: 2 * len(names)].view(complex), strict=True))


def shows(scene: Scene, name: str) -> bool:
    return len(set(scene.bodies[name].points) & {*scene.ground, *scene.sketch.points}) > 1


@pytest.mark.parametrize("name", scene_files.MECHANISMS)
def test_the_linkage_is_assembled_as_sketched(name: str) -> None:
    scene = scene_files.load(name)
    motion = run(scene, samples=4)
    for point, at in independently_assembled(scene).items():
        assert (
            abs(complex(motion[f"{point}.x"][0], motion[f"{point}.y"][0]) - at) <= 1e-14
        )  # doubles, of metres, by the condition


@pytest.mark.parametrize("name", ["toggle_press", *SMOOTH])
def test_velocity_and_acceleration_are_the_derivatives(name: str) -> None:
    """Central differences are of second order: the error falls by four when the step is halved."""
    scene = scene_files.load(name)
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
        linkage = multiprecision_constraints.LinkageEquations(scene)
        continuation, rows = continuing(linkage), linkage.constraints
        at, h = flint.arb(scene.drive.start), flint.arb("1e-10").mid()
        q = continuation.follow(closed(linkage, continuation), linkage.drive(at))
        after, before = (continuation.follow(q, linkage.drive(at + step)) for step in (h, -h))
        J = rows.jacobian(q)
        slope = J.solve(linkage.drive(1.0))
        curvature = J.solve(rows.centripetal(q, slope))
        first = (after - before) * (1 / (2 * h)) - slope
        second = (after - q * flint.arb(2) + before) * (1 / (h * h)) - curvature
        assert max(abs(float(entry)) for entry in first.entries()) <= 1e-16
        assert max(abs(float(entry)) for entry in second.entries()) <= 1e-16

"""What must hold of the analytic core for every linkage: changes of frame, units, time and names; laws of mechanics.

Roundings are 1.1e-16 of coordinates up to some 30 m. A dyad at 20 degrees from lock makes them 1 / sin(20 deg) = 3
times larger in positions and up to 3^3 = 27 times in accelerations and reactions; a second dyad does so once more.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import analytic
from compare import registry
from compare.checks import checks
from compare.reference import establish, relative_errors
from scenes import Motion, Sampling, Scene
from scenes.consistency import check
from scenes.motion import Samples, channels, force_channels, quantity
from scenes.scene import Body, Load, Slide, Vector

from .linkages import STEPS, Path, directions, drawn_linkages, linkages, numbers, signs, vectors, xy

Channels = Mapping[str, Samples]

# Relative to the peak of a kind. Of 400 drawn linkages a test the worst are 7e-15 and 3e-14: times ten for other draws.
MOTION, FORCES = 1e-13, 3e-13
TOLERANCE = dict.fromkeys(("time", "crank_angle", "x", "angle", "vx", "omega"), MOTION) | dict.fromkeys(
    ("ax", "alpha", "fx", "torque"), FORCES
)
ALIKE = {"y": "x", "vy": "vx", "ay": "ax", "fy": "fx", "guide_force": "fx", "guide_moment": "torque"}

often = settings(max_examples=50, deadline=None, derandomize=True)
seldom = settings(max_examples=12, deadline=None, derandomize=True)


def turn(scene: Scene) -> Samples:
    return scene.drive.start + np.linspace(0, 2 * np.pi, 49)


def solve(scene: Scene) -> Motion:
    return analytic.solve(scene, turn(scene))


def kind(channel: str) -> str:
    """Return what channels of one unit and one size have in common."""
    return ALIKE.get(quantity(channel), quantity(channel))


def size(motion: Motion, scene: Scene) -> float:
    """Return the stroke of the output, the crank's pin, m."""
    return float(np.hypot(np.ptp(motion[f"{scene.output}.x"]), np.ptp(motion[f"{scene.output}.y"])))


def scales(scene: Scene, motion: Motion) -> dict[str, float]:
    """Return by kind the peak over all channels of that kind; a torque may vanish where the forces do not."""
    peaks: dict[str, float] = {"angle": 1.0, "crank_angle": 1.0}
    for channel in channels(scene):
        if kind(channel) not in ("angle", "crank_angle"):
            peaks[kind(channel)] = max(peaks.get(kind(channel), 0.0), float(np.abs(motion[channel]).max()))
    if "fx" in peaks:
        peaks["torque"] = max(peaks["torque"], peaks["fx"] * size(motion, scene))
    return {name: peak or 1.0 for name, peak in peaks.items()}


def assert_agree(scene: Scene, motion: Motion, expected: Channels) -> None:
    """Compare every channel of the scene's motion with the one expected."""
    scale = scales(scene, motion)
    assert set(expected) == set(channels(scene))
    for channel, samples in expected.items():
        difference = motion[channel] - samples
        if quantity(channel) == "angle":
            difference = np.remainder(difference + np.pi, 2 * np.pi) - np.pi
        assert np.abs(difference).max() <= TOLERANCE[kind(channel)] * scale[kind(channel)], channel


# --- the linkage itself -----------------------------------------------------------------------------------------------


@often
@given(drawn_linkages())
def test_the_drawing_is_what_is_solved(drawn: tuple[Scene, dict[str, Path]]) -> None:
    """The scene is one that a file could hold, and its points are where circles and lines meet, on the same branch."""
    scene, path = drawn
    check(scene, output_slides=False)
    motion = analytic.solve(scene, scene.sketch.angle + STEPS)
    for point, z in path.items():
        assert np.abs(motion[f"{point}.x"] + 1j * motion[f"{point}.y"] - z).max() <= MOTION * np.abs(z).max(), point


# --- another frame, other units ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Change:
    """Another view of one world: mirrored in the x axis, then turned and shifted, or measured in other units."""

    mirror: int = 1  # -1 for y -> -y
    turn: complex = 1
    shift: complex = 0
    length: float = 1
    mass: float = 1
    time: float = 1

    def vector(self, x: float, y: float) -> complex:
        """Return a direction as it is seen now."""
        return self.turn * complex(x, self.mirror * y)

    def point(self, v: Vector) -> Vector:
        return xy(self.vector(*v) * self.length + self.shift)

    def angle(self, angle: float) -> float:
        return self.mirror * angle + float(np.angle(self.turn))

    def scene(self, scene: Scene) -> Scene:
        acceleration = self.length / self.time**2
        loads = (replace(load, force=xy(self.vector(*load.force) * self.mass * acceleration)) for load in scene.loads)
        return replace(
            scene,
            ground={name: self.point(v) for name, v in scene.ground.items()},
            bodies={name: self.body(body) for name, body in scene.bodies.items()},
            drive=replace(
                scene.drive,
                speed=self.mirror * scene.drive.speed / self.time,
                start=self.angle(scene.drive.start),
            ),
            loads=tuple(loads),
            gravity=None if scene.gravity is None else xy(self.vector(*scene.gravity) * acceleration),
            sketch=replace(
                scene.sketch,
                angle=self.angle(scene.sketch.angle),
                points={name: self.point(v) for name, v in scene.sketch.points.items()},
            ),
        )

    def body(self, body: Body) -> Body:
        """Return the body; its frame turns with the world, but a slider's stays parallel to the ground's."""
        view = replace(self, turn=1 if body.slide is None else self.turn, shift=0)
        along = body.slide and xy(self.vector(*body.slide.along))
        return replace(
            body,
            local=body.local and {name: view.point(v) for name, v in body.local.items()},
            lengths=body.lengths and {pair: length * self.length for pair, length in body.lengths.items()},
            mass=None if body.mass is None else body.mass * self.mass,
            com=body.com and view.point(body.com),
            inertia=None if body.inertia is None else body.inertia * self.mass * self.length**2,
            slide=body.slide and along and Slide(self.point(body.slide.through), along),
        )

    def channels(self, scene: Scene, motion: Motion) -> Channels:
        """Return what the scene's motion looks like now."""
        omega = self.mirror / self.time
        force = self.mass * self.length / self.time**2
        scalar = {"time": self.time, "omega": omega, "alpha": omega / self.time}
        scalar |= {"guide_force": self.mirror * force, "guide_moment": self.mirror * force * self.length}
        scalar |= {"torque": self.mirror * force * self.length}
        vector = {"": self.length, "v": self.length / self.time, "a": self.length / self.time**2, "f": force}
        seen = {}
        for channel in channels(scene):
            stem, of = channel.rpartition(".")[0], quantity(channel)
            if of in scalar:
                seen[channel] = scalar[of] * motion[channel]
            elif of in ("angle", "crank_angle"):
                seen[channel] = self.mirror * motion[channel] + np.angle(self.turn)
            elif of.endswith("x"):
                y = f"{channel[:-1]}y"
                v = self.turn * (motion[channel] + 1j * self.mirror * motion[y]) * vector[of[:-1]]
                v = v + self.shift if of == "x" else v
                seen |= {f"{stem}.{of}": v.real, y: v.imag}
        return seen


CHANGES = {
    "turned": st.builds(Change, turn=directions()),
    "shifted": st.builds(Change, shift=vectors(10)),
    "mirrored": st.builds(Change, mirror=st.just(-1)),
    "other length": st.builds(Change, length=st.sampled_from((1e-3, 0.3048, 1e3))),
    "other mass": st.builds(Change, mass=st.sampled_from((1e-3, 0.45359237, 1e3))),
    "other time": st.builds(Change, time=st.sampled_from((1e-3, 60.0, 1e3))),
    "all at once": st.builds(
        Change, signs, directions(), vectors(1), numbers(0.5, 2), numbers(0.1, 10), numbers(0.1, 10)
    ),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
@often
@given(data=st.data(), scene=linkages())
def test_another_view_of_the_world(change: st.SearchStrategy[Change], data: st.DataObject, scene: Scene) -> None:
    """Vectors turn, scalars stay or change sign with the sense of turning, and all scale by their dimension."""
    seen = data.draw(change)
    other = seen.scene(scene)
    angle = seen.mirror * turn(scene) + np.angle(seen.turn)
    assert_agree(other, analytic.solve(other, angle), seen.channels(scene, solve(scene)))


@often
@given(linkages())
def test_time_reversed(scene: Scene) -> None:
    """At the same crank angle only the velocities and the time change sign."""
    back = replace(scene, drive=replace(scene.drive, speed=-scene.drive.speed))
    motion = solve(scene)
    odd = ("time", "vx", "omega")
    assert_agree(back, solve(back), {c: -motion[c] if kind(c) in odd else motion[c] for c in channels(scene)})


# --- other names, another order ---------------------------------------------------------------------------------------


def on_bodies(scene: Scene, motion: Motion) -> dict[tuple[str, str], Path]:
    """Return the force of each pin on each of its bodies, by point and body, whichever comes first in the file."""
    found: dict[tuple[str, str], Path] = {}
    for pin in scene.pins:
        force = motion[f"{pin.channel}.fx"] + 1j * motion[f"{pin.channel}.fy"]
        found[pin.point, pin.second] = force
        found[pin.point, pin.first] = found.get((pin.point, pin.first), 0) - force
    return found


def renamed(scene: Scene, names: Mapping[str, str], order: list[str]) -> Scene:
    """Return the scene with other names of points and bodies, its bodies in another order, their points reversed."""

    def body(old: Body) -> Body:
        points = old.points
        if old.local is not None and old.slide is None:
            points = points[::-1]  # nothing hangs on which is first, unless lengths or a slide start from it
        return replace(
            old,
            name=names[old.name],
            points=tuple(names[point] for point in points),
            local=old.local and {names[point]: old.local[point] for point in points},
            lengths=old.lengths and {frozenset(names[p] for p in pair): of for pair, of in old.lengths.items()},
        )

    return replace(
        scene,
        ground={names[point]: v for point, v in scene.ground.items()},
        bodies={names[name]: body(scene.bodies[name]) for name in order},
        drive=replace(scene.drive, body=names[scene.drive.body]),
        loads=tuple(replace(load, body=names[load.body], at=names[load.at]) for load in scene.loads),
        sketch=replace(scene.sketch, points={names[point]: v for point, v in scene.sketch.points.items()}),
        output=names[scene.output],
    )


@often
@given(data=st.data(), scene=linkages())
def test_names_and_order_do_not_matter(data: st.DataObject, scene: Scene) -> None:
    """Only the sign rule looks at the order: a pin's force is that of the body first in the file on the later one."""
    old = [*scene.owners, *scene.bodies]
    names = dict(zip(old, data.draw(st.permutations([f"n{i}" for i in range(len(old))])), strict=True))
    other = renamed(scene, names, data.draw(st.permutations(list(scene.bodies))))
    motion = solve(scene)
    expected = {}
    for channel in channels(scene):
        stem, _, of = channel.rpartition(".")
        if of not in ("fx", "fy"):
            expected[f"{names.get(stem, stem)}.{of}" if stem else of] = motion[channel]
    forces = {(names[p], names.get(b, b)): force for (p, b), force in on_bodies(scene, motion).items()}
    for pin in other.pins:
        force = forces[pin.point, pin.second]
        expected |= {f"{pin.channel}.fx": force.real, f"{pin.channel}.fy": force.imag}
    assert_agree(other, solve(other), expected)


# --- laws of mechanics ------------------------------------------------------------------------------------------------


@often
@given(linkages(), numbers(0.1, 10))
def test_forces_follow_density(scene: Scene, denser: float) -> None:
    """Without loads every force is proportional to the masses, whatever gravity and speed are."""
    light = replace(scene, loads=())
    heavy = replace(light, bodies={name: denser_body(body, denser) for name, body in scene.bodies.items()})
    motion = solve(light)
    forces = force_channels(scene)
    assert_agree(heavy, solve(heavy), {c: motion[c] * (denser if c in forces else 1) for c in channels(scene)})


def denser_body(body: Body, by: float) -> Body:
    assert body.mass is not None
    return replace(body, mass=body.mass * by, inertia=None if body.inertia is None else body.inertia * by)


@often
@given(linkages(), numbers(0.1, 10))
def test_forces_follow_the_square_of_speed(scene: Scene, faster: float) -> None:
    """Without loads and weights all forces are inertia's."""
    slow = replace(scene, loads=(), gravity=None)
    fast = replace(slow, drive=replace(slow.drive, speed=slow.drive.speed * faster))
    motion = solve(slow)
    power = {"time": -1, "vx": 1, "omega": 1, "ax": 2, "alpha": 2, "fx": 2, "torque": 2}
    expected = {c: motion[c] * faster ** power.get(kind(c), 0) for c in channels(scene)}
    assert_agree(fast, solve(fast), expected)


@often
@given(linkages(), st.data())
def test_loads_superpose(scene: Scene, data: st.DataObject) -> None:
    """Forces are affine in the loads, F(a + 2 b) = F(a) + 2 F(b) - 2 F(0); weights count among the loads here."""
    places = [(body.name, point) for body in scene.bodies.values() for point in body.points]
    some = [Load(*data.draw(st.sampled_from(places)), xy(data.draw(vectors(20)))) for _ in range(2)]
    twice = [replace(load, force=(2 * load.force[0], 2 * load.force[1])) for load in some]
    g = scene.gravity or (0.0, 0.0)
    none = solve(replace(scene, loads=(), gravity=None))
    own = solve(scene)
    more = solve(replace(scene, loads=tuple(some), gravity=(1.0, -9.81)))
    both = replace(scene, loads=(*twice, *scene.loads), gravity=(g[0] + 2.0, g[1] - 2 * 9.81))
    forces = force_channels(scene)
    expected = {c: own[c] + 2 * (more[c] - none[c]) if c in forces else own[c] for c in channels(scene)}
    assert_agree(both, solve(both), expected)


@often
@given(linkages())
def test_masses_do_not_change_the_motion(scene: Scene) -> None:
    """A kinematic scene has the very same motion, to the bit, and no force at all."""
    bare = replace(scene, bodies={n: replace(b, mass=None, com=None, inertia=None) for n, b in scene.bodies.items()})
    motion, moved = solve(scene), solve(replace(bare, loads=(), gravity=None))
    assert set(moved.samples) == set(channels(scene)) - set(force_channels(scene))
    for channel in moved.samples:
        assert np.array_equal(moved[channel], motion[channel]), channel


@often
@given(linkages())
def test_joints_close_and_forces_and_power_balance(scene: Scene) -> None:
    motion = solve(scene)
    found = checks(scene, motion, size(motion, scene))
    assert {c.check for c in found} == {"closure", "Newton", "Euler", "power"}
    for c in found:
        assert c.worst <= MOTION, (
            c
        )  # what is summed up here rounds, at 5e-15; how the channels came about does not matter


@seldom
@given(linkages())
def test_against_50_digits(scene: Scene) -> None:
    """Newton from the sketch, then multipliers: another formulation with 50 digits agrees in every channel."""
    engine = registry.engine(registry.ORACLE)
    run = engine.build(scene, engine.DEFAULT, Sampling(24))
    run.solve()
    exact = run.read()
    motion = analytic.solve(scene, exact["crank_angle"])
    errors = relative_errors(motion, exact, establish(scene).scale)
    assert set(errors) == set(channels(scene)) - {"time"}
    for channel, error in errors.items():
        # As above, 2e-14 at worst; but each joint is measured by its own peak here, which may be a small one.
        assert error.max() <= 1e-12, channel

"""What must hold of the analytic core for every linkage: changes of frame, units, time, names and sides of a slot."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import analytic
from scenes import Motion, Scene
from scenes.consistency import check
from scenes.motion import Samples, channels, quantity
from scenes.scene import (
    GROUND,
    Body,
    ConstantSpeed,
    Drive,
    ForceTable,
    Load,
    MotionLaw,
    PressForce,
    Slide,
    Spring,
    Vector,
)
from tests.agreement import MOTION, Channels, assert_agree, attitude, instants, kind, solve, where
from tests.linkage_scenes import drawn_linkages, linkages
from tests.linkages import Path, directions, numbers, signs, vectors, xy

often = settings(max_examples=40, deadline=None, derandomize=True)


@often
@given(drawn_linkages())
def test_the_drawing_is_what_is_solved(drawn: tuple[Scene, Samples, dict[str, Path]]) -> None:
    """The scene is one that a file could hold, and its points are where circles and lines meet, on the same branch."""
    scene, positions, path = drawn
    check(scene, output_slides=False)
    motion = analytic.solve(scene, positions, np.zeros(positions.shape))
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
        return replace(
            scene,
            ground={name: self.point(v) for name, v in scene.ground.items()},
            bodies={name: self.body(scene, body) for name, body in scene.bodies.items()},
            drive=self.drive(scene),
            loads=tuple(map(self.load, scene.loads)),
            springs=tuple(map(self.spring, scene.springs)),
            gravity=scene.gravity and xy(self.vector(*scene.gravity) * self.length / self.time**2),
            sketch=replace(
                scene.sketch,
                drive=self.position(scene, scene.sketch.drive),
                points={name: self.point(v) for name, v in scene.sketch.points.items()},
            ),
        )

    @property
    def force(self) -> float:
        return self.mass * self.length / self.time**2

    def position(self, scene: Scene, position: float) -> float:
        """Return a position of the drive."""
        return self.angle(position) if scene.driven_slide is None else self.length * position

    def drive(self, scene: Scene) -> Drive:
        drive, unit = scene.drive, self.mirror if scene.driven_slide is None else self.length
        if isinstance(drive, MotionLaw):
            positions = tuple(self.position(scene, position) for position in drive.positions)
            return replace(drive, times=tuple(time * self.time for time in drive.times), positions=positions)
        start, end = (None if x is None else self.position(scene, x) for x in (drive.start, drive.end))
        assert start is not None
        return replace(drive, speed=unit * drive.speed / self.time, start=start, end=end)

    def load(self, load: Load) -> Load:
        if isinstance(load, ForceTable):
            displacements, forces = load.displacements, load.forces
            return replace(
                load,
                displacements=tuple(x * self.length for x in displacements),
                forces=tuple(f * self.force for f in forces),
            )
        force = xy(self.vector(*load.force) * self.force)
        if isinstance(load, PressForce):
            return replace(load, force=force, last=load.last * self.length)
        return replace(load, force=force)

    def spring(self, spring: Spring) -> Spring:
        return replace(
            spring, stiffness=spring.stiffness * self.mass / self.time**2, length=spring.length * self.length
        )

    def body(self, scene: Scene, body: Body) -> Body:
        """Return the body; its frame turns with the world, but one that cannot turn stays parallel to the ground's."""
        view = self.within(scene, body.name)
        slide = body.slide
        if slide is not None:
            on = self.within(scene, slide.on)
            slide = Slide(slide.on, on.point(slide.through), xy(on.vector(*slide.along)))
        return replace(
            body,
            local=body.local and {name: view.point(v) for name, v in body.local.items()},
            lengths=body.lengths and {pair: length * self.length for pair, length in body.lengths.items()},
            mass=None if body.mass is None else body.mass * self.mass,
            com=body.com and view.point(body.com),
            inertia=None if body.inertia is None else body.inertia * self.mass * self.length**2,
            slide=slide,
        )

    def within(self, scene: Scene, name: str) -> "Change":
        """Return the change as it is seen in the frame of a body or the ground."""
        if name == GROUND:
            return self
        return replace(self, shift=0, turn=1 if name in scene.turning else self.turn)

    def channels(self, scene: Scene, motion: Motion) -> Channels:
        """Return what the scene's motion looks like now."""
        omega = self.mirror / self.time
        force, moment = self.force, self.mirror * self.force * self.length
        scalar = {"time": self.time, "displacement": self.length, "omega": omega, "alpha": omega / self.time}
        scalar |= {"force": force, "guide_force": self.mirror * force, "guide_moment": moment, "torque": moment}
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
    assert_agree(other, solve(other, instants(scene) * seen.time), seen.channels(scene, solve(scene)))


@often
@given(linkages())
def test_time_reversed(scene: Scene) -> None:
    """At the same position of the drive only velocities and time change sign; press forces are left out."""
    scene = replace(scene, loads=tuple(load for load in scene.loads if not isinstance(load, PressForce)))
    back, whole = replace(scene, drive=reversed_drive(scene.drive)), scene.drive.cycle
    motion = solve(scene)
    expected = {c: -motion[c] if kind(c) in ("vx", "omega") else motion[c] for c in channels(scene)}
    assert_agree(back, solve(back, whole - instants(scene)), expected | {"time": whole - motion["time"]})


def reversed_drive(drive: Drive) -> Drive:
    """Return a drive that goes through its cycle backwards."""
    if isinstance(drive, MotionLaw):
        times = tuple(drive.cycle - time for time in reversed(drive.times))
        return replace(drive, times=times, positions=drive.positions[::-1])
    ends = drive.start + drive.advance, None if drive.end is None else drive.start
    return ConstantSpeed(drive.body, -drive.speed, *ends)


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
        slide = old.slide and replace(old.slide, on=names.get(old.slide.on, GROUND))
        return replace(
            old,
            name=names[old.name],
            points=tuple(names[point] for point in points),
            local=old.local and {names[point]: old.local[point] for point in points},
            lengths=old.lengths and {frozenset(names[p] for p in pair): of for pair, of in old.lengths.items()},
            slide=slide,
        )

    def place(old: tuple[str, str]) -> tuple[str, str]:
        return names.get(old[0], GROUND), names[old[1]]

    return replace(
        scene,
        ground={names[point]: v for point, v in scene.ground.items()},
        bodies={names[name]: body(scene.bodies[name]) for name in order},
        drive=replace(scene.drive, body=names[scene.drive.body]),
        loads=tuple(replace(load, body=names[load.body], at=names[load.at]) for load in scene.loads),
        springs=tuple(replace(of, first=place(of.second), second=place(of.first)) for of in scene.springs),
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


# --- a slot, seen from either side ------------------------------------------------------------------------------------


@often
@given(data=st.data(), scene=linkages("RPR") | linkages())
def test_a_slot_may_be_declared_from_either_side(data: st.DataObject, scene: Scene) -> None:
    """A block slides on a rocker as the rocker does on the block: only what the guide does is opposite."""
    slots = [
        body
        for body in scene.bodies.values()
        if body.slide is not None
        and body.slide.on not in (GROUND, scene.drive.body)
        and scene.bodies[body.slide.on].slide is None
    ]
    assume(slots)
    block = data.draw(st.sampled_from(slots))
    assert block.slide is not None
    rocker = scene.bodies[block.slide.on]
    other = seen_from_the_other_side(scene, block, rocker)
    motion = solve(scene)
    normal = 1j * attitude(scene, motion, rocker.name) * complex(*block.slide.along)
    force = normal * motion[f"{block.name}.guide_force"]
    apart = where(scene, motion, block.points[0]) - where(scene, motion, rocker.points[0])
    expected = {c: motion[c] for c in channels(scene) if not c.startswith(f"{block.name}.guide")}
    expected[f"{rocker.name}.guide_force"] = -motion[f"{block.name}.guide_force"]
    expected[f"{rocker.name}.guide_moment"] = -motion[f"{block.name}.guide_moment"] - (apart.conj() * force).imag
    assert_agree(other, solve(other), expected)


def seen_from_the_other_side(scene: Scene, block: Body, rocker: Body) -> Scene:
    """Return the scene with the rocker sliding on the block: its first point along a line of the block's frame."""
    slide = block.slide
    assert slide is not None
    through = first(block) + first(rocker) - complex(*slide.through)
    turned = {
        block.name: replace(block, slide=None),
        rocker.name: replace(rocker, slide=Slide(block.name, xy(through), slide.along)),
    }
    return replace(scene, bodies={**scene.bodies, **turned})


def first(body: Body) -> complex:
    return complex(*body.local[body.points[0]]) if body.local is not None else 0j

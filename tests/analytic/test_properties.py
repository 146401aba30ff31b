"""What must hold of the analytic core for every linkage: changes of frame, units, time, names and sides of a slot."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import analytic
from scenes import Motion, Scene
from scenes.file.consistency import check
from scenes.model.motion import Samples, channels
from scenes.scene import GROUND, Body, ConstantSpeed, Drive, MotionLaw, PressForce
from tests.agreement import MOTION, assert_agree, attitude, instants, kind, solve, where
from tests.linkage_scenes import drawn_linkages, linkages
from tests.linkages import Path, directions, numbers, signs, vectors

from .test_mechanisms import flipped
from .views import Change

often = settings(max_examples=12, deadline=None, derandomize=True)
few = settings(often, max_examples=6)  # of each change alone: all of them are in the one at once


@often
@given(drawn_linkages())
def test_the_drawing_is_what_is_solved(drawn: tuple[Scene, Samples, dict[str, Path]]) -> None:
    """The scene is one that a file could hold, and its points are where circles and lines meet, on the same branch."""
    scene, positions, path = drawn
    check(scene, output_slides=False)
    motion = analytic.solve(scene, positions, np.zeros(positions.shape))
    for point, z in path.items():
        assert np.abs(motion[f"{point}.x"] + 1j * motion[f"{point}.y"] - z).max() <= MOTION * np.abs(z).max(), point


CHANGES = {
    "turned": st.builds(Change, turn=directions()),
    "shifted": st.builds(Change, shift=vectors(10)),
    "mirrored": st.builds(Change, mirror=st.just(-1)),
    "other length": st.builds(Change, length=st.sampled_from((1e-3, 0.3048, 1e3))),
    "other mass": st.builds(Change, mass=st.sampled_from((1e-3, 0.45359237, 1e3))),
    "other time": st.builds(Change, time=st.sampled_from((1e-3, 60.0, 1e3))),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
@few
@given(data=st.data(), scene=linkages())
def test_another_view_of_the_world(change: st.SearchStrategy[Change], data: st.DataObject, scene: Scene) -> None:
    """Vectors turn, scalars stay or change sign with the sense of turning, and all scale by their dimension."""
    assert_seen(data.draw(change), scene)


@often
@given(
    st.builds(Change, signs, directions(), vectors(1), numbers(0.5, 2), numbers(0.1, 10), numbers(0.1, 10)), linkages()
)
def test_another_view_in_every_way(seen: Change, scene: Scene) -> None:
    assert_seen(seen, scene)


def assert_seen(seen: Change, scene: Scene) -> None:
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
            corners=tuple(names[point] for point in old.corners),
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
    other = flipped(scene, block.name, rocker.name)
    motion = solve(scene)
    normal = 1j * attitude(scene, motion, rocker.name) * complex(*block.slide.along)
    force = normal * motion[f"{block.name}.guide_force"]
    apart = where(scene, motion, block.points[0]) - where(scene, motion, rocker.points[0])
    expected = {c: motion[c] for c in channels(scene) if not c.startswith(f"{block.name}.guide")}
    expected[f"{rocker.name}.guide_force"] = -motion[f"{block.name}.guide_force"]
    expected[f"{rocker.name}.guide_moment"] = -motion[f"{block.name}.guide_moment"] - (apart.conj() * force).imag
    assert_agree(other, solve(other), expected)

"""What must hold of the analytic core for every linkage: changes of frame, units, time, names and sides of a slot."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import analytic
from scenes import Motion, Scene
from scenes.file.consistency import check
from scenes.model.motion import Samples
from scenes.scene import GROUND, Body
from tests.agreement import MOTION, assert_agree, instants, solve
from tests.linkage_scenes import drawn_linkages, linkages
from tests.linkages import Path, directions, signs, vectors

from .views import Change

often = settings(max_examples=12, deadline=None, derandomize=True)
LENGTHS, MASSES, TIMES = (st.sampled_from(of) for of in ((1e-3, 0.3048, 1e3), (1e-3, 0.4536, 1e3), (1e-3, 60.0, 1e3)))


@often
@given(drawn_linkages())
def test_the_drawing_is_what_is_solved(drawn: tuple[Scene, Samples, dict[str, Path]]) -> None:
    """The scene is one that a file could hold, and its points are where circles and lines meet, on the same branch."""
    scene, positions, path = drawn
    check(scene, output_slides=False)
    motion = analytic.solve(scene, positions, np.zeros(positions.shape))
    for point, z in path.items():
        assert np.abs(motion[f"{point}.x"] + 1j * motion[f"{point}.y"] - z).max() <= MOTION * np.abs(z).max(), point


@often
@given(st.builds(Change, signs, directions(), vectors(1), LENGTHS, MASSES, TIMES), linkages())
def test_another_view_in_every_way(seen: Change, scene: Scene) -> None:
    assert_seen(seen, scene)


def assert_seen(seen: Change, scene: Scene) -> None:
    other = seen.scene(scene)
    assert_agree(other, solve(other, instants(scene) * seen.time), seen.channels(scene, solve(scene)))


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
        drives=(replace(scene.drive, body=names[scene.drive.body], on=names.get(scene.drive.on, GROUND)),),
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
    for channel in scene.channels.names():
        stem, _, of = channel.rpartition(".")
        if of not in ("fx", "fy"):
            expected[f"{names.get(stem, stem)}.{of}" if stem else of] = motion[channel]
    forces = {(names[p], names.get(b, b)): force for (p, b), force in on_bodies(scene, motion).items()}
    for pin in other.pins:
        force = forces[pin.point, pin.second]
        expected |= {f"{pin.channel}.fx": force.real, f"{pin.channel}.fy": force.imag}
    assert_agree(other, solve(other), expected)

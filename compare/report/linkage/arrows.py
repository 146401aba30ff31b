"""The forces that a picture of the linkage shows: of every pin, guide and load, and of a driven slider's drive."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from scenes import Motion, Scene
from scenes.scene import PressForce

from ...mechanics.motion_vectors import MotionVectors, Vectors


@dataclass(frozen=True)
class Arrow:
    """One force over a motion."""

    name: str
    point: str  # where it attacks
    force: Vectors  # N, shape (n,)
    components: tuple[str, str]  # their names: of a pin, its channels
    load: bool = False  # rather than of a joint


def arrows(scene: Scene, pose: Motion, motion: Motion) -> list[Arrow]:
    """The forces of the joints that a motion has, and the loads; none of a scene without masses.

    Args:
        scene: the linkage.
        pose: how guides are turned, and where loads act; of all channels.
        motion: forces, shape (n,) as those of the pose.
    """
    if not scene.has_masses:
        return []
    return [*_joints(MotionVectors(scene, pose), motion), *_loads(scene, pose)]


def _joints(state: MotionVectors, motion: Motion) -> Iterator[Arrow]:
    scene = state.scene
    for pin in scene.pins:
        components = f"{pin.channel}.fx", f"{pin.channel}.fy"
        if all(component in motion for component in components):
            name = f"{pin.channel}: {pin.first} on {pin.second}"
            yield Arrow(name, pin.point, motion[components[0]] + 1j * motion[components[1]], components)
    for body in scene.bodies.values():
        if body.slide is None:
            continue
        along = np.exp(1j * state.angle(body.slide.on)) * complex(*body.slide.along)
        for channel, direction, name in (
            (f"{body.name}.guide_force", 1j * along, f"guide on {body.name}"),
            ("drive.force", along, f"drive on {body.name}"),
        ):
            if channel in motion and (channel != "drive.force" or body.name == scene.drive.body):
                yield Arrow(name, body.points[0], motion[channel] * direction, (f"{name} x", f"{name} y"))


def _loads(scene: Scene, motion: Motion) -> Iterator[Arrow]:
    state = MotionVectors(scene, motion)
    acting = [
        load.acts(*state.displacement(scene.bodies[load.body])[:2], state.stroke_end(load))
        for load in scene.loads
        if isinstance(load, PressForce)
    ]
    state = MotionVectors(scene, motion, acting)
    for body in scene.bodies.values():
        own = [load for load in scene.loads if load.body == body.name]
        for number, (load, applied) in enumerate(zip(own, state.applied(body), strict=False)):
            components = f"load {body.name} {number} x", f"load {body.name} {number} y"
            yield Arrow(f"load on {body.name}", load.at, applied.force, components, load=True)

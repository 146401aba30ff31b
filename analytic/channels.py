"""The scene's channels, each with how it is taken from the kinematics and the reactions."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from typing import TypeAlias

import numpy as np

from scenes import Scene
from scenes.arguments import known_names
from scenes.model.motion import Samples
from scenes.scene import Pin

from .core.decomposition import Dyad, inner_joint
from .core.dyads import Vectors, dot
from .core.group_equations import Group
from .core.kinetostatics import Reactions
from .core.placing import Kinematics
from .way.nearest_length import to_lock

FromBoth: TypeAlias = Callable[[Kinematics, Reactions], Vectors | Samples]
Channels: TypeAlias = tuple[tuple[str, ...], FromBoth]  # names, and what they are taken from


def vector_channels(scene: Scene) -> Iterator[Channels]:
    """Yield the channels that are a vector's x and y, with the vector."""
    for point in scene.moving_points:
        yield from _of_point(point)
    if scene.has_masses:
        for pin in scene.pins:
            yield _of_pin(pin)


def scalar_channels(scene: Scene, groups: Iterable[Dyad | Group]) -> Iterator[Channels]:
    """Yield the other channels, and those that only this model has."""
    for body in scene.turning:
        yield from _of_turning(body)
    if scene.has_masses:
        for body in (body.name for body in scene.bodies.values() if body.slide is not None):
            yield from _of_slider(body)
        yield ("drive.torque" if scene.driven_slide is None else "drive.force",), lambda _, on: on.effort
    for group in groups:
        yield from _of_group(group)


def known_channels(
    scene: Scene, groups: Sequence[Dyad | Group], channels: AbstractSet[str] | None
) -> frozenset[str] | None:
    """The channels asked for, besides the time and the drive's position; None for all.

    Raises:
        InputError: there is no such channel.
    """
    if channels is None:
        return None
    every = (*vector_channels(scene), *scalar_channels(scene, groups))
    known = ("time", scene.drive_channel, *(name for names, _ in every for name in names))
    return known_names("channels", channels, known)


def _of_point(p: str) -> Iterator[Channels]:
    yield (f"{p}.x", f"{p}.y"), lambda k, _: k.z[p]
    yield (f"{p}.vx", f"{p}.vy"), lambda k, _: k.v[p]
    yield (f"{p}.ax", f"{p}.ay"), lambda k, _: k.a[p]


def _of_pin(pin: Pin) -> Channels:
    return (f"{pin.channel}.fx", f"{pin.channel}.fy"), lambda _, on: on.pin[pin.point, pin.second]


def _of_turning(body: str) -> Iterator[Channels]:
    yield (f"{body}.angle",), lambda k, _: np.arctan2(k.u[body].imag, k.u[body].real)
    yield (f"{body}.omega",), lambda k, _: k.omega[body]
    yield (f"{body}.alpha",), lambda k, _: k.alpha[body]


def _of_slider(body: str) -> Iterator[Channels]:
    yield (f"{body}.guide_force",), lambda _, on: on.guide[body][0]
    yield (f"{body}.guide_moment",), lambda _, on: on.guide[body][1]


def _of_group(group: Dyad | Group) -> Iterator[Channels]:
    """Yield how far a group is from a singular configuration."""
    joint = inner_joint(group)
    if isinstance(group, Group):
        yield (f"{joint}.to_lock",), lambda k, _: to_lock(*k.jacobian[joint][:2])
        return
    yield (f"{joint}.transmission",), lambda k, _: _transmission(k, joint)
    yield (f"{joint}.to_lock",), lambda k, _: k.to_lock[joint]


def _transmission(k: Kinematics, joint: str) -> Samples:
    g1, g2, det = k.closure[joint]
    angle: Samples = np.arctan2(np.abs(det), np.abs(dot(g1, g2)))
    return angle

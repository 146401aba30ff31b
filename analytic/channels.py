"""The scene's channels, each with how it is taken from the kinematics and the reactions."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from collections.abc import Set as AbstractSet
from functools import partial
from typing import TypeAlias

import numpy as np

from scenes import Scene
from scenes.arguments import known_names
from scenes.model.motion import Samples

from .core.decomposition import Dyad
from .core.dyads import Vectors, dot
from .core.group_equations import Group
from .core.kinetostatics import Reactions
from .core.placing import Kinematics
from .way.nearest_length import to_lock

FromBoth: TypeAlias = Callable[[Kinematics, Reactions], Vectors | Samples]


def all_channels(scene: Scene, groups: Iterable[Dyad | Group]) -> Iterator[tuple[tuple[str, ...], FromBoth]]:
    """Yield the names of a channel, or of both of a vector's, with what they are taken from: vectors first.

    Last are those that only this model has: how far a group is from a singular configuration.
    """
    for point in scene.moving_points:
        for q, of in (("", "z"), ("v", "v"), ("a", "a")):
            yield (f"{point}.{q}x", f"{point}.{q}y"), partial(_moving, of, point)
    for pin in scene.pins if scene.has_masses else ():
        yield (f"{pin.channel}.fx", f"{pin.channel}.fy"), partial(_pin, (pin.point, pin.second))
    for body in scene.turning:
        yield (f"{body}.angle",), partial(_angle, body)
        yield (f"{body}.omega",), partial(_moving, "omega", body)
        yield (f"{body}.alpha",), partial(_moving, "alpha", body)
    if scene.has_masses:
        for name in (name for name, body in scene.bodies.items() if body.slide is not None):
            yield (f"{name}.guide_force",), partial(_guide, name, 0)
            yield (f"{name}.guide_moment",), partial(_guide, name, 1)
        yield ("drive.torque" if scene.driven_slide is None else "drive.force",), lambda _, on: on.effort
    for group in groups:
        if not isinstance(group, Group):
            yield (f"{group.P}.transmission",), partial(_transmission, group.P)
        yield (f"{group.P}.to_lock",), partial(_to_lock, group)


def known_channels(
    scene: Scene, groups: Sequence[Dyad | Group], channels: AbstractSet[str] | None
) -> frozenset[str] | None:
    """The channels asked for, besides the time and the drive's position, or InputError; None for all."""
    if channels is None:
        return None
    names = (name for names, _ in all_channels(scene, groups) for name in names)
    return known_names("channels", channels, ("time", scene.drive_channel, *names))


def _moving(of: str, name: str, k: Kinematics, _: Reactions) -> Vectors | Samples:
    samples: Vectors | Samples = getattr(k, of)[name]
    return samples


def _pin(joint: tuple[str, str], _: Kinematics, on: Reactions) -> Vectors:
    return on.pin[joint]


def _angle(body: str, k: Kinematics, _: Reactions) -> Samples:
    return np.arctan2(k.u[body].imag, k.u[body].real)


def _guide(body: str, part: int, _: Kinematics, on: Reactions) -> Samples:
    return on.guide[body][part]


def _transmission(joint: str, k: Kinematics, _: Reactions) -> Samples:
    g1, g2, det = k.closure[joint]
    return np.arctan2(np.abs(det), np.abs(dot(g1, g2)))


def _to_lock(group: Dyad | Group, k: Kinematics, _: Reactions) -> Samples:
    return to_lock(*k.jacobian[group.P][:2]) if isinstance(group, Group) else k.to_lock[group.P]

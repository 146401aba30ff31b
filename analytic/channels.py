"""The scene's channels, each with how it is taken from the kinematics and the reactions."""

from collections.abc import Callable, Iterable, Iterator
from collections.abc import Set as AbstractSet
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from scenes import Sampling, Scene
from scenes.arguments import known_names
from scenes.model.motion import Samples, friction_channels

from .core.decomposition import Dyad, Linkage, members
from .core.dyads import Vectors, dot
from .core.groups.group_equations import Group
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
            yield (f"{point}.{q}x", f"{point}.{q}y"), partial(lambda of, point, k, _: getattr(k, of)[point], of, point)
    for pin in scene.pins if scene.has_masses else ():
        yield (f"{pin.channel}.fx", f"{pin.channel}.fy"), partial(lambda at, _, on: on.pin[at], (pin.point, pin.second))
    for body in scene.turning:
        yield (f"{body}.angle",), partial(lambda body, k, _: np.arctan2(k.u[body].imag, k.u[body].real), body)
        yield (f"{body}.omega",), partial(lambda body, k, _: k.omega[body], body)
        yield (f"{body}.alpha",), partial(lambda body, k, _: k.alpha[body], body)
    if scene.has_masses:
        for name in scene.slides:
            for part, q in enumerate(("force", "moment")):
                yield (f"{name}.guide_{q}",), partial(lambda name, part, _, on: on.guide[name][part], name, part)
        yield (scene.effort_channel,), lambda _, on: on.effort
        for name in friction_channels(scene):
            yield (name,), partial(lambda name, _, on: on.friction[name], name)
    for group in groups:
        if not isinstance(group, Group):
            yield (f"{group.P}.transmission",), partial(_transmission, group.P)
        yield (f"{group.P}.to_lock",), partial(_to_lock, group)


def of_larger(groups: Iterable[Dyad | Group]) -> frozenset[str]:
    """The channels of larger groups' distances to a singular pose, which take many times as long as all others."""
    return frozenset(f"{group.P}.to_lock" for group in groups if isinstance(group, Group))


def asked(scene: Scene, whole: Linkage, channels: AbstractSet[str] | None) -> tuple[Sampling, Linkage]:
    """A request of the channels, or InputError; and the decomposition with the groups that they need.

    The last groups go unless a force, or a point or body of theirs, is wanted.
    """
    if channels is None:
        return Sampling(), whole
    names = (name for names, _ in all_channels(scene, whole.groups) for name in names)
    request = Sampling(channels=known_names("channels", channels, ("time", scene.drive_channel, *names)))
    wanted = {channel.rpartition(".")[0] for channel in request.channels or ()}
    count = len(whole.groups)
    while count and wanted.isdisjoint(_names(whole, whole.groups[count - 1])):
        count -= 1
    return request, whole if request.wants_forces(scene) else replace(whole, groups=whole.groups[:count])


def _names(whole: Linkage, group: Dyad | Group) -> Iterator[str]:
    """Yield what a group's channels are named by: itself, its bodies and their points."""
    yield group.P
    for body in members(group):
        yield from (body, *whole.carries[body])


def _transmission(joint: str, k: Kinematics, _: Reactions) -> Samples:
    g1, g2, det = k.closure[joint]
    return np.arctan2(np.abs(det), np.abs(dot(g1, g2)))


def _to_lock(group: Dyad | Group, k: Kinematics, _: Reactions) -> Samples:
    return to_lock(*k.jacobian[group.P][:2]) if isinstance(group, Group) else k.to_lock[group.P]

"""The scene's channels, each with how it is taken from the kinematics and the reactions."""

from collections.abc import Callable, Iterable, Iterator
from collections.abc import Set as AbstractSet
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from scenes import Sampling, Scene
from scenes.arguments import known_names
from scenes.channels import TO_LOCK, TRANSMISSION, Role, own_channel
from scenes.joints import DriveJoint, Guide, Pin
from scenes.model.motion import Samples

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
    known = scene.channels
    for point, vectors in known.points.items():
        for both, level in zip(vectors, ("z", "v", "a"), strict=True):
            yield both, partial(lambda level, point, k, _: getattr(k, level)[point], level, point)
    for pin in scene.pins if scene.has_masses else ():
        yield known.pins[pin.channel], partial(lambda joint, _, on: on.pin[joint], (pin.point, pin.second))
    for body, rates in known.bodies.items():
        yield (rates.angle,), partial(lambda body, k, _: np.arctan2(k.u[body].imag, k.u[body].real), body)
        yield (rates.omega,), partial(lambda body, k, _: k.omega[body], body)
        yield (rates.alpha,), partial(lambda body, k, _: k.alpha[body], body)
    for slider, names in known.guides.items():
        for part, name in enumerate(names):
            yield (name,), partial(lambda slider, part, _, on: on.guide[slider][part], slider, part)
    if scene.has_masses:
        for joint in scene.joints:
            for channel in () if isinstance(joint, Pin | Guide | DriveJoint) else joint.channels(scene):
                yield (channel.name,), partial(lambda name, _, on: on.others[name], channel.name)
        yield (known.drive.effort,), lambda _, on: on.effort
        for name in known.names(Role.friction):
            yield (name,), partial(lambda name, _, on: on.friction[name], name)
    for group in groups:
        if not isinstance(group, Group):
            yield (own_channel(group.P, TRANSMISSION),), partial(_transmission, group.P)
        yield (own_channel(group.P, TO_LOCK),), partial(_to_lock, group)


def of_larger(groups: Iterable[Dyad | Group]) -> frozenset[str]:
    """The channels of larger groups' distances to a singular pose, which take many times as long as all others."""
    return frozenset(own_channel(group.P, TO_LOCK) for group in groups if isinstance(group, Group))


def asked(scene: Scene, whole: Linkage, channels: AbstractSet[str] | None) -> tuple[Sampling, Linkage]:
    """A request of the channels, or InputError; and the decomposition with the groups that they need.

    The last groups go unless a force, or a point or body of theirs, is wanted.
    """
    if channels is None:
        return Sampling(), whole
    given, known = scene.channels.names(Role.time, Role.input), all_channels(scene, whole.groups)
    every = (*given, *(name for names, _ in known for name in names))
    request = Sampling(channels=known_names("channels", channels, every))
    wanted = {scene.channels[channel].subject for channel in (request.channels or frozenset()).difference(given)}
    # Groups hang on earlier ones only: those at the end that nobody asks about may go, and all before the last one
    # needed stay. Forces need all, since later groups load earlier ones.
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

"""The forces of loads and springs on the bodies, in one pose at a step of the engine or in many at the read-out.

A pose is the places z of the bodies' origins and the turns exp(i theta) of their frames, by number of the body: complex
numbers, or arrays of them of shape (n,). Single numbers are plain Python's, which are much faster than numpy's.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes.scene import Force, ForceTable, PressForce

from .constraints import LinkageConstraints, Plane

Active: TypeAlias = NDArray[np.bool_]  # (n, press forces), whether each acts
Planes: TypeAlias = Any  # one number or array for each body and the ground


def varying(linkage: LinkageConstraints) -> tuple[str, ...]:
    """Return the bodies under forces that are not all constant."""
    scene = linkage.scene
    loaded = {load.body for load in scene.loads if not isinstance(load, Force)}
    loaded |= {body for spring in scene.springs for body, _ in (spring.first, spring.second)}
    return tuple(name for name in scene.bodies if name in loaded)


def active_presses(
    linkage: LinkageConstraints, z: Planes, turn: Planes, velocity: Planes, ends: Sequence[float]
) -> list[NDArray[np.bool_]]:
    """Return for each press force whether it acts; `ends` are those of their closing strokes, m."""
    presses = [load for load in linkage.scene.loads if isinstance(load, PressForce)]
    found = []
    for load, end in zip(presses, ends, strict=True):
        i, along = linkage.index[load.body], complex(*linkage.slides[load.body].along)
        rate = (along.conjugate() * velocity[i]).real  # it does not turn
        found.append(load.acts(linkage.displacement(load.body, z[i], turn[i]), rate, end))
    return found


def forces(
    linkage: LinkageConstraints, z: Planes, turn: Planes, active: Iterable[NDArray[np.bool_]]
) -> Iterator[tuple[str, Plane, Plane]]:
    """Yield every force, N: its body, which may be the ground, its arm from that one's origin, m, and the force."""
    index = linkage.index
    presses = iter(active)
    for load in linkage.scene.loads:
        i = index[load.body]
        r = linkage.arm(load.body, load.at) * turn[i]
        if isinstance(load, ForceTable):
            force = load.along(linkage.displacement(load.body, z[i], turn[i]))
            yield load.body, r, force * complex(*linkage.slides[load.body].along)
        elif isinstance(load, PressForce):
            yield load.body, r, next(presses) * complex(*load.force)
        else:
            yield load.body, r, complex(*load.force)
    for spring in linkage.scene.springs:
        (first, p), (second, q) = spring.first, spring.second
        r, s = linkage.arm(first, p) * turn[index[first]], linkage.arm(second, q) * turn[index[second]]
        d = z[index[second]] + s - z[index[first]] - r
        # At zero length there is no direction: the result is not finite, unless the free length is zero.
        relaxed = spring.length * d / np.abs(d) if spring.length else 0
        pull = spring.stiffness * (d - relaxed)
        yield first, r, pull
        yield second, s, -pull

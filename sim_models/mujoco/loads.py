"""The forces of loads and springs, at one time or at many."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from scenes.motion import Samples
from scenes.scene import Force, ForceTable, Load, Spring

from .model import Linkage, Moving, Plane


def applied(linkage: Linkage, moving: Mapping[str, Moving], ends: Samples) -> Iterator[tuple[str, Plane, Any]]:
    """Yield body, place, m, and force, N, of loads and springs, each of shape (n,) or the same at all times."""
    for load, end in zip(linkage.scene.loads, ends, strict=True):
        place, *_ = moving[load.body].at(linkage.local(load.body, load.at))
        x = v = np.zeros(len(place))
        if linkage.slides(load.body):
            _, through, along, first = linkage.guide(load.body)
            at, velocity, _ = moving[load.body].at(first)
            x, v = ((along.conjugate() * of).real for of in (at - through, velocity))
        yield load.body, place, load_force(linkage, load, end, x, v)
    for spring in linkage.scene.springs:
        p, q = (moving[body].at(linkage.local(body, point))[0] for body, point in (spring.first, spring.second))
        yield spring.first[0], p, pull(spring, q - p)
        yield spring.second[0], q, -pull(spring, q - p)


def load_force(linkage: Linkage, load: Load, end: float, x: Any, v: Any) -> Any:
    """Return the force of a load, N, with its slider, if it needs one, at a displacement, m, and a velocity, m/s."""
    if isinstance(load, Force):
        return complex(*load.force)
    if isinstance(load, ForceTable):
        return linkage.guide(load.body)[2] * np.interp(x, load.displacements, load.forces)
    return ((load.closing * v > 0) & (load.closing * (end - x) <= load.last)) * complex(*load.force)


def pull(spring: Spring, way: Any) -> Any:
    """Return the force of a spring on its first end, N, by the way to its second."""
    return spring.stiffness * (way - (spring.length * way / np.abs(way) if spring.length else 0))

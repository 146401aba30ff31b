"""The scene's channels as symbols of coordinates, their rates and the multipliers."""

from typing import Any

import casadi
from casadi import jtimes

from scenes.model.motion import force_channels, kinematic_channels

from .linkage import SymbolicLinkage


def channels(linkage: SymbolicLinkage, multipliers: Any) -> dict[str, Any]:
    """All channels but the time, by coordinates, their rates and the multipliers of the constraints."""
    scene, x, v, a = linkage.scene, linkage.x, linkage.v, linkage.a
    values = [linkage.drive_position]
    for point in scene.moving_points:
        place = linkage.point(scene.owners[point][0], point)
        velocity = jtimes(place, x, v)
        for vector in (place, velocity, jtimes(velocity, x, v) + jtimes(velocity, v, a)):
            values += casadi.vertsplit(vector)
    for body in scene.turning:
        values += [level[3 * linkage.index[body] + 2] for level in (x, v, a)]
    if scene.has_masses:
        values += casadi.vertsplit(multipliers / linkage.row_units)
    return dict(zip((*kinematic_channels(scene)[1:], *force_channels(scene)), values, strict=True))

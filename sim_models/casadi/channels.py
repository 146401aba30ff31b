"""The scene's channels as symbols of coordinates, their rates and the multipliers."""

from typing import Any

import casadi
from casadi import jtimes

from scenes.motion import force_channels

from .linkage import Linkage


def channels(linkage: Linkage, multipliers: Any) -> dict[str, Any]:
    """Return all channels but the time, by coordinates, their rates and the multipliers of the constraints."""
    scene, x, v, a = linkage.scene, linkage.x, linkage.v, linkage.a
    found: dict[str, Any] = {scene.drive_channel: linkage.drive_position}
    for point in scene.moving_points:
        place = linkage.point(scene.owners[point][0], point)
        velocity = jtimes(place, x, v)
        levels = {"": place, "v": velocity, "a": jtimes(velocity, x, v) + jtimes(velocity, v, a)}
        for level, vector in levels.items():
            found |= {f"{point}.{level}x": vector[0], f"{point}.{level}y": vector[1]}
    for body in scene.turning:
        turn = 3 * linkage.index[body] + 2
        found |= {f"{body}.angle": x[turn], f"{body}.omega": v[turn], f"{body}.alpha": a[turn]}
    found |= zip(force_channels(scene), casadi.vertsplit(multipliers / linkage.row_units), strict=False)
    return found

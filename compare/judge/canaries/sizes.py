"""What errors are relative to, by no line of the comparison's: docs/theory.md once more, within a factor of two."""

from collections.abc import Mapping

import numpy as np

from scenes import Motion, Scene
from scenes.channels import Channel, Role
from scenes.model.motion import Samples
from scenes.scene import GROUND

MIN_TRAVEL = 1e-2  # of the largest travel
ZERO_FORCE_TOL = 1e-9  # of the largest force: what is relative to others


def sizes(scene: Scene, cycle: Motion, true: Motion, otherwise: Mapping[str, float]) -> dict[str, Samples]:
    """The sizes that errors are relative to, by channel, each of shape (n,).

    Travels and peaks are those of one cycle of the drive, `true` is the motion at the instants asked for, shape (n,);
    errors of a force that is nothing beside the others are relative to what they are `otherwise`, by channel.
    """
    whole = np.ones_like(true["time"])
    places = {point: names.place for point, names in scene.channels.points.items()}
    paths = {point: cycle[x] + 1j * cycle[y] for point, (x, y) in places.items()}
    reach = {point: 2 * float(np.abs(path - path.mean()).max()) for point, path in paths.items()}  # T to 2 T
    by_channel = {}
    for name in scene.channels.names(Role.time, Role.kinematic):
        row = scene.channels[name]
        unit = max(reach[row.subject], MIN_TRAVEL * max(reach.values())) if row.kind == "point" else 1.0
        scale = unit * scene.pace ** (row.order or 0)
        by_channel[name] = np.maximum(scale, length(row, true)) if row.order else scale * whole
    forces = (scene.channels[name] for name in scene.channels.names(Role.force, Role.friction) if name in cycle)
    peaks = {row.name: float(length(row, cycle).max()) for row in forces}
    for name, guide in scene.slides.items() if peaks else ():
        force, moment = scene.channels.guides[name]
        both = [scene.bodies[each] for each in {name, guide.on} - {GROUND}]
        lever = max(reach.get(point, 0.0) for body in both for point in body.points)
        peaks[moment] = max(peaks[moment], lever * peaks[force])
    for channel, peak in peaks.items():
        least_peak = ZERO_FORCE_TOL * max(otherwise[channel], *peaks.values())  # of no force: what balances leaves
        by_channel[channel] = whole * (peak if peak > least_peak else otherwise[channel])
    ways = {drive: true[drive.channel] - true[drive.channel][0] for drive in scene.drives}
    return by_channel | {drive.channel: np.maximum(drive.unit, np.abs(way)) for drive, way in ways.items()}


def length(row: Channel, motion: Motion) -> Samples:
    """Return the length of the vector of a component, the size of any other channel, shape (n,)."""
    return np.hypot(*(motion[name] for name in row.components)) if row.axis else np.abs(motion[row.name])

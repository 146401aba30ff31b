"""What errors are relative to, by no line of the comparison's: docs/theory.md once more, within a factor of two."""

from collections.abc import Mapping

import numpy as np

from scenes import Motion, Scene
from scenes.model.motion import Samples, force_channels, friction_channels, kinematic_channels, quantity
from scenes.scene import GROUND

ORDERS = {"vx": 1, "vy": 1, "omega": 1, "ax": 2, "ay": 2, "alpha": 2}  # of rates
LEAST = 1e-2  # of the largest travel
NOTHING = 1e-9  # of the largest force: what is relative to others


def sizes(scene: Scene, cycle: Motion, true: Motion, otherwise: Mapping[str, float]) -> dict[str, Samples]:
    """The sizes that errors are relative to, by channel, each of shape (n,).

    Travels and peaks are those of one cycle of the drive, `true` is the motion at the instants asked for, shape (n,);
    errors of a force that is nothing beside the others are relative to what they are `otherwise`, by channel.
    """
    whole = np.ones_like(true["time"])
    paths = {point: cycle[f"{point}.x"] + 1j * cycle[f"{point}.y"] for point in scene.moving_points}
    reach = {point: 2 * float(np.abs(path - path.mean()).max()) for point, path in paths.items()}  # T to 2 T
    by_channel = {}
    for channel in kinematic_channels(scene):
        kind, name = quantity(channel), channel.partition(".")[0]  # a body may have the name of a point
        order, point = ORDERS.get(kind, 0), kind[-1] in "xy"
        unit = max(reach[name], LEAST * max(reach.values())) if point else 1.0
        scale = unit * scene.pace**order
        by_channel[channel] = np.maximum(scale, length(true, channel)) if order else scale * whole
    forces = (channel for channel in force_channels(scene) + friction_channels(scene) if channel in cycle)
    peaks = {channel: float(length(cycle, channel).max()) for channel in forces}
    for name, guide in scene.slides.items() if peaks else ():
        both = [scene.bodies[each] for each in {name, guide.on} - {GROUND}]
        lever = max(reach.get(point, 0.0) for body in both for point in body.points)
        least_moment = lever * peaks[f"{name}.guide_force"]
        peaks[f"{name}.guide_moment"] = max(peaks[f"{name}.guide_moment"], least_moment)
    for channel, peak in peaks.items():
        least_peak = NOTHING * max(otherwise[channel], *peaks.values())  # of no force: what loads leave that balance
        by_channel[channel] = whole * (peak if peak > least_peak else otherwise[channel])
    ways = {drive: true[drive.channel] - true[drive.channel][0] for drive in scene.drives}
    return by_channel | {drive.channel: np.maximum(drive.unit, np.abs(way)) for drive, way in ways.items()}


def length(motion: Motion, channel: str) -> Samples:
    """Return the length of the vector of a component, the size of any other channel, shape (n,)."""
    stem = channel[:-1]
    return np.hypot(motion[f"{stem}x"], motion[f"{stem}y"]) if channel[-1] in "xy" else np.abs(motion[channel])

"""Whether a motion in time is what the equations of motion ask for at its samples.

Errors are relative to what reports take: a stroke S of the output, S w and S w^2 of points, w and w^2 of bodies that
turn, w the drive's peak rate, in strokes or turns; the peak of a pin's force, a guide's or the drive's effort.
"""

from collections.abc import Mapping

import numpy as np

from scenes import Failure, Status
from scenes.motion import quantity

from . import channels
from .system import Array, System

OFF_LIMIT = 0.1  # relative; a run that is so far off has not converged

Channels = Mapping[str, Array]


def check_channels(system: System, found: Channels, expected: Channels, cycle: Array, positions: Array) -> float:
    """Return the largest relative error of places, rates, accelerations and forces, of those asked for.

    Args:
        system: the scene's.
        found: channels of the whole run, shape (n,).
        expected: the same channels at the samples of one cycle, shape (m,), m at most n.
        cycle: the coordinates there, shape (m, 3 bodies).
        positions: of the drive at the samples, shape (n,), rad or m.

    Raises:
        Failure: it is too large.
    """
    gaps = {
        name: np.abs(found[name] - np.resize(expected[name], len(positions))) / scale
        for name, scale in _scales(system, expected, cycle).items()
    }
    if not gaps:
        return 0.0
    off = np.nan_to_num(list(gaps.values()), nan=np.inf)
    far = ~(off <= OFF_LIMIT)
    if far.any():
        worst = list(gaps)[off.max(axis=1).argmax()]
        where = system.scene.where(float(positions[far.any(axis=0).argmax()]))
        raise Failure(
            Status.not_converged,
            f"from {where} on the motion is not what its equations ask for: {worst} is off by {off.max():.2g}",
        )
    return float(off.max())


def _scales(system: System, expected: Channels, q: Array) -> dict[str, float]:
    """Return what errors are relative to, by channel, of all but angles and the drive's own position."""
    scene = system.scene
    output = channels.place(system, scene.output, q)
    stroke = float(np.hypot(np.ptp(output.real), np.ptp(output.imag))) or system.size
    least, most = scene.drive.extent
    w = scene.drive.peak_rate / (1.0 if scene.driven_slide is None else most - least)
    size = dict.fromkeys(("x", "y"), stroke) | dict.fromkeys(("vx", "vy"), stroke * w) | {"omega": w, "alpha": w**2}
    size |= dict.fromkeys(("ax", "ay"), stroke * w**2)
    rates = {name: size[quantity(name)] for name in expected if quantity(name) in size}
    peaks = {name: _peak(expected, name) for name in expected if quantity(name) in FORCES}
    for name in peaks:
        if quantity(name) == "guide_moment":
            force = name.replace("guide_moment", "guide_force")
            peaks[name] = max(peaks[name], stroke * peaks.get(force, 0.0))
    largest = max(peaks.values(), default=0.0) or 1.0
    return rates | {name: peak or largest for name, peak in peaks.items()}


FORCES = ("fx", "fy", "guide_force", "guide_moment", "torque", "force")


def _peak(expected: Channels, name: str) -> float:
    """Return the peak magnitude of a pin's force for its components, of the channel itself otherwise."""
    stem = name.removesuffix(quantity(name))
    parts = [expected[of] for of in (f"{stem}fx", f"{stem}fy") if of in expected]
    return float(np.linalg.norm(parts or [expected[name]], axis=0).max())

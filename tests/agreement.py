"""How closely two motions of one scene must agree, channel by channel, and what they are measured by.

Roundings are 1.1e-16 of coordinates up to some 30 m. A dyad at 20 degrees from lock makes them 1 / sin(20 deg) = 3
times larger in positions and up to 3^3 = 27 times in accelerations and reactions; a second dyad does so once more.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

import analytic
from scenes import Motion, Scene
from scenes.motion import Samples, channels, quantity

Channels = Mapping[str, Samples]

# Relative to the peak of a kind. Of 400 drawn linkages a test the worst are 3e-14 and 1e-13: times ten for other draws.
MOTION, FORCES = 3e-13, 1e-12
TOLERANCE = dict.fromkeys(("time", "crank_angle", "displacement", "x", "angle", "vx", "omega"), MOTION) | dict.fromkeys(
    ("ax", "alpha", "fx", "torque"), FORCES
)
ALIKE = {
    **{"y": "x", "vy": "vx", "ay": "ax", "fy": "fx"},
    **{"guide_force": "fx", "force": "fx", "guide_moment": "torque"},
}


def instants(scene: Scene) -> Samples:
    return np.linspace(0, scene.drive.cycle, 49)


def solve(scene: Scene, time: Samples | None = None) -> Motion:
    time = instants(scene) if time is None else time
    return analytic.solve(scene, scene.drive.at(time).position, time)


def kind(channel: str) -> str:
    """Return what channels of one unit and one size have in common."""
    return ALIKE.get(quantity(channel), quantity(channel))


def size(motion: Motion, scene: Scene) -> float:
    """Return the stroke of the output, the driver's pin, m."""
    return float(np.hypot(np.ptp(motion[f"{scene.output}.x"]), np.ptp(motion[f"{scene.output}.y"])))


def scales(scene: Scene, motion: Motion) -> dict[str, float]:
    """Return by kind the peak over all channels of that kind; a torque may vanish where the forces do not.

    So may angular velocities and accelerations: they are differences of velocities, and of squares of velocities. Where
    all guides stay parallel and the drive is steady, nothing accelerates.
    """
    peaks: dict[str, float] = {"angle": 1.0, "crank_angle": 1.0, "displacement": 1.0}
    for channel in channels(scene):
        if kind(channel) not in ("angle", "crank_angle", "displacement"):
            peaks[kind(channel)] = max(peaks.get(kind(channel), 0.0), float(np.abs(motion[channel]).max()))
    peaks["displacement"] = peaks["x"]
    peaks["ax"] = max(peaks["ax"], peaks["vx"] ** 2 / size(motion, scene))
    if "omega" in peaks:
        peaks["omega"] = max(peaks["omega"], peaks["vx"] / size(motion, scene))
        peaks["alpha"] = max(peaks["alpha"], peaks["omega"] ** 2)
    if "fx" in peaks:
        peaks["torque"] = max(peaks.get("torque", 0.0), peaks["fx"] * size(motion, scene))
    return {name: peak or 1.0 for name, peak in peaks.items()}


def assert_agree(scene: Scene, motion: Motion, expected: Channels, whole: Motion | None = None) -> None:
    """Compare every channel of the scene's motion with the one expected; scales are those of the whole motion."""
    scale = scales(scene, whole or motion)
    assert set(expected) == set(channels(scene))
    for channel, samples in expected.items():
        difference = motion[channel] - samples
        if quantity(channel) == "angle":
            difference = np.remainder(difference + np.pi, 2 * np.pi) - np.pi
        assert np.abs(difference).max() <= TOLERANCE[kind(channel)] * scale[kind(channel)], channel


def attitude(scene: Scene, motion: Motion, body: str) -> NDArray[np.complex128]:
    angle = motion[f"{body}.angle"] if body in scene.turning else np.zeros(motion["time"].shape)
    return np.asarray(np.exp(1j * angle))


def where(scene: Scene, motion: Motion, point: str) -> NDArray[np.complex128]:
    if point in scene.ground:
        return np.full(motion["time"].shape, complex(*scene.ground[point]))
    return motion[f"{point}.x"] + 1j * motion[f"{point}.y"]

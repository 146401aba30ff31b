"""What every engine is measured against: the analytic core, its scales, and how far it may itself be off."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from scenes import Failure, InputError, Motion, Sampling, Scene
from scenes.motion import Samples, channels, quantity

from . import registry
from .runner import run

SCALE_SAMPLES = 3600  # a turn: fine enough for peaks to 1e-6 of themselves
FLOOR_SAMPLES = 72  # a turn: what arbitrary precision can afford in every run


@dataclass(frozen=True)
class Floor:
    """How far the reference itself may be off: relative error by channel, and how that was established."""

    by_channel: Mapping[str, float]
    by: str


@dataclass(frozen=True)
class Reference:
    """The reference for one scene."""

    scene: Scene
    stroke: float  # m, of the output point
    scale: Mapping[str, float]  # by channel, what errors are divided by
    floor: Floor

    def at(self, crank_angle: Samples) -> Motion:
        """Return the reference's motion at crank angles of shape (n,), rad."""
        return registry.reference()(self.scene, crank_angle)


def establish(scene: Scene) -> Reference:
    """Solve one turn of the reference, take the scales from it, and certify it.

    Raises:
        InputError: the reference cannot solve the scene, so that there is nothing to compare with.
    """
    try:
        motion = registry.reference()(scene, Sampling(SCALE_SAMPLES).commanded(scene))
    except Failure as failure:
        raise InputError(f"{scene.file}: bodies: {failure.status.name}: {failure.reason}") from None
    stroke = float(np.hypot(np.ptp(motion[f"{scene.output}.x"]), np.ptp(motion[f"{scene.output}.y"])))
    if not stroke > 0:
        raise InputError(f"{scene.file}: output: {scene.output} does not move; expected a point that does")
    uncertified = Reference(scene, stroke, _scales(scene, motion, stroke), Floor({}, ""))
    return replace(uncertified, floor=_certify(uncertified))


def _scales(scene: Scene, motion: Motion, stroke: float) -> dict[str, float]:
    """Return the scale of each channel.

    Points are scaled by the stroke S, S w and S w^2; turning by 1 rad, w and w^2; forces by the peak magnitude of their
    pin, guide or drive.
    """
    w = abs(scene.drive.speed)
    size = dict.fromkeys(("x", "y"), stroke) | dict.fromkeys(("vx", "vy"), stroke * w)
    size |= dict.fromkeys(("ax", "ay"), stroke * w**2) | {"angle": 1.0, "crank_angle": 1.0, "omega": w, "alpha": w**2}
    size |= {"time": 2 * np.pi / w}
    peak = {channel: _peak(motion, channel) for channel in channels(scene) if quantity(channel) not in size}
    for channel in peak:
        if quantity(channel) == "guide_moment":  # often zero by symmetry; a force times the stroke is its natural size
            peak[channel] = max(peak[channel], stroke * peak[channel.replace("guide_moment", "guide_force")])
    largest = max(peak.values(), default=0.0) or 1.0  # for a joint that never carries anything
    return {c: size[quantity(c)] if quantity(c) in size else peak[c] or largest for c in channels(scene)}


def _peak(motion: Motion, channel: str) -> float:
    """Return the peak magnitude of a pin's vector for its components, of the channel itself otherwise."""
    stem = channel.removesuffix(quantity(channel))
    if quantity(channel) in ("fx", "fy"):
        return float(np.hypot(motion[stem + "fx"], motion[stem + "fy"]).max())
    return float(np.abs(motion[channel]).max())


def relative_errors(motion: Motion, reference: Motion, scale: Mapping[str, float]) -> dict[str, Samples]:
    """Return |motion - reference| / scale by channel, each of shape (n,); angles are compared modulo one turn."""
    errors = {}
    for channel in motion.samples:
        if channel != "time":
            difference = motion[channel] - reference[channel]
            if quantity(channel) == "angle":
                difference = np.remainder(difference + np.pi, 2 * np.pi) - np.pi
            errors[channel] = np.abs(difference) / scale[channel]
    return errors


def _certify(reference: Reference) -> Floor:
    """Measure the reference against arbitrary precision at a few angles of one turn."""
    oracle = run(registry.ORACLE, reference.scene, Sampling(FLOOR_SAMPLES))
    if oracle.motion is None:
        return Floor({}, f"not certified: {oracle.reason}")
    errors = relative_errors(oracle.motion, reference.at(oracle.motion["crank_angle"]), reference.scale)
    by = f"{registry.ENTRIES[registry.ORACLE].version} at {FLOOR_SAMPLES} angles a turn"
    return Floor({channel: float(error.max()) for channel, error in errors.items()}, by)

"""What every engine is measured against: the analytic core, its scales, and how far it may itself be off."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from scenes import Failure, InputError, Motion, Sampling, Scene
from scenes.motion import Samples, channels, force_channels, quantity

from . import axis as units
from . import registry
from .motion_vectors import MotionVectors
from .press_switches import Acts, acts, fixed, press_forces, stroke_end
from .runner import run

SCALE_SAMPLES = 3600  # a cycle: fine enough for peaks to 1e-6 of themselves
FLOOR_SAMPLES = 72  # a cycle: what arbitrary precision can afford in every run


@dataclass(frozen=True)
class Floor:
    """How far the reference itself may be off: relative error by channel, and how that was established."""

    by_channel: Mapping[str, float]
    by: str


@dataclass(frozen=True)
class Reference:
    """The reference for one scene."""

    scene: Scene
    at: registry.Solve  # the motion at positions of the drive and instants: every channel
    stroke: float  # m, of the output point
    scale: Mapping[str, float]  # by channel, what errors are divided by
    floor: Floor
    stroke_ends: tuple[float, ...] = ()  # m, of each press force

    def acts(self, *motions: Motion) -> list[Acts]:
        """Return whether each press force may act, by sample, from motions that are the same but for a hair."""
        states = [MotionVectors(self.scene, motion) for motion in motions]
        loads = zip(press_forces(self.scene), self.stroke_ends, strict=True)
        return [np.concatenate([acts(state, load, end) for state in states]) for load, end in loads]

    def errors(self, motion: Motion, true: Motion, may: Sequence[Acts]) -> dict[str, Samples]:
        """Return the relative errors by channel, each of shape (n,), where `true` is what the motion should be.

        At a sample on the switch of a press force all forces are compared with those on the side where they fit best.
        """
        found = relative_errors(motion, true, self.scale)
        judged = [channel for channel in force_channels(self.scene) if channel in motion]
        for scene, rows in fixed(self.scene, may) if judged else ():
            other = registry.reference(scene)(true[scene.drive_channel][rows], true["time"][rows])
            there = Motion({channel: motion[channel][rows] for channel in judged})
            errors = relative_errors(there, other, self.scale)
            better = sum(errors.values()) < sum(found[channel][rows] for channel in judged)
            for channel in judged:
                found[channel][rows] = np.where(better, errors[channel], found[channel][rows])
        return found


def establish(scene: Scene, channels: frozenset[str] | None = None) -> Reference:
    """Solve one cycle of the reference, take the scales from it, and certify it for some of the channels or all.

    Raises:
        InputError: the reference cannot solve the scene, so that there is nothing to compare with.
    """
    try:
        uncertified = found(scene)
    except Failure as failure:
        raise InputError(f"{scene.file}: bodies: {failure.status.name}: {failure.reason}") from None
    return replace(uncertified, floor=_certify(uncertified, channels))


def found(scene: Scene) -> Reference:
    """Solve one cycle of the reference and take the scales from it.

    Raises:
        Failure: the reference cannot solve the scene, or there is no one motion.
        InputError: the output does not move, so that there is no scale.
    """
    sampling = Sampling(SCALE_SAMPLES)
    solve = registry.checked_reference(scene)
    motion = solve(sampling.commanded(scene), sampling.times(scene))
    size = stroke(scene, motion)
    if not size > 0:
        raise InputError(f"{scene.file}: output: {scene.output} does not move; expected a point that does")
    ends = tuple(stroke_end(MotionVectors(scene, motion), load) for load in press_forces(scene))
    return Reference(scene, solve, size, scales(scene, motion, size), Floor({}, ""), ends)


def stroke(scene: Scene, motion: Motion) -> float:
    """Return the diagonal of the box in which the output point moves, m."""
    return float(np.hypot(np.ptp(motion[f"{scene.output}.x"]), np.ptp(motion[f"{scene.output}.y"])))


def scales(scene: Scene, motion: Motion, stroke: float) -> dict[str, float]:
    """Return what errors are divided by, channel by channel.

    Points are scaled by the stroke S, S w and S w^2; turning by 1 rad, w and w^2; forces by the peak magnitude of their
    pin, guide or drive. w is the crank's peak rate, or that of a driven slider over its travel.
    """
    least, largest = scene.drive.extent
    travel = largest - least
    w = scene.drive.peak_rate if scene.driven_slide is None else scene.drive.peak_rate / travel
    size = dict.fromkeys(("x", "y"), stroke) | dict.fromkeys(("vx", "vy"), stroke * w)
    size |= dict.fromkeys(("ax", "ay"), stroke * w**2) | {"angle": 1.0, "crank_angle": 1.0, "omega": w, "alpha": w**2}
    size |= {"displacement": travel, "time": scene.drive.cycle}
    peaks = {c: float(magnitude(motion, c).max()) for c in channels(scene) if quantity(c) not in size}
    for channel in peaks:
        if quantity(channel) == "guide_moment":  # often zero by symmetry; a force times the stroke is its natural size
            peaks[channel] = max(peaks[channel], stroke * peaks[channel.replace("guide_moment", "guide_force")])
    largest = max(peaks.values(), default=0.0) or 1.0  # for a joint that never carries anything
    return {c: size[quantity(c)] if quantity(c) in size else peaks[c] or largest for c in channels(scene)}


def magnitude(motion: Motion, channel: str) -> Samples:
    """Return the magnitude of the vector of a component, of the channel itself otherwise, shape (n,)."""
    stem, axis = channel[:-1], channel[-1]
    return np.hypot(motion[stem + "x"], motion[stem + "y"]) if axis in "xy" else np.abs(motion[channel])


def relative_errors(motion: Motion, reference: Motion, scale: Mapping[str, float]) -> dict[str, Samples]:
    """Return |motion - reference| / scale by channel, each of shape (n,); angles are compared modulo one turn.

    The time is an input, and what only one model can say has no scale: neither is compared.
    """
    errors = {}
    for channel in motion.samples:
        if channel != "time" and channel in scale:
            difference = motion[channel] - reference[channel]
            if quantity(channel) == "angle":
                difference = np.remainder(difference + np.pi, 2 * np.pi) - np.pi
            errors[channel] = np.abs(difference) / scale[channel]
    return errors


def _certify(reference: Reference, channels: frozenset[str] | None) -> Floor:
    """Measure the reference against arbitrary precision at a few positions of one cycle."""
    oracle = run(registry.ORACLE, reference.scene, Sampling(FLOOR_SAMPLES, channels=channels))
    if oracle.motion is None:
        return Floor({}, f"not certified: {oracle.reason}")
    true = reference.at(oracle.motion[reference.scene.drive_channel], oracle.motion["time"])
    errors = reference.errors(oracle.motion, true, reference.acts(true))
    where = f"{FLOOR_SAMPLES} {'angles' if units.turns_fully(reference.scene) else 'instants'}"
    by = f"{registry.ENTRIES[registry.ORACLE].version} at {where} a {units.cycle_name(reference.scene)}"
    return Floor({channel: float(error.max()) for channel, error in errors.items()}, by)

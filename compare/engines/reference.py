"""What every engine is measured against: the analytic core, and the scales of its channels."""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from scenes import InputError, Motion, Sampling, Scene
from scenes.motion import Samples, channels, force_channels, quantity

from . import registry
from .motion_vectors import MotionVectors
from .press_switches import Acting, Acts, acts, fitted, fixed, on_switch, press_forces, stroke_ends
from .travel import guide_travel, largest_distance, travels

SCALE_SAMPLES = 3600  # a cycle: fine enough for peaks to 1e-6 of themselves
NOTHING = 1e-12  # of the largest force: what a joint carries that carries but round-off
REST = 1e-6  # of T w^2, and of what it takes for the heaviest body: what engines find where nothing accelerates
REMEMBERED, FEW = 4, 4096  # motions, of samples at most
POWERS = {"x": 0, "y": 0, "vx": 1, "vy": 1, "ax": 2, "ay": 2}  # of w, in what points are scaled by
PLACES = {"x", "y", "angle"}  # quantities whose magnitude depends on where one counts from


@dataclass(frozen=True)
class Floor:
    """How far the reference itself may be off: relative error by channel, and how that was established."""

    by_channel: Mapping[str, float]
    by: str
    doubt: str = ""  # why the reference is not to be believed; empty where it is
    limit: str = ""  # where it is further off than it promises: why doubles leave no more


@dataclass(frozen=True)
class Reference:
    """The reference for one scene."""

    scene: Scene
    at: registry.Solve  # the motion at positions of the drive and instants: every channel
    stroke: float  # m, of the output point
    travel: Mapping[str, float]  # m, of each moving point, see `travels`
    scale: Mapping[str, float]  # by channel, what errors are divided by
    floor: Floor
    cycle: Motion = field(default_factory=lambda: Motion({}))  # at `SCALE_SAMPLES`
    stroke_ends: tuple[float, ...] = ()  # m, of each press force
    neighbours: tuple[registry.Solve, ...] = ()  # the same with the scene's numbers a few last places off, where known

    def acts(self, *motions: Motion) -> list[Acts]:
        """Return whether each press force may act, by sample, from motions that are the same but for a hair."""
        states = [MotionVectors(self.scene, motion) for motion in motions]
        loads = zip(press_forces(self.scene), self.stroke_ends, strict=True)
        return [np.concatenate([acts(state, load, end) for state in states]) for load, end in loads]

    def errors(self, motion: Motion, true: Motion, may: Sequence[Acts]) -> dict[str, Samples]:
        """Return the relative errors by channel, each of shape (n,), where `true` is what the motion should be.

        At a sample on the switch of a press force all forces are compared with those on the side where they fit best.
        """
        return relative_errors(motion, self.fitting(motion, true, may), self.scale)

    def fitting(self, motion: Motion, true: Motion, may: Sequence[Acts]) -> Motion:
        """Return `true`, with the forces on a press force's switch those of the side where the motion's fit best."""
        forces = force_channels(self.scene)  # all: a component is judged by its vector's magnitude
        judged, rows = [channel for channel in forces if channel in motion], on_switch(may)
        if not judged or not rows.size:
            return true
        there = {channel: motion[channel][rows] for channel in judged}
        now = {channel: true[channel][rows] for channel in forces}
        position, time = true[self.scene.drive_channel][rows], true["time"][rows]

        def misfit(acting: Acting) -> tuple[Samples, Mapping[str, Samples]]:
            other = {channel: np.empty(rows.shape) for channel in forces}
            for scene, some in fixed(self.scene, acting):
                standing = registry.reference(scene)(position[some], time[some])
                for channel in other:
                    other[channel][some] = standing[channel]
            return off(other), other

        def off(side: Mapping[str, Samples]) -> Samples:
            return np.asarray(sum(relative_errors(Motion(there), Motion({"time": time, **side}), self.scale).values()))

        _, best = fitted(press_forces(self.scene), [act[:, rows] for act in may], misfit)
        better = off(best) < off(now)
        changed = {channel: true[channel].copy() for channel in forces}
        for channel in forces:
            changed[channel][rows] = np.where(better, best[channel], now[channel])
        return Motion({**true.samples, **changed})


@dataclass(frozen=True)
class Remembering:
    """A solver that solves nothing twice: every engine's run of few samples is held against the same ones."""

    solve: registry.Solve
    known: deque[tuple[Samples, Samples, Motion]] = field(default_factory=lambda: deque(maxlen=REMEMBERED))

    def __call__(self, position: Samples, time: Samples) -> Motion:
        """Return the motion at positions of the drive and instants."""
        for before, then, motion in self.known:
            if np.array_equal(before, position) and np.array_equal(then, time):
                return motion
        motion = self.solve(position, time)
        if len(position) <= FEW:
            self.known.append((position.copy(), time.copy(), motion))
        return motion

    def __reduce__(self) -> tuple[type["Remembering"], tuple[registry.Solve]]:
        """Have what it remembers stay in this process."""
        return Remembering, (self.solve,)


def found(scene: Scene) -> Reference:
    """Solve one cycle of the reference and take the scales from it.

    Raises:
        Failure: the reference cannot solve the scene, or there is no one motion.
        InputError: the output does not move, so that there is no scale.
    """
    sampling = Sampling(SCALE_SAMPLES)
    solve = registry.checked_reference(scene)
    motion = solve(sampling.commanded(scene), sampling.times(scene))
    output, travel = scene.output, travels(scene, motion)
    stroke = largest_distance(motion[f"{output}.x"] + 1j * motion[f"{output}.y"])
    if not stroke > 0:
        raise InputError(f"{scene.file}: output: {output} does not move; expected a point that does")
    ends = stroke_ends(MotionVectors(scene, motion))
    return Reference(
        scene, Remembering(solve), stroke, travel, scales(scene, motion, travel), Floor({}, ""), motion, ends
    )


def scales(scene: Scene, motion: Motion, travel: Mapping[str, float]) -> dict[str, float]:
    """Return what errors are divided by, channel by channel; `travel` is that of each moving point, m, see `travels`.

    Points are scaled by their own travel T, T w and T w^2; turning by 1 rad, w and w^2; forces by the peak magnitude of
    their pin, guide or drive. w is the crank's peak rate, or that of a driven slider over its travel.
    """
    known = kinematic_scales(scene, travel)
    peaks = {c: float(magnitude(motion, c).max()) for c in channels(scene) if c not in known}
    for body in scene.bodies.values():
        moment, force = f"{body.name}.guide_moment", f"{body.name}.guide_force"
        if moment in peaks:  # often zero by symmetry; a force times the travel is its natural size
            peaks[moment] = max(peaks[moment], guide_travel(scene, travel, body) * peaks[force])
    return known | force_scales(scene, motion, travel, peaks)


def kinematic_scales(scene: Scene, travel: Mapping[str, float]) -> dict[str, float]:
    """Return what errors of all channels but forces are divided by, see `scales`."""
    (least, largest), w = scene.drive.extent, natural_rate(scene)
    size = {"angle": 1.0, "crank_angle": 1.0, "omega": w, "alpha": w**2}
    size |= {"displacement": largest - least, "time": scene.drive.cycle}
    size |= {f"{point}.{of}": T * w**power for point, T in travel.items() for of, power in POWERS.items()}
    sizes = {channel: size.get(channel, size.get(quantity(channel))) for channel in channels(scene)}
    return {channel: of for channel, of in sizes.items() if of is not None}


def natural_rate(scene: Scene) -> float:
    """Return w, rad/s: the crank's peak rate, or that of a driven slider over its travel."""
    least, largest = scene.drive.extent
    return scene.drive.peak_rate if scene.driven_slide is None else scene.drive.peak_rate / (largest - least)


def force_scales(
    scene: Scene, motion: Motion, travel: Mapping[str, float], peaks: Mapping[str, float]
) -> dict[str, float]:
    """Return what errors of forces are divided by: their peak, or the largest of all where it is rounding.

    Where nothing accelerates and nothing pushes, all are rounding: then 1 N, or what T w^2 of the largest travel takes
    for the heaviest body if that is less.
    """
    largest, w = max(peaks.values(), default=0.0), natural_rate(scene)
    natural = max(body.mass or 0.0 for body in scene.bodies.values()) * max(travel.values()) * w**2
    known = kinematic_scales(scene, travel)
    rates = (c for c in motion.samples if c in known and quantity(c) in ("ax", "ay", "alpha"))
    still = (np.abs(motion[c]).max() <= REST * known[c] for c in rates)
    if largest <= REST * natural and all(still):
        return dict.fromkeys(peaks, min(natural, 1.0) or 1.0)
    largest = largest or 1.0
    return {name: peak if peak > NOTHING * largest else largest for name, peak in peaks.items()}


def magnitude(motion: Motion, channel: str) -> Samples:
    """Return the magnitude of the vector of a component, of the channel itself otherwise, shape (n,)."""
    stem, axis = channel[:-1], channel[-1]
    return np.hypot(motion[stem + "x"], motion[stem + "y"]) if axis in "xy" else np.abs(motion[channel])


def sizes(true: Motion, channel: str, scale: float) -> Samples:
    """Return what errors of a channel are divided by, shape (n,): the larger of its scale and of its magnitude there.

    Places and angles have no magnitude; that of the drive is how far it has come.
    """
    if quantity(channel) in PLACES:
        return np.full(true["time"].shape, scale)
    if quantity(channel) in ("crank_angle", "displacement"):
        return np.maximum(scale, np.abs(true[channel] - true[channel][:1]))
    return np.maximum(scale, magnitude(true, channel))


def relative_errors(motion: Motion, true: Motion, scale: Mapping[str, float]) -> dict[str, Samples]:
    """Return the error of each channel over its size, each of shape (n,); that of a component is its vector's.

    Angles are compared modulo one turn. The time is an input, and what only one model returns has no scale: neither is
    compared.
    """
    judged = [channel for channel in motion.samples if channel != "time" and channel in scale and channel in true]
    errors: dict[str, Samples] = {}
    for channel in judged:
        stem, axis = channel[:-1], channel[-1]
        other = stem + {"x": "y", "y": "x"}[axis] if axis in "xy" else ""
        if other in errors and scale[other] == scale[channel]:
            errors[channel] = errors[other]  # the same array: errors are half of what a long run keeps in memory
            continue
        distance = _distance(motion, true, channel)
        if other in judged:
            distance = np.hypot(distance, _distance(motion, true, other))
        errors[channel] = distance / sizes(true, channel, scale[channel])
    return errors


def _distance(motion: Motion, true: Motion, channel: str) -> Samples:
    difference = motion[channel] - true[channel]
    if quantity(channel) == "angle":
        difference = np.remainder(difference + np.pi, 2 * np.pi) - np.pi
    return np.abs(difference)

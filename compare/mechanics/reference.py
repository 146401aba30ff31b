"""What every engine is measured against: the analytic core, with the scales that its own cycle gives."""

from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from scenes import InputError, Motion, Sampling, Scene
from scenes.model.motion import Samples

from ..engines import registry
from .mechanics import Mechanics
from .motion_vectors import Acts, MotionVectors
from .press_switches import Acting, fitted, fixed, on_switch
from .scales import chord, relative_errors, scales, travels

SCALE_SAMPLES = 3600  # a cycle: fine enough for peaks to 1e-6 of themselves
REMEMBERED, FEW = 4, 4096  # motions, of samples at most


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

    mechanics: Mechanics
    at: registry.Solve  # the motion at positions of the drive and instants: every channel
    stroke: float  # m, of the output point
    travel: Mapping[str, float]  # m, of each moving point, see `travels`
    scale: Mapping[str, float]  # by channel, what errors are divided by
    floor: Floor
    cycle: Motion = field(default_factory=lambda: Motion({}))  # at `SCALE_SAMPLES`
    stroke_ends: tuple[float, ...] = ()  # m, of each press force

    @property
    def scene(self) -> Scene:
        """The linkage."""
        return self.mechanics.scene

    def acts(self, *motions: Motion) -> list[Acts]:
        """Whether each press force may act, by sample, from motions that are the same but for a hair."""
        each = [MotionVectors(self.scene, motion).acts(self.stroke_ends) for motion in motions]
        return [np.concatenate(of) for of in zip(*each, strict=True)]

    def errors(self, motion: Motion, true: Motion, may: Sequence[Acts] | None = None) -> dict[str, Samples]:
        """The relative errors by channel, each of shape (n,), where `true` is what the motion should be.

        At a sample on the switch of a press force, where it `may` act or not, by `true` where nothing is given, all
        forces are compared with those on the side where they fit best.
        """
        fitting = self.fitting(motion, true, self.acts(true) if may is None else may)
        return relative_errors(motion, fitting, self.scale)

    def fitting(self, motion: Motion, true: Motion, may: Sequence[Acts]) -> Motion:
        """`true`, with the forces on a press force's switch those of the side where the motion's fit best."""
        forces = self.mechanics.forces  # all: a component is judged by its vector's magnitude
        judged, rows = [channel for channel in forces if channel in motion], on_switch(may)
        if not judged or not rows.size:
            return true
        there = Motion({channel: motion[channel][rows] for channel in judged})
        now = {channel: true[channel][rows] for channel in forces}
        position, time = true[self.scene.drive_channel][rows], true["time"][rows]

        def off(side: Mapping[str, Samples]) -> Samples:
            return np.asarray(sum(relative_errors(there, Motion({"time": time, **side}), self.scale).values()))

        def misfit(acting: Acting) -> tuple[Samples, Mapping[str, Samples]]:
            other = np.empty((len(forces), rows.size))
            for scene, some in fixed(self.scene, acting):
                standing = registry.reference(scene)(position[some], time[some])
                other[:, some] = [standing[channel] for channel in forces]
            side = dict(zip(forces, other, strict=True))
            return off(side), side

        _, best = fitted(self.mechanics.presses, [act[:, rows] for act in may], misfit)
        better = off(best) < off(now)
        changed = {channel: true[channel].copy() for channel in forces}
        for channel, samples in changed.items():
            samples[rows[better]] = best[channel][better]
        return Motion({**true.samples, **changed})


@dataclass(frozen=True)
class Remembering:
    """A solver that solves nothing twice: every engine's run of few samples is held against the same ones."""

    solve: registry.Solve
    known: deque[tuple[Samples, Samples, Motion]] = field(default_factory=lambda: deque(maxlen=REMEMBERED))

    def __call__(self, position: Samples, time: Samples) -> Motion:
        """The motion at positions of the drive and instants."""
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


def uncertified(scene: Scene) -> Reference:
    """One cycle of the reference, solved, and the scales that it gives.

    Raises:
        Failure: the reference cannot solve the scene, or there is no one motion.
        InputError: the output does not move, so that there is no scale.
    """
    mechanics, sampling = Mechanics(scene), Sampling(SCALE_SAMPLES)
    solve = registry.checked_reference(scene)
    motion = solve(sampling.commanded(scene), sampling.times(scene))
    output, travel = scene.output, travels(scene, motion)
    stroke = abs(chord(motion[f"{output}.x"] + 1j * motion[f"{output}.y"]))
    if not stroke > 0:
        raise InputError(f"{scene.file}: output: {output} does not move; expected a point that does")
    scale, ends = scales(mechanics, motion, travel), MotionVectors(scene, motion).stroke_ends()
    return Reference(mechanics, Remembering(solve), stroke, travel, scale, Floor({}, ""), motion, ends)

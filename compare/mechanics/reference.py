"""What every engine is measured against: the analytic core, with the scales that its own cycle gives.

Press forces jump at their switches, where a slider turns round, and where the last part of the stroke begins. There
rounding decides whether they act: displacement and velocity say the one or the other by their last digits, and every
model has its own. An engine is right on either side, as long as all its channels are on the same.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import InputError, Motion, Sampling, Scene
from scenes.elements.loads import Load
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed, PressForce

from ..engines import registry
from .elements import magnitudes
from .mechanics import Mechanics
from .motion_vectors import Acts, MotionVectors
from .scales import chord, judged_errors, relative_errors, scales, travels

SCALE_SAMPLES = 3600  # a cycle: fine enough for peaks to 1e-6 of themselves

Acting: TypeAlias = Sequence[NDArray[np.bool_]]  # of each press force, whether it acts, shape (n,)
Channels: TypeAlias = Mapping[str, Samples]


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
    at: registry.Solve  # the motion at inputs: every channel
    stroke: float  # m, of the output point
    travel: Mapping[str, float]  # m, of each moving point, see `travels`
    scale: Mapping[str, float]  # by channel, what errors are divided by
    floor: Floor
    cycle: Motion = field(default_factory=lambda: Motion({}))  # at `SCALE_SAMPLES`
    stroke_ends: tuple[float, ...] = ()  # m, of each press force
    rough_sketch: str = ""  # of one that may be read in two ways: what an engine takes that reads it in the other one
    notes: Sequence[str] = ()  # what the user should know of the sketch

    @property
    def scene(self) -> Scene:
        """The linkage."""
        return self.mechanics.scene

    @cached_property
    def steadily(self) -> registry.Solve:
        """What solves the scene for the output's velocity where its drive has a constant speed of 1."""
        steady = self.scene.with_law(ConstantSpeed(1.0, *self.scene.drive.law.extent))
        return registry.reference(steady, frozenset(steady.channels.points[steady.output].velocity))

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
        return judged_errors(self.mechanics, motion, fitting, self.scale)

    def fitting(self, motion: Motion, true: Motion, may: Sequence[Acts]) -> Motion:
        """`true`, with the forces on a press force's switch those of the side where the motion's fit best."""
        forces = self.mechanics.forces  # all: a component is judged by its vector's magnitude
        judged, rows = [channel for channel in forces if channel in motion], on_switch(may)
        if not judged or not rows.size:
            return true
        there = Motion({channel: motion[channel][rows] for channel in judged})
        now = {channel: true[channel][rows] for channel in forces}
        time = true["time"][rows]

        def off(side: Mapping[str, Samples]) -> Samples:
            other = Motion({"time": time, **side})
            return np.asarray(sum(relative_errors(self.scene.channels, there, other, self.scale).values()))

        def misfit(acting: Acting) -> tuple[Samples, Mapping[str, Samples]]:
            other = np.empty((len(forces), rows.size))
            for scene, some in fixed(self.scene, acting):
                standing = registry.reference(scene, frozenset(forces))(true.inputs(scene, rows[some]))
                other[:, some] = [standing[channel] for channel in forces]
            side = dict(zip(forces, other, strict=True))
            return off(side), side

        _, best = fitted(self.mechanics.presses, [act[:, rows] for act in may], misfit)
        better = off(best) < off(now)
        changed = {channel: true[channel].copy() for channel in forces}
        for channel, samples in changed.items():
            samples[rows[better]] = best[channel][better]
        return Motion({**true.prompt.samples, **changed})


def uncertified(scene: Scene) -> Reference:
    """The reference of a scene alone; see `first_cycle`."""
    return first_cycle(Mechanics(scene))


def first_cycle(mechanics: Mechanics) -> Reference:
    """One cycle of the reference, solved, and the scales that it gives.

    Raises:
        Failure: the reference cannot solve the scene, or there is no one motion.
        InputError: the output does not move, so that there is no scale.
    """
    scene, sampling = mechanics.scene, Sampling(SCALE_SAMPLES)
    solver = registry.reference(scene)
    registry.check_way(solver)
    solve = registry.Remembering(solver)
    motion = solver(sampling.inputs(scene))
    output, travel = scene.output, travels(scene, motion)
    x, y = scene.channels.points[output].place
    stroke = abs(chord(motion[x] + 1j * motion[y]))
    if not stroke > 0:
        raise InputError(f"{scene.file}: output: {output} does not move; expected a point that does")
    scale = scales(mechanics, motion, travel, magnitudes(mechanics, motion))
    ends = MotionVectors(scene, motion).stroke_ends()
    return Reference(mechanics, solve, stroke, travel, scale, Floor({}, ""), motion, ends)


# On a switch, n forces could stand in 2^n ways. The forces on one slider go by the same displacement and velocity: they
# stand as a hair to either side has them, or all that may act do, or none. Sliders are tried one after the other, so
# that the cost grows with the number of sliders that are on a switch at once.
def fitted(
    presses: Sequence[PressForce], may: Sequence[Acts], misfit: Callable[[Acting], tuple[Samples, Channels]]
) -> tuple[Channels, Channels]:
    """What the forces do where all act that may, and as they stand with the least misfit, sample by sample.

    `misfit` is that of forces that stand somehow, shape (n,), with what they do then, each of shape (n,).
    """
    if not presses:
        _, alone = misfit([])
        return alone, alone
    standing, must = (np.array([of(act, axis=0) for act in may]) for of in (np.any, np.all))
    least, first = misfit([*standing])
    bodies = [load.body for load in presses]
    own = np.array([[name == body for name in bodies] for body in dict.fromkeys(bodies)])
    on = own @ (standing & ~must)  # shape (sliders, n)
    best = first
    for number in range(1, int(on.sum(axis=0).max()) + 1):
        tried = own.T @ (on & (np.cumsum(on, axis=0) == number))
        others = [must, *map(np.array, zip(*may, strict=True))] if len(own) < len(presses) else [must]
        for other in others:
            trial = np.where(tried, other, standing)
            off, then = misfit([*trial])
            better = off < least
            standing, least = np.where(better, trial, standing), np.where(better, off, least)
            best = {channel: np.where(better, then[channel], best[channel]) for channel in best}
    return first, best


def on_switch(may: Sequence[Acts]) -> NDArray[np.intp]:
    """The samples where a force may act and may not."""
    return np.flatnonzero(np.any([act.any(axis=0) & ~act.all(axis=0) for act in may], axis=0))


def fixed(scene: Scene, acting: Acting) -> Iterator[tuple[Scene, NDArray[np.intp]]]:
    """Yield scenes whose press forces always or never act, with the samples where they stand so."""
    # Samples that share one combination of acting forces are solved together: a scene with those forces always on,
    # without the others.
    ways, rows = np.unique(acting, axis=1, return_inverse=True)
    for number, way in enumerate(ways.T):
        standing = dict(zip(scene.presses, way, strict=True))
        loads = (load.always for place, load in scene.of_type(Load).items() if standing.get(place, True))
        yield replace(scene, loads=tuple(loads)), np.flatnonzero(rows == number)

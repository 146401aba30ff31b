"""One integration over the whole time: every step recorded, the drive and the forces set before it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil

import numpy as np

from scenes import Failure, ProcessorBudget, Sampling, Scene
from scenes.motion import Samples
from scenes.scene import ConstantSpeed, PressForce

from .applied_forces import AppliedForces
from .constraints import LinkageConstraints, Masses, Poses
from .loads import Active
from .recorders import BatchRecorder, PropertyRecorder, Recorder
from .settings import PymunkSettings
from .space import Model, pair
from .start import begun, move, rates

# Steps before t = 0: the joints' cached impulses start at zero, and the rates half a step early. The error of the rates
# decays within four steps, if the sweeps converge and each step corrects the whole error; that of the impulses with the
# sweeps, of which the first step has more. Steps that correct little need more, but never more than a cycle: what takes
# longer to decay outlasts the run as well. Where the linkage does not assemble that far back, fewer steps leave the
# first acceleration less exact.
PRE_ROLL, LEAST_PRE_ROLL = 5, 3
STARTS = 32  # that are kept; the settings that every run measures have nine
FIRST_SWEEPS = 10  # times those of a later step


@dataclass(frozen=True)
class Steps:
    """Equal steps in time, from before t = 0 to the end."""

    size: float  # s
    stride: int  # from sample to sample
    pre_roll: int  # before t = 0
    count: int  # from t = 0 on


def build(
    scene: Scene,
    masses: Masses,
    stroke_ends: Sequence[float],
    sampling: Sampling,
    stride: int,
    settings: PymunkSettings,
    *,
    loaded: bool = True,
) -> "Integration":
    """Return an integration with `stride` steps from sample to sample; `loaded`: with forces on the bodies.

    Raises:
        Failure: cannot_assemble, for the steps before t = 0; unsupported, the settings.
    """
    linkage, _ = begun(scene, masses)
    dt, count = float(sampling.times(scene)[1]) / stride, stride * sampling.samples * sampling.turns
    wanted = min(ceil(PRE_ROLL / settings.corrected(dt)), max(PRE_ROLL, stride * sampling.samples))
    pre_roll, pose = _before(scene, masses, dt, wanted)
    # The last rate follows from the position one step after the end.
    driven = scene.drive.at(dt * np.arange(-pre_roll, count + 2, dtype=np.float64))
    model = Model(linkage, pose, rates(linkage, pose, float(driven.rate[0])), settings.error_bias(dt), settings.extra)
    model.space.gravity = (scene.gravity if loaded else None) or (0, 0)
    forces = AppliedForces(linkage, model.bodies, stroke_ends, dt) if loaded else None
    bodies = model.bodies.values()
    recorder = PropertyRecorder(bodies) if settings.extra == "properties" else BatchRecorder(model.space, bodies)
    return Integration(linkage, model, forces, recorder, driven.position, Steps(dt, stride, pre_roll, count), settings)


class Integration:
    """One integration; `driven` are the drive's positions from the first step to one after the end.

    Filled by `advance`: row k + 1 of `record`, shape (steps + 2, bodies, 6), holds the pose p_k and the rates v_k, so
    row 0 is one step before t = 0. Where forces act, `impulses`, shape (n, joints), N s, are the engine's own at the n
    samples, and `active`, shape (n, press forces), those that acted. `positions`, shape (steps + 1,), are the drive's.
    """

    def __init__(
        self,
        linkage: LinkageConstraints,
        model: Model,
        forces: AppliedForces | None,
        recorder: Recorder,
        driven: Samples,
        steps: Steps,
        settings: PymunkSettings,
    ) -> None:
        self._linkage, self._model, self._recorder, self._driven = linkage, model, recorder, driven
        self.forces, self.steps, self._settings = forces, steps, settings
        self.positions = driven[steps.pre_roll : -1]
        self.joints = model.joints if forces else {}
        samples = steps.count // steps.stride + 1
        self.record: Poses = np.empty((steps.count + 2, len(model.bodies), 6))
        self.impulses = np.empty((samples, len(self.joints)))
        presses = sum(isinstance(load, PressForce) for load in linkage.scene.loads)
        self.active: Active = np.zeros((samples, presses), dtype=np.bool_)

    @property
    def counters(self) -> dict[str, int]:
        """Steps, sweeps times constraints, and the size of the model."""
        found, steps = self._model.counters, self.steps.pre_roll + self.steps.count
        sweeps = self._settings.iterations * (FIRST_SWEEPS - 1 + steps)
        return {"steps": steps, "constraint_iterations": sweeps * found["constraints"]} | found

    def advance(self, budget: ProcessorBudget) -> None:
        """Step from before t = 0 to the end.

        Raises:
            Failure: timed_out.
        """
        space, steps, recorder, forces = self._model.space, self.steps, self._recorder, self.forces
        follows_law = not isinstance(self._linkage.scene.drive, ConstantSpeed)
        joints = [*self.joints.values()]
        recorder.append()
        space.iterations = FIRST_SWEEPS * self._settings.iterations
        for k in range(1 - steps.pre_roll, steps.count + 1):
            if k % steps.stride == 0:
                budget.check(f"step {k} of {steps.count}")
            if forces:
                forces.apply()
            if follows_law:
                self._drive(k)
            space.step(steps.size)
            recorder.append()
            if k <= 0:
                space.iterations = self._settings.iterations
            if forces and k >= 0 and k % steps.stride == 0:
                self.impulses[k // steps.stride] = [joint.impulse for joint in joints]
                self.active[k // steps.stride] = forces.active
        self.record[:] = recorder.rows()[steps.pre_roll - 1 :]

    def _drive(self, k: int) -> None:
        """Put the driven body where the law has it at t_k, with the rate that takes it to where that is at t_{k+1}.

        pymunk moves it first, by that same rate; hence it starts from as far behind.
        """
        here, there = self._driven[k + self.steps.pre_roll : k + self.steps.pre_roll + 2]
        behind, rate = 2 * here - there, (there - here) / self.steps.size
        name, slide = self._linkage.scene.drive.body, self._linkage.scene.driven_slide
        body = self._model.bodies[name]
        if slide is None:
            body.angle, body.angular_velocity = behind, rate
        else:
            along = complex(*slide.along)
            body.position = pair(self._linkage.through(name) - self._linkage.first_arm(name) + behind * along)
            body.velocity = pair(rate * along)


@lru_cache(STARTS)
def _before(scene: Scene, masses: Masses, dt: float, wanted: int) -> tuple[int, Poses]:
    """Return the number of steps before t = 0, as wanted or fewer, and the pose there; once a scene, masses and steps.

    Raises:
        Failure: cannot_assemble, with the drive's position.
    """
    drive, (linkage, start) = scene.drive, begun(scene, masses)
    for steps in (wanted, LEAST_PRE_ROLL):
        try:
            return steps, move(linkage, start, drive.start, float(drive.at(-steps * dt).position))
        except Failure as failure:
            found = failure
    raise Failure(found.status, f"pymunk starts {LEAST_PRE_ROLL} steps before zero, where {found.reason}")

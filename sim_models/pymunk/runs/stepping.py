"""One integration over the whole time: every step recorded, drive and forces set before it; or as the manual has it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import ceil

import numpy as np

from scenes import Failure, ProcessorBudget, Sampling, Scene, Status
from scenes.model.inputs import inputs_of
from scenes.scene import ConstantSpeed, Force

from ..channels import Motions
from ..loads import AppliedForces
from ..masses import Masses, between_bodies, loaded, masses_of, own_masses
from ..planes import PoseArray, pair
from ..settings import ERROR_BIAS, PymunkSettings, TextbookSettings
from ..space import BatchRecorder, Model, PropertyRecorder
from ..start import begun, move, rates

# Steps before t = 0: the joints' cached impulses start at zero, and the rates half a step early. The error of the rates
# decays within four steps, if the sweeps converge and each step corrects the whole error; that of the impulses with the
# sweeps, of which the first step has more. Steps that correct little need more, but never more than a cycle: what takes
# longer to decay outlasts the run as well. Where the linkage does not assemble that far back, fewer steps leave the
# first acceleration less exact.
PRE_ROLL, MIN_PRE_ROLL = 5, 3
TEXTBOOK_PRE_ROLL = 1 / 8  # of a cycle before t = 0, in which the cached impulses, zero at first, settle
MAX_STARTS = 32  # that are kept; the settings that every run measures have nine
FIRST_SWEEPS = 10  # times those of a later step


@dataclass(frozen=True)
class Steps:
    """Equal steps in time, from before t = 0 to the end."""

    size: float  # s
    stride: int  # from sample to sample
    pre_roll: int  # before t = 0
    count: int  # from t = 0 on


class Integration:
    """One integration, `stride` steps from sample to sample.

    Filled by `advance`: row k + 1 of `record`, shape (steps + 2, bodies, 6), holds the pose p_k and the rates v_k, so
    row 0 is one step before t = 0. Where forces act, `impulses`, shape (n, joints), N s, are the engine's own at the n
    samples, and `active`, shape (press forces, n), those that acted. `positions`, shape (steps + 1,), are the drive's.
    """

    def __init__(
        self, scene: Scene, sampling: Sampling, stride: int, settings: PymunkSettings, stroke_ends: Sequence[float]
    ) -> None:
        if between_bodies(scene) and settings.correction != 1:
            raise Failure(Status.unsupported, "a drive between moving bodies lags where steps leave errors of joints")
        masses, with_forces = masses_of(scene, settings, sampling), loaded(scene, settings, sampling)
        self._linkage, _ = begun(scene, masses)
        self._settings = settings
        dt, count = float(sampling.times(scene)[1]) / stride, stride * sampling.samples * sampling.turns
        wanted = min(ceil(PRE_ROLL / settings.corrected(dt)), max(PRE_ROLL, stride * sampling.samples))
        pre_roll, pose = _before(scene, masses, dt, wanted)
        self.steps = Steps(dt, stride, pre_roll, count)
        # The last rate follows from the position one step after the end.
        driven = inputs_of(scene, dt * np.arange(-pre_roll, count + 2, dtype=np.float64)).driven()
        self._driven, self.positions = driven.position, driven.position[pre_roll:-1]
        first = rates(self._linkage, pose, float(driven.rate[0]))
        self._gravity = (scene.gravity if with_forces else None) or (0, 0)
        self._model = model = self.model(pose, first)
        self._forces = AppliedForces(self._linkage, model.bodies, stroke_ends, dt) if with_forces else None
        self.joints = model.joints if with_forces else {}
        bodies, by_properties = model.bodies.values(), settings.extra == "properties"
        self._recorder = PropertyRecorder(bodies) if by_properties else BatchRecorder(model.space, bodies)
        self._record: PoseArray = np.empty((count + 3, len(bodies), 6))
        self.record = self._record[1:]
        self.impulses = np.empty((count // stride + 1, len(self.joints)))
        self.active = np.zeros((len(scene.presses), count // stride + 1), dtype=np.bool_)

    def model(self, pose: PoseArray, rate: PoseArray) -> Model:
        """A space of the run's, at a pose with some rates, each of shape (1, bodies, 3), to begin with more sweeps."""
        settings = self._settings
        model = Model(self._linkage, pose, rate, settings.error_bias(self.steps.size), settings.extra)
        model.space.gravity, model.space.iterations = self._gravity, FIRST_SWEEPS * settings.iterations
        return model

    @property
    def counters(self) -> dict[str, int]:
        """Steps, sweeps times constraints, and the size of the model."""
        steps = self.steps.pre_roll + self.steps.count
        return self._model.counters(steps, self._settings.iterations * (FIRST_SWEEPS - 1 + steps))

    def advance(self, budget: ProcessorBudget) -> None:
        """Step from before t = 0 to the end.

        In each step what acts at its beginning is put on the bodies, the driven body is put where the law has it, and
        pymunk moves the bodies by their rates and finds new rates by sweeps over the joints' impulses. The first step
        has more sweeps, as no impulses are known before it. Impulses are kept at the samples: over the step's size
        they are the joints' forces. The budget of processor time ends a run that takes too long.
        """
        space, steps, recorder, forces = self._model.space, self.steps, self._recorder, self._forces
        follows = self._model.drive is not None or not isinstance(self._linkage.drive.law, ConstantSpeed)
        joints = [*self.joints.values()]
        recorder.append()
        for k in range(1 - steps.pre_roll, steps.count + 1):
            if k % steps.stride == 0:
                budget.check(f"step {k} of {steps.count}")
            if forces:
                forces.apply(k * steps.size, float(self._driven[k + steps.pre_roll]))
            if follows:
                self._drive(k)
            space.step(steps.size)
            recorder.append()
            if k <= 0:
                space.iterations = self._settings.iterations
            if forces and k >= 0 and k % steps.stride == 0:
                self.impulses[k // steps.stride] = [joint.impulse for joint in joints]
                self.active[:, k // steps.stride] = forces.active
        self._record[:] = recorder.rows()[steps.pre_roll - 2 :]

    @property
    def path(self) -> PoseArray:
        """The poses and rates after every step from t = 0 on, shape (steps + 1, bodies, 6)."""
        return self.record[1:]

    @property
    def motions(self) -> Motions:
        """The motion at the samples; the rates of a step belong to its middle."""
        # Central differences: rates v_(k-1) and v_k are half a step before and after t_k.
        before, after = self.record[: -1 : self.steps.stride], self.record[1 :: self.steps.stride]
        a = (after[..., 3:] - before[..., 3:]) / self.steps.size
        return Motions(after[..., :3], after[..., 3:] - self.steps.size / 2 * a, a)

    @property
    def rates(self) -> PoseArray:
        """The rates that the forces at the samples were by, shape (n, bodies, 3), from the two steps before."""
        before, last = self._record[: -2 : self.steps.stride, :, 3:], self._record[1 : -1 : self.steps.stride, :, 3:]
        return np.asarray(1.5 * last - 0.5 * before)

    def _drive(self, k: int) -> None:
        """Put the driven body where the law has it at t_k, with the rate that takes it to where that is at t_{k+1}."""
        here, there = self._driven[k + self.steps.pre_roll : k + self.steps.pre_roll + 2]
        if self._model.drive:
            self._model.aim(there, self.steps.size)
            return
        # A kinematic body is moved by its rate before rates are updated. It is put back by one move, so that the move
        # takes it to `here`, and its rate then leads on to `there`.
        behind, rate = 2 * here - there, (there - here) / self.steps.size  # pymunk moves it first, by that rate
        name, slide = self._linkage.drive.body, self._linkage.drive.slide
        body = self._model.bodies[name]
        if slide is None:
            body.angle, body.angular_velocity = behind, rate
        else:
            along = complex(*slide.along)
            body.position = pair(self._linkage.through(name) - self._linkage.first_arm(name) + behind * along)
            body.velocity = pair(rate * along)


class TextbookRun:
    """A linkage modelled as in the examples of pymunk's manual, recorded at the samples.

    All links are dynamic bodies about their centres of mass, a SimpleMotor turns the crank, a slider that cannot turn
    runs in a GrooveJoint, constant forces are applied before each step, and everything else is preset: 10 sweeps,
    joints that correct a tenth of their error in 1/60 s. The start is closed, with the rates of the drive. Poses and
    velocities are read after a step; accelerations are the change of the velocities in it.
    """

    def __init__(self, scene: Scene, sampling: Sampling, settings: TextbookSettings) -> None:
        if between_bodies(scene):
            raise Failure(Status.unsupported, "the textbook set-up has a motor on the ground only")
        if scene.kinds - {Force.kind}:
            raise Failure(Status.unsupported, "the textbook set-up has constant loads only")
        if not scene.slides.keys().isdisjoint(scene.turning):
            raise Failure(Status.unsupported, "the textbook set-up has guides on the ground only")
        linkage, pose = begun(scene, own_masses)
        stride = ceil(settings.steps / sampling.samples)
        dt = float(sampling.times(scene)[1]) / stride
        pre_roll = ceil(TEXTBOOK_PRE_ROLL * stride * sampling.samples)
        self.steps = Steps(dt, stride, pre_roll, stride * (sampling.count - 1))
        first = inputs_of(scene, -self.steps.pre_roll * dt).driven()
        begin = move(linkage, pose, linkage.drive.law.start, float(first.position))
        self._model = Model(linkage, begin, rates(linkage, begin, float(first.rate)), ERROR_BIAS, "motor")
        self._model.space.gravity = scene.gravity or (0, 0)
        self._model.space.iterations = settings.iterations
        bodies = self._model.bodies
        self._before, self._after = PropertyRecorder(bodies.values()), PropertyRecorder(bodies.values())
        constant = scene.of_type(Force).values()
        self._loads = [(bodies[load.body], load.force, pair(linkage.arm(load.body, load.at))) for load in constant]
        self.positions = sampling.commanded(scene)

    @property
    def counters(self) -> dict[str, int]:
        """Steps, sweeps times constraints, and the size of the model."""
        steps = self.steps.pre_roll + self.steps.count
        return self._model.counters(steps, self._model.space.iterations * steps)

    def advance(self, budget: ProcessorBudget) -> None:
        """Step from before t = 0 to the end."""
        steps = self.steps
        for k in range(1 - steps.pre_roll, steps.count + 1):
            sampled = k >= 0 and k % steps.stride == 0
            if sampled:
                budget.check(f"step {k} of {steps.count}")
                self._before.append()
            for body, force, arm in self._loads:
                body.apply_force_at_world_point(force, body.local_to_world(arm))
            self._model.space.step(steps.size)
            if sampled:
                self._after.append()

    @property
    def path(self) -> PoseArray:
        """The poses and rates at the samples, shape (n, bodies, 6)."""
        return self._after.rows()

    @property
    def motions(self) -> Motions:
        """The motion at the samples."""
        before, after = self._before.rows(), self.path
        return Motions(after[..., :3], after[..., 3:], (after[..., 3:] - before[..., 3:]) / self.steps.size)


@lru_cache(MAX_STARTS)
def _before(scene: Scene, masses: Masses, dt: float, wanted: int) -> tuple[int, PoseArray]:
    """The number of steps before t = 0, as wanted or fewer, and the pose there; once a scene, masses and steps."""
    linkage, start = begun(scene, masses)
    for steps in (wanted, MIN_PRE_ROLL):
        try:
            return steps, move(
                linkage, start, linkage.drive.law.start, float(inputs_of(scene, -steps * dt).driven().position)
            )
        except Failure as failure:
            ended = failure
    raise Failure(ended.status, f"pymunk starts {MIN_PRE_ROLL} steps before zero, where {ended.reason}")

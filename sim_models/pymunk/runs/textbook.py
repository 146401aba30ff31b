"""A linkage modelled as in the examples of pymunk's manual.

All links are dynamic bodies about their centres of mass, a SimpleMotor turns the crank, a slider that cannot turn runs
in a GrooveJoint, constant forces are applied before each step, and everything else is preset: 10 sweeps, joints that
correct a tenth of their error in 1/60 s. The start is closed, with the rates of the drive. Poses and velocities are
read after a step; accelerations are the change of the velocities in it.
"""

from math import ceil

import numpy as np

from scenes import Failure, ProcessorBudget, Sampling, Scene, Status
from scenes.scene import Force

from ..channels import Motions
from ..constraints import PoseArray
from ..loads import Active
from ..masses import own_masses
from ..settings import ERROR_BIAS, TextbookSettings
from ..space import Model, PropertyRecorder, pair
from ..start import begun, move, rates
from .stepping import Steps

PRE_ROLL = 1 / 8  # of a cycle before t = 0, in which the cached impulses, zero at first, settle


class TextbookRun:
    """One run, recorded at the samples; `joints` has none whose impulses could confirm the reactions."""

    def __init__(self, scene: Scene, sampling: Sampling, settings: TextbookSettings) -> None:
        if any(not isinstance(load, Force) for load in scene.loads) or scene.springs:
            raise Failure(Status.unsupported, "the textbook set-up has constant loads only")
        if any(name in scene.turning for name, body in scene.bodies.items() if body.slide is not None):
            raise Failure(Status.unsupported, "the textbook set-up has guides on the ground only")
        linkage, pose = begun(scene, own_masses)
        stride = ceil(settings.steps / sampling.samples)
        dt = float(sampling.times(scene)[1]) / stride
        self.steps = Steps(dt, stride, ceil(PRE_ROLL * stride * sampling.samples), stride * (sampling.count - 1))
        first = scene.drive.at(-self.steps.pre_roll * dt)
        begin = move(linkage, pose, scene.drive.start, float(first.position))
        self._model = Model(linkage, begin, rates(linkage, begin, float(first.rate)), ERROR_BIAS, "motor")
        self._model.space.gravity = scene.gravity or (0, 0)
        self._model.space.iterations = settings.iterations
        bodies = self._model.bodies
        self._before, self._after = PropertyRecorder(bodies.values()), PropertyRecorder(bodies.values())
        constant = [load for load in scene.loads if isinstance(load, Force)]
        self._loads = [(bodies[at.body], at.force, pair(linkage.arm(at.body, at.at))) for at in constant]
        self.positions, self.joints = sampling.commanded(scene), dict[str, Active]()
        self.impulses, self.active = np.empty((sampling.count, 0)), np.zeros((sampling.count, 0), dtype=np.bool_)

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

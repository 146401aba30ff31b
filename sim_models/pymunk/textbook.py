"""A linkage modelled as in the examples of pymunk's manual.

All links are dynamic bodies about their centres of mass, a SimpleMotor turns the crank, a slider that cannot turn runs
in a GrooveJoint, constant forces are applied before each step, and everything else is preset: 10 sweeps, joints that
correct a tenth of their error in 1/60 s. The start is closed, with the rates of the drive. Poses and velocities are
read after a step; accelerations are the change of the velocities in it.
"""

from collections.abc import Mapping
from math import ceil

import numpy as np

from scenes import Failure, Motion, ProcessorBudget, Request, Sampling, Scene, Status
from scenes.engine import equal_steps
from scenes.motion import Samples
from scenes.scene import Force

from .channels import found_channels
from .checks import check_path
from .constraints import LinkageConstraints
from .masses import own_masses
from .recorders import PropertyRecorder
from .settings import ERROR_BIAS, SECONDS, TextbookSettings
from .space import Model, pair
from .start import begun, move, rates
from .stepping import Steps

PRE_ROLL = 1 / 8  # of a cycle before t = 0, in which the cached impulses, zero at first, settle


def build(scene: Scene, settings: TextbookSettings, request: Request) -> "TextbookSimulation":
    """Prepare one run, see `engine.build`.

    Raises:
        Failure: unsupported, the manual has no joint or force for something; cannot_assemble, with the drive's
            position.
    """
    if any(not isinstance(load, Force) for load in scene.loads) or scene.springs:
        raise Failure(Status.unsupported, "the textbook set-up has constant loads only")
    if any(name in scene.turning for name, body in scene.bodies.items() if body.slide is not None):
        raise Failure(Status.unsupported, "the textbook set-up has guides on the ground only")
    sampling, (linkage, pose) = equal_steps(request), begun(scene, own_masses)
    stride = ceil(settings.steps / sampling.samples)
    dt = float(sampling.times(scene)[1]) / stride
    steps = Steps(dt, stride, ceil(PRE_ROLL * stride * sampling.samples), stride * (sampling.count - 1))
    first = scene.drive.at(-steps.pre_roll * dt)
    begin = move(linkage, pose, scene.drive.start, float(first.position))
    model = Model(linkage, begin, rates(linkage, begin, float(first.rate)), ERROR_BIAS, "motor")
    model.space.gravity = scene.gravity or (0, 0)
    model.space.iterations = settings.iterations
    return TextbookSimulation(sampling, linkage, model, steps, linkage.branch(pose))


class TextbookSimulation:
    """One run."""

    def __init__(
        self, sampling: Sampling, linkage: LinkageConstraints, model: Model, steps: Steps, branch: Samples
    ) -> None:
        self._scene, self._sampling, self._linkage = linkage.scene, sampling, linkage
        self._model, self._steps, self._branch = model, steps, branch
        self._wanted = frozenset(sampling.wanted(linkage.scene))
        bodies = model.bodies.values()
        self._before, self._after = PropertyRecorder(bodies), PropertyRecorder(bodies)
        self._channels: Mapping[str, Samples] = {}
        self.residuals: dict[str, float] = {}

    @property
    def counters(self) -> Mapping[str, int]:
        """Steps, sweeps times constraints, and the size of the model."""
        found, steps = self._model.counters, self._steps.pre_roll + self._steps.count
        sweeps = self._model.space.iterations * steps
        return {"steps": steps, "constraint_iterations": sweeps * found["constraints"]} | found

    def solve(self) -> None:
        """Step from before t = 0 to the end, and find the channels.

        Raises:
            Failure: timed_out.
        """
        bodies, steps, linkage = self._model.bodies, self._steps, self._linkage
        budget = ProcessorBudget(SECONDS, f"{steps.count} steps")
        constant = [load for load in self._scene.loads if isinstance(load, Force)]
        loads = [(bodies[at.body], at.force, pair(linkage.arm(at.body, at.at))) for at in constant]
        for k in range(1 - steps.pre_roll, steps.count + 1):
            sampled = k >= 0 and k % steps.stride == 0
            if sampled:
                budget.check(f"{k} of them are done")
                self._before.append()
            for body, force, arm in loads:
                body.apply_force_at_world_point(force, body.local_to_world(arm))
            self._model.space.step(steps.size)
            if sampled:
                self._after.append()
        before, after = self._before.rows(), self._after.rows()
        q, v, a = after[..., :3], after[..., 3:], (after[..., 3:] - before[..., 3:]) / steps.size
        self._channels = found_channels(linkage, self._wanted, q, v, a, np.zeros((len(q), 0), dtype=np.bool_))

    def read(self) -> Motion:
        """Return the channels requested.

        Raises:
            Failure: nonfinite, wrong_branch or diverged, with the drive's position where it happened; and with the
                motion.
        """
        found, path = self._channels, self._after.rows()
        samples = {name: found[name] for name in self._sampling.wanted(self._scene) if name in found}
        motion = Motion({"time": self._sampling.times(self._scene)} | samples)
        try:
            self.residuals = check_path(self._linkage, path, self._sampling.commanded(self._scene), self._branch)
        except Failure as failure:
            raise Failure(failure.status, failure.reason, motion) from None
        return motion

"""A linkage as the manual's examples would have it: what one gets from pymunk without knowing more.

All links are dynamic bodies about their centres of mass, a SimpleMotor turns the crank, a slider that cannot turn runs
in a GrooveJoint, constant forces are applied before each step, and everything else is as pymunk has it: 10 sweeps,
joints that correct a tenth of their error in 1/60 s. The start is closed, with the rates of the drive. Poses and
velocities are read as they stand after a step; accelerations are the change of the velocities in it.
"""

from collections.abc import Mapping
from math import ceil

import numpy as np

from scenes import Failure, Motion, Request, Scene, Status
from scenes.engine import equal_steps
from scenes.scene import Force

from .channels import found_channels
from .checks import check_path
from .constraints import Linkage, branch
from .masses import own_masses
from .record import PropertyRecord
from .settings import ERROR_BIAS, Textbook
from .space import Model, pair
from .start import move, rates, start

LEAD = 1 / 8  # of a cycle before t = 0, in which the cached impulses, zero at first, come near what they are


class TextbookSimulation:
    """One run.

    Raises:
        Failure: unsupported, what the manual has no joint or force for; cannot_assemble, with the drive's position.
    """

    def __init__(self, scene: Scene, settings: Textbook, request: Request) -> None:
        _refuse(scene)
        sampling = equal_steps(request)
        self._scene, self._sampling, self._iterations = scene, sampling, settings.iterations
        self._wanted = frozenset(request.wanted(scene))
        self._linkage = linkage = Linkage(scene, own_masses)
        self._stride = ceil(settings.steps / sampling.samples)
        self._dt = float(sampling.times(scene)[1]) / self._stride
        self._lead = ceil(LEAD * self._stride * sampling.samples)
        pose = start(linkage)
        self._branch = branch(linkage.jacobian(pose))
        first = scene.drive.at(-self._lead * self._dt)
        pose = move(linkage, pose, scene.drive.start, float(first.position))
        self._model = Model(linkage, pose, rates(linkage, pose, float(first.rate)), ERROR_BIAS, "motor")
        self._model.space.gravity = scene.gravity or (0, 0)
        self._model.space.iterations = settings.iterations
        bodies = self._model.bodies
        self._loads = [
            (bodies[load.body], load.force, pair(linkage.arm(load.body, load.at)))
            for load in scene.loads
            if isinstance(load, Force)
        ]
        self._before, self._after = PropertyRecord(bodies.values()), PropertyRecord(bodies.values())
        self.residuals: dict[str, float] = {}

    @property
    def counters(self) -> Mapping[str, int]:
        """Steps, sweeps times constraints in them, and what each step goes over."""
        found = self._model.counters
        steps = self._lead + self._stride * (self._sampling.count - 1)
        return {"steps": steps, "constraint_iterations": steps * self._iterations * found["constraints"]} | found

    def solve(self) -> None:
        """Step from before t = 0 to the end."""
        for k in range(1 - self._lead, self._stride * (self._sampling.count - 1) + 1):
            sampled = k >= 0 and k % self._stride == 0
            if sampled:
                self._before.append()
            for body, force, arm in self._loads:
                body.apply_force_at_world_point(force, body.local_to_world(arm))
            self._model.space.step(self._dt)
            if sampled:
                self._after.append()

    def read(self) -> Motion:
        """Return the channels asked for.

        Raises:
            Failure: nonfinite, wrong_branch or diverged, with the drive's position where it happened; and with the
                motion.
        """
        linkage, before, after = self._linkage, self._before.rows(), self._after.rows()
        q, v, a = after[..., :3], after[..., 3:], (after[..., 3:] - before[..., 3:]) / self._dt
        acts = np.zeros((len(q), 0), dtype=np.bool_)
        found = found_channels(linkage, self._wanted, q, v, a, acts)
        samples = {name: found[name] for name in self._sampling.wanted(self._scene) if name in found}
        motion = Motion({"time": self._sampling.times(self._scene)} | samples)
        try:
            self.residuals = check_path(linkage, after, self._sampling.commanded(self._scene), self._branch)
        except Failure as failure:
            raise Failure(failure.status, failure.reason, motion) from None
        return motion


def _refuse(scene: Scene) -> None:
    if any(not isinstance(load, Force) for load in scene.loads) or scene.springs:
        raise Failure(Status.unsupported, "the textbook set-up has constant loads only")
    if any(name in scene.turning for name, body in scene.bodies.items() if body.slide is not None):
        raise Failure(Status.unsupported, "the textbook set-up has guides on the ground only")

"""One run: steps in time from a little before the first sample, and the channels from what they leave."""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import mujoco
import numpy as np

from scenes import Failure, Motion, ProcessorBudget, Request, Scene, Status
from scenes.engine import equal_steps
from scenes.motion import Samples
from scenes.scene import GROUND

from ..coordinates.start import SCENES, Start, begun
from . import channels
from .loads import load_force, pull
from .settings import MujocoSettings
from .system import MujocoSystem

PRE_ROLL = 6  # steps before the first sample, after which the gaps are those that a step opens
LARGEST_GAP = 0.05  # over the linkage's size, from where the run is no longer one of it
SHORTEST_SPRING = 1e-4  # over the size: a shorter one's direction is that of the gaps in the joints
SECONDS = 120.0  # of processor time, for each cycle


def build(scene: Scene, settings: MujocoSettings, request: Request) -> "MujocoSimulation":
    """Model and assemble, see `engine.build`."""
    equal_steps(request)
    mujoco.set_mju_user_warning(lambda _: None)  # else it writes a file where the numbers get too large
    return MujocoSimulation(scene, settings, request)


@lru_cache(SCENES)
def _begun(scene: Scene) -> tuple[MujocoSystem, Start]:
    """Return the constraints of a scene and its start, with the whole way of the drive followed once."""
    system = MujocoSystem(scene)
    start = begun(system)
    for end in scene.drive.extent:
        _ = [*start.poses.through(start.pose, scene.drive.start, [end])]
    return system, start


class MujocoSimulation:
    """One prepared run, see `scenes.engine.Simulation`."""

    def __init__(self, scene: Scene, settings: MujocoSettings, request: Request) -> None:
        self._scene, self._request, self._sampling = scene, request, equal_steps(request)
        system, (self._follower, start, self._ends) = _begun(scene)
        self._follower.begin(1)
        linkage = self._linkage = system.linkage
        self._each = -(-settings.steps // self._sampling.samples)
        self._h = scene.drive.cycle / (self._each * self._sampling.samples)  # s
        self._model = linkage.model(self._h / linkage.second, hard=settings.hard)
        self._data: Any = mujoco.MjData(self._model)
        self._order = linkage.order(self._model)
        before, at = (float(scene.drive.at(-steps * self._h).position) for steps in (PRE_ROLL + 1, PRE_ROLL))
        first, second = self._follower.through(start, scene.drive.start, [before, at])
        self._start, self._branch = (second.x, (second.x - first.x) / (self._h / linkage.second)), second.branch
        self._motion: Motion | None = None
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}

    def solve(self) -> None:
        """Make the steps, and the channels from them.

        Raises:
            Failure: `diverged` or `nonfinite`, a joint opened; `wrong_branch`; `timed_out`.
        """
        linkage, count = self._linkage, self._sampling.count
        q, v, a = (np.empty((count, len(self._order))) for _ in range(3))
        held = np.empty((count, 2 * len(self._scene.pins) + 1))
        budget = ProcessorBudget(SECONDS * self._sampling.turns, "the steps")
        total, largest, data = self._each * (count - 1) + 1, 0.0, self._data
        mujoco.mj_resetData(self._model, data)
        data.qpos[self._order], data.qvel[self._order] = self._start
        times = self._h * np.arange(1 - PRE_ROLL, total + 1)
        targets = (self._scene.drive.at(times).position / linkage.drive_unit).tolist()
        previous = np.array(data.qvel)
        for step, target in enumerate(targets, start=-PRE_ROLL):
            self._model.eq_data[-1, 0] = target  # the gap that this step closes is that at its end
            pose, rate = np.array(data.qpos), np.array(data.qvel)
            data.qvel[:] = 1.5 * rate - 0.5 * previous  # now; those of MuJoCo are half a step ago
            mujoco.mj_step1(self._model, data)
            centrifugal = np.array(data.qfrc_bias)
            self._apply()
            data.qvel[:] = rate
            mujoco.mj_fwdVelocity(self._model, data)
            data.qfrc_bias[:] = centrifugal
            mujoco.mj_step2(self._model, data)
            previous = rate
            row, rest = divmod(step, self._each)
            if rest == 0 and step >= 0:
                budget.check(f"{row} of {count} samples are done")
                q[row] = pose[self._order]
                v[row], a[row] = ((data.qvel + rate) / 2)[self._order], (data.qvel - rate)[self._order]
                held[row] = self._forces()
                gap = float(np.abs(data.efc_pos[:-1]).max(initial=0.0))
                largest = max(largest, gap)
                if not gap <= LARGEST_GAP:
                    where = self._scene.where(float(self._request.commanded(self._scene)[row]))
                    raise Failure(Status.diverged, f"a joint is open by {gap:.3g} of the linkage's size at {where}")
                if self._follower.pose(q[row]).branch != self._branch:
                    where = self._scene.where(float(self._request.commanded(self._scene)[row]))
                    raise Failure(Status.wrong_branch, f"the bodies are assembled another way at {where}")
        self.counters = {"steps": len(targets)}
        self.residuals = {"joint_gap": largest}
        rates = linkage.units / linkage.second
        self._motion = self._channels(q * linkage.units, v * rates, a * rates / self._h, held)

    def read(self) -> Motion:
        """Return the channels."""
        assert self._motion is not None, "expected `solve` first"
        return self._motion

    def _apply(self) -> None:
        """Set the forces of loads and springs at MuJoCo's pose and rates."""
        linkage, data = self._linkage, self._data
        data.xfrc_applied[:] = 0
        for load, end in zip(self._scene.loads, self._ends, strict=True):
            x = v = 0.0
            if linkage.slides(load.body):
                column = self._model.joint(f"{load.body}.s").qposadr[0]
                x, v = linkage.size * data.qpos[column], linkage.size / linkage.second * data.qvel[column]
            self._push(load.body, self._site(load.body, load.at), load_force(linkage, load, end, x, v))
        for spring in self._scene.springs:
            p, q = (self._site(*end) for end in (spring.first, spring.second))
            if spring.length and not abs(q - p) > SHORTEST_SPRING:
                ends = f"{'.'.join(spring.first)} and {'.'.join(spring.second)}"
                raise Failure(Status.nonfinite, f"the ends {ends} of a spring all but meet: it has no direction")
            force = pull(spring, linkage.size * (q - p))
            self._push(spring.first[0], p, force)
            self._push(spring.second[0], q, -force)

    def _site(self, body: str, point: str) -> complex:
        return complex(*self._data.site(f"{body}:{point}").xpos[:2])

    def _push(self, body: str, at: complex, force: complex) -> None:
        """Add a force, N, on a body at a place of MuJoCo's; it takes them at centres of mass."""
        if body != GROUND:
            com, scaled = complex(*self._data.body(body).xipos[:2]), force / self._linkage.force
            moment = ((at - com).conjugate() * scaled).imag
            self._data.xfrc_applied[self._data.body(body).id] += scaled.real, scaled.imag, 0, 0, 0, moment

    def _forces(self) -> Samples:
        """Return the forces of the pins and the drive, N or N m; MuJoCo has a third for every pin, out of the plane."""
        force = self._data.efc_force
        pins = np.reshape(force[:-1], (-1, 3))[:, :2] * self._linkage.force
        return np.append(pins.ravel(), force[-1] * self._linkage.force * self._linkage.size / self._linkage.drive_unit)

    def _channels(self, q: Samples, v: Samples, a: Samples, held: Samples) -> Motion:
        """Return the channels asked for."""
        linkage, scene = self._linkage, self._scene
        moving = linkage.moving(q, v, a)
        drive = linkage.coordinates.index(f"{scene.drive.body}.{'turn' if scene.driven_slide is None else 's'}")
        found = {"time": self._request.times(scene)} | channels.kinematics(linkage, moving, q[:, drive])
        if self._request.wants_forces(scene):
            found |= channels.forces(linkage, moving, held, self._ends)
        return Motion({name: np.ascontiguousarray(found[name]) for name in self._request.wanted(scene)})

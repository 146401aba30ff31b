"""One run: steps in time from a little before the first sample, and the channels from what they leave."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import mujoco
import numpy as np

from scenes import Failure, Request, Scene, Status
from scenes.elements.element import End
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND

from ..coordinates.bodies import MovingBody
from ..coordinates.loads import LoadedPose, Wrench, applied
from ..coordinates.simulation import CoordinateSimulation
from ..coordinates.system import System
from .engine import MujocoSettings
from .model import MujocoUnits, model

PRE_ROLL = 6  # steps before the first sample, after which the gaps are those that a step opens
MAX_GAP = 0.05  # over the linkage's size, from where the run is no longer one of it
MIN_SPRING_LENGTH = 1e-4  # over the size: a shorter one's direction is that of the gaps in the joints
_sliding = partial(System, slides=True)  # one, by which the starts of scenes are kept


class MujocoSimulation(CoordinateSimulation[System]):
    """One prepared run, see `scenes.model.engine.Simulation`."""

    whole_way = True

    def __init__(self, scene: Scene, settings: MujocoSettings, request: Request) -> None:
        """Model and assemble, see `engine.build`."""
        mujoco.set_mju_user_warning(lambda _: None)  # else it writes a file where the numbers get too large
        super().__init__(_sliding, scene, settings.steps, request)
        self._follower.begin(1)
        self._h = scene.cycle / (self._each * self._samples)  # s
        self._units = MujocoUnits(self._system)
        h = self._h / self._units.second
        self._model = model(self._system, h, hard=settings.hard)
        self._data: Any = mujoco.MjData(self._model)
        # Where MuJoCo has our coordinates.
        self._order = np.array([int(self._model.joint(name).qposadr[0]) for name in self._system.coordinates])
        # MuJoCo has a third row for every pin, out of the plane; the last row is the drive's.
        self._in_plane = np.delete(np.arange(3 * len(scene.pins) + 1), np.s_[2:-1:3])
        before, first_position = (
            float(inputs_of(scene, -steps * self._h).driven().position) for steps in (PRE_ROLL + 1, PRE_ROLL)
        )
        first, second = self._follower.through(
            self._start, self._follower.system.drive.law.start, [before, first_position]
        )
        self._first, self._branch = (second.x, (second.x - first.x) / h), second.branch

    def solve(self) -> None:
        """Make the steps, and the channels from them."""
        system, order, count = self._system, self._order, len(self._times)
        q, v, a = (np.empty((count, len(order))) for _ in range(3))
        held = np.empty((count, len(system.row_units)))
        self._follower.begin(self._turns)
        largest, data = 0.0, self._data
        mujoco.mj_resetData(self._model, data)
        data.qpos[order], data.qvel[order] = self._first
        times = self._h * np.arange(1 - PRE_ROLL, self._steps + 2)
        targets = (inputs_of(self._scene, times).driven().position / system.drive_unit).tolist()
        previous = np.array(data.qvel)
        for step, target in enumerate(targets, start=-PRE_ROLL):
            # One step by hand. The velocity that MuJoCo holds is half a step old: velocity-dependent terms (centrifugal
            # forces, dampers, loads) are evaluated with the extrapolated velocity at the pose, and the step itself is
            # made from the stored one. Without that the leapfrog falls to order 1.
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
                self._follower.budget.check(f"{row} of {count} samples are done")
                q[row] = pose[order]
                v[row], a[row] = ((data.qvel + rate) / 2)[order], (data.qvel - rate)[order]
                held[row] = data.efc_force[self._in_plane]
                largest = max(largest, self._checked_gap(row))
        self.counters = {"steps": len(targets)}
        self.residuals = {"joint_gap": largest}
        bodies = system.moved(q, v / self._units.second, a / self._units.second / self._h)
        self._channels = system.kinematics(bodies)
        if self._forces:
            held *= self._units.force
            held[:, -1] *= system.size / system.drive_unit
            self._channels |= forces(system, bodies, held, self._ends)

    def _checked_gap(self, row: int) -> float:
        """Return the largest gap of a joint, over the linkage's size, after a check of the gap and of the branch."""
        gap = float(np.abs(self._data.efc_pos[:-1]).max(initial=0.0))
        J = np.reshape(self._data.efc_J, (-1, self._model.nv))[:, self._order]
        same = np.linalg.slogdet(J[self._in_plane])[0] == self._branch
        if not (gap <= MAX_GAP and same):
            where = self._scene.where(float(self._driven.position[row]))
            if not gap <= MAX_GAP:
                raise Failure(Status.diverged, f"a joint is open by {gap:.3g} of the linkage's size at {where}")
            raise Failure(Status.wrong_branch, f"the bodies are assembled another way at {where}")
        return gap

    def _apply(self) -> None:
        """Set the forces of loads and springs at MuJoCo's pose and rates; it takes them at centres of mass."""
        data, units, size = self._data, self._units, self._system.size

        def slid(slider: str) -> tuple[float, float]:
            column = self._model.joint(f"{slider}.s").qposadr[0]
            return size * data.qpos[column], size / units.second * data.qvel[column]

        def place(end: End) -> complex:
            return size * complex(*data.site(":".join(end)).xpos[:2])

        data.xfrc_applied[:] = 0
        for wrench in applied(LoadedPose(self._scene, self._ends, slid, place, MIN_SPRING_LENGTH * size)):
            if wrench.body != GROUND:
                body, force = data.body(wrench.body), wrench.force / units.force
                moment = wrench.about(size * complex(*body.xipos[:2])) / (units.force * size)
                data.xfrc_applied[body.id] += force.real, force.imag, 0, 0, 0, moment


def forces(
    system: System, moving: Mapping[str, MovingBody], held: Samples, ends: Mapping[str, float]
) -> dict[str, Samples]:
    """Return the force channels, from what pins and drive hold, N or N m, shape (n, rows), and ends of strokes, m.

    A guide is a joint of MuJoCo's tree, which has no constraint: what it exerts is what Newton's and Euler's equations
    of the slider leave.
    """
    scene = system.scene
    exerted = [*system.applied(moving, ends)]
    channels = {scene.channels.drive.effort: held[:, -1]}
    for pin, fx, fy in zip(scene.pins, held[:, :-1:2].T, held[:, 1:-1:2].T, strict=True):
        channels |= zip(scene.channels.pins[pin.channel], (fx, fy), strict=True)
        for body, force in ((pin.first, -fx - 1j * fy), (pin.second, fx + 1j * fy)):
            exerted.append(Wrench(body, moving[body].place(system.arms[body, pin.point]), force))
    # From the last slider in a chain to the first: what a guide exerts on its slider loads the carrier in return.
    for name in (name for name in reversed(system.carriers_first()) if name in system.guides):
        carrier, _, along, first = system.guides[name]
        moving_body, rigid = moving[name], system.bodies[name]
        foot, (com, _, acceleration) = moving_body.place(first), moving_body.at(rigid.com)
        needed = rigid.mass * (acceleration - complex(*(scene.gravity or (0, 0))))
        moment = rigid.inertia * moving_body.alpha + ((com - foot).conjugate() * needed).imag
        for wrench in (wrench for wrench in exerted if wrench.body == name):
            needed, moment = needed - wrench.force, moment - wrench.about(foot)
        across = 1j * along * moving[carrier].turn
        normal = (np.conj(across) * needed).real
        channels |= zip(scene.channels.guides[name], (normal, moment), strict=True)
        exerted.append(Wrench(carrier, foot, -across * normal, -moment))
    return channels

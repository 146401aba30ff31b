"""Poses where MuJoCo's own constraints have no gap: Newton's method with its Jacobian, along the way of the drive."""

from collections.abc import Iterator
from math import ceil, remainder, tau
from typing import Any

import mujoco
import numpy as np

from scenes import Failure, ProcessorBudget, Status
from scenes.motion import Samples
from scenes.open_joint import open_joint
from scenes.scene import GROUND

from .model import Linkage

FULL_TURN = tau - 1e-6  # rad, less roundings
LARGEST = np.radians(2.0)  # step of the drive, and as a part of its travel
SMALLEST = 1e-6  # of that: a linkage that needs a shorter step is singular
ITERATIONS = 8  # near a solution 3 or 4 are enough
PATIENT = 200  # from a sketch
CLOSED = 1e-12  # largest gap, over the size; 1e-9 where rounding stops it
SECONDS = 20.0  # of processor time, for the build


class Poses:
    """The poses of one linkage, as coordinates over their units, shape (coordinates,)."""

    def __init__(self, linkage: Linkage) -> None:
        self.linkage, self.scene = linkage, linkage.scene
        self._model = linkage.model(1.0)
        self._data: Any = mujoco.MjData(self._model)
        self._order = linkage.order(self._model)
        pins = len(self.scene.pins)
        self._rows = np.array([*(3 * pin + axis for pin in range(pins) for axis in (0, 1)), 3 * pins])

    def gaps(self, x: Samples, position: float) -> Samples:
        """Return the gaps of pins, two each, and of the drive at a position, rad or m; over the size, or rad."""
        self._model.eq_data[-1, 0] = position / self.linkage.drive_unit
        self._data.qpos[self._order] = x
        mujoco.mj_fwdPosition(self._model, self._data)
        return np.array(self._data.efc_pos[self._rows])

    def jacobian(self, x: Samples) -> Samples:
        """Return their derivatives, shape (rows, coordinates)."""
        self.gaps(x, 0.0)
        J = np.reshape(self._data.efc_J, (-1, self._model.nv))
        return np.array(J[self._rows][:, self._order])

    def start(self) -> Samples:
        """Return the pose at the drive's start.

        Raises:
            Failure: as of `engine.build`.
        """
        scene, drawn = self.scene, self.scene.sketch.drive
        if scene.driven_slide is None:
            low, high = scene.drive.extent
            near = scene.drive.start if high - low > FULL_TURN else (low + high) / 2  # no lock lies past its ends
            drawn = near + remainder(drawn - near, tau)
        sketch = self.sketched(drawn)
        x = self._closed(sketch, drawn, PATIENT)
        where = scene.where(drawn)
        if x is None:
            reason = f"the bodies do not fit together where the sketch shows them, {where}{self._misfit(sketch, drawn)}"
            raise Failure(Status.cannot_assemble, reason)
        repeated = len(x) - int(np.linalg.matrix_rank(self.jacobian(x)))
        if repeated:
            reason = f"{repeated} constraints repeat others at {where}: the reactions are not determined"
            raise Failure(Status.unsupported, reason)
        if self.branch(x) != self.branch(sketch):
            reason = f"the sketch, {where}, is too rough to decide between two ways of assembling the bodies"
            raise Failure(Status.wrong_branch, reason)
        *_, (_, x) = self.way(x, drawn, scene.drive.start)
        return x

    def sketched(self, position: float) -> Samples:
        """Return every body where it fits the sketch best, with the drive at a position; pins are open."""
        linkage, scene = self.linkage, self.scene
        drawn = {name: complex(*at) for name, at in (*scene.ground.items(), *scene.sketch.points.items())}
        frames = {GROUND: (0j, 0.0)}
        for name in scene.bodies:
            group, fits = scene.aligned[name], 0j
            for other in sorted(group - {GROUND}):
                shown = [point for point in scene.bodies[other].points if point in drawn]
                own = np.array([linkage.local(other, point) for point in shown])
                fits += np.vdot(own - own.mean(), [drawn[point] for point in shown]) if shown else 0j
            turned = position if scene.driven_slide is None and scene.drive.body in group else float(np.angle(fits))
            angle = 0.0 if GROUND in group else turned
            shown = [point for point in scene.bodies[name].points if point in drawn]
            at = [drawn[point] - np.exp(1j * angle) * linkage.local(name, point) for point in shown]
            frames[name] = complex(np.mean(at)) if at else 0j, angle
        x = []
        for name, (z, angle) in frames.items():
            if linkage.slides(name):
                carrier, through, along, first = linkage.guide(name)
                turn = np.exp(1j * angle)
                way = z + turn * first - frames[carrier][0] - turn * through
                x.append((np.conj(turn * along) * way).real)
            elif name != GROUND:
                x += [z.real, z.imag, angle]
        return np.asarray(np.array(x) / linkage.units)

    def way(self, x: Samples, here: float, there: float) -> Iterator[tuple[float, Samples]]:
        """Yield positions and poses from one position of the drive to another; at least one.

        Raises:
            Failure: the linkage locks, two branches meet, or `timed_out`.
        """
        budget = ProcessorBudget(SECONDS, "the way of the linkage")  # of each way: poses are kept from run to run
        unit = LARGEST if self.scene.driven_slide is None else LARGEST / tau * float(np.ptp(self.scene.drive.extent))
        parts = max(1, ceil(abs(there - here) / unit))
        branch = self.branch(x)
        at, step = 0.0, 1 / parts
        while at < 1:
            budget.check(f"it is at {self.scene.where(here + at * (there - here))}")
            ahead = min(1.0, at + step)
            position = here + ahead * (there - here)
            found = self._closed(self._predicted(x, here + at * (there - here), position), position)
            if found is not None and self.branch(found) == branch:
                x, at, step = found, ahead, min(1 / parts, 2 * step)
                yield position, x
            elif step * parts > SMALLEST:
                step /= 2
            else:
                raise self._locked(x, here + at * (there - here), here + min(1.0, at + 1 / parts) * (there - here))

    def branch(self, x: Samples) -> float:
        """Return the sign of det J, which changes only where two branches meet."""
        return float(np.linalg.slogdet(self.jacobian(x))[0])

    def _predicted(self, x: Samples, here: float, there: float) -> Samples:
        drive = np.zeros(len(x))
        drive[-1] = (there - here) / self.linkage.drive_unit
        return np.asarray(x + np.linalg.lstsq(self.jacobian(x), drive)[0])

    def _closed(self, x: Samples, position: float, iterations: int = ITERATIONS) -> Samples | None:
        """Return the pose near x by Newton's method, its steps limited to half a size, half a radian."""
        for _ in range(iterations):
            gaps = self.gaps(x, position)
            if np.abs(gaps).max() <= CLOSED:
                return x
            step: Samples = np.asarray(np.linalg.lstsq(self.jacobian(x), -gaps)[0])
            x = x + step / max(1.0, 2 * float(np.abs(step).max()))
        return x if np.abs(self.gaps(x, position)).max() <= 1e3 * CLOSED else None

    def _locked(self, x: Samples, here: float, ahead: float) -> Failure:
        past = self.scene.where(here)
        for position in np.linspace(here, ahead, 5)[1:].tolist():
            if self._closed(x, position, PATIENT) is None:
                reason = f"the bodies cannot follow the drive past {past}: the linkage locks{self._misfit(x, position)}"
                return Failure(Status.cannot_assemble, reason)
        return Failure(Status.not_converged, f"two ways of assembling the bodies meet past {past}")

    def _misfit(self, x: Samples, position: float) -> str:
        """Return which pin stays open when all others close, for a message; or nothing."""
        joints = {pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(self.scene.pins)}
        joint, gap = open_joint(lambda x: self.gaps(x, position), self.jacobian, x, np.ones(len(x)), joints, 1.0)
        apart, where = self.scene.length(gap * self.linkage.size), self.scene.where(position)
        return f"; with all else closed {joint} stays open by {apart} at {where}" if gap else ""

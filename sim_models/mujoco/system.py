"""MuJoCo's own constraints at positions alone, see `coordinates.system.System`: its poses have no gap."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import numpy as np

from scenes import Scene
from scenes.motion import Samples
from scenes.scene import GROUND

from ..coordinates.bodies import FramedBody
from ..coordinates.system import Frame
from .model import Linkage

APART = 1e-6  # between the Jacobians whose difference is a second derivative: good to ten digits


class MujocoSystem:
    """Coordinates over their units, see `model`; rows are two a pin and the drive's."""

    def __init__(self, scene: Scene) -> None:
        """Compile the model.

        Raises:
            Failure: see `model.Linkage`.
        """
        self.linkage = linkage = Linkage(scene)
        self.scene, self.size, self.drive_unit = scene, linkage.size, linkage.drive_unit
        self.bodies: Mapping[str, FramedBody] = linkage.bodies
        self._model = linkage.model(1.0)
        self._data: Any = mujoco.MjData(self._model)
        self._order = linkage.order(self._model)
        pins = len(scene.pins)
        self.rows = 2 * pins + 1
        self.joints: Mapping[str, Sequence[int]] = {
            pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(scene.pins)
        }
        # MuJoCo has a third row for every pin, out of the plane.
        self._in_plane = np.array([*(3 * pin + axis for pin in range(pins) for axis in (0, 1)), 3 * pins])

    def gaps(self, x: Samples) -> Samples:
        """Return the gaps of pins and the drive's position, over the size or in rad, shape (m,)."""
        self._data.qpos[self._order] = x
        mujoco.mj_fwdPosition(self._model, self._data)
        return np.array(self._data.efc_pos[self._in_plane])

    def jacobian(self, x: Samples) -> Samples:
        """Return their derivatives, shape (m, n)."""
        self.gaps(x)
        J = np.reshape(self._data.efc_J, (-1, self._model.nv))
        return np.array(J[self._in_plane][:, self._order])

    def bend(self, x: Samples, v: Samples) -> Samples:
        """Return their second derivatives along v, shape (m,), by the difference of two Jacobians."""
        length = float(np.abs(v).max())
        if not 0 < length < np.inf:
            return np.zeros(self.rows)
        way = APART / length * v
        return np.asarray((self.jacobian(x + way) - self.jacobian(x - way)) @ v * (length / (2 * APART)))

    def displacement(self, x: Samples, slider: str) -> float:
        """Return how far a body that slides on the ground is along its guide, m."""
        return float(self.size * x[self.linkage.coordinates.index(f"{slider}.s")])

    def placed(self, frames: Mapping[str, Frame]) -> Samples:
        """Return the coordinates of bodies in these places, shape (n,); pins are open."""
        x = list[float]()
        for name, (origin, angle) in frames.items():
            if self.linkage.slides(name):
                carrier, through, along, first = self.linkage.guide(name)
                turn = np.exp(1j * angle)
                way = origin + turn * first - frames[carrier].origin - turn * through
                x.append(float((np.conj(turn * along) * way).real))
            elif name != GROUND:
                x += [origin.real, origin.imag, angle]
        return np.asarray(np.array(x) / self.linkage.units)

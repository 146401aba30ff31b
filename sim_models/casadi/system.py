"""The constraints of a linkage as arrays, by CasADi's functions, see `coordinates.system.System`."""

from collections.abc import Mapping, Sequence

import numpy as np
from casadi import Function

from scenes import Scene
from scenes.motion import Samples

from ..coordinates.bodies import FramedBody
from ..coordinates.system import Frame
from .linkage import Linkage, table


class CasadiSystem:
    """Coordinates: of each body the place of its frame's origin, over the linkage's size, and its angle."""

    def __init__(self, scene: Scene) -> None:
        """Differentiate the constraints.

        Raises:
            Failure: see `coordinates.bodies`.
        """
        self.linkage = linkage = Linkage(scene)
        self.scene, self.size, self.drive_unit, self.rows = scene, linkage.size, linkage.drive_unit, linkage.rows
        self.bodies: Mapping[str, FramedBody] = linkage.bodies
        guides = {f"the guide of {name}": rows[:1] for name, rows in linkage.rows_of_slides.items()}
        pins = {pin.channel: [2 * row, 2 * row + 1] for row, pin in enumerate(scene.pins)}
        self.joints: Mapping[str, Sequence[int]] = guides | pins

    def gaps(self, x: Samples) -> Samples:
        """Return C(x), shape (m,)."""
        return table(self.linkage.gaps, x)[:, 0]

    def jacobian(self, x: Samples) -> Samples:
        """Return C_x, shape (m, n)."""
        return table(self.linkage.jacobian, x)

    def bend(self, x: Samples, v: Samples) -> Samples:
        """Return (C_x v)_x v, shape (m,)."""
        return table(self.linkage.bend, x, v)[:, 0]

    def displacement(self, x: Samples, slider: str) -> float:
        """Return how far a body that slides on the ground is along its guide, m."""
        return float(Function("displacement", [self.linkage.x], [self.linkage.displacement(slider)])(x))

    def placed(self, frames: Mapping[str, Frame]) -> Samples:
        """Return the coordinates of bodies in these places, shape (n,)."""
        places = ((frames[name].origin / self.size, frames[name].angle) for name in self.scene.bodies)
        return np.array([part for origin, angle in places for part in (origin.real, origin.imag, angle)])

"""What a model is solved at: instants, and the position of every drive there with its derivatives by the time.

Where they come from is nobody's business but the source's: the laws of a scene's drives, positions that a drive passes
at its constant speed, or whoever solves a scene from Python.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import finite_numbers
from ..drive import ConstantSpeed, Driven, Samples
from ..errors import InputError
from ..laws import derivatives

if TYPE_CHECKING:
    from ..scene import Scene

NEEDED = 3  # orders: position, rate and acceleration


@dataclass(frozen=True)
class Inputs:
    """Instants and the drives at them, each in rad or m, in the order of the scene's `drives`.

    Attributes:
        time: s, shape (n,).
        derivatives: by their order position, rate, acceleration and so on, shape (order + 1, n, d). As a sequence an
            order of shape (d,) is the same at all instants.
    """

    time: Samples
    derivatives: Sequence[Samples] | Samples

    def driven(self, drive: int = 0) -> Driven:
        """One drive's position, rate and acceleration, each of shape (n,), or () where it is the same throughout."""
        position, rate, acceleration, *_ = self.derivatives
        return Driven(position[..., drive], rate[..., drive], acceleration[..., drive])

    def rows(self, drive: int = 0) -> Driven:
        """The same, each of shape (n,)."""
        return Driven(*np.broadcast_arrays(*self.driven(drive)))

    def checked(self, scene: "Scene") -> "Inputs":
        """The same as arrays; InputError where they are not finite, of another shape, or of too few orders."""
        time = finite_numbers("inputs.time", self.time)
        given = self.derivatives if isinstance(self.derivatives, Sequence) else np.atleast_1d(self.derivatives)
        orders = [finite_numbers("inputs.derivatives", order) for order in given]
        count, drives, shapes = (
            len(time) if time.ndim == 1 else -1,
            len(scene.drives),
            [order.shape for order in orders],
        )
        constant = {(count, drives), (drives,)}
        if len(orders) < NEEDED or shapes[0] != (count, drives) or not constant.issuperset(shapes):
            raise InputError(
                f"inputs: expected times (n,), and positions, rates and accelerations, each (n, {drives}), found"
                f" {time.shape} and {', '.join(map(str, shapes))}"
            )
        return Inputs(time, orders)


def inputs_of(scene: "Scene", time: ArrayLike, order: int = 2) -> Inputs:
    """The inputs by the laws of a scene's drives at instants, s, shape (n,), with derivatives up to an order."""
    time = np.asarray(time, np.float64)
    return Inputs(time, np.stack([derivatives(drive.law, time, order) for drive in scene.drives], axis=-1))


def passing(scene: "Scene", position: ArrayLike, time: ArrayLike | None = None, axes: int = 1) -> Inputs:
    """The inputs of a scene's only drive at positions, rad or m, its rates by its law at instants, s, if any are given.

    At a constant speed it passes them at instants that follow from them. Their shape is (n,), or of more `axes` at most
    where many machines are solved.

    Raises:
        InputError: positions or instants are no finite numbers, or of other shapes.
        InputError: the drive follows a law, and no instants are given.
    """
    position, law = np.asarray(position), scene.drive.law
    if time is not None:
        time = finite_numbers("time", time)
    shapes = [given.shape for given in (position, time) if given is not None]
    if any(not 0 < len(shape) <= axes for shape in shapes) or len({shape[-1] for shape in shapes}) > 1:
        raise InputError(f"position, time: expected the shape (n,) of both, found {' and '.join(map(str, shapes))}")
    # At a constant speed rate and acceleration are left without an axis of instants: they are the same at all of them,
    # and many positions of many machines would repeat them.
    if isinstance(law, ConstantSpeed):
        instants = (position - law.start) / law.speed if time is None else time
        return Inputs(instants, (position[..., np.newaxis], np.asarray(law.speed)[..., np.newaxis], np.zeros(1)))
    if time is None:
        raise InputError("a drive that follows a law needs the instants")
    _, rate, acceleration = law.at(time)
    return Inputs(time, tuple(of[..., np.newaxis] for of in (position, rate, acceleration)))

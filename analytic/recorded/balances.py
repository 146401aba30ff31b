"""The balance of a linkage as recorded expressions, and what of it an arithmetic of bounds takes otherwise."""

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from typing import Any

import numpy as np

from scenes.scene import Friction, PressForce, TorsionSpring

from ..core.friction import Loads, Rubbing
from ..core.groups.group_equations import Group
from ..core.numbers import Number, chosen
from ..core.rubbing_joints import FrictionBalance
from .expressions import Expression, Recorder
from .traced import Traced, traced

NEARLY_HALF = 3.0  # rad, of a turn
BALANCE = "the balance with friction"  # of which a few steps may not find what is there


class RecordedBalance(FrictionBalance):
    """Balances everything as expressions."""

    def settled(self, loads: Loads) -> Sequence[Any]:
        """The frictions; the reach is negative where more than a few steps would be needed."""
        w, bound = loads.solved()
        self.contracts(bound)
        return w

    def contracts(self, bound: Any) -> None:
        """Have the reach negative where a bound on a map's contraction is not below one."""
        self.k.reach[f"{BALANCE} ({len(self.k.reach)})"] = chosen(bound < 1, 1.0, -1.0)

    def larger(self, group: Group) -> None:
        """Balance a larger group: the multipliers of its constraints, from the transpose of their Jacobian."""
        J: Any = self.k.jacobian[group.P]
        make: Recorder = self.k.reach[group.P].make  # type: ignore[attr-defined]
        loads: list[Expression] = []
        for body in group.bodies:
            force, moment = (traced(make, x) for x in self.applied(body, self.scene.bodies[body].points[0]))
            loads += [make("negative", component) for component in (force.x, force.y, moment.x)]
        m = len(loads)
        system = make.system([J[m * row + column] for column in range(m) for row in range(m)], loads)
        self.spread(group, [Traced(make, make.component(system, i)) for i in range(m)])


class BoundedLoads(Loads):
    """The frictions of a group and its loads, whose method's steps are made without bounds: it may end anywhere."""

    def about(self, number: Any) -> Any:
        """A polynomial near the number."""
        return Traced(number.make, number.make("middle", number.x))


class BoundedBalance(RecordedBalance):
    """Balances everything as expressions of which an arithmetic finds bounds; whole numbers in them are inputs."""

    def settled(self, loads: Loads) -> Sequence[Any]:
        """The friction forces after a few steps, with a bound on the truncation error.

        The loads X differ from those of the solution by S times what (1) of `friction` is open by, and by the map's
        contraction of that difference.
        """
        # The steps of the method are made with polynomials alone, without their rests: an iteration with bounds would
        # only widen them. Where it ends may be anywhere; the residual of (1) there, with bounds, and the contraction
        # then bound the distance to the solution (a posteriori error bound of Banach's theorem).
        w, _ = BoundedLoads(loads.rubbing, loads.X0, loads.S).solved()
        self.contracts(loads.contraction)
        slopes = [joint.slope() for joint in loads.rubbing]
        left = [np.abs(residual) for residual in loads.open(w, slopes)[0]]
        sizes = ([joint.size(s) for s in row] for joint, row in zip(loads.rubbing, loads.S, strict=True))
        largest = reduce(np.maximum, (reduce(np.add, map(np.multiply, row, left)) for row in sizes))
        distance = largest / (1.0 - loads.contraction)
        every = zip(w, left, slopes, strict=True)
        return [
            Traced(x.make, x.make("within", x.x, (error + np.abs(slope) * distance).x)) for x, error, slope in every
        ]

    def rubbing(self, friction: Friction) -> Rubbing:
        """A friction as it acts, of one sense at a time."""
        rubbing = super().rubbing(friction)
        return replace(rubbing, sense=rubbing.sense.whole) if friction.smooth is None else rubbing

    def acting(self, load: PressForce, place: str) -> Any:
        """Whether a press force acts."""
        return super().acting(load, place).whole

    def along(self, d: Any, length: Number | None = None) -> Any:
        """The direction of a way; none where a length is zero, as there is no pull and the ends may meet."""
        direction = super().along(d, length)
        return direction if length is None else chosen(length > 0, direction, 0.0)

    def twisted(self, spring: TorsionSpring, place: str) -> Any:
        """The angle of a torsion spring, by what it is roughly; not known where that may be half a turn off."""
        return continued(self.given[place], self.k.u[spring.second] * self.k.u[spring.first].conjugate())


def continued(rough: Any, u: Any) -> Any:
    """The angle of a unit vector over whole turns, by what it is roughly; not known if that may be half a turn off."""
    # The angle from the rough one: a division by zero is the recorded way of making a value unknown.
    turned = u * np.exp(-1j * rough)
    angle: Any = np.arctan2(turned.imag, turned.real)
    return rough + angle / chosen(np.abs(angle) < NEARLY_HALF, 1.0, 0.0)

"""How joints with friction rub, a rule for each type of friction: what presses on them, and what a unit of it does."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from scenes.elements.friction import Friction, GuideFriction, PinFriction

if TYPE_CHECKING:  # which kinds there are rules for is asked without python-flint too
    from flint import arb, arb_mat

    from .constraints import LinkageEquations
    from .rows import EquationRows


class RubbingBalls(NamedTuple):
    """A joint with friction."""

    joint: int  # its number among the scene's joints
    work: EquationRows  # of a unit of friction
    presses: Sequence[arb_mat]  # each times the joint's two multipliers is what presses its surfaces together, N
    radius: arb | None  # at which it resists, m; None of a force


def _pin(friction: PinFriction, linkage: LinkageEquations) -> RubbingBalls:
    from flint import arb, arb_mat

    first, second = friction.joined(linkage.scene)
    work = linkage.rows(1)
    linkage.add_angle(work, 0, second, first)
    joint = linkage.scene.pins.index(friction.pin(linkage.scene))
    return RubbingBalls(joint, work, [arb_mat([[1, 0], [0, 1]])], arb(friction.radius))


def _guide(friction: GuideFriction, linkage: LinkageEquations) -> RubbingBalls:
    from flint import arb, arb_mat

    joint = len(linkage.scene.pins) + list(linkage.scene.slides).index(friction.slider)
    ends = [arb_mat([[arb(0.5), end / arb(friction.length)]]) for end in (1, -1)]
    return RubbingBalls(joint, linkage.displacement(friction.slider), ends, None)


CONTACTS: Mapping[type[Friction], Callable[[Any, LinkageEquations], RubbingBalls]] = {
    PinFriction: _pin,
    GuideFriction: _guide,
}

"""What loads and springs do as symbols, a rule for each type of element: energies, and forces whose work counts."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from scenes.elements.constant_force_springs import ConstantForceSpring
from scenes.elements.element import Element, End
from scenes.elements.loads import Force, ForceTable, PressForce
from scenes.elements.springs import Spring

if TYPE_CHECKING:  # which kinds there are rules for is asked without CasADi too
    from .linkage import SymbolicLinkage


class Acting(NamedTuple):
    """What an element has: energy, N m, and forces on points, N."""

    potential: Any = 0.0
    forces: Sequence[tuple[End, Any]] = ()


def _force(_linkage: "SymbolicLinkage", load: Force, _place: str) -> Acting:
    from casadi import vertcat

    return Acting(forces=[(load.ends[0], vertcat(*load.force))])


def _press(linkage: "SymbolicLinkage", load: PressForce, place: str) -> Acting:
    from casadi import jtimes, logic_and, vertcat

    x, end = linkage.slid(load.body), linkage.stroke_ends[[*linkage.scene.presses].index(place)]
    # A truth value as a factor, 1 or 0: compiled functions have no branches.
    before_end, closes = load.closing * (end - x), load.closing * jtimes(x, linkage.x, linkage.v) > 0
    return Acting(forces=[(load.ends[0], logic_and(before_end <= load.last, closes) * vertcat(*load.force))])


def _force_table(linkage: "SymbolicLinkage", load: ForceTable, _place: str) -> Acting:
    from casadi import fmax, fmin, pw_lin, vertcat

    assert load.table is not None
    x, places, forces = linkage.slid(load.body), load.table.arguments, load.table.values
    force = pw_lin(fmin(fmax(x, places[0]), places[-1]), vertcat(*places), vertcat(*forces))
    return Acting(forces=[(load.ends[0], force * vertcat(*linkage.scene.slides[load.body].along))])


def _spring(linkage: "SymbolicLinkage", spring: Spring, _place: str) -> Acting:
    """Return its energy, which without a free length has a derivative at no length too."""
    from casadi import norm_2, sumsqr

    way = linkage.way(spring)
    squared = (norm_2(way) - spring.length) ** 2 if spring.length else sumsqr(way)
    return Acting(potential=spring.stiffness / 2 * squared)


def _constant_force_spring(linkage: "SymbolicLinkage", spring: ConstantForceSpring, _place: str) -> Acting:
    from casadi import norm_2

    return Acting(potential=spring.force * norm_2(linkage.way(spring)))


RULES: Mapping[type[Element], Callable[["SymbolicLinkage", Any, str], Acting]] = {
    Force: _force,
    PressForce: _press,
    ForceTable: _force_table,
    Spring: _spring,
    ConstantForceSpring: _constant_force_spring,
}

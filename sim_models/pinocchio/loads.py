"""Forces on the bodies, and Newton's and Euler's equations of the tree by Pinocchio's recursion."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import pinocchio

from scenes import Failure, Status
from scenes.motion import Samples
from scenes.scene import Force, ForceTable, Load

from .closures import Closures, Held
from .tree import Bodies

SHORTEST_SPRING = 1e-12  # of the linkage's size; a shorter one's direction is round-off


class Wrench(NamedTuple):
    """A force on a body, N, at a place, m, and a moment, N m."""

    row: int
    at: complex
    force: complex
    moment: float = 0.0


def applied(closures: Closures, bodies: Bodies, ends: Samples) -> Iterator[Wrench]:
    """Yield what loads and springs do; `ends` are of the press forces' strokes, m.

    Raises:
        Failure: `nonfinite`, a spring has no direction.
    """
    scene = closures.tree.scene
    for load, end in zip(scene.loads, ends, strict=True):
        held = closures.held(load.body, load.at)
        yield Wrench(held.row, bodies.place(*held), _force(closures, bodies, load, float(end)))
    for spring in scene.springs:
        first, second = closures.held(*spring.first), closures.held(*spring.second)
        p, q = bodies.place(*first), bodies.place(*second)
        pull = spring.stiffness * (q - p)
        if spring.length:
            if not abs(q - p) > SHORTEST_SPRING * closures.size:
                raise Failure(
                    Status.nonfinite,
                    f"the ends {'.'.join(spring.first)} and {'.'.join(spring.second)} of a"
                    " spring meet: it has no direction",
                )
            pull *= 1 - spring.length / abs(q - p)
        yield Wrench(first.row, p, pull)
        yield Wrench(second.row, q, -pull)


def _force(closures: Closures, bodies: Bodies, load: Load, end: float) -> complex:
    """Return the force of a load, N."""
    if isinstance(load, Force):
        return complex(*load.force)
    guide = closures.guides[load.body]
    x = closures.along_guide(bodies, guide)
    if isinstance(load, ForceTable):
        return complex(np.interp(x, load.displacements, load.forces)) * guide.along
    v = (guide.along.conjugate() * bodies.velocity(*guide.first)).real
    acts = load.closing * v > 0 and load.closing * (end - x) <= load.last
    return complex(*load.force) if acts else 0j


def held(closures: Closures, bodies: Bodies, multipliers: Samples) -> Iterator[Wrench]:
    """Yield what the joints that close loops and the drive do, by their multipliers in the order of the rows."""
    rows = iter(multipliers.tolist())
    for first, second in closures.pins.values():
        force = complex(next(rows), next(rows))
        yield from _between(bodies, second, first.row, force, 0.0)
    for guide in closures.sliders.values():
        axis, _ = closures.on_guide(bodies, guide)
        yield from _between(bodies, guide.first, guide.through.row, 1j * axis * next(rows), next(rows))
    effort, guided = next(rows), closures.driven_guide
    if guided is None:
        yield Wrench(closures.driven, 0j, 0j, effort)
    else:
        yield Wrench(closures.driven, bodies.place(*guided.first), guided.along * effort)


def _between(bodies: Bodies, on: Held, other: int, force: complex, moment: float) -> Iterator[Wrench]:
    yield Wrench(on.row, bodies.place(*on), force, moment)
    yield Wrench(other, bodies.place(*on), -force, -moment)


def inverse_dynamics(
    closures: Closures, bodies: Bodies, motion: tuple[Samples, Samples, Samples], wrenches: list[Wrench]
) -> Samples:
    """Return the generalised forces that a motion q, v, a needs besides the wrenches; Pinocchio keeps the joints'."""
    tree = closures.tree
    linear, angular = np.zeros(len(tree.index), complex), np.zeros(len(tree.index))
    for row, at, force, moment in wrenches:
        linear[row] += force
        angular[row] += moment + ((at - bodies.at[row]).conjugate() * force).imag
    linear *= bodies.turn.conj()
    forces: Any = pinocchio.StdVec_Force()
    forces.extend([pinocchio.Force.Zero()] * tree.model.njoints)
    for name, row in tree.index.items():
        in_plane = np.array([linear[row].real, linear[row].imag, 0.0])
        forces[tree.number[name]] = pinocchio.Force(in_plane, np.array([0.0, 0.0, angular[row]]))
    return np.asarray(pinocchio.rnea(tree.model, tree.data, *motion, forces))

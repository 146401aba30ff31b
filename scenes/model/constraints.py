"""Block-triangular order of a linkage's constraints, and the joint that fails to close.

The rows and columns of a square matrix can be ordered so that it is lower block triangular (Dulmage and Mendelsohn). Of
the constraints of a linkage the diagonal blocks are the bodies that move together, a crank, a dyad, a larger Assur
group, each solved when those before it are: the work is linear in their number. No number of the matrix is looked at.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from itertools import groupby
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from ..joints import Joint
from ..scene import Scene
from .motion import Samples

Pattern: TypeAlias = Sequence[Sequence[int]]  # by row the columns where an entry may be other than zero
HEAVY_WEIGHT = 1e3  # weight of what does not give way: the drive, and the angles of guides
OPEN_TOL = 1e-9  # of the linkage's size: a gap larger than roundings
BLOCK = 2**20  # numbers of Jacobians that are in memory at a time


class DiagonalBlock(NamedTuple):
    """A diagonal block: its rows and columns, and the columns to the left where those rows have entries too."""

    rows: Sequence[int]
    columns: Sequence[int]
    left: Sequence[int]


def groups(pattern: Pattern) -> list[DiagonalBlock]:
    """The diagonal blocks of a square matrix in their order; one for all where there is none."""
    # Every unknown is matched to an equation that has it. It needs the other unknowns of that equation, and those that
    # they need; unknowns that need each other are one block.
    count = len(pattern)
    equation = matched(pattern)
    if len(equation) < count:
        return [DiagonalBlock(range(count), range(count), [])]
    # needs[i, j] is 1 where unknown i needs unknown j. Each product of the matrix with itself doubles the length of the
    # chains that it knows, so that after log2(count) squarings it is transitively closed. Floats make it a BLAS
    # product, which NumPy has for no booleans; entries are cut to 1, and single precision counts exactly to 2^24.
    needs = np.eye(count, dtype=np.float32)
    for unknown, row in equation.items():
        needs[unknown, pattern[row]] = 1
    for _ in range(count.bit_length()):
        needs = np.minimum(needs @ needs, 1)
    # Unknowns that need each other are a strongly connected component, and are known by the first of them. An unknown
    # that needs another component needs all that this needs, and itself: sorted by the number of needs, each component
    # comes after all that it depends on.
    first = np.argmax(needs * needs.T, axis=1)  # of the unknowns that need each other
    order = sorted(range(count), key=lambda unknown: (needs[unknown].sum(), first[unknown]))
    blocks = []
    for columns in ([*members] for _, members in groupby(order, key=lambda unknown: first[unknown])):
        rows = [equation[unknown] for unknown in columns]
        left = {column for row in rows for column in pattern[row]}.difference(columns)
        blocks.append(DiagonalBlock(rows, columns, sorted(left)))
    return blocks


def matched(pattern: Pattern) -> Mapping[int, int]:
    """By column a row of its own that has an entry there, for as many as possible: by augmenting paths."""
    # Maximum matching of rows and columns (Berge): from a row without a column, a breadth-first search along columns
    # that are taken and the rows that took them, until a column is free. Then every row on the path exchanges its
    # column, and one more row is matched. Where no path is found the row stays without, and no later exchange can
    # change that.
    owner, owned = dict[int, int](), dict[int, int]()  # by column its row, by row its column
    for start in range(len(pattern)):
        came, reached = dict[int, int](), [start]  # by column the row that leads to it
        for row in reached:
            new = [column for column in pattern[row] if column not in came]
            came |= dict.fromkeys(new, row)
            free = next((column for column in new if column not in owner), None)
            if free is None:
                reached += [owner[column] for column in new]
                continue
            while free is not None:  # every row on the way gives up its column for the one that it led to
                row = came[free]
                owner[free], (owned[row], free) = row, (free, owned.get(row))
            break
    return owner


def open_joint(
    gaps: Callable[[Samples], Samples],
    jacobian: Callable[[Samples], Samples],
    q: Samples,
    units: Samples,
    joints: Mapping[str, Sequence[int]],
    size: float,
) -> tuple[str, float]:
    """The joint that stays open when all others close, and its gap, m: zero where there is not one alone.

    `gaps`, m and rad, are a model's constraints, of coordinates, both of shape (m,), and `jacobian` their derivative,
    shape (m, m). It begins from `q`; `units`, shape (m,), make coordinates comparable. `joints` has by name the rows
    that are gaps of a joint; all others hold. `size` is of the linkage, m. For messages alone.
    """
    # By least squares all joints give way; then the worst of them alone, the last of equals.
    from scipy.optimize import least_squares, minimize  # late: only a linkage that fails needs it

    is_gap = np.isin(np.arange(len(q)), np.concatenate([*joints.values()]))
    scale, weights = np.where(is_gap, 1 / size, 1.0), np.where(is_gap, 1.0, HEAVY_WEIGHT * max(1.0, 1 / size))

    def relative(x: Samples) -> Samples:
        return np.asarray(scale * gaps(x * units))

    def slope(x: Samples) -> Samples:
        return np.asarray((scale * (jacobian(x * units) * units).T).T)

    # Levenberg and Marquardt's method needs no solution to exist: it spreads the misfit over all gaps. The heavy rows,
    # the drive and the angles of guides, count a million times as much in the sum of squares, since a drive that is off
    # is no answer to the question which joint is open.
    x = least_squares(lambda x: weights * relative(x), q / units, lambda x: (weights * slope(x).T).T, method="lm").x
    # Gaps are compared to two digits: the joints of a symmetric linkage share a misfit equally, and the last digits
    # would choose one by rounding, another one on another machine.
    worst = max(reversed([*joints]), key=lambda joint: float(f"{np.linalg.norm(relative(x)[joints[joint]]):.2g}"))
    rows = joints[worst]
    others = np.delete(np.arange(len(x)), rows)

    # Now the least gap of that joint alone, with all other constraints as equations (sequential quadratic programming).
    # Where the others cannot be closed even so, more than one joint is to blame, and none is named.
    def square(x: Samples) -> tuple[Any, Samples]:
        gap = relative(x)[rows]
        return gap @ gap, 2 * gap @ slope(x)[rows]

    closed = {"type": "eq", "fun": lambda x: relative(x)[others], "jac": lambda x: slope(x)[others]}
    closest = minimize(square, x, jac=True, constraints=closed, method="SLSQP", options={"ftol": 1e-14})
    left = relative(closest.x)
    gap = float(np.linalg.norm(left[rows]))
    return worst, gap * size if gap > OPEN_TOL and np.abs(left[others]).max() <= OPEN_TOL else 0.0


def misfit(
    scene: Scene, positions: Iterable[float], gaps: Callable[[float, Samples], Samples], *given: Any, unit: float = 1.0
) -> str:
    """Return which joint stays open at the first position of the drive where one does, for a message, or nothing.

    `gaps` are by position and coordinates; `given` is the rest for `open_joint`, with lengths in a unit, m.
    """
    for position in positions:
        joint, gap = open_joint(partial(gaps, position), *given)
        if gap:
            apart, where = scene.length(gap * unit), scene.where(position)
            return f"; with all else closed {joint} stays open by {apart} at {where}"
    return ""


def joint_rows(joints: Iterable[Joint]) -> dict[str, list[int]]:
    """By name the rows that are gaps of a joint, where constraints are in the order of joints; pins come last."""
    first, gaps = 0, list[tuple[str, list[int]]]()
    for joint in joints:
        gaps.append((joint.label, [*range(first, first + joint.gaps)]))
        first += joint.equations
    return {label: rows for label, rows in sorted(gaps, key=lambda gap: len(gap[1])) if rows}


def blocks(q: Samples) -> Iterator[slice]:
    """Yield the rows of n poses in turn, of which the Jacobians fit in memory, by coordinates of shape (n, ...)."""
    # A dense Jacobian of m coordinates has m^2 numbers a pose: so many poses fit in 8 MB of doubles.
    rows = max(BLOCK // (q.size // len(q)) ** 2, 1)
    yield from (slice(first, first + rows) for first in range(0, len(q), rows))

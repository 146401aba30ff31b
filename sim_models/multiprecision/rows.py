"""The one form that every equation of a planar linkage has in absolute coordinates, in arbitrary-precision balls.

The coordinates are q = (x, y, θ) of every body's centre of mass and x axis; plane vectors are complex balls, x + iy. A
point of a body is r + e^{iθ} s, so every pin, drive, observed point, load and slide on the ground is a row that is
linear but for the angles:

    f(q) = k + C q + Re(W e^{iθ})                                            (1)

A slide on a moving body a projects the way d = r_b - r_a to its slider b on a direction n that turns with a, and
(e^{iθ} n)·d is a row (1) whose W is linear in q. All that f is nonlinear in is y = S q: the angles, and such d
over the linkage's size L, so that y has no unit. Jacobian and second derivative along a motion q(t) follow without
further geometry:

    J = df/dq = C + B S,   B = [-Im(W diag(e^{iθ})), L e^{iθ} n]                        (2)
    f'' = J q'' - Re(W diag(e^{iθ})) θ'^2 - 2 Im(W' diag(e^{iθ})) θ'                    (3)

W' vanishes but for the slides on moving bodies, whose Coriolis term that is.

Systems with J are solved group by group, see `scenes.model.constraints`. Needs python-flint; every function works at
the precision that the caller has set in `flint.ctx`.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

from flint import acb, arb, arb_mat

from scenes.model.constraints import DiagonalBlock

AXES = acb(1), acb(0, 1)  # the unit vectors of x and y
MAX_AT_ONCE = 16  # equations: at 50 digits, FLINT eliminates all in less time than their blocks are taken apart


class GuideTerm(NamedTuple):
    """A term (e^{iθ} n)·d of a row: the way from one body's centre of mass to another's, on a turning direction n."""

    row: int
    column: int  # of B, the first of two
    carrier: int  # the body that turns n, and where the way begins
    slider: int
    direction: acb  # n, in the carrier's frame

    def way(self, q: arb_mat) -> acb:
        """Return d = r_b - r_a of a pose, or its derivative of a rate."""
        a, b = 3 * self.carrier, 3 * self.slider
        return acb(q[b, 0] - q[a, 0], q[b + 1, 0] - q[a + 1, 0])


class EquationRows:
    """Rows of the form (1) over the coordinates of `bodies` bodies; zero until terms are added.

    `guides` of them may be of slides on moving bodies, in a linkage of a given size, m.
    """

    def __init__(self, count: int, bodies: int, guides: int = 0, size: float = 1.0) -> None:
        self.k = arb_mat(count, 1)
        self.C = arb_mat(count, 3 * bodies)
        self.S = arb_mat(bodies + 2 * guides, 3 * bodies)
        self.moved_by = [[3 * i + 2] for i in range(bodies)]  # the columns of S by row
        for i in range(bodies):
            self.S[i, 3 * i + 2] = arb(1)
        self._levers: dict[tuple[int, int], acb] = {}  # entries of W by row and body
        self._guides: list[GuideTerm] = []
        self._size = arb(size)

    def add_angle(self, row: int, body: int, factor: arb) -> None:
        """Add a body's angle θ times a factor to a row."""
        self.C[row, 3 * body + 2] += factor

    def add_point(self, row: int, weight: acb, body: int, arm: acb) -> None:
        """Add the projection w·p of a body's point p = r + e^{iθ} s to a row, s being the `arm` in the body's frame."""
        self.C[row, 3 * body] += weight.real
        self.C[row, 3 * body + 1] += weight.imag
        # w·p = Re(conj(w) p) with p = r + e^{iθ} s: the part with r is linear and goes into C, conj(w) s is the entry
        # of W.
        self._levers[row, body] = self._levers.get((row, body), acb(0)) + weight.conjugate() * arm

    def add_guide(self, row: int, direction: acb, carrier: int, slider: int) -> None:
        """Add the way from the carrier's to the slider's centre of mass, projected on a direction of the carrier's.

        A row holds one such term at most; rows with the same way share its columns.
        """
        ways = {(guide.carrier, guide.slider): guide.column for guide in self._guides}
        column = ways.get((carrier, slider), self.C.ncols() // 3 + 2 * len(ways))
        self._guides.append(GuideTerm(row, column, carrier, slider, direction))
        self._levers.setdefault((row, carrier), acb(0))
        for axis in (0, 1) if (carrier, slider) not in ways else ():
            self.S[column + axis, 3 * slider + axis] = 1 / self._size
            self.S[column + axis, 3 * carrier + axis] = -1 / self._size
            self.moved_by.append([3 * slider + axis, 3 * carrier + axis])

    def value(self, q: arb_mat) -> arb_mat:
        """Return f(q) of (1), shape (rows, 1)."""
        f, turns = self.k + self.C * q, _turns(q)
        for (row, body), lever in self._levers_at(q).items():
            f[row, 0] += (lever * turns[body]).real
        return f

    def varying(self, q: arb_mat) -> dict[tuple[int, int], arb]:
        """Return B of (2), the part of J that varies, for y = S q alone: the entries that are not zero."""
        turns = _turns(q)
        B = {(row, body): -(lever * turns[body]).imag for (row, body), lever in self._levers_at(q).items()}
        for guide in self._guides:
            # (e^{iθ} n)·d is differentiated by d alone: its derivative by the carrier's angle is that of W, which is
            # linear in d and stands in the first part of B. The columns are those of d / L, hence the factor L.
            turned = self._size * (guide.direction * turns[guide.carrier])
            B[guide.row, guide.column], B[guide.row, guide.column + 1] = turned.real, turned.imag
        return B

    def jacobian(self, q: arb_mat) -> arb_mat:
        """Return J of (2), shape (rows, 3 bodies)."""
        J = arb_mat(self.C)
        for (row, y), slope in self.varying(q).items():
            for column in self.moved_by[y]:
                J[row, column] += slope * self.S[y, column]
        return J

    @property
    def pattern(self) -> list[list[int]]:
        """The columns of J, by row, where it may be other than zero."""
        columns = [{j for j in range(self.C.ncols()) if self.C[i, j] != 0} for i in range(self.C.nrows())]
        for row, y in self.varying(arb_mat(self.C.ncols(), 1)):
            columns[row].update(self.moved_by[y])
        return [sorted(row) for row in columns]

    def centripetal(self, q: arb_mat, rate: arb_mat) -> arb_mat:
        """Return J q'' - f'' of (3), shape (rows, 1), for q' = `rate`: the centripetal and the Coriolis terms."""
        turns, omega = _turns(q), angles(rate)
        total = arb_mat(self.k.nrows(), 1)
        for (row, body), lever in self._levers_at(q).items():
            total[row, 0] += (lever * turns[body]).real * omega[body] * omega[body]
        for guide in self._guides:
            lever = guide.way(rate).conjugate() * guide.direction
            total[guide.row, 0] += 2 * omega[guide.carrier] * (lever * turns[guide.carrier]).imag
        return total

    def _levers_at(self, q: arb_mat) -> dict[tuple[int, int], acb]:
        """Return the entries of W of (1) by row and body, of a pose."""
        levers = dict(self._levers)
        for guide in self._guides:
            levers[guide.row, guide.carrier] += guide.way(q).conjugate() * guide.direction
        return levers


def angles(q: arb_mat) -> list[arb]:
    """Return the angle, or its derivative, of every body."""
    return [q[k, 0] for k in range(2, q.nrows(), 3)]


def column(entries: Sequence[arb]) -> arb_mat:
    """Return the entries as a matrix of one column."""
    return arb_mat(len(entries), 1, entries)


def dot(u: acb, v: acb) -> arb:
    """Return u·v."""
    return (u.conjugate() * v).real


def _turns(q: arb_mat) -> list[acb]:
    """Return e^{iθ} of every body."""
    return [acb(0, angle).exp() for angle in angles(q)]


def solved(groups: Sequence[DiagonalBlock], matrix: arb_mat, right: arb_mat, **how: Any) -> arb_mat:
    """The solution, column by column, by forward substitution; ZeroDivisionError where no block is proven regular."""
    # Forward substitution: what is known of the groups before goes to the right side, and each group is eliminated by
    # itself. The work grows with the number of the groups, not with its cube.
    if right.nrows() <= MAX_AT_ONCE:
        return matrix.solve(right, **how)
    every = range(right.ncols())
    solution = arb_mat(right.nrows(), len(every))
    for rows, columns, left in groups:
        given = part(right, rows, every)
        if left:
            given -= part(matrix, rows, left) * part(solution, left, every)
        for j, values in zip(columns, part(matrix, rows, columns).solve(given, **how).tolist(), strict=True):
            for k, value in enumerate(values):
                solution[j, k] = value
    return solution


def part(matrix: arb_mat, rows: Sequence[int], columns: Sequence[int]) -> arb_mat:
    """Return the entries of some rows and columns as a matrix."""
    return arb_mat(len(rows), len(columns), [matrix[i, j] for i in rows for j in columns])

"""The constraints of a linkage in the coordinates of all its bodies: equations, Jacobian and second derivative.

A body has the coordinates x, y of its first point, over the linkage's largest length L, and its angle; the ground comes
last and stays at zero. With r the arms of points from the first ones of their bodies, over L, every constraint is

    Re(conj(d e^(iθₖ)) w) = 0,  w = zᵢ + rᵢ e^(iθᵢ) - zⱼ - rⱼ e^(iθⱼ)   no distance along d, in the frame of k, or
    Σ nₖ θₖ = 0                                                       no turn: θᵢ - θⱼ of most.

A drive's equation is less its position; `joints` has the equations of each kind of joint. They are in the order of
`Scene.joints`, and as many as coordinates, m, where the linkage has one degree of freedom and no constraint too many.

One step of Newton's method closes the joints of computed poses with the drive where it is. In the poses found rates and
accelerations have no choice: with γ the second derivative of the constraints at q'' = 0 and e the drive's row,

    J q' = e rate,   J q'' = e acceleration - γ(q, q').
"""

from collections.abc import Iterable, Iterator
from itertools import zip_longest
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.model.constraints import DiagonalBlock, blocks, groups
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND

from .bodies import arms, largest_length
from .joints import RULES
from .motion_vectors import MotionVectors, Vectors

Poses: TypeAlias = NDArray[np.float64]  # shape (n, bodies, 3), also of rates and accelerations
Matrices: TypeAlias = NDArray[np.float64]  # shape (n, m, m)


class ClosedPoses(NamedTuple):
    """Poses that meet the constraints, and how these stand there: not finite in a singular pose."""

    q: Poses
    v: Poses
    a: Poses
    inverse: Matrices  # of J
    branch: Samples  # the sign of det J in the poses as computed, shape (n,): it changes in a singular pose alone
    condition: Samples  # of J in the Frobenius norm, shape (n,)


class Constraints:
    """C(q) = 0 of one scene, at many poses at once."""

    def __init__(self, scene: Scene) -> None:
        self.scene, self.size = scene, largest_length(scene)
        self.bodies = {name: number for number, name in enumerate((*scene.bodies, GROUND))}
        self.arms = {name: arms(scene, body) for name, body in scene.bodies.items()}
        self.arms[GROUND] = {point: complex(*place) for point, place in scene.ground.items()}
        rows = [row for joint in scene.joints for row in RULES[type(joint)].equations(joint, scene, self.arms)]
        first, second, arm, other, along, frame, angles = zip(*rows, strict=True)
        self._first, self._second, self._frame = (
            np.array([self.bodies[name] for name in names]) for names in (first, second, frame)
        )
        self._arm, self._other, self._along = np.array(arm) / self.size, np.array(other) / self.size, np.array(along)
        self._turns = np.flatnonzero(self._along == 0)
        # The sums of angles, term by term: one that has fewer is filled with the ground's angle, which is zero.
        terms = [*zip_longest(*(angles[row] for row in self._turns), fillvalue=(GROUND, 0.0))]
        self._turning = [np.array([self.bodies[name] for name, _ in term], np.intp) for term in terms]
        self._counts = [np.array([count for _, count in term]) for term in terms]
        self.units = np.where(self._along == 0, 1.0, self.size)  # of the constraints, m and rad
        somewhere = np.random.default_rng(0).normal(size=(1, len(scene.bodies), 3))  # where no entry vanishes by chance
        self._groups = _alike(groups([np.flatnonzero(row).tolist() for row in self.jacobian(somewhere)[0]]))

    def blocks(self, motion: Motion) -> Iterator[Motion]:
        """Yield a motion in pieces, of which the matrices fit in memory."""
        for rows in blocks(self.poses(motion)):
            yield Motion({channel: samples[rows] for channel, samples in motion.samples.items()})

    def condition(self, motion: Motion) -> Samples:
        """The condition number of J in the 2-norm at each sample of a motion, shape (n,)."""
        q = self.poses(motion)
        with np.errstate(divide="ignore"):
            return np.concatenate([np.linalg.cond(self.jacobian(q[rows])) for rows in blocks(q)])

    def closed(self, motion: Motion) -> ClosedPoses:
        """The poses of a motion after one step of Newton's onto the constraints, with their rates."""
        q = self.poses(motion)
        J = self.jacobian(q)
        branch = self._branch(J)
        # One Newton step takes a gap g to about kappa g^2: an engine's gaps of 1e-6 become round-off, larger ones
        # remain as errors. A pose in which J is singular stays as it is.
        gaps = self.gaps(q, motion[self.scene.channels.drive.position])
        step = self._solve(J, gaps[..., np.newaxis]).reshape(q.shape)
        q = q - np.where(np.isfinite(step), step, 0.0)
        J = self.jacobian(q)
        inverse = self._solve(J, np.broadcast_to(np.eye(len(self.units)), J.shape))
        driven = inputs_of(self.scene, motion["time"]).driven()
        _, rate, acceleration = (driven_order[:, np.newaxis] / self.units[-1] for driven_order in driven)
        v = (inverse[:, :, -1] * rate).reshape(q.shape)
        bending = (inverse @ self.bending(q, v)[..., np.newaxis])[..., 0]
        a = (inverse[:, :, -1] * acceleration - bending).reshape(q.shape)
        condition = np.linalg.norm(J, axis=(1, 2)) * np.linalg.norm(inverse, axis=(1, 2))
        return ClosedPoses(q, v, a, inverse, branch, condition)

    def poses(self, motion: Motion) -> Poses:
        """Coordinates q from the channels of a motion, shape (n, bodies, 3)."""
        state = MotionVectors(self.scene, motion)
        first = np.stack([state.place(body.points[0]) for body in self.scene.bodies.values()], axis=1) / self.size
        angle = np.stack([state.angle(name) for name in self.scene.bodies], axis=1)
        return np.stack([first.real, first.imag, angle], axis=-1)

    def gaps(self, q: Poses, position: Samples) -> Samples:
        """C(q) with the drive at a position, rad or m, of shape (n,); shape (n, m)."""
        (_, angle), (along, w, *_) = planes(q), self._parts(q)
        gaps: Samples = (along.conj() * w).real
        terms = zip(self._turning, self._counts, strict=True)
        gaps[:, self._turns] = np.sum([count * angle[:, body] for body, count in terms], axis=0)
        gaps[:, -1] -= position / self.units[-1]
        gaps[:, self._turns] = np.remainder(gaps[:, self._turns] + np.pi, 2 * np.pi) - np.pi  # modulo a turn
        return gaps

    def jacobian(self, q: Poses) -> Matrices:
        """J = dC/dq."""
        # Row by row: the gradient of Re(conj(d e^(i theta_k)) w) by place and angle of both bodies, and by the angle of
        # the frame, in which d turns; rows of turns are +-1 in two angles. The ground's columns are cut off.
        along, w, *arms = self._parts(q)
        rows = np.arange(len(self.units))
        J = np.zeros((len(q), len(rows), len(self.bodies), 3))
        for body, arm, sign in zip((self._first, self._second), arms, (1, -1), strict=True):
            turn = (along.conj() * 1j * arm).real
            J[:, rows, body] = sign * np.stack([along.real, along.imag, turn], axis=-1)
        for body, count in zip(self._turning, self._counts, strict=True):
            J[:, self._turns, body, 2] += count
        J[:, rows, self._frame, 2] += (along.conj() * w).imag
        return J[:, :, :-1].reshape(len(q), len(rows), -1)

    def _branch(self, J: Matrices) -> Samples:
        """The sign of det J, but for one that is the same everywhere, shape (n,); NaN where J is not finite."""
        # The determinant of a block-triangular matrix is the product of its blocks' determinants, but for the sign of
        # the permutation, which is the same in all poses.
        each = [np.linalg.slogdet(_blocks(J, rows, columns)) for rows, columns, _ in self._groups]
        signs, sizes = (np.concatenate(parts, axis=1) for parts in zip(*each, strict=True))
        return np.where(np.isnan(sizes.sum(axis=1)), np.nan, signs.prod(axis=1))

    def _solve(self, J: Matrices, right: Samples) -> Samples:
        """J^-1 times what is given by constraints, shape (n, m, k): infinite in singular poses."""
        x, singular = np.zeros(right.shape), np.zeros(len(J), dtype=bool)
        for rows, columns, left in self._groups:
            inverse = _inverse(_blocks(J, rows, columns))
            singular |= np.any(np.isinf(inverse).all(axis=(2, 3)), axis=1)
            x[:, columns] = inverse @ (right[:, rows] - _blocks(J, rows, left) @ x[:, left])
        x[singular] = np.inf
        return x

    def bending(self, q: Poses, v: Poses) -> Samples:
        """d²C/dt² at rates v without accelerations, shape (n, m)."""
        (along, w, arm, other), (rate, omega) = self._parts(q), planes(v)
        # With frame k turning at w_k: d'' in the ground is -w_k^2 d, so that (conj(d) w)'' = conj(d) (w'' - 2 i w_k w'
        # - w_k^2 w).
        spin, other_spin, turn = (1j * omega[:, bodies] for bodies in (self._first, self._second, self._frame))
        dw = rate[:, self._first] + spin * arm - rate[:, self._second] - other_spin * other
        ddw = spin**2 * arm - other_spin**2 * other
        return np.asarray((along.conj() * (ddw - 2 * turn * dw + turn**2 * w)).real)

    def _parts(self, q: Poses) -> tuple[Vectors, Vectors, Vectors, Vectors]:
        """The vectors d e^(iθₖ), w, rᵢ e^(iθᵢ) and rⱼ e^(iθⱼ) of all constraints."""
        z, angle = planes(q)
        turn = np.exp(1j * angle)
        arm, other = self._arm * turn[:, self._first], self._other * turn[:, self._second]
        return self._along * turn[:, self._frame], z[:, self._first] + arm - z[:, self._second] - other, arm, other


class _Blocks(NamedTuple):
    """Diagonal blocks of one size, none of which needs another; arrays of shape (blocks, size), see `DiagonalBlock`."""

    rows: NDArray[np.intp]
    columns: NDArray[np.intp]
    left: NDArray[np.intp]


def _alike(blocks: Iterable[DiagonalBlock]) -> list[_Blocks]:
    """Diagonal blocks, those together that can be solved together, each after all that it needs."""
    # Levels of the block-triangular order: a block is one level below the deepest that it needs. Blocks of one level
    # and one shape are solved in one call of NumPy.
    depth, alike = dict[int, int](), dict[tuple[int, int, int], list[DiagonalBlock]]()  # by column, by size
    for block in blocks:
        below = 1 + max((depth[column] for column in block.left), default=-1)
        depth |= dict.fromkeys(block.columns, below)
        alike.setdefault((below, len(block.columns), len(block.left)), []).append(block)
    return [
        _Blocks(*(np.array(numbers, np.intp) for numbers in zip(*alike[size], strict=True))) for size in sorted(alike)
    ]


def _blocks(J: Matrices, rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Samples:
    return J[:, rows[..., np.newaxis], columns[:, np.newaxis]]


def _inverse(J: Matrices) -> Matrices:
    """The inverses, infinite in singular poses."""
    try:
        return np.linalg.inv(J).astype(np.float64, copy=False)
    except np.linalg.LinAlgError:  # of any of them
        singular = (np.linalg.slogdet(J)[0] == 0)[..., np.newaxis, np.newaxis]
        return np.where(singular, np.inf, np.linalg.inv(np.where(singular, np.eye(J.shape[-1]), J)))


def planes(q: Poses) -> tuple[Vectors, Samples]:
    """X + iy and the angle of every body and the ground, or their rates; shape (n, bodies + 1)."""
    q = np.concatenate([q, np.zeros((len(q), 1, 3))], axis=1)
    return q[..., 0] + 1j * q[..., 1], q[..., 2]

"""Friction in the joints: loads by what Exudyn's multipliers say that the joints carry, until the two agree.

The motion is prescribed, so that only the multipliers of an instant change: C_q^T lambda = f - M a + B y, where B^T v
are the rates of the joints' parts on each other, and y what friction does there, N m or N. What a joint carries is
linear in the multipliers:

    r = r0 + K y,    y = -c s |r|,                                                                                  (1)

with a pin's force, or a guide's N and 2 M / length and the larger of both for |r|; c is the radius of the friction
circle, or the coefficient, and s the sense of the rate. The solution is the one that a common factor on all
coefficients leads to, from 0 to 1.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Status
from scenes.channels import Role
from scenes.model.constraints import blocks

from .channels import forces, kinematics
from .contacts import CONTACTS
from .joints import TURN
from .poses import PoseSolver
from .system import Array, ExudynSystem

MAX_CONTRACTION = 0.95  # a bound on that of (1), below which it has one solution, which no step can miss
MAX_CHANGE = 0.2  # of the largest force: so much do forces change in a step of the factor that is not proven
MIN_STEP = 1e-8  # of the factor, before no solution follows
MAX_ITERATIONS = 20  # of Newton's method, where (1) has kinks
CONVERGED_TOL = 1e-8  # the last correction, of the largest force; it is squared in the next one


class JointFriction:
    """The friction of a scene, on the system of its poses."""

    def __init__(self, poses: PoseSolver) -> None:
        self._poses, self._scene = poses, poses.system.scene
        every = self._scene.friction
        pins = [CONTACTS[type(friction)].round for friction in every]
        self._pins, self._bend = np.array(pins), np.array([friction.coefficient for friction in every]) * pins
        self._slope = np.array([CONTACTS[type(friction)].lever(friction) * friction.coefficient for friction in every])
        self._viscous = np.array([friction.viscous or 0.0 for friction in every])
        self._carried = _carried(poses.system)

    def act(self, q: Array, multipliers: Array, positions: Array, rates: Array) -> tuple[Array, Mapping[str, Array]]:
        """The multipliers with friction, shape (n, constraints), and its channels; Failure where it jams.

        The multipliers without it are given, and the drive's positions and rates, shape (n,).
        """
        given = q, multipliers, positions, rates
        found = [self._at(*(values[rows] for values in given)) for rows in blocks(q)]
        loaded, acting, slip = map(np.concatenate, zip(*found, strict=True))
        power = (acting * slip).sum(axis=1)
        return loaded, dict(zip(self._scene.channels.names(Role.friction), [*acting.T, power], strict=True))

    def _at(self, q: Array, multipliers: Array, positions: Array, rates: Array) -> tuple[Array, Array, Array]:
        """The multipliers with friction, what it does, shape (n, joints), and the joints' rates."""
        # K is (1)'s matrix of influence, shape (n, joint that resists, joint that carries, 2 parts): the change of
        # multipliers by a unit of friction, C_q^-T B, read as what the joints carry. Viscous friction depends on the
        # motion alone and is added before the iteration.
        state, system = self._poses.closed(q, positions), self._poses.system  # what was recorded may move at rest
        v, directions = state.velocities(rates), _directions(system, state.q)
        slip = np.einsum("nkj,nk->nj", directions, v)
        change = np.einsum("nkc,nkj->njc", state.inverse, directions) / system.force_unit
        viscous = -self._viscous * slip
        multipliers = multipliers + np.einsum("nj,njc->nc", viscous, change)
        r0 = np.einsum("irc,nc->nir", self._carried, multipliers)
        K = np.einsum("irc,njc->njir", self._carried, change)
        coulomb = self._followed(r0, K, self._senses(state.q, v, slip), positions)
        return multipliers + np.einsum("nj,njc->nc", coulomb, change), viscous + coulomb, slip

    def _senses(self, q: Array, v: Array, slip: Array) -> Array:
        points, still = self._scene.channels.points.values(), np.zeros(len(q))
        found = kinematics(self._poses.system, q, v)
        spin = np.abs(v[:, TURN::3]).max(axis=1)
        speed = np.max([still, *(np.hypot(*map(found.__getitem__, names.velocity)) for names in points)], axis=0)
        pairs = zip(self._scene.friction, self._pins, slip.T, strict=True)
        return np.transpose([friction.sense(rate, spin if pin else speed) for friction, pin, rate in pairs])

    def _followed(self, r0: Array, K: Array, sense: Array, positions: Array) -> Array:
        """Follow the solution y of (1) from a factor of 0 to 1, at each instant in steps of its own."""
        # Continuation in a common factor on all coefficients, from the frictionless solution y = 0. Where the map y ->
        # -c s |r| is a contraction there is one solution and the first step may go as far as the bound, up to 1 at
        # once. Beyond it a step counts only if Newton's method converges with a positive determinant (no other solution
        # was met) and the forces change little; else it is halved. Below MIN_STEP no solution follows: the joints jam.
        y, factor = np.zeros(sense.shape), np.zeros(len(sense))
        contraction = np.abs(np.linalg.eigvals(self._norm(K) * np.abs(self._slope * sense)[:, np.newaxis])).max(axis=1)
        step = MAX_CONTRACTION / np.maximum(contraction, MAX_CONTRACTION)
        while len(rows := np.flatnonzero((factor < 1) & (step >= MIN_STEP))):
            target = np.minimum(factor[rows] + step[rows], 1.0)
            found, closes = self._newton(y[rows], r0[rows], K[rows], sense[rows], target)
            moved = self._moved(found - y[rows], K[rows]) <= MAX_CHANGE * self._largest(found, r0[rows], K[rows])
            closes &= moved | (factor[rows] == 0)
            y[rows[closes]], factor[rows[closes]] = found[closes], target[closes]
            step[rows] *= np.where(closes, 2.0, 0.5)
        if (factor < 1).any():
            row = int(np.argmax(factor < 1))
            where = self._scene.where(float(positions[row]))
            reason = f"friction jams at {where}: no forces follow past {factor[row]:.4g} of its coefficients"
            raise Failure(Status.jammed, reason)
        return y

    def _newton(self, y: Array, r0: Array, K: Array, sense: Array, factor: Array) -> tuple[Array, NDArray[np.bool_]]:
        """Solve (1) at a factor from a y near; and where the branch has met no other solution since the factor 0."""
        factors = factor[:, np.newaxis]
        c = sense * self._slope * factors / np.sqrt(1 + (self._bend * factors) ** 2)
        closes, unit = np.zeros(len(y), dtype=bool), np.eye(y.shape[1])
        for _ in range(MAX_ITERATIONS):
            # Newton's method on y + c |r0 + K y| = 0, whose derivative is 1 + c grad|r| K. |r| of a guide is the larger
            # part and has a kink: the method is semismooth there, and iterates more than quadratic convergence would
            # need.
            r = r0 + np.einsum("njir,nj->nir", K, y)
            J = unit + c[..., np.newaxis] * np.einsum("nir,njir->nij", self._gradient(r), K)
            sign: Array = np.asarray(np.linalg.slogdet(J)[0])
            J[~(sign > 0)] = unit
            correction: Array = np.asarray(np.linalg.solve(J, (y + c * self._norm(r))[..., np.newaxis]))[..., 0]
            y = y - correction
            closes = (sign > 0) & (self._moved(correction, K) <= CONVERGED_TOL * self._largest(y, r0, K))
            if closes.all():
                break
        return y, closes

    def _largest(self, y: Array, r0: Array, K: Array) -> Array:
        return np.asarray(self._norm(r0 + np.einsum("njir,nj->nir", K, y)).max(axis=1))

    def _moved(self, change: Array, K: Array) -> Array:
        """How far a change of y moves the forces at most, N."""
        return self._largest(change, np.zeros(1), K)

    def _norm(self, r: Array) -> Array:
        """What friction goes by, N, of what the joints carry, shape (..., joints, 2)."""
        return np.where(self._pins, np.hypot(r[..., 0], r[..., 1]), np.abs(r).max(axis=-1))

    def _gradient(self, r: Array) -> Array:
        size = self._norm(r)[..., np.newaxis]
        larger = np.sign(r) * np.eye(2)[np.abs(r).argmax(axis=-1)]
        return np.where(self._pins[:, np.newaxis], r / np.where(size > 0, size, 1.0), larger)


def _carried(system: ExudynSystem) -> Array:
    """What joints with friction carry, N, by the multipliers, shape (joints, 2, constraints)."""
    found = forces(system, np.eye(3 * len(system.bodies)))
    return np.array([CONTACTS[type(friction)].carried(friction, system, found) for friction in system.scene.friction])


def _directions(system: ExudynSystem, q: Array) -> Array:
    """B: what turns or slides on the coordinates by a unit moment or force of friction, shape (n, 3 bodies, joints)."""
    every = system.scene.friction
    directions = np.zeros((*q.shape, len(every)))
    for friction, B in zip(every, np.moveaxis(directions, -1, 0), strict=True):
        CONTACTS[type(friction)].direct(friction, system, q, B)
    return directions

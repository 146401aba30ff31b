"""Poses of pymunk's bodies as points and directions of the plane, which are complex numbers x + iy."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

PoseArray: TypeAlias = NDArray[np.float64]  # (n, bodies, 3), also of rates, accelerations, and the forces dual to them
ComplexArray: TypeAlias = NDArray[np.complex128]
PlaneVector: TypeAlias = Any  # a complex number, or an array of them of shape (n,)


def with_ground(q: PoseArray) -> PoseArray:
    """Append the ground as a body that stays at zero."""
    return np.concatenate([q, np.zeros((*q.shape[:-2], 1, 3))], axis=-2)


def planes(q: PoseArray) -> tuple[ComplexArray, ComplexArray]:
    """The places of the origins and exp(i theta), of the shape of q but its last axis."""
    return q[..., 0] + 1j * q[..., 1], np.exp(1j * q[..., 2])


def point_gradients(r: ComplexArray) -> ComplexArray:
    """Return d(z + r)/d(x, y, theta) of points at the arms r, shape (..., 3)."""
    gradients = np.empty((*r.shape, 3), dtype=np.complex128)
    gradients[..., 0], gradients[..., 1], gradients[..., 2] = 1, 1j, 1j * r
    return gradients


def pair(vector: complex) -> tuple[float, float]:
    """A vector as a pair of numbers, as pymunk takes it."""
    return vector.real, vector.imag

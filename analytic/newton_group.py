"""The mathematics of a group that holds no dyad: pins that must close, by Newton's method, all angles at once.

The bodies' Cartesian coordinates q are the unknowns, m of them: x and y of a body's foot and its angle; for a slider
its displacement along the guide alone. Each of the m / 2 pins must close,

    F(q) = S z + R u - placed = 0,    z = origin + D q,    u = exp(i E q),                                           (1)

one complex equation a pin. The same Jacobian J = dF / dq gives the velocities and accelerations, and its transpose the
forces of the pins: Nikravesh, "Computer-Aided Analysis of Mechanical Systems" (1988), chapters 3 and 9.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.motion import Samples

from .geometry import RigidBody, as_complex

ROUGHLY = 1e-7  # of the group's size: Newton's last correction; near lock, roundings grow to their square root, 1e-8
LONGEST = 0.1  # of the group's size: a rough sketch must not throw the bodies about
ITERATIONS = 200  # from the sketch

Complex: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True)
class Joint:
    """A pin of a larger group: at `point`, `body` hangs on the body `on` of the group, or on a placed point (None)."""

    point: str
    body: str
    on: str | None


@dataclass(frozen=True)
class Group:
    """Bodies that only together have no freedom left, a group of class III or higher; P is the first pin among them."""

    bodies: tuple[str, ...]
    joints: tuple[Joint, ...]
    P: str


@dataclass(frozen=True)
class System:
    """The constants of equation (1), for b bodies, j pins and m = 2 j unknowns."""

    origin: Complex  # (b,), m: of each foot where its coordinates are zero
    D: Complex  # (b, m): how each coordinate moves each foot
    E: Samples  # (b, m): 1 where the coordinate is the body's angle
    S: Samples  # (j, b): 1 for the body that is pinned, -1 for the one of the group that it is pinned to
    R: Complex  # (j, b), m: the arm from the foot to the pin, body frame, with the same sign
    size: float  # m, the longest arm

    def feet(self, q: Samples) -> Complex:
        """Return D q, shape (n, b): where the feet are from their origins; of q' or q'' their velocities or so on."""
        feet: Complex = np.einsum("bm,nm->nb", self.D, q)
        return feet

    def angles(self, q: Samples) -> Samples:
        """Return E q, shape (n, b): the bodies' angles; of q' or q'' their rates."""
        angles: Samples = np.einsum("bm,nm->nb", self.E, q)
        return angles

    def attitude(self, q: Samples) -> Complex:
        """Return u, shape (n, b)."""
        attitude: Complex = np.exp(1j * self.angles(q))
        return attitude

    def open(self, q: Samples, placed: Complex) -> Complex:
        """Return F, shape (n, j), m, by equation (1)."""
        feet = self.origin + self.feet(q)
        gap: Complex = np.einsum("jb,nb->nj", self.S, feet) + np.einsum("jb,nb->nj", self.R, self.attitude(q)) - placed
        return gap

    def jacobian(self, q: Samples) -> Samples:
        """Return dF / dq = S D + i R u E, its real rows above its imaginary ones, shape (n, m, m)."""
        return _real(self.S @ self.D + (1j * self.R * self.attitude(q)[:, None, :]) @ self.E)

    def length(self, correction: Samples) -> Samples:
        """Return the largest move of a correction, shape (n,), m."""
        length: Samples = np.abs(np.where(self.E.any(axis=0), self.size, 1.0) * correction).max(axis=1)
        return length


def system(scene: Scene, bodies: Mapping[str, RigidBody], group: Group) -> System:
    """Return the equations of a group; the foot of each body is its first point."""
    columns = np.cumsum([0] + [1 if scene.bodies[name].slide else 3 for name in group.bodies])
    index = {name: b for b, name in enumerate(group.bodies)}
    origin = np.zeros(len(index), complex)
    D, E = np.zeros((len(index), columns[-1]), complex), np.zeros((len(index), columns[-1]))
    for b, (name, column) in enumerate(zip(group.bodies, columns, strict=False)):
        slide = scene.bodies[name].slide
        if slide is not None:
            origin[b], D[b, column] = as_complex(slide.through), as_complex(slide.along)
        else:
            D[b, column : column + 2], E[b, column + 2] = (1, 1j), 1
    S, R = np.zeros((len(group.joints), len(index))), np.zeros((len(group.joints), len(index)), complex)
    for j, joint in enumerate(group.joints):
        for end, sign in ((joint.body, 1), (joint.on, -1)):
            if end is not None:
                S[j, index[end]] = sign
                R[j, index[end]] = sign * bodies[end].arm(scene.bodies[end].points[0], joint.point)
    return System(origin, D, E, S, R, float(np.abs(R).max()))


def assemble(equations: System, q: Samples, placed: Complex) -> Samples:
    """Return the coordinates near a rough guess q, shape (1, m), where the pins close, if there are any."""
    for _ in range(ITERATIONS):
        correction = solved(equations.jacobian(q), _real(equations.open(q, placed)))
        length = equations.length(correction)
        q = q - correction / np.maximum(1, length / (LONGEST * equations.size))[:, None]
        if not length >= ROUGHLY * equations.size:
            break
    return q


def refine(equations: System, q: Samples, placed: Complex) -> tuple[Samples, NDArray[np.bool_]]:
    """Return the coordinates where the pins close, from a near guess q, shape (n, m), and where they were found, (n,).

    Each angle is on its own: it is corrected as long as the corrections at least halve, which ends in their roundings.
    """
    last = np.full(len(q), np.inf)
    while True:
        correction = solved(equations.jacobian(q), _real(equations.open(q, placed)))
        length = equations.length(correction)
        halved = length < last / 2
        if not halved.any():
            return q, last < ROUGHLY * equations.size
        q = np.where(halved[:, None], q - correction, q)
        last = np.where(halved, length, last)


def rates(equations: System, q: Samples, J: Samples, v: Complex, a: Complex) -> tuple[Samples, Samples]:
    """Return the coordinates' velocities and accelerations, given the placed points': (1), derived once and twice.

    J q' = v and J q'' = a + R (theta'^2 u), the centripetal terms; all of shape (n, m).
    """
    velocity = solved(J, _real(v))
    turning = equations.angles(velocity)
    centripetal = np.einsum("jb,nb->nj", equations.R, turning**2 * equations.attitude(q))
    return velocity, solved(J, _real(a + centripetal))


def pin_forces(equations: System, J: Samples, force: Complex, moment: Samples) -> Complex:
    """Return what each pin does on the body pinned, shape (n, j), N, by J^T forces + Q = 0 (virtual work).

    `force` and `moment` about the foot, shape (n, b), are what the bodies carry without these pins, inertia included.
    """
    Q = np.einsum("bm,nb->nm", equations.D.conj(), force).real + np.einsum("bm,nb->nm", equations.E, moment)
    x, y = np.split(solved(J.transpose(0, 2, 1), -Q), 2, axis=1)
    forces: Complex = x + 1j * y
    return forces


def solved(A: Samples, b: Samples) -> Samples:
    """Return x of A x = b, shape (n, m), NaN where A is singular."""
    x = np.empty_like(b)
    try:
        x[:] = np.linalg.solve(A, b[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:  # of one, for all
        singular = np.linalg.slogdet(A)[0] == 0
        x[:] = solved(np.where(singular[:, None, None], np.nan, A), b)
    return x


def _real(complex_rows: Complex) -> Samples:
    """Return the real parts of the rows, axis 1, above the imaginary ones."""
    return np.concatenate([complex_rows.real, complex_rows.imag], axis=1)

"""The mathematics of a group that holds no dyad: joints that must close, by Newton's method, all positions at once.

The bodies' Cartesian coordinates q = (x, y, angle) of each body's first point are the unknowns, m of them; what the
group hangs on is placed and moves as it is told. The joints' constraints, and their derivatives by the time, are

    C(q) = 0,    J q' + placed = 0,    J q'' + placed + quadratic = 0,    J = dC / dq,                               (1)

m of them too, so that the transpose of J gives the forces of the joints: Nikravesh, "Computer-Aided Analysis of
Mechanical Systems" (1988), chapters 3 and 9.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.motion import Samples
from scenes.scene import GROUND

from .geometry import RigidBody, as_complex

CLOSED = 1e-10  # of the group's size: Newton's last correction, beyond which there are only roundings
ROUGHLY = 1e-7  # of the group's size: Newton's last correction; near lock, roundings grow to their square root, 1e-8
LONGEST = 0.1  # of the group's size: a rough sketch must not throw the bodies about
ITERATIONS = 200  # from the sketch

Complex: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True)
class PinJoint:
    """A pin of a larger group: at `point`, `body` hangs on the body `on` of the group, or on a placed point (None)."""

    point: str
    body: str
    on: str | None


@dataclass(frozen=True)
class SlideJoint:
    """A slide of a larger group: one of the two is a body of the group, the other is too, or is placed."""

    slider: str
    on: str


@dataclass(frozen=True)
class Group:
    """Bodies that only together have no freedom left, of class III or higher; P is the first pin among them."""

    bodies: tuple[str, ...]
    pins: tuple[PinJoint, ...]
    slides: tuple[SlideJoint, ...]
    P: str

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """Return what is placed and the group's joints are at: bodies, the ground among them, and points."""
        bodies = (name for slide in self.slides for name in (slide.slider, slide.on) if name not in self.bodies)
        return (*dict.fromkeys(bodies), *dict.fromkeys(f".{pin.point}" for pin in self.pins if pin.on is None))


@dataclass(frozen=True)
class Pose:
    """Where frames are: their first points, m, and their angles, rad, each of shape (n, frames)."""

    z: Complex
    angle: Samples

    @cached_property
    def u(self) -> Complex:
        """Return the attitudes exp(i angle)."""
        attitudes: Complex = np.exp(1j * self.angle)
        return attitudes


@dataclass(frozen=True)
class Placed:
    """What a group hangs on: frames, and how they move, each of shape (n, frames)."""

    pose: Pose
    v: Complex
    omega: Samples
    a: Complex
    alpha: Samples

    @classmethod
    def at_rest(cls, n: int, frames: int) -> "Placed":
        """Return frames in the origin."""
        plane, turn = np.zeros((3, n, frames), complex), np.zeros((3, n, frames))
        return cls(Pose(plane[0], turn[0]), plane[1], turn[1], plane[2], turn[2])


@dataclass(frozen=True)
class GroupEquations:
    """The constants of the joints, between the frames of the group's b bodies and, after them, of what they hang on.

    S and T say which frames a joint is between: -1 for the one that a pin hangs on or that a slider slides on, 1 for
    the other, else 0. R and E are, with the same signs, the arms in them: of the pin; of the slider's first point and
    of the guide's.
    """

    bodies: int  # b
    S: Samples  # (p, frames), pins
    R: Complex  # (p, frames), m
    T: Samples  # (s, frames), slides
    E: Complex  # (s, frames), m
    on: NDArray[np.intp]  # (s,), the frame that the guide is in
    along: Complex  # (s,), unit, in that frame
    size: float  # m, the longest arm

    def pose(self, q: Samples, placed: Pose) -> Pose:
        """Return all frames, those of the group at the coordinates q, shape (n, m)."""
        z, angle = in_plane(q)
        return Pose(np.concatenate([z, placed.z], axis=1), np.concatenate([angle, placed.angle], axis=1))

    def open(self, pose: Pose) -> Samples:
        """Return C, shape (n, m): of each pin the gap, x and y; of each slide the offset and the difference of angles.

        The offset is w x D, w the guide's direction and D from the guide's point to the slider's.
        """
        gap = _joined(self.S, pose.z) + _joined(self.R, pose.u)
        rows = [gap.real, gap.imag]
        if len(self.T):
            w, D = self._guides(pose)
            turned = np.remainder(_joined(self.T, pose.angle) + np.pi, 2 * np.pi) - np.pi
            rows += [(w.conj() * D).imag, turned]
        return np.concatenate(rows, axis=1)

    def jacobian(self, pose: Pose) -> Samples:
        """Return dC by the coordinates of all frames, shape (n, m, 3 frames)."""
        pins = _gradients(self.S, self.R, pose.u)
        rows = [pins.real, pins.imag]
        if len(self.T):
            w, D = self._guides(pose)
            offset = (w.conj()[:, :, None, None] * _gradients(self.T, self.E, pose.u)).imag
            offset[:, np.arange(len(self.on)), self.on, 2] -= (w.conj() * D).real  # the guide turns under the slider
            turned = np.zeros(offset.shape)
            turned[..., 2] = self.T
            rows += [offset, turned]
        jacobian = np.concatenate(rows, axis=1)
        return jacobian.reshape(*jacobian.shape[:2], 3 * jacobian.shape[2])

    def quadratic(self, pose: Pose, v: Complex, omega: Samples) -> Samples:
        """Return what C'' has besides J q'' of all frames, closed, shape (n, m).

        A guide's offset w x D turns into Im(conj(w) (D'' - 2 i w' D' - w'^2 D)); closed, D is along w and the last
        term has no imaginary part.
        """
        inward = -(omega**2) * pose.u
        pins = _joined(self.R, inward)
        rows = [pins.real, pins.imag]
        if len(self.T):
            w, _ = self._guides(pose)
            turning = omega[:, self.on]
            dD = _joined(self.T, v) + _joined(self.E, (1j * omega * pose.u))
            ddD = _joined(self.E, inward)
            offset = (w.conj() * (ddD - 2j * turning * dD)).imag
            rows += [offset, np.zeros(offset.shape)]
        return np.concatenate(rows, axis=1)

    def length(self, correction: Samples) -> Samples:
        """Return the largest move of a correction, shape (n,), m."""
        length: Samples = np.abs(correction * np.tile([1, 1, self.size], self.bodies)).max(axis=1)
        return length

    def _guides(self, pose: Pose) -> tuple[Complex, Complex]:
        """Return w and D of each slide, shape (n, s)."""
        return self.along * pose.u[:, self.on], _joined(self.T, pose.z) + _joined(self.E, pose.u)


def equations_of(scene: Scene, bodies: Mapping[str, RigidBody], group: Group) -> GroupEquations:
    """Return the joints of a group; the foot of each body is its first point."""
    index = {name: number for number, name in enumerate((*group.bodies, *group.hangs_on))}

    def arm(body: str, local: complex) -> complex:
        return local if body == GROUND else local - bodies[body].first

    S, R = np.zeros((len(group.pins), len(index))), np.zeros((len(group.pins), len(index)), complex)
    for number, pin in enumerate(group.pins):
        for name, sign in ((pin.body, 1), (pin.on or f".{pin.point}", -1)):
            S[number, index[name]] = sign
            R[number, index[name]] = sign * arm(name, bodies[name].local[pin.point]) if name in bodies else 0
    T, E = np.zeros((len(group.slides), len(index))), np.zeros((len(group.slides), len(index)), complex)
    along = []
    for number, joint in enumerate(group.slides):
        slide = scene.bodies[joint.slider].slide
        assert slide is not None
        T[number, index[joint.slider]], T[number, index[joint.on]] = 1, -1
        E[number, index[joint.on]] = -arm(joint.on, as_complex(slide.through))
        along.append(as_complex(slide.along))
    locals_ = [bodies[name].local.values() for name in group.bodies]
    size = max(abs(a - b) for local in locals_ for a in local for b in local) or 1.0  # bodies of one point have no arm
    on = np.array([index[joint.on] for joint in group.slides], np.intp)
    return GroupEquations(len(group.bodies), S, R, T, E, on, np.array(along, complex), size)


def assemble(equations: GroupEquations, q: Samples, placed: Pose) -> Samples:
    """Return the coordinates near a rough guess q, shape (1, m), where the joints close, if there are any."""
    for _ in range(ITERATIONS):
        correction = _correction(equations, q, placed)
        length = equations.length(correction)
        q = q - correction / np.maximum(1, length / (LONGEST * equations.size))[:, None]
        if not length >= ROUGHLY * equations.size:
            break
    return q


def refine(equations: GroupEquations, q: Samples, placed: Pose) -> tuple[Samples, NDArray[np.bool_]]:
    """Return the coordinates where the joints close, from a near guess q, shape (n, m), and whether they were found.

    Each position is on its own: it is corrected as long as the corrections at least halve, which ends in their
    roundings, or until the next one, about the square of the last, is sure to be below them.
    """
    last = np.full(len(q), np.inf)
    while True:
        correction = _correction(equations, q, placed)
        length = equations.length(correction)
        halved = (length < last / 2) & (last > CLOSED * equations.size)
        if not halved.any():
            return q, last < ROUGHLY * equations.size
        q = np.where(halved[:, None], q - correction, q)
        last = np.where(halved, length, last)


def rates(equations: GroupEquations, pose: Pose, placed: Placed) -> tuple[Samples, Samples]:
    """Return q' and q'', shape (n, m)."""
    b = equations.bodies
    everywhere = equations.jacobian(pose)
    J, J_placed = everywhere[:, :, : 3 * b], everywhere[:, :, 3 * b :]
    dq = solved(J, -np.einsum("nij,nj->ni", J_placed, coordinates(placed.v, placed.omega)))
    v, omega = (np.concatenate(pair, axis=1) for pair in zip(in_plane(dq), (placed.v, placed.omega), strict=True))
    driving = np.einsum("nij,nj->ni", J_placed, coordinates(placed.a, placed.alpha))
    return dq, solved(J, -driving - equations.quadratic(pose, v, omega))


def own_jacobian(equations: GroupEquations, pose: Pose) -> Samples:
    """Return dC / dq, shape (n, m, m)."""
    return equations.jacobian(pose)[:, :, : 3 * equations.bodies]


def joint_forces(
    equations: GroupEquations, J: Samples, force: Complex, moment: Samples
) -> tuple[Complex, Samples, Samples]:
    """Return what each pin does on the body pinned, N, shape (n, p), each guide on the slider, N and N m, shape (n, s).

    By J^T forces + Q = 0 (virtual work); `force` and `moment` about the first point, shape (n, b), are what the bodies
    carry without these joints, inertia included.
    """
    multipliers = solved(J.transpose(0, 2, 1), -coordinates(force, moment))
    p, s = len(equations.S), len(equations.T)
    x, y, guide_force, guide_moment = np.split(multipliers, [p, 2 * p, 2 * p + s], axis=1)
    return x + 1j * y, guide_force, guide_moment


def to_lock(equations: GroupEquations, J: Samples) -> Samples:
    """Return how much arms would have to be off for J to be singular, shape (n,), m: its least singular value.

    So it is by Eckart and Young's theorem when all its entries are arms: moves and differences of angles count as those
    of the group's longest arm.
    """
    p, s = len(equations.S), len(equations.T)
    rows = np.repeat([1.0, equations.size], [2 * p + s, s])
    arms = J * rows[:, None] * np.tile([equations.size, equations.size, 1], equations.bodies)
    least: Samples = np.linalg.svd(arms, compute_uv=False)[:, -1]
    return least


def solved(A: Samples, b: Samples) -> Samples:
    """Return x of A x = b, shape (n, m), NaN where A is singular."""
    x = np.empty_like(b)
    try:
        x[:] = np.linalg.solve(A, b[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:  # of one, for all
        singular = np.linalg.slogdet(A)[0] == 0
        x[:] = solved(np.where(singular[:, None, None], np.nan, A), b)
    return x


def in_plane(q: Samples) -> tuple[Complex, Samples]:
    """Return points and angles, each of shape (n, b), from coordinates of shape (n, 3 b), or their rates."""
    bodies = q.reshape(len(q), q.shape[1] // 3, 3)
    return bodies[..., 0] + 1j * bodies[..., 1], bodies[..., 2]


def coordinates(plane: Complex, turn: Samples) -> Samples:
    """Return x, y and angle of frame after frame, shape (n, 3 frames)."""
    return np.stack([plane.real, plane.imag, turn], axis=-1).reshape(len(plane), 3 * plane.shape[1])


def _correction(equations: GroupEquations, q: Samples, placed: Pose) -> Samples:
    pose = equations.pose(q, placed)
    return solved(own_jacobian(equations, pose), equations.open(pose))


def _joined(signed: Samples | Complex, x: Samples | Complex) -> Any:
    """Return sums over the frames of each joint, shape (n, joints); not a matrix product, whose rows depend on n."""
    return np.einsum("jf,nf->nj", signed, x)


def _gradients(incidence: Samples, arms: Complex, u: Complex) -> Complex:
    """Return the derivatives by x, y and the angle of each frame, shape (n, joints, frames, 3)."""
    gradients = np.empty((len(u), *incidence.shape, 3), complex)
    gradients[..., 0], gradients[..., 1] = incidence, 1j * incidence
    np.multiply(1j * arms, u[:, None, :], out=gradients[..., 2])
    return gradients

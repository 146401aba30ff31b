"""A group that holds no dyad, as equations: joints that must close, at all positions at once.

The bodies' Cartesian coordinates q = (x, y, angle) of each body's first point are the unknowns, m of them; what the
group hangs on is placed and moves as the drive has it. The joints' constraints, and their derivatives by the time, are

    C(q) = 0,    J q' + placed = 0,    J q'' + placed + quadratic = 0,    J = dC / dq,                               (1)

m of them too: Nikravesh, "Computer-Aided Analysis of Mechanical Systems" (1988), chapter 3.
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

    S and T mark the frames that a joint is between: -1 the one that a pin hangs on or that a slider slides on, 1 the
    other, else 0. R and E are, with the same signs, the arms in them: of the pin; of the slider's first point and of
    the guide's.
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
        length: Samples = np.abs(correction * self._arms).max(axis=1)
        return length

    @cached_property
    def _arms(self) -> Samples:
        """Return what a correction of each coordinate moves by, shape (m,), m."""
        return np.tile([1.0, 1.0, self.size], self.bodies)

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


def in_plane(q: Samples) -> tuple[Complex, Samples]:
    """Return points and angles, each of shape (n, b), from coordinates of shape (n, 3 b), or their rates."""
    bodies = q.reshape(len(q), q.shape[1] // 3, 3)
    return bodies[..., 0] + 1j * bodies[..., 1], bodies[..., 2]


def coordinates(plane: Complex, turn: Samples) -> Samples:
    """Return x, y and angle of frame after frame, shape (n, 3 frames)."""
    return np.stack([plane.real, plane.imag, turn], axis=-1).reshape(len(plane), 3 * plane.shape[1])


def _joined(signed: Samples | Complex, x: Samples | Complex) -> Any:
    """Return sums over the frames of each joint, shape (n, joints); not a matrix product, whose rows depend on n."""
    return np.einsum("jf,nf->nj", signed, x)


def _gradients(incidence: Samples, arms: Complex, u: Complex) -> Complex:
    """Return the derivatives by x, y and the angle of each frame, shape (n, joints, frames, 3)."""
    gradients = np.empty((len(u), *incidence.shape, 3), complex)
    gradients[..., 0], gradients[..., 1] = incidence, 1j * incidence
    np.multiply(1j * arms, u[:, None, :], out=gradients[..., 2])
    return gradients

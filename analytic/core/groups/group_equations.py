"""A group that holds no dyad, as equations: joints that must close, at all positions at once.

The bodies' Cartesian coordinates q = (x, y, angle) of each body's first point are the unknowns, m of them; what the
group hangs on is placed and moves as the drive has it. The joints' constraints, and their derivatives by the time, are

    C(q) = 0,    J q' + placed = 0,    J q'' + placed + quadratic = 0,    J = dC / dq,                               (1)

m of them too: Nikravesh, "Computer-Aided Analysis of Mechanical Systems" (1988), chapter 3.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.model.motion import Samples
from scenes.scene import GROUND

from ..geometry import RigidBody, as_complex, sketched_attitude
from ..numbers import Number, Vector, chosen, largest

Complex: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True)
class PinJoint:
    """A pin of a larger group: at `point`, `body` hangs on the body `on` of the group, or on a placed point (None)."""

    point: str
    body: str
    on: str | None


@dataclass(frozen=True)
class Group:
    """Bodies that only together have no freedom left, of class III or higher; P is the first pin among them."""

    bodies: tuple[str, ...]
    pins: tuple[PinJoint, ...]
    slides: tuple[tuple[str, str], ...]  # of a slider on a body, one of which is of the group, the other too or placed
    P: str
    drive: tuple[str, str] | None = None  # the driven body, and the moving one that it slides on, or turns against

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The placed bodies, the ground among them, and points that the group's joints are at; and last the drive."""
        joined = (*(name for slide in self.slides for name in slide), *(self.drive or ()))
        points = (f".{pin.point}" for pin in self.pins if pin.on is None)
        drive = ("drive",) if self.drive else ()
        return (*dict.fromkeys(name for name in joined if name not in self.bodies), *dict.fromkeys(points), *drive)


@dataclass(frozen=True)
class FramePoses:
    """Where frames are: their first points, m, and their angles, rad, each of shape (..., frames)."""

    z: Complex
    angle: Samples

    @cached_property
    def u(self) -> Complex:
        """Return the attitudes exp(i angle)."""
        attitudes: Complex = np.exp(1j * self.angle)
        return attitudes


@dataclass(frozen=True)
class Placed:
    """What a group hangs on: frames, and the rates of their coordinates, q' and q'', each of shape (..., 3 frames)."""

    pose: FramePoses
    dq: Samples
    ddq: Samples


@dataclass(frozen=True)
class GroupEquations:
    """The constants of the joints, between the frames of the group's b bodies and, after them, of what they hang on.

    S and A mark the frames that a joint is between: -1 the one that a pin hangs on or that a slider slides on, 1 the
    other, else 0. R has, with the same signs, the arms in them: of the pin; of the slider's first point and of the
    guide's. Where there is a drive, the last frame stands for it, and its x and its angle are the drive's position.
    """

    bodies: int  # b
    pins: int  # p
    S: Samples  # (p + s, frames), pins and then slides
    R: Complex  # (p + s, frames), m
    on: NDArray[np.intp]  # (s,), the frame that the guide is in
    along: Complex  # (s,), unit, in that frame
    size: float  # m, the longest arm
    A: Samples  # (t, frames), angles that add up to none: of slides; or of bodies that the drive turns, and the drive
    driven: NDArray[np.intp]  # (d,), the slide that the drive moves, if it moves one
    G: Samples  # (d, frames), -1 of the drive

    def pose(self, q: Samples, placed: FramePoses) -> FramePoses:
        """Return all frames, those of the group at the coordinates q, shape (..., m)."""
        z, angle = in_plane(q)
        return FramePoses(np.concatenate([z, placed.z], axis=-1), np.concatenate([angle, placed.angle], axis=-1))

    def open(self, pose: FramePoses) -> Samples:
        """Return C, shape (..., m): the gaps of pins, x and y; offsets of slides, angles, and how far off the drive is.

        Of a slide the vector D goes from the guide's point to the slider's, and w is the guide's direction: the
        offset is w x D, and the displacement w . D.
        """
        gap, D, w = self._joints(pose)
        seen = w.conj() * D
        turned = within_a_turn(_joined(self.A, pose.angle))
        moved = seen.real[..., self.driven] + _joined(self.G, pose.z.real)
        return np.concatenate([gap.real, gap.imag, seen.imag, turned, moved], axis=-1)

    def jacobian(self, pose: FramePoses) -> Samples:
        """Return dC by the coordinates of all frames, shape (..., m, 3 frames)."""
        _, D, w = self._joints(pose)
        (joints, frames), p = self.S.shape, self.pins
        offset, turned, moved = p + joints, p + joints + len(self.A), p + joints + len(self.A) + len(self.G)
        jacobian = np.zeros((*D.shape[:-1], moved, frames, 3))
        # Columns by frame (x, y, angle): S for the translations, i R u for the turns. A slide's rows are those of D,
        # seen in the guide's frame by conj(w); the guide's own turn takes D with it.
        turning = 1j * self.R * pose.u[..., None, :]
        jacobian[..., :p, :, 0] = jacobian[..., p : 2 * p, :, 1] = self.S[:p]
        jacobian[..., :p, :, 2], jacobian[..., p : 2 * p, :, 2] = turning.real[..., :p, :], turning.imag[..., :p, :]
        if len(self.on):
            turning[..., np.arange(p, joints), self.on] -= 1j * D  # the guide turns under the slider
            for column, gradient in enumerate((self.S[p:], 1j * self.S[p:], turning[..., p:, :])):
                seen = w.conj()[..., None] * gradient
                jacobian[..., 2 * p : offset, :, column] = seen.imag
                jacobian[..., turned:, :, column] = seen.real[..., self.driven, :]
        jacobian[..., offset:turned, :, 2] = self.A
        jacobian[..., turned:, :, 0] += self.G
        return jacobian.reshape(*jacobian.shape[:-2], 3 * frames)

    def quadratic(self, pose: FramePoses, v: Complex, omega: Samples) -> Samples:
        """The part of C'' besides J q'' of all frames, shape (..., m)."""
        # conj(w) D, of a guide's offset and displacement, turns into conj(w) (D'' - 2 i w' D' - w'^2 D).
        _, D, w = self._joints(pose)
        p, turning, inward = self.pins, omega[..., self.on], _joined(self.R, -(omega**2) * pose.u)
        gap, ddD = inward[..., :p], inward[..., p:]
        dD = _joined(self.S[p:], v) + _joined(self.R[..., p:, :], 1j * omega * pose.u)
        seen = w.conj() * (ddD - 2j * turning * dD - turning**2 * D)
        turned = np.zeros((*gap.shape[:-1], len(self.A)))
        return np.concatenate([gap.real, gap.imag, seen.imag, turned, seen.real[..., self.driven]], axis=-1)

    @cached_property
    def arms(self) -> Samples:
        """The moves by a unit of each coordinate, shape (m,), m."""
        return np.where(np.arange(3 * self.bodies) % 3 == 2, self.size, 1.0)

    def _joints(self, pose: FramePoses) -> tuple[Complex, Complex, Complex]:
        """Return the gap of each pin, shape (..., p), and D and w of each slide, shape (..., s)."""
        apart = _joined(self.S, pose.z) + _joined(self.R, pose.u)
        return apart[..., : self.pins], apart[..., self.pins :], self.along * pose.u[..., self.on]


def equations_of(scene: Scene, bodies: Mapping[str, RigidBody], group: Group) -> GroupEquations:
    """Return the joints of a group; the foot of each body is its first point."""
    index = {name: number for number, name in enumerate((*group.bodies, *group.hangs_on))}
    p, frames = len(group.pins), len(index)

    def arm(body: str, local: Vector) -> Vector:
        return local if body == GROUND else local - bodies[body].first

    S = np.zeros((p + len(group.slides), frames))
    R, along = np.zeros(S.shape, complex), np.zeros(len(group.slides), complex)
    for number, pin in enumerate(group.pins):
        for name, sign in ((pin.body, 1), (pin.on or f".{pin.point}", -1)):
            S[number, index[name]] = sign
            R[number, index[name]] = sign * arm(name, bodies[name].local[pin.point]) if name in bodies else 0
    on = np.array([index[carrier] for _, carrier in group.slides], np.intp)
    for number, (slider, carrier) in enumerate(group.slides):
        S[p + number, index[slider]], S[p + number, index[carrier]] = 1, -1
        R[p + number, index[carrier]] = -arm(carrier, as_complex(scene.slides[slider].through))
        along[number] = as_complex(scene.slides[slider].along)
    A, G = S[p:], np.zeros((0, frames))
    driven = np.zeros(0, np.intp)
    if group.drive is not None:
        drive = np.zeros((1, frames))
        drive[0, -1] = -1
        if scene.drive.slide is None:
            drive[0, [index[name] for name in group.drive]] = 1, -1
            A = np.append(A, drive, axis=0)
        else:
            G, driven = drive, np.array([group.slides.index(group.drive)])
    return GroupEquations(len(group.bodies), p, S, R, on, along, size_of(group, bodies), A, driven, G)


def within_a_turn(angle: Samples) -> Samples:
    """Angles less the whole turns that leave them next to zero, rad."""
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi


def size_of(group: Group, bodies: Mapping[str, RigidBody]) -> Number:
    """Return the longest arm of a group, m, or one where its bodies are of one point each."""
    locals_ = [bodies[name].local.values() for name in group.bodies]
    longest = largest(*(abs(a - b) for local in locals_ for a in local for b in local))
    return chosen(longest > 0, longest, 1.0)


def sketched_coordinates(scene: Scene, group: Group, bodies: Mapping[str, RigidBody]) -> list[Number]:
    """Return the m coordinates that lay each body on its sketched points with the least squares."""
    at = scene.drawn
    q: list[Number] = []
    for name in group.bodies:
        local = bodies[name].local
        shown = [point for point in local if point in at]
        u = sketched_attitude(scene, name, bodies)
        feet = [at[point] + u * (bodies[name].first - local[point]) for point in shown]
        feet = feet or list(at.values())  # of a body on a guide nothing need be shown
        foot = sum(feet) / len(feet)
        q += [foot.real, foot.imag, np.arctan2(u.imag, u.real)]
    return q


def in_plane(q: Samples) -> tuple[Complex, Samples]:
    """Return points and angles, each of shape (..., b), from coordinates of shape (..., 3 b), or their rates."""
    bodies = q.reshape(*q.shape[:-1], q.shape[-1] // 3, 3)
    return bodies[..., 0] + 1j * bodies[..., 1], bodies[..., 2]


def coordinates(plane: Complex, turn: Samples) -> Samples:
    """Return x, y and angle of frame after frame, shape (..., 3 frames)."""
    return np.stack([plane.real, plane.imag, turn], axis=-1).reshape(*plane.shape[:-1], 3 * plane.shape[-1])


def stacked(shape: tuple[int, ...], frames: Sequence[NDArray[Any]]) -> NDArray[Any]:
    """Return samples of one frame after the other, each of a shape or constant, with the frames as last axis."""
    together = np.empty((*shape, len(frames)), np.result_type(float, *frames))
    for frame, samples in enumerate(frames):
        together[..., frame] = samples
    return together


def _joined(signed: Samples | Complex, x: Samples | Complex) -> Any:
    """Return sums over the frames of each joint, shape (..., joints), row by row unlike a matrix product."""
    return np.einsum("...jf,...f->...j", signed, x)

"""A group that holds no dyad, as equations: joints that must close, at all positions at once.

The bodies' Cartesian coordinates q = (x, y, angle) of each body's first point are the unknowns, m of them; what the
group hangs on is placed and moves as the drive has it. The joints' constraints, and their derivatives by the time, are

    C(q) = 0,    J q' + placed = 0,    J q'' + placed + quadratic = 0,    J = dC / dq,                               (1)

m of them too: Nikravesh, "Computer-Aided Analysis of Mechanical Systems" (1988), chapter 3.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.model.motion import Samples
from scenes.scene import GROUND

from ..geometry import RigidBody, sketched_attitude
from ..numbers import Number, Vector, chosen, imag, largest, real
from .joints import GAPS, GroupJoint, Part

Complex: TypeAlias = NDArray[np.complex128]


@dataclass(frozen=True)
class Group:
    """Bodies that only together have no freedom left, of class III or higher; P is the first pin among them."""

    bodies: tuple[str, ...]
    joints: tuple[GroupJoint, ...]
    P: str

    @property
    def hangs_on(self) -> tuple[str, ...]:
        """The frames of its joints that are of none of its bodies: bodies, then points, and last a drive."""
        frames = dict.fromkeys(frame for joint in self.joints for frame in joint.frames if frame not in self.bodies)
        return tuple(sorted(frames, key=lambda frame: "./".find(frame[0])))

    @cached_property
    def parts(self) -> tuple[Part, ...]:
        """What each of its equations holds, in their order."""
        return tuple(sorted(part for joint in self.joints for part in joint.parts))

    @cached_property
    def rows(self) -> Mapping[GroupJoint, tuple[int, ...]]:
        """The equations of each joint."""
        order = sorted((part, number) for number, joint in enumerate(self.joints) for part in joint.parts)
        return {joint: tuple(order.index((part, n)) for part in joint.parts) for n, joint in enumerate(self.joints)}

    @cached_property
    def gaps(self) -> Mapping[str, list[int]]:
        """By joint, as messages call it, the equations that are lengths by which it is open; pins come last."""
        gaps = {joint: [row for row in rows if self.parts[row] in GAPS] for joint, rows in self.rows.items()}
        return {joint.label: gaps[joint] for joint in sorted(gaps, key=lambda joint: len(gaps[joint])) if gaps[joint]}


class Frames(Protocol):
    """Where frames are: arrays of samples, or of what is recorded of them, with the frames as last axis."""

    @property
    def z(self) -> Any:
        """Their first points, m."""

    @property
    def u(self) -> Any:
        """Their attitudes."""

    def turned(self, A: Samples) -> Any:
        """Sums of angles, by how often each counts, shape (t, frames), that are zero at whole turns."""


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

    def turned(self, A: Samples) -> Samples:
        """Return sums of angles, by how often each counts, shape (t, frames), less whole turns."""
        return within_a_turn(_joined(A, self.angle))


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

    def open(self, pose: Frames) -> Samples:
        """Return C, shape (..., m): the gaps of pins, x and y; offsets of slides, angles, and how far off the drive is.

        Of a slide the vector D goes from the guide's point to the slider's, and w is the guide's direction: the
        offset is w x D, and the displacement w . D.
        """
        gap, D, w = self._joints(pose)
        seen = w.conj() * D
        moved = real(seen)[..., self.driven] + _joined(self.G, real(pose.z))
        return np.concatenate([real(gap), imag(gap), imag(seen), pose.turned(self.A), moved], axis=-1)

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

    def _joints(self, pose: Frames) -> tuple[Complex, Complex, Complex]:
        """Return the gap of each pin, shape (..., p), and D and w of each slide, shape (..., s)."""
        apart = _joined(self.S, pose.z) + _joined(self.R, pose.u)
        return apart[..., : self.pins], apart[..., self.pins :], self.along * pose.u[..., self.on]


def equations_of(scene: Scene, bodies: Mapping[str, RigidBody], group: Group) -> GroupEquations:
    """Return the joints of a group; the foot of each body is its first point. Arms are objects where they are open."""
    index = {name: number for number, name in enumerate((*group.bodies, *group.hangs_on))}
    local = {name: body.local for name, body in bodies.items()}

    def arm(body: str, place: Vector) -> Vector:
        return place if body == GROUND else place - bodies[body].first

    found = ((joint.body, joint.way(scene, local, arm)) for joint in group.joints)
    ways = [(body, way) for body, way in found if way is not None]
    S, R = np.zeros((len(ways), len(index))), [[0j] * len(index) for _ in ways]
    for number, (_, way) in enumerate(ways):
        for (frame, place), sign in ((way.start, -1), (way.end, 1)):
            S[number, index[frame]], R[number][index[frame]] = sign, sign * place
    guided = [(body, way) for body, way in ways if way.along is not None]
    A = [[joint.turns.get(frame, 0.0) for frame in index] for joint in group.joints if joint.turns]
    driven = [joint for joint in group.joints if Part.along in joint.parts]
    G = [[-float(frame == joint.frames[-1]) for frame in index] for joint in driven]
    return GroupEquations(
        bodies=len(group.bodies),
        pins=len(ways) - len(guided),
        S=S,
        R=np.array(R).reshape(S.shape),
        on=np.array([index[way.start[0]] for _, way in guided], np.intp),
        along=np.array([way.along for _, way in guided]),
        size=size_of(group, bodies),
        A=np.array(A).reshape(-1, len(index)),
        driven=np.array([[body for body, _ in guided].index(joint.body) for joint in driven], np.intp),
        G=np.array(G).reshape(-1, len(index)),
    )


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
    drawn = scene.drawn
    q: list[Number] = []
    for name in group.bodies:
        local = bodies[name].local
        shown = [point for point in local if point in drawn]
        u = sketched_attitude(scene, name, bodies)
        feet = [drawn[point] + u * (bodies[name].first - local[point]) for point in shown]
        feet = feet or list(drawn.values())  # of a body on a guide nothing need be shown
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

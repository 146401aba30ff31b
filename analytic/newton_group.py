"""The mathematics of a group that holds no dyad: joints that must close, by Newton's method, all positions at once.

The bodies' Cartesian coordinates q = (x, y, angle) of each body's first point are the unknowns, m of them; what the
group hangs on is placed and moves as it is told. The joints' constraints, and their derivatives by the time, are

    C(q) = 0,    J q' + placed = 0,    J q'' + placed + quadratic = 0,    J = dC / dq,                               (1)

m of them too, so that the transpose of J gives the forces of the joints: Nikravesh, "Computer-Aided Analysis of
Mechanical Systems" (1988), chapters 3 and 9.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.motion import Samples
from scenes.scene import GROUND

from .geometry import RigidBody, as_complex

ROUGHLY = 1e-7  # of the group's size: Newton's last correction; near lock, roundings grow to their square root, 1e-8
LONGEST = 0.1  # of the group's size: a rough sketch must not throw the bodies about
ITERATIONS = 200  # from the sketch

Complex: TypeAlias = NDArray[np.complex128]
Indices: TypeAlias = NDArray[np.intp]


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
class Frames:
    """The first points and the angles of frames, and their first and second derivatives, each of shape (n, frames)."""

    z: Complex  # m
    angle: Samples  # rad
    v: Complex
    omega: Samples
    a: Complex
    alpha: Samples

    @classmethod
    def at_rest(cls, n: int, frames: int) -> "Frames":
        """Return frames in the origin."""
        plane, turn = np.zeros((3, n, frames), complex), np.zeros((3, n, frames))
        return cls(plane[0], turn[0], plane[1], turn[1], plane[2], turn[2])


@dataclass(frozen=True)
class System:
    """The constants of the joints, between the frames of the group's b bodies and then of what they hang on."""

    bodies: int  # b
    pins: Indices  # (p, 2): the frames
    arms: Complex  # (p, 2), m, of the pin in either
    slides: Indices  # (s, 2): of the slider and of what it slides on
    ends: Complex  # (s, 2), m: the slider's first point and the guide's, each in its own frame
    along: Complex  # (s,)
    size: float  # m, the longest arm

    def frames(self, q: Samples, placed: Frames) -> Frames:
        """Return all frames, those of the group at the coordinates q, shape (n, m), and at rest."""
        x, y, angle = np.moveaxis(q.reshape(len(q), self.bodies, 3), 2, 0)
        mine = replace(Frames.at_rest(len(q), self.bodies), z=x + 1j * y, angle=angle)
        return _joined(mine, placed)

    def moving(self, frames: Frames, dq: Samples, ddq: Samples) -> Frames:
        """Return the frames with those of the group moving."""
        (vx, vy, omega), (ax, ay, alpha) = (
            np.moveaxis(rate.reshape(len(rate), self.bodies, 3), 2, 0) for rate in (dq, ddq)
        )
        b = self.bodies
        mine = Frames(frames.z[:, :b], frames.angle[:, :b], vx + 1j * vy, omega, ax + 1j * ay, alpha)
        return _joined(mine, _rest(frames, b))

    def open(self, f: Frames) -> Samples:
        """Return C, shape (n, m): of each pin the gap, x and y; of each slide the offset and the difference of angles.

        The offset is w x D, w the guide's direction and D from the guide's point to the slider's.
        """
        pins = self._points(f, self.pins, self.arms)
        gap = pins[..., 1] - pins[..., 0]
        w, D = self._guides(f)
        turned = f.angle[:, self.slides[:, 0]] - f.angle[:, self.slides[:, 1]]
        turned = np.remainder(turned + np.pi, 2 * np.pi) - np.pi
        return np.concatenate([gap.real, gap.imag, (w.conj() * D).imag, turned], axis=1)

    def jacobian(self, f: Frames) -> Samples:
        """Return dC by the coordinates of all frames, shape (n, m, 3 frames)."""
        n, frames = f.z.shape
        u = np.exp(1j * f.angle)
        pins = np.zeros((n, len(self.pins), frames, 3), complex)
        number = np.arange(len(self.pins))
        for end, sign in ((0, -1), (1, 1)):
            at = self.pins[:, end]
            pins[:, number, at] += sign * _gradient(self.arms[:, end] * u[:, at])
        w, D = self._guides(f)
        offset, turned = np.zeros((2, n, len(self.slides), frames, 3))
        number = np.arange(len(self.slides))
        for end, sign in ((0, 1), (1, -1)):
            at = self.slides[:, end]
            offset[:, number, at] += sign * (w.conj()[..., None] * _gradient(self.ends[:, end] * u[:, at])).imag
            turned[:, number, at, 2] += sign
        offset[:, number, self.slides[:, 1], 2] -= (w.conj() * D).real  # the guide turns under the slider
        rows = np.concatenate([pins.real, pins.imag, offset, turned], axis=1)
        return rows.reshape(n, -1, 3 * frames)

    def quadratic(self, f: Frames) -> Samples:
        """Return what C'' has besides J q'' and the placed frames' accelerations, shape (n, m)."""
        u = np.exp(1j * f.angle)
        inward = -(f.omega[:, self.pins] ** 2) * self.arms * u[:, self.pins]
        pins = inward[..., 1] - inward[..., 0]
        w, D = self._guides(f)
        turning = f.omega[:, self.slides[:, 1]]
        r = self.ends * u[:, self.slides]
        rates = f.v[:, self.slides] + 1j * f.omega[:, self.slides] * r
        inward = -(f.omega[:, self.slides] ** 2) * r
        dD, ddD = rates[..., 0] - rates[..., 1], inward[..., 0] - inward[..., 1]
        offset = (w.conj() * (ddD - turning**2 * D - 2j * turning * dD)).imag
        return np.concatenate([pins.real, pins.imag, offset, np.zeros(offset.shape)], axis=1)

    def length(self, correction: Samples) -> Samples:
        """Return the largest move of a correction, shape (n,), m."""
        length: Samples = np.abs(correction * np.tile([1, 1, self.size], self.bodies)).max(axis=1)
        return length

    def _points(self, f: Frames, frames: Indices, arms: Complex) -> Complex:
        points: Complex = f.z[:, frames] + arms * np.exp(1j * f.angle[:, frames])
        return points

    def _guides(self, f: Frames) -> tuple[Complex, Complex]:
        """Return w and D of each slide, shape (n, s)."""
        ends = self._points(f, self.slides, self.ends)
        return self.along * np.exp(1j * f.angle[:, self.slides[:, 1]]), ends[..., 0] - ends[..., 1]


def system(scene: Scene, bodies: Mapping[str, RigidBody], group: Group) -> System:
    """Return the joints of a group; the foot of each body is its first point."""
    index = {name: number for number, name in enumerate((*group.bodies, *group.hangs_on))}

    def arm(body: str, local: complex) -> complex:
        return local if body == GROUND else local - bodies[body].first

    pins, arms = [], []
    for pin in group.pins:
        on = pin.on or f".{pin.point}"
        pins.append((index[on], index[pin.body]))
        arms.append(tuple(arm(x, bodies[x].local[pin.point]) if x in bodies else 0j for x in (on, pin.body)))
    slides, ends, along = [], [], []
    for joint in group.slides:
        slide = scene.bodies[joint.slider].slide
        assert slide is not None
        slides.append((index[joint.slider], index[joint.on]))
        ends.append((0j, arm(joint.on, as_complex(slide.through))))
        along.append(as_complex(slide.along))
    spans = [
        abs(a - b) for name in group.bodies for a in bodies[name].local.values() for b in bodies[name].local.values()
    ]
    return System(
        len(group.bodies),
        np.array(pins, np.intp).reshape(-1, 2),
        np.array(arms, complex).reshape(-1, 2),
        np.array(slides, np.intp).reshape(-1, 2),
        np.array(ends, complex).reshape(-1, 2),
        np.array(along, complex),
        max(spans),
    )


def assemble(equations: System, q: Samples, placed: Frames) -> Samples:
    """Return the coordinates near a rough guess q, shape (1, m), where the joints close, if there are any."""
    for _ in range(ITERATIONS):
        correction = _correction(equations, q, placed)
        length = equations.length(correction)
        q = q - correction / np.maximum(1, length / (LONGEST * equations.size))[:, None]
        if not length >= ROUGHLY * equations.size:
            break
    return q


def refine(equations: System, q: Samples, placed: Frames) -> tuple[Samples, NDArray[np.bool_]]:
    """Return the coordinates where the joints close, from a near guess q, shape (n, m), and whether they were found.

    Each position is on its own: it is corrected as long as the corrections at least halve, which ends in their
    roundings.
    """
    last = np.full(len(q), np.inf)
    while True:
        correction = _correction(equations, q, placed)
        length = equations.length(correction)
        halved = length < last / 2
        if not halved.any():
            return q, last < ROUGHLY * equations.size
        q = np.where(halved[:, None], q - correction, q)
        last = np.where(halved, length, last)


def rates(equations: System, f: Frames, J: Samples) -> tuple[Samples, Samples]:
    """Return q' and q'', shape (n, m), from frames of which only the placed ones move; J as of `own_jacobian`."""
    everywhere = equations.jacobian(f)[:, :, 3 * equations.bodies :]
    placed = _rest(f, equations.bodies)
    dq = solved(J, -np.einsum("nij,nj->ni", everywhere, _coordinates(placed.v, placed.omega)))
    moving = equations.moving(f, dq, np.zeros(dq.shape))
    driving = np.einsum("nij,nj->ni", everywhere, _coordinates(placed.a, placed.alpha))
    return dq, solved(J, -driving - equations.quadratic(moving))


def own_jacobian(equations: System, f: Frames) -> Samples:
    """Return dC / dq, shape (n, m, m)."""
    return equations.jacobian(f)[:, :, : 3 * equations.bodies]


def joint_forces(equations: System, J: Samples, force: Complex, moment: Samples) -> tuple[Complex, Samples, Samples]:
    """Return what each pin does on the body pinned, N, shape (n, p), each guide on the slider, N and N m, shape (n, s).

    By J^T forces + Q = 0 (virtual work); `force` and `moment` about the first point, shape (n, b), are what the bodies
    carry without these joints, inertia included.
    """
    multipliers = solved(J.transpose(0, 2, 1), -_coordinates(force, moment))
    p, s = len(equations.pins), len(equations.slides)
    x, y, guide_force, guide_moment = np.split(multipliers, [p, 2 * p, 2 * p + s], axis=1)
    return x + 1j * y, guide_force, guide_moment


def to_lock(equations: System, J: Samples) -> Samples:
    """Return the least singular value of J, shape (n,), m, angles being counted as moves of the group's longest arm.

    By Eckart and Young's theorem so much is J, in that sense, away from the next singular matrix.
    """
    p, s = len(equations.pins), len(equations.slides)
    rows = np.repeat([1.0, equations.size], [2 * p + s, s])
    scaled = J * rows[:, None] / np.tile([1, 1, equations.size], equations.bodies)
    least: Samples = np.linalg.svd(scaled, compute_uv=False)[:, -1]
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


def _correction(equations: System, q: Samples, placed: Frames) -> Samples:
    f = equations.frames(q, placed)
    return solved(own_jacobian(equations, f), equations.open(f))


def _gradient(r: Complex) -> Complex:
    """Return the derivatives of z + r by x, y and the angle, shape (..., 3)."""
    return np.stack([np.ones_like(r), np.full_like(r, 1j), 1j * r], axis=-1)


def _coordinates(plane: Complex, turn: Samples) -> Samples:
    """Return x, y and angle of frame after frame, shape (n, 3 frames)."""
    return np.stack([plane.real, plane.imag, turn], axis=-1).reshape(len(plane), -1)


def _joined(one: Frames, two: Frames) -> Frames:
    return Frames(*(np.concatenate(pair, axis=1) for pair in zip(vars(one).values(), vars(two).values(), strict=True)))


def _rest(f: Frames, start: int) -> Frames:
    return Frames(*(values[:, start:] for values in vars(f).values()))

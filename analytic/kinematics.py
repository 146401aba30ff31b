"""Position, velocity and acceleration of the whole linkage, group after group, for many positions at once."""

from dataclasses import dataclass, field, replace
from typing import NamedTuple, TypeAlias

import numpy as np

from scenes import Scene
from scenes.drive import Driven
from scenes.motion import Samples
from scenes.scene import GROUND

from .continuation import follow
from .decomposition import Decomposition, Guided, InnerPin, InnerSlide, Leg, Pinned, inner_joint
from .dyads import Vectors, as_vectors, closing, cross, dot, rrr_position, rrr_reach, slide_reach, turned
from .geometry import as_complex
from .newton_group import Frames, Group, rates

Plane: TypeAlias = tuple[Vectors, Vectors, Vectors]  # position, velocity, acceleration


class Closure(NamedTuple):
    """How a dyad closes, and locks where det is zero.

    At an inner pin, g is what a leg moves the pin by per unit of its freedom. RPP: the directions of both guides. RPR:
    the guide's normal, and from the second leg's pin to the first's.
    """

    g1: Vectors
    g2: Vectors
    det: Samples  # g1 x g2


@dataclass(frozen=True)
class Kinematics:
    """Where everything is and how it moves. Arrays of shape (n,), or of shape () for what does not change."""

    z: dict[str, Vectors] = field(default_factory=dict)  # points: position, m
    v: dict[str, Vectors] = field(default_factory=dict)  # m/s
    a: dict[str, Vectors] = field(default_factory=dict)  # m/s^2
    u: dict[str, Vectors] = field(default_factory=dict)  # bodies: attitude exp(i angle)
    omega: dict[str, Samples] = field(default_factory=dict)  # rad/s
    alpha: dict[str, Samples] = field(default_factory=dict)  # rad/s^2
    rate: dict[str, Vectors] = field(default_factory=dict)  # i alpha - omega^2
    foot: dict[str, str] = field(default_factory=dict)  # bodies: the point by which they were placed
    closure: dict[str, Closure] = field(default_factory=dict)  # dyads, by inner joint
    jacobian: dict[str, Samples] = field(default_factory=dict)  # larger groups, by inner joint: shape (n, m, m)
    reach: dict[str, Samples] = field(default_factory=dict)  # by inner joint: positive where the group can be assembled
    to_lock: dict[str, Samples] = field(default_factory=dict)  # dyads, by inner joint, m

    def direction(self, leg: Guided) -> Vectors:
        """Return the direction of a leg's guide in the plane."""
        return np.asarray(leg.t) if leg.on == GROUND else self.u[leg.on] * leg.t


def kinematics(scene: Scene, linkage: Decomposition, driven: Driven) -> Kinematics:
    """Solve position, velocity and acceleration at positions of the drive, shape (n,), rad or m.

    Where a group does not reach, its `reach` is negative and it and all that hangs on it are NaN.

    Raises:
        Failure: a larger group has no branch to follow, as `continuation.follow` says.
    """
    return _Solution(scene, linkage, driven).k


class _Solution:
    """One pass from the driver to the last group."""

    def __init__(self, scene: Scene, linkage: Decomposition, driven: Driven) -> None:
        self.scene, self.linkage = scene, linkage
        k = self.k = Kinematics()
        for point, xy in scene.ground.items():
            k.z[point], k.v[point], k.a[point] = np.array(as_complex(xy)), np.array(0j), np.array(0j)
        k.u[GROUND], k.omega[GROUND], k.alpha[GROUND] = np.array(1 + 0j), np.array(0.0), np.array(0.0)
        self.driver(linkage.driver, driven)
        for group in linkage.groups:
            if isinstance(group, InnerPin):
                self.inner_pin(group)
            elif isinstance(group, InnerSlide):
                self.inner_slide(group)
            else:
                self.larger(group, driven.position)

    def driver(self, driver: Leg, driven: Driven) -> None:
        if isinstance(driver, Pinned):
            u = np.exp(1j * driven.position)
            self.place(driver.body, driver.A, u, driven.rate, driven.acceleration)
            return
        first = self.scene.bodies[driver.body].points[0]
        k = self.k
        k.z[first] = np.asarray(driver.G + driver.t * driven.position, complex)
        k.v[first] = np.asarray(driver.t * driven.rate, complex)
        k.a[first] = np.asarray(driver.t * driven.acceleration, complex)
        self.place_on_guide(driver, first)

    # --- dyads

    def inner_pin(self, dyad: InnerPin) -> None:
        one, two = dyad.legs
        if isinstance(one, Pinned) and isinstance(two, Pinned):
            self.rrr(dyad, one, two)
        elif isinstance(one, Pinned) and isinstance(two, Guided):
            self.rrp(dyad, one, two)
        elif isinstance(one, Guided) and isinstance(two, Guided):
            self.prp(dyad, one, two)

    def rrr(self, dyad: InnerPin, one: Pinned, two: Pinned) -> None:
        A, B, P, k = one.A, two.A, dyad.P, self.k
        bar_1 = self.linkage.bodies[one.body].arm(A, P)
        bar_2 = self.linkage.bodies[two.body].arm(B, P)
        r1, r2 = abs(bar_1), abs(bar_2)
        d = k.z[B] - k.z[A]
        distance = np.abs(d)
        k.reach[P] = rrr_reach(r1, r2, distance)
        k.to_lock[P] = np.minimum((r1 + r2) - distance, distance - abs(r1 - r2))
        p, q, area = rrr_position(d, distance, r1, r2, k.reach[P], dyad.branch)
        closure = k.closure[P] = Closure(1j * p, 1j * q, area)

        w1, w2 = closing(k.v[B] - k.v[A], *closure)
        centripetal = (k.a[B] - w2**2 * q) - (k.a[A] - w1**2 * p)
        alpha_1, alpha_2 = closing(centripetal, *closure)
        self.place(one.body, A, p * (1 / bar_1), w1, alpha_1)
        self.place(two.body, B, q * (1 / bar_2), w2, alpha_2)

    def rrp(self, dyad: InnerPin, bar: Pinned, slider: Guided) -> None:
        """Solve in guide axes: P = C + s t on the slider, A + p on the bar; only s and the bar's angle are unknown."""
        A, P, k = bar.A, dyad.P, self.k
        arm = self.linkage.bodies[bar.body].arm(A, P)
        C, t = self.guide_through(slider, P), self.k.direction(slider)
        e = (C[0] - k.z[A]) * t.conjugate()
        k.reach[P] = slide_reach(abs(arm), e.imag)
        k.to_lock[P] = abs(arm) - np.abs(e.imag)
        p_t, p_n = dyad.branch * np.sqrt(k.reach[P]), e.imag
        s = p_t - e.real
        p = as_vectors(p_t, p_n) * t
        closure = k.closure[P] = Closure(1j * p, np.asarray(t), -p_t)

        base = self.carried(slider.on, C, s * t)
        omega, ds = closing(base[1] - k.v[A], *closure)
        a = base[2] + self.coriolis(slider.on, ds * t)
        alpha, dds = closing(a - (k.a[A] - omega**2 * p), *closure)
        k.z[P], k.v[P], k.a[P] = np.asarray(base[0]), np.asarray(base[1] + ds * t), np.asarray(a + dds * t)
        self.place_on_guide(slider, P)
        self.place(bar.body, A, as_vectors(p_t, p_n) * (t / arm), omega, alpha)

    def prp(self, dyad: InnerPin, one: Guided, two: Guided) -> None:
        P, k = dyad.P, self.k
        C1, C2 = self.guide_through(one, P), self.guide_through(two, P)
        t1, t2 = self.k.direction(one), self.k.direction(two)
        closure = k.closure[P] = Closure(t1, t2, cross(t1, t2))
        k.reach[P] = dyad.branch * closure.det
        k.z[P], k.v[P], k.a[P] = self.crossing(closure, one.on, C1, two.on, C2)
        self.place_on_guide(one, P)
        self.place_on_guide(two, P)

    def inner_slide(self, dyad: InnerSlide) -> None:
        one, two = dyad.legs
        if isinstance(one, Pinned):
            self.rpr(dyad, one, two)
        else:
            self.rpp(dyad, one, two)

    def rpr(self, dyad: InnerSlide, one: Pinned, two: Pinned) -> None:
        """With w the guide's direction, d = A1 - A2 has the side h across the guide, known, and sigma along it."""
        k, guide, name = self.k, dyad.guide, inner_joint(dyad)
        bodies = self.linkage.bodies
        feet = (guide.F - bodies[one.body].local[one.A]) - (guide.G - bodies[two.body].local[two.A])
        h = -cross(guide.t, np.asarray(feet))
        d, dd, ddd = (x[one.A] - x[two.A] for x in (k.z, k.v, k.a))
        distance = np.abs(d)
        k.reach[name] = slide_reach(distance, h)
        k.to_lock[name] = distance - np.abs(h)
        sigma = dyad.branch * np.sqrt(k.reach[name])
        w = d * as_vectors(sigma, -h) / (distance * distance)
        k.closure[name] = Closure(1j * w, d, -sigma)
        omega = cross(w, dd) / sigma
        slip = dot(w, dd) + omega * h
        alpha = (cross(w, ddd) - 2 * omega * slip + omega**2 * h) / sigma
        u = w * guide.t.conjugate()
        self.place(one.body, one.A, u, omega, alpha)
        self.place(two.body, two.A, u, omega, alpha)

    def rpp(self, dyad: InnerSlide, one: Guided, two: Pinned) -> None:
        """Turn the pinned leg with the outer guide; the other leg's point F then lies where its two guides cross."""
        k, inner = self.k, dyad.guide
        self.place(two.body, two.A, k.u[one.on], k.omega[one.on], k.alpha[one.on])
        t1, t2 = self.k.direction(one), self.k.direction(inner)
        closure = k.closure[inner_joint(dyad)] = Closure(t1, t2, cross(t1, t2))
        C1, C2 = self.fixed(one.on, one.G), self.fixed(two.body, inner.G - (inner.F - one.F))
        z, v, a = self.crossing(closure, one.on, C1, two.body, C2)
        body = self.linkage.bodies[one.body]
        first = self.scene.bodies[one.body].points[0]
        r = k.u[one.on] * (body.first - one.F)
        k.z[first], k.v[first] = z + r, v + 1j * k.omega[one.on] * r
        k.a[first] = a + turned(k.omega[one.on], k.alpha[one.on]) * r
        self.place_on_guide(one, first)

    # --- guides

    def guide_through(self, leg: Guided, P: str) -> Plane:
        """Return where P is, fixed to what the leg slides on, while the leg's displacement is zero."""
        return self.fixed(leg.on, leg.G + (self.linkage.bodies[leg.body].local[P] - leg.F))

    def fixed(self, body: str, local: complex) -> Plane:
        """Return a point fixed to a placed body, or the ground, at a place in its frame."""
        if body == GROUND:
            return np.array(local), np.array(0j), np.array(0j)
        k, foot = self.k, self.k.foot[body]
        r = k.u[body] * (local - self.linkage.bodies[body].local[foot])
        return k.z[foot] + r, k.v[foot] + 1j * k.omega[body] * r, k.a[foot] + k.rate[body] * r

    def carried(self, body: str, C: Plane, r: Vectors) -> Plane:
        """Return the point fixed to a body that is off another such point by r."""
        if body == GROUND:
            return C[0] + r, C[1], C[2]
        k = self.k
        return C[0] + r, C[1] + 1j * k.omega[body] * r, C[2] + k.rate[body] * r

    def coriolis(self, body: str, slip: Vectors) -> Vectors:
        """Return the acceleration of what slips along a guide that the body turns."""
        return np.array(0j) if body == GROUND else 2j * self.k.omega[body] * slip

    def crossing(self, closure: Closure, on_1: str, C1: Plane, on_2: str, C2: Plane) -> Plane:
        """Return the point that runs along two guides through C1 and C2, each fixed to a placed body."""
        t1, t2, _ = closure
        s1, s2 = closing(C2[0] - C1[0], *closure)
        one, two = self.carried(on_1, C1, s1 * t1), self.carried(on_2, C2, s2 * t2)
        ds1, ds2 = closing(two[1] - one[1], *closure)
        a1, a2 = one[2] + self.coriolis(on_1, ds1 * t1), two[2] + self.coriolis(on_2, ds2 * t2)
        dds1, _ = closing(a2 - a1, *closure)
        return one[0], one[1] + ds1 * t1, a1 + dds1 * t1

    # --- larger groups

    def larger(self, group: Group, position: Samples) -> None:
        linkage, k = self.linkage, self.k
        if group not in linkage.tracks:
            before = replace(linkage, groups=linkage.groups[: linkage.groups.index(group)])

            def placed_at(position: Samples) -> Frames:
                unit = Driven(position, np.ones(position.shape), np.zeros(position.shape))
                return _Solution(self.scene, before, unit).hung(group, len(position))

            linkage.tracks[group] = follow(self.scene, group, linkage.bodies, placed_at)
        track = linkage.tracks[group]
        frames, J = track.at(position, self.hung(group, len(position)))
        dq, ddq = rates(track.equations, frames, J)
        k.jacobian[group.P], k.reach[group.P] = J, np.where(np.isnan(J[:, 0, 0]), -1.0, 1.0)
        frames = track.equations.moving(frames, dq, ddq)
        for b, body in enumerate(group.bodies):
            foot = self.scene.bodies[body].points[0]
            if foot not in k.z:
                k.z[foot], k.v[foot], k.a[foot] = frames.z[:, b], frames.v[:, b], frames.a[:, b]
            self.place(body, foot, np.exp(1j * frames.angle[:, b]), frames.omega[:, b], frames.alpha[:, b])

    def hung(self, group: Group, n: int) -> Frames:
        """Return the frames of what the group hangs on; a point's stay parallel to the ground's."""
        k, frames = self.k, Frames.at_rest(n, len(group.hangs_on))
        for column, name in enumerate(group.hangs_on):
            if name in self.scene.bodies:
                local = self.linkage.bodies[name].first
                plane = self.fixed(name, local)
                turn = np.angle(k.u[name]), k.omega[name], k.alpha[name]
                frames.angle[:, column], frames.omega[:, column], frames.alpha[:, column] = turn
            elif name != GROUND:
                point = name.removeprefix(".")
                plane = k.z[point], k.v[point], k.a[point]
            else:
                continue
            frames.z[:, column], frames.v[:, column], frames.a[:, column] = plane
        return frames

    # --- bodies

    def place_on_guide(self, leg: Guided, foot: str) -> None:
        """Carry a leg's own points along with its placed point `foot`; it turns with what it slides on."""
        self.place(leg.body, foot, self.k.u[leg.on], self.k.omega[leg.on], self.k.alpha[leg.on])

    def place(self, body: str, foot: str, u: Vectors, omega: Samples, alpha: Samples) -> None:
        """Carry the body's own points along with its placed point `foot`."""
        k, linkage = self.k, self.linkage
        rate = turned(omega, alpha)
        k.u[body], k.omega[body], k.alpha[body], k.rate[body], k.foot[body] = u, omega, alpha, rate, foot
        for point in linkage.carries[body]:
            if point not in k.z:
                r = u * linkage.bodies[body].arm(foot, point)
                k.z[point] = k.z[foot] + r
                k.v[point] = k.v[foot] + r * (1j * omega)
                k.a[point] = k.a[foot] + r * rate

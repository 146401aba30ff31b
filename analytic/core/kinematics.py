"""Position, velocity and acceleration of the whole linkage, group after group, for many positions at once."""

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.drive import Driven, Samples
from scenes.scene import GROUND

from .decomposition import Guided, InnerPin, InnerSlide, Leg, Linkage, Pinned, kind
from .dyads import Vectors, as_vectors, closing, cross, dot, rrr_position, rrr_reach, slide_reach
from .groups.continuation import follow
from .groups.group_equations import FramePoses, Group, Placed, coordinates, in_plane, stacked
from .groups.newton_group import rates
from .numbers import Number, samples
from .placing import Closure, Kinematics, Placing, RRRPosition, Spin


def kinematics(
    scene: Scene, linkage: Linkage, driven: Driven, *, rates: bool = True, rrr: RRRPosition = rrr_position
) -> Kinematics:
    """Solve position and, with `rates`, velocity and acceleration at positions of the drive, shape (n,), rad or m.

    Where a group does not reach, its `reach` is negative and it and all that hangs on it are NaN.
    """
    return Pass(scene, linkage, driven, rates=rates, rrr=rrr).solve().k


def followed(scene: Scene, whole: Linkage) -> Linkage:
    """Return the linkage with the branch of every larger group, followed over the drive's way where it is not known."""
    known = dict(whole.tracks)
    for number, group in enumerate(whole.groups):
        if isinstance(group, Group) and group not in known:
            before = replace(whole, groups=whole.groups[:number], tracks=dict(known))
            with np.errstate(invalid="ignore", divide="ignore"):  # next to a singular configuration
                known[group] = follow(scene, whole.drive, group, whole.bodies, partial(placed, scene, before, group))
    return replace(whole, tracks=known)


def placed(scene: Scene, before: Linkage, group: Group, position: Samples) -> Placed:
    """The frames that a group hangs on, by a drive of rate one; `before` is all that is placed by then."""
    unit = Driven(position, np.ones(position.shape), np.zeros(position.shape))
    return Pass(scene, before, unit).solve().hung(group)


class Pass(Placing):
    """One pass from the driver to the last group."""

    def solve(self) -> "Pass":
        """Place everything."""
        if self.linkage.driver is not None:
            self.driver(self.linkage.driver)
        for group in self.linkage.groups:
            if isinstance(group, Group):
                self.larger(group)
            else:  # each kind of dyad has a method of its name
                getattr(self, kind(group).lower())(group, *group.legs)
        return self

    def driver(self, driver: Leg) -> None:
        """Place the driven body."""
        driven = self.driven
        spin = driven.rate.astype(self.real), driven.acceleration.astype(self.real)
        if isinstance(driver, Pinned):
            self.place(driver.body, driver.A, np.exp(1j * driven.position), spin if self.rates else None)
            return
        first = self.scene.bodies[driver.body].points[0]
        k = self.k
        k.z[first] = (driver.G + driver.t * driven.position).astype(self.complex)
        k.v[first], k.a[first] = ((driver.t * rate).astype(self.complex) for rate in spin)
        self.place_along(driver.body, first, driver.on)

    def rrr(self, dyad: InnerPin, leg_1: Pinned, leg_2: Pinned) -> None:
        """Place two bars; P follows from the three sides of their triangle."""
        A, B, P, k = leg_1.A, leg_2.A, dyad.P, self.k
        bar_1, bar_2 = self.bar(leg_1, P), self.bar(leg_2, P)
        r1, r2 = abs(bar_1), abs(bar_2)
        d = k.z[B] - k.z[A]
        distance = np.abs(d)
        k.reach[P] = rrr_reach(r1, r2, distance)
        k.to_lock[P] = np.minimum((r1 + r2) - distance, distance - abs(r1 - r2))
        p, q, area = self.arms(dyad, d, distance, r1, r2)
        k.closure[P] = Closure(1j * p, 1j * q, area)
        spin_1, spin_2 = self.spins(P, (leg_1, p), (leg_2, q)) if self.rates else (None, None)
        self.place_bar(leg_1, P, p, p * (1 / bar_1), spin_1)
        self.place_bar(leg_2, P, q, q * (1 / bar_2), spin_2)

    def arms(
        self, dyad: InnerPin, d: Vectors, distance: Samples, r1: Number, r2: Number
    ) -> tuple[Vectors, Vectors, Samples]:
        """Return the arms of two bars from their outer pins to the inner one, and p x q; the outer ones are d apart."""
        return self.rrr_position(d, distance, r1, r2, self.k.reach[dyad.P], dyad.branch)

    def spins(self, P: str, bar_1: tuple[Pinned, Vectors], bar_2: tuple[Pinned, Vectors]) -> tuple[Spin, Spin]:
        """Return how two bars turn, each given with its arm to the inner pin."""
        closure, (leg_1, p), (leg_2, q) = self.k.closure[P], bar_1, bar_2
        w1, w2 = closing(self.foot_v(leg_2, q) - self.foot_v(leg_1, p), *closure)
        # Both legs give the inner pin one acceleration: a_A + i alpha_1 p - w1^2 p = a_B + i alpha_2 q - w2^2 q, two
        # real equations for alpha_1 and alpha_2.
        centripetal = (self.foot_a(leg_2, q, w2) - w2**2 * q) - (self.foot_a(leg_1, p, w1) - w1**2 * p)
        alpha_1, alpha_2 = closing(centripetal, *closure)
        return (w1, alpha_1), (w2, alpha_2)

    def rrp(self, dyad: InnerPin, bar: Pinned, slider: Guided) -> None:
        """Solve in guide axes: P = C + s t on the slider, A + p on the bar; only s and the bar's angle are unknown."""
        A, P, k = bar.A, dyad.P, self.k
        arm = self.bar(bar, P)
        C, t = self.guide_through(slider, P), self.k.direction(slider)
        # From A to the guide's point C in guide axes: e.imag is the distance of A from the line, the bar's other side
        # follows from its length, with the sign of the branch.
        e = (C[0] - k.z[A]) * t.conjugate()
        k.reach[P] = slide_reach(abs(arm), e.imag)
        k.to_lock[P] = abs(arm) - np.abs(e.imag)
        p_t, p_n = dyad.branch * np.sqrt(k.reach[P]), e.imag
        s = p_t - e.real
        p = as_vectors(p_t, p_n) * t
        closure = k.closure[P] = Closure(1j * p, samples(t), -p_t)

        spin = None
        base = self.carried(slider.on, C, s * t)
        k.z[P] = samples(base[0])
        if self.rates:
            omega, ds = closing(base[1] - self.foot_v(bar, p), *closure)
            a = base[2] + self.coriolis(slider.on, ds * t)
            alpha, dds = closing(a - (self.foot_a(bar, p, omega) - omega**2 * p), *closure)
            k.v[P], k.a[P] = samples(base[1] + ds * t), samples(a + dds * t)
            spin = omega, alpha
        self.place_along(slider.body, P, slider.on)
        self.place_bar(bar, P, p, as_vectors(p_t, p_n) * (t / arm), spin)

    def prp(self, dyad: InnerPin, leg_1: Guided, leg_2: Guided) -> None:
        """Place two sliders, whose guides cross at P."""
        P, k = dyad.P, self.k
        C1, C2 = self.guide_through(leg_1, P), self.guide_through(leg_2, P)
        t1, t2 = self.k.direction(leg_1), self.k.direction(leg_2)
        closure = k.closure[P] = Closure(t1, t2, cross(t1, t2))
        k.reach[P] = dyad.branch * closure.det
        k.to_lock[P] = self.linkage.arm * k.reach[P]
        k.z[P], k.v[P], k.a[P] = self.crossing(closure, leg_1.on, C1, leg_2.on, C2)
        self.place_along(leg_1.body, P, leg_1.on)
        self.place_along(leg_2.body, P, leg_2.on)

    def rpr(self, dyad: InnerSlide, leg_1: Pinned, leg_2: Pinned) -> None:
        """With w the guide's direction, d = A1 - A2 has the side h across the guide, known, and sigma along it."""
        k, guide, name = self.k, dyad.guide, dyad.P
        bodies = self.linkage.bodies
        feet = (guide.F - bodies[leg_1.body].local[leg_1.A]) - (guide.G - bodies[leg_2.body].local[leg_2.A])
        h = -cross(guide.t, samples(feet))
        d = k.z[leg_1.A] - k.z[leg_2.A]
        distance = np.abs(d)
        k.reach[name] = slide_reach(distance, h)
        k.to_lock[name] = distance - np.abs(h)
        # w = d (sigma - i h) / |d|^2 is the guide's unit vector: d has the components sigma along and h across it. Its
        # rate follows from the part of d' across the guide.
        sigma = dyad.branch * np.sqrt(k.reach[name])
        w = d * as_vectors(sigma, -h) / (distance * distance)
        k.closure[name] = Closure(1j * w, d, -sigma)
        spin = None
        if self.rates:
            dd, ddd = k.v[leg_1.A] - k.v[leg_2.A], k.a[leg_1.A] - k.a[leg_2.A]
            omega = cross(w, dd) / sigma
            slip = dot(w, dd) + omega * h
            spin = omega, (cross(w, ddd) - 2 * omega * slip + omega**2 * h) / sigma
        u = w * guide.t.conjugate()
        self.place(leg_1.body, leg_1.A, u, spin)
        self.place(leg_2.body, leg_2.A, u, spin)

    def rpp(self, dyad: InnerSlide, leg_1: Guided, leg_2: Pinned) -> None:
        """Turn the pinned leg with the outer guide; the other leg's point F then lies where its two guides cross."""
        k, inner = self.k, dyad.guide
        self.place_along(leg_2.body, leg_2.A, leg_1.on)
        t1, t2 = self.k.direction(leg_1), self.k.direction(inner)
        closure = k.closure[dyad.P] = Closure(t1, t2, cross(t1, t2))
        k.reach[dyad.P] = dyad.branch * closure.det
        k.to_lock[dyad.P] = self.linkage.arm * k.reach[dyad.P]
        C1, C2 = self.fixed(leg_1.on, leg_1.G), self.fixed(leg_2.body, inner.G - (inner.F - leg_1.F))
        first = self.scene.bodies[leg_1.body].points[0]
        r = k.u[leg_1.on] * (self.linkage.bodies[leg_1.body].first - leg_1.F)
        crossing = self.crossing(closure, leg_1.on, C1, leg_2.body, C2)
        k.z[first], k.v[first], k.a[first] = self.carried(leg_1.on, crossing, r)
        self.place_along(leg_1.body, first, leg_1.on)

    def larger(self, group: Group) -> None:
        """Place a larger group by Newton's method from the nearest pose of its branch."""
        k, track, placed = self.k, self.linkage.tracks[group], self.hung(group)
        pose, J = track.at(*track.guess(self.driven.position), placed.pose)
        orders: list[NDArray[Any]] = [pose.z, pose.u]
        if self.rates:
            (v, omega), (a, alpha) = map(in_plane, rates(track.equations, pose, J, placed))
            orders += [v, a, omega, alpha]
        k.jacobian[group.P] = track.equations, pose, J[..., : 3 * len(group.bodies)]
        k.reach[group.P] = np.where(np.isnan(J[..., 0, 0]), -1.0, 1.0)
        for b, body in enumerate(group.bodies):
            z, u, *moving = (values[..., b] for values in orders)
            foot = self.scene.bodies[body].points[0]
            k.z.setdefault(foot, z)
            if self.rates:
                k.v.setdefault(foot, moving[0])
                k.a.setdefault(foot, moving[1])
            self.place(body, foot, u, (moving[2], moving[3]) if self.rates else None)

    def hung(self, group: Group) -> Placed:
        """Return the frames of what the group hangs on; a point's and the ground's do not turn."""
        k, still, frames = self.k, self.still, []
        for name in group.hangs_on:
            plane, turn = (still, still, still), (still.real, still.real, still.real)
            if name in self.scene.bodies:
                plane = self.fixed(name, self.linkage.bodies[name].first)
                turn = np.angle(k.u[name]), k.omega.get(name, still.real), k.alpha.get(name, still.real)
            elif name.startswith("/"):
                turn = self.driven[:3]
                plane = turn[0] + still, turn[1] + still, turn[2] + still
            elif name != GROUND:
                point = name.removeprefix(".")
                plane = k.z[point], k.v.get(point, still), k.a.get(point, still)
            frames.append((*plane, *turn))
        z, v, a, angle, omega, alpha = (
            stacked(self.driven.position.shape, values) for values in zip(*frames, strict=True)
        )
        return Placed(FramePoses(z, angle), coordinates(v, omega), coordinates(a, alpha))

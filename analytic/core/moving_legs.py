"""Legs of two bodies with the drive between them: a cylinder and its rod, or two bodies that the drive turns.

Such a leg goes from its outer pin to the inner one by an arm L, in the frame of the body with the outer pin, that the
drive changes. As a vector of the plane that is p = u L, u the attitude of that frame: with a bar's own terms it changes
by p (L' / L), and its rate by p (L'' / L) + 2 i omega p (L' / L).
"""

from typing import Any

import numpy as np

from scenes.drive import Samples

from .decomposition import Pinned
from .dyads import Vectors
from .geometry import as_complex
from .numbers import Vector, samples
from .placing import Placing, Spin


class MovingLegs(Placing):
    """Places bars, and legs that the drive changes; `changing` has L' / L and L'' / L of these."""

    def bar(self, leg: Pinned, P: str) -> Vector:
        """The arm of a leg from its outer pin to the inner one, m."""
        if leg.via is None:
            return self.linkage.bodies[leg.body].arm(leg.A, P)
        arm, rate, acceleration = self.arm(leg, P)
        self.changing[leg] = rate / arm, acceleration / arm
        return arm

    def arm(self, leg: Pinned, P: str) -> tuple[Vector, Vector, Vector]:
        """L, L' and L'' of a leg with the drive in it, m."""
        body, on, driven = self.scene.drive.body, self.scene.drive_on, self.driven
        x, rate, acceleration = driven.position, driven.rate, driven.acceleration
        b, c = self.linkage.bodies[body].local, self.linkage.bodies[on].local
        sign = 1 if leg.body == body else -1
        if (slide := self.scene.driven_slide) is not None:
            along = as_complex(slide.along)
            way = as_complex(slide.through) - self.linkage.bodies[body].first + along * x
            L = way + b[P] - c[leg.A] if sign > 0 else c[P] - b[leg.A] - way
            return L, sign * along * rate, sign * along * acceleration
        near, far = (c, b) if sign > 0 else (b, c)
        pin = next(point for point in near if point in far)
        swing = np.exp(1j * (sign * x)) * (far[P] - far[pin])
        turning = sign * rate * 1j
        return near[pin] - near[leg.A] + swing, turning * swing, (sign * acceleration * 1j + turning * turning) * swing

    def foot_v(self, leg: Pinned, p: Vectors) -> Vectors:
        """The velocity of the inner pin as the leg has it where it does not turn, m/s."""
        v = self.k.v[leg.A]
        return v if leg not in self.changing else samples(v + p * self.changing[leg][0])

    def foot_a(self, leg: Pinned, p: Vectors, omega: Samples) -> Vectors:
        """Its acceleration but for what a bar of constant length has, m/s^2."""
        a = self.k.a[leg.A]
        if leg not in self.changing:
            return a
        rate, acceleration = self.changing[leg]
        return samples(a + p * (acceleration + 2j * omega * rate))

    def place_bar(self, leg: Pinned, P: str, p: Vectors, u: Vectors, spin: Spin | None) -> None:
        """Place a leg whose arm is p, and whose body with the outer pin has the attitude u."""
        k = self.k
        if leg.via is None:
            self.place(leg.body, leg.A, u, spin)
            return
        self.place(leg.via, leg.A, u, spin)
        if P not in k.z:
            k.z[P] = k.z[leg.A] + p
            if spin is not None:
                k.v[P] = self.foot_v(leg, p) + p * (1j * spin[0])
                k.a[P] = self.foot_a(leg, p, spin[0]) + p * k.rate[leg.via]
        if self.scene.driven_slide is None:
            sign: Any = 1 if leg.body == self.scene.drive.body else -1
            u = u * np.exp(1j * (sign * self.driven.position))
            if spin is not None:
                spin = spin[0] + sign * self.driven.rate, spin[1] + sign * self.driven.acceleration
        self.place(leg.body, P, u, spin)

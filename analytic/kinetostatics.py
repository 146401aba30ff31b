"""Reactions of every pin and guide and the drive's torque, group after group, last first (d'Alembert's principle).

A group is statically determinate once the groups that hang on it have passed on their pull. Section 3 of Yang (2023),
doi:10.56578/jisc020103, sets up the same balance body by body.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from scenes import Scene
from scenes.motion import Samples

from .decomposition import RRP, RRR, Decomposition
from .dyads import Vectors, as_vectors, cross, rrr_force
from .geometry import as_complex
from .kinematics import Kinematics
from .newton_group import Group, pin_forces


@dataclass
class Reactions:
    """What holds the bodies and drives them; arrays of shape (n,)."""

    pin: dict[tuple[str, str], Vectors] = field(default_factory=dict)  # (point, body): force of the pin on the body, N
    guide: dict[str, tuple[Samples, Samples]] = field(default_factory=dict)  # slider: force, N; moment, N m
    torque: Samples = field(default_factory=lambda: np.zeros(()))  # N m


def kinetostatics(scene: Scene, linkage: Decomposition, k: Kinematics) -> Reactions:
    """Return all reactions, and the torque that keeps the crank at its speed."""
    balance = _Balance(scene, linkage, k)
    for group in reversed(linkage.groups):
        if isinstance(group, RRR):
            balance.rrr(group)
        elif isinstance(group, RRP):
            balance.rrp(group)
        else:
            balance.larger(group)
    balance.crank()
    return balance.found


@dataclass(frozen=True)
class _Balance:
    """One pass from the last group to the crank."""

    scene: Scene
    linkage: Decomposition
    k: Kinematics
    found: Reactions = field(default_factory=Reactions)

    def rrr(self, dyad: RRR) -> None:
        A, B, P, pin = dyad.A, dyad.B, dyad.P, self.found.pin
        force_1, moment_1 = self.applied(dyad.body_1, A)
        force_2, moment_2 = self.applied(dyad.body_2, B)
        R = rrr_force(moment_1, moment_2, *self.k.arms[P])
        self.hold(dyad.body_1, P, R)
        self.hold(dyad.body_2, P, -R)
        pin[A, dyad.body_1] = -(force_1 + R)
        pin[B, dyad.body_2] = R - force_2

    def rrp(self, dyad: RRP) -> None:
        """In guide axes: the slider's balance along t gives R . t, the bar's moment about A then gives R . n."""
        A, P, t = dyad.A, dyad.P, dyad.t
        force_s, moment_s = self.applied(dyad.slider, dyad.first)
        force_b, moment_b = self.applied(dyad.bar, A)
        p_t, p_n = self.k.guide[P]
        on_guide = force_s * t.conjugate()
        R_t = on_guide.real
        R_n = (p_n * R_t - moment_b) / p_t
        R = t * as_vectors(R_t, R_n)  # of the slider on the bar
        self.hold(dyad.bar, P, R)
        self.hold(dyad.slider, P, -R)
        self.found.pin[A, dyad.bar] = -(force_b + R)
        arm = self.linkage.bodies[dyad.slider].arm(dyad.first, P)
        self.found.guide[dyad.slider] = R_n - on_guide.imag, cross(arm, R) - moment_s

    def larger(self, group: Group) -> None:
        equations, J = self.linkage.tracks[group].equations, self.k.jacobian[group.P]
        force, moment = np.zeros((len(J), len(group.bodies)), complex), np.zeros((len(J), len(group.bodies)))
        for b, body in enumerate(group.bodies):
            force[:, b], moment[:, b] = self.applied(body, self.scene.bodies[body].points[0])
        R = pin_forces(equations, J, force, moment)
        for joint, on_body in zip(group.joints, R.T, strict=True):
            self.hold(joint.body, joint.point, on_body)
            if joint.on is not None:
                self.hold(joint.on, joint.point, -on_body)
        for b, body in enumerate(group.bodies):
            slide = self.scene.bodies[body].slide
            if slide is not None:
                total = force[:, b] + np.einsum("j,nj->n", equations.S[:, b], R)
                turning = moment[:, b] + cross(equations.R[:, b], R).sum(axis=1)
                self.found.guide[body] = -cross(as_complex(slide.along), total), -turning

    def crank(self) -> None:
        body, pivot = self.linkage.crank.body, self.linkage.crank.pivot
        force, moment = self.applied(body, pivot)
        self.found.pin[pivot, body] = -force
        self.found.torque = -moment

    def hold(self, body: str, point: str, force: Vectors) -> None:
        """Add the inner pin's force to what the body already takes from the bodies that hang on that pin."""
        pin = self.found.pin
        pin[point, body] = pin[point, body] + force if (point, body) in pin else force

    def applied(self, body: str, foot: str) -> tuple[Vectors, Samples]:
        """Return the force on a body, and its moment about `foot`, of all but the joints of its own group."""
        rigid, k = self.linkage.bodies[body], self.k
        r = k.u[body] * rigid.com_arm(foot)
        force = -rigid.mass * (k.a[foot] + r * k.rate[body])
        moment = cross(r, force) - rigid.inertia * k.alpha[body]
        for arm, push in self.pushes(body, foot, r):
            force = force + push
            moment = moment + cross(arm, push)
        return force, moment

    def pushes(self, body: str, foot: str, com: Vectors) -> Iterator[tuple[Vectors, Vectors]]:
        """Yield weight, loads and the pull at the pins that the body carries, each with its arm from `foot`."""
        z, pin = self.k.z, self.found.pin
        if self.scene.gravity is not None:
            yield com, np.array(self.linkage.bodies[body].mass * as_complex(self.scene.gravity))
        for load in self.scene.loads:
            if load.body == body:
                yield z[load.at] - z[foot], np.array(as_complex(load.force))
        for point in self.linkage.carries[body]:
            solved = [pin[point, other] for other in self.scene.owners[point] if (point, other) in pin]
            if solved:
                pin[point, body] = -sum(solved[1:], start=solved[0])
                yield z[point] - z[foot], pin[point, body]

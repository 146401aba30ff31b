"""Reactions of every pin and guide and the drive's effort, group after group, last first (d'Alembert's principle).

A group is statically determinate once the groups that hang on it have passed on their pull. Section 3 of Yang (2023),
doi:10.56578/jisc020103, sets up the same balance body by body.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from scenes.model.motion import Samples

from .decomposition import Dyad, Guided, InnerPin, InnerSlide, Leg, Pinned
from .dyads import Vectors, cross, dot, inner_force
from .elements import ActingForce, Loading
from .geometry import as_complex
from .groups.group_equations import Group, coordinates, stacked
from .groups.newton_group import solved
from .numbers import samples


@dataclass
class Reactions:
    """What holds the bodies and drives them; arrays of shape (n,)."""

    pin: dict[tuple[str, str], Vectors] = field(default_factory=dict)  # (point, body): force of the pin on the body, N
    guide: dict[str, tuple[Samples, Samples]] = field(default_factory=dict)  # slider: force, N; moment, N m
    effort: Samples = field(default_factory=lambda: np.zeros(()))  # torque, N m, or force, N
    friction: dict[str, Samples] = field(default_factory=dict)  # by channel, N m or N, and its power
    others: dict[str, Samples] = field(default_factory=dict)  # by channel, of joints that are neither pins nor guides


@dataclass(frozen=True)
class Balance(Loading):
    """One pass from the last group to the driver."""

    reactions: Reactions = field(default_factory=Reactions)
    far: dict[str, tuple[Vectors, Samples]] = field(default_factory=dict)  # of legs with the drive in them, at P
    slid_on: dict[str, list[ActingForce]] = field(default_factory=dict)  # by body: of the guides of other groups
    alone: Mapping[str, ActingForce] | None = None  # by body: in place of all other loads, and of inertia

    def solve(self) -> Reactions:
        """Return the reactions and the effort of the drive."""
        for group in reversed(self.linkage.groups):
            self.balance(group)
        if self.linkage.driver is not None:
            self.balance(self.linkage.driver)
        return self.reactions

    def balance(self, group: Dyad | Group | Leg) -> None:
        """Balance a group, or the driven body."""
        kinds: dict[type, Callable[[Any], None]]
        kinds = {InnerPin: self.inner_pin, InnerSlide: self.inner_slide, Group: self.larger}
        kinds.get(type(group), self.driver)(group)

    def inner_pin(self, dyad: InnerPin) -> None:
        """Balance a dyad with an inner pin."""
        leg_1, leg_2 = dyad.legs
        # Each leg has one freedom about its outer joint. Virtual work on both freedoms gives the inner pin's force; the
        # outer joints then hold what is left over of each leg.
        applied = [self.on_leg(leg, dyad.P) for leg in dyad.legs]
        Q1, Q2 = (self.on_freedom(leg, *load) for leg, load in zip(dyad.legs, applied, strict=True))
        R = self.pull(dyad, Q1, Q2)
        self.hold(leg_1.body, dyad.P, R)
        self.hold(leg_2.body, dyad.P, -R)
        for leg, (force, moment), on_leg in zip(dyad.legs, applied, (R, -R), strict=True):
            if isinstance(leg, Pinned):
                self.reactions.pin[leg.A, leg.via or leg.body] = -(force + on_leg)
                if leg.via is not None:
                    self.between(leg, dyad.P, on_leg)
            else:
                arm = self.k.z[dyad.P] - self.k.z[self.foot(leg)]
                self.outer_guide(leg, force + on_leg, moment + cross(arm, on_leg))

    def pull(self, dyad: InnerPin, Q1: Samples, Q2: Samples) -> Vectors:
        """Return the force of the second leg on the first one at the inner pin, given each leg's generalised force."""
        return inner_force(Q1, Q2, *self.k.closure[dyad.P])

    def inner_slide(self, dyad: InnerSlide) -> None:
        """Balance a dyad with an inner slide."""
        leg_1, leg_2 = dyad.legs
        force_1, moment_1 = self.applied(leg_1.body, self.foot(leg_1))
        force_2, moment_2 = self.applied(leg_2.body, leg_2.A)
        g1, g2, det = self.k.closure[dyad.P]
        if isinstance(leg_1, Pinned):
            # The inner guide's force is normal to it. Two pinned legs, which turn together: N from the sum of moments
            # about both feet. One leg on an outer guide: N from the force along that guide.
            n, N = g1, (moment_1 + moment_2) / -det
        else:  # the normal of the inner guide is square to it, what is left over goes along the outer guide's normal
            n, N = 1j * g2, dot(g1, force_1) / det
        on_1 = n * N
        self.reactions.pin[leg_2.A, leg_2.body] = on_1 - force_2
        # Where either leg's balance gives M, take the slider's: its own lever is the short one, often none.
        place = self.k.z[self.scene.bodies[dyad.guide.slider].points[0]]
        if dyad.guide.slider == leg_1.body and isinstance(leg_1, Pinned):
            M = -moment_1 - cross(place - self.k.z[leg_1.A], on_1)
        else:
            M = moment_2 - cross(place - self.k.z[leg_2.A], on_1)
        self.channel(dyad.guide, N, M)
        if isinstance(leg_1, Pinned):
            self.reactions.pin[leg_1.A, leg_1.body] = -(force_1 + on_1)
        else:
            self.outer_guide(leg_1, force_1 + on_1, moment_1 + cross(place - self.k.z[self.foot(leg_1)], on_1) + M)

    def foot(self, leg: Leg) -> str:
        """Return the point about which a leg's moments are taken."""
        return leg.A if isinstance(leg, Pinned) else self.scene.bodies[leg.body].points[0]

    def on_leg(self, leg: Leg, P: str) -> tuple[Vectors, Samples]:
        """Return the force on a leg, and its moment about the foot, of all but the joints of its own group."""
        if not (isinstance(leg, Pinned) and leg.via):
            return self.applied(leg.body, self.foot(leg))
        force, moment = self.far[leg.body] = self.applied(leg.body, P)
        near, about_foot = self.applied(leg.via, leg.A)
        return near + force, about_foot + moment + cross(self.k.z[P] - self.k.z[leg.A], force)

    def between(self, leg: Pinned, P: str, at_pin: Vectors) -> None:
        """Balance what a leg with the drive in it has beyond that, given the force at its inner pin."""
        scene, k, drive = self.scene, self.k, leg.drive
        assert drive is not None, "only of a leg with one"
        force, moment = self.far[leg.body]
        force = force + at_pin
        body, sign = drive.body, 1 if leg.body == drive.body else -1
        if (slide := drive.slide) is not None:
            t = k.u[slide.on] * as_complex(slide.along)
            about_first = moment + cross(k.z[P] - k.z[scene.bodies[body].points[0]], force)
            self.reactions.guide[body] = -sign * cross(t, force), -sign * about_first
            self.reactions.effort = -sign * dot(t, force)
            return
        pin = next(point for point in scene.bodies[body].points if point in scene.bodies[drive.on].points)
        for name, on_body in ((leg.body, -force), (leg.via or "", force)):
            self.hold(name, pin, on_body)
        self.reactions.effort = -sign * (moment + cross(k.z[P] - k.z[pin], force))

    def on_freedom(self, leg: Leg, force: Vectors, moment: Samples) -> Samples:
        """Return the generalised force on a leg's own freedom: to turn, or to move along the guide."""
        return moment if isinstance(leg, Pinned) else dot(self.k.direction(leg), force)

    def outer_guide(self, leg: Guided, force: Vectors, moment: Samples) -> None:
        """Let a leg's guide hold what acts on the leg, the moment about the leg's foot."""
        t = self.k.direction(leg)
        N = -cross(t, force)
        place = self.k.z[self.scene.bodies[leg.slider].points[0]]
        reaction = 1j * t * N
        M = -moment if leg.slider == leg.body else -moment - cross(place - self.k.z[self.foot(leg)], reaction)
        self.channel(leg, N, M)
        self.slid_on.setdefault(leg.on, []).append(ActingForce(-reaction, place, -M))

    def channel(self, leg: Guided, N: Samples, M: Samples) -> None:
        """Keep what a guide does on the leg as what it does on the slider, which may be the other body."""
        sign = 1 if leg.slider == leg.body else -1
        self.reactions.guide[leg.slider] = sign * N, sign * M

    def larger(self, group: Group) -> None:
        """Balance a larger group by the transpose of its Jacobian: J^T forces + loads = 0, by virtual work."""
        _, _, J = self.k.jacobian[group.P]
        applied = [self.applied(body, self.scene.bodies[body].points[0]) for body in group.bodies]
        loads = coordinates(*(stacked(J.shape[:-2], values) for values in zip(*applied, strict=True)))
        self.spread(group, np.moveaxis(solved(np.swapaxes(J, -1, -2), -loads), -1, 0))

    def spread(self, group: Group, multipliers: Iterable[Any]) -> None:
        """Let a group's joints pass on what they do, by the multipliers of its constraints in their order."""
        rows = [*multipliers]
        for joint, numbers in group.rows.items():
            joint.act(self, group.bodies, *(rows[number] for number in numbers))

    def pass_on(self, ends: Iterable[str], bodies: Sequence[str], force: Any, moment: Any) -> None:
        """Leave what a joint of a group does to its first end, and the reaction on the other, to the placed of both.

        The force, N, acts at the first point of the first end, and the moment, N m, is about that.
        """
        first, second = ends
        place = self.k.z[self.scene.bodies[first].points[0]]
        for body, sign in ((second, -1), (first, 1)):
            if body not in bodies:
                self.slid_on.setdefault(body, []).append(ActingForce(sign * force, place, sign * moment))

    def driver(self, leg: Leg) -> None:
        """Balance the driven body, and find the effort of the drive."""
        force, moment = self.applied(leg.body, self.foot(leg))
        self.reactions.effort = -self.on_freedom(leg, force, moment)
        if isinstance(leg, Pinned):
            self.reactions.pin[leg.A, leg.body] = -force
        else:
            self.outer_guide(leg, force, moment)

    def hold(self, body: str, point: str, force: Vectors) -> None:
        """Add the inner pin's force to what the body already takes from the bodies that hang on that pin."""
        pin = self.reactions.pin
        pin[point, body] = pin[point, body] + force if (point, body) in pin else force

    def applied(self, body: str, foot: str) -> tuple[Vectors, Samples]:
        """Return the force on a body, and its moment about `foot`, of all but the joints of its own group."""
        if self.alone is not None:
            alone = [self.alone[body]] if body in self.alone else []
            return resultant(alone, self.k.z[foot], samples(0j), samples(0.0))
        rigid, k = self.linkage.bodies[body], self.k
        r = k.u[body] * (rigid.com - rigid.local[foot])
        # d'Alembert: inertia force at the centre of mass, its moment about the foot, and the couple -I alpha.
        force = -rigid.mass * (k.a[foot] + r * k.rate[body])
        moment = cross(r, force) - rigid.inertia * k.alpha[body]
        if self.scene.gravity is not None:
            weight = samples(rigid.mass * as_complex(self.scene.gravity))
            force, moment = force + weight, moment + cross(r, weight)
        acting = (*self.outside.get(body, ()), *self.at_pins(body), *self.slid_on.get(body, ()))
        return resultant(acting, k.z[foot], force, moment)

    def at_pins(self, body: str) -> list[ActingForce]:
        """The pull at the pins that the body carries of the groups that are balanced, which is kept."""
        pin, pulls = self.reactions.pin, []
        for point in self.linkage.carries[body]:
            solved = [pin[point, other] for other in self.scene.owners[point] if (point, other) in pin]
            if solved:
                pin[point, body] = -sum(solved[1:], start=solved[0])
                pulls.append(ActingForce(pin[point, body], self.k.z[point]))
        return pulls


def resultant(acting: Iterable[ActingForce], foot: Vectors, force: Vectors, moment: Samples) -> tuple[Vectors, Samples]:
    """The sum of forces, and of their moments about a foot, from one of each on."""
    for force_on in acting:
        force = force + force_on.force
        moment = moment + cross(force_on.at - foot, force_on.force) + force_on.moment
    return force, moment

"""Causes in the forces on a right motion that are no numbers of the scene: where and when loads act, and friction.

None of them moves anything. What acts on a body besides, its joints carry, with the Jacobian of the constraints at the
motion as it should be:

    J^T λ = M q'' - Q.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from scenes import Motion
from scenes.channels import Role
from scenes.elements.element import Element
from scenes.elements.friction import Friction, GuideFriction, PinFriction
from scenes.elements.loads import Load
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import GROUND

from ...mechanics import friction
from ...mechanics.bodies import weights
from ...mechanics.contacts import CONTACTS
from ...mechanics.elements import Push, generalised, of_element, weight
from ...mechanics.motion_vectors import MotionVectors
from .cause import Cause, Kind
from .evidence import MAX_REST_TRIED, Channels, Evidence, Hypothesis
from .scene_numbers import kind_of

ROUNDS = 8  # of friction by the joints' forces: what each leaves over is some thousandths of that before
ROWS_LATE = (0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0)


@dataclass(frozen=True)
class Carried(MotionVectors):
    """What the joints of a right motion carry, as it should be."""

    evidence: Evidence = field(kw_only=True)

    @cached_property
    def _inverse(self) -> NDArray[np.float64]:
        """That of the Jacobian, by the units of the constraints, shape (n, coordinates, channels)."""
        constraints = self.evidence.reference.mechanics.constraints
        closed = [constraints.closed(part).inverse for part in constraints.blocks(self.motion)]
        return np.asarray(np.concatenate(closed) / constraints.units)

    def change(self, *pushes: Push) -> Channels:
        """Return by how much the force channels change where bodies are pushed, and friction by its law with them.

        The law is repeated, as the joints carry friction.
        """
        true, rubbing = self.motion.samples, self.scene.channels.names(Role.friction)
        # A fixed point: friction follows from the joint forces, and these from friction. Joint forces are those as they
        # should be, less what friction was part of, plus the pushes, plus the friction of the round before. It
        # converges as a geometric series, whose ratio is about the coefficient of friction times the ratio of pin to
        # link.
        before, pushed = self._of(*self.resisting), self._of(*pushes)
        now = {**true}
        for _ in range(ROUNDS if rubbing else 1):
            now |= friction.by_law(replace(self, motion=Motion(now)), now)
            resisted = self._of(*replace(self, motion=Motion(now)).resisting)
            now |= {c: true[c] + pushed[c] - before[c] + resisted[c] for c in pushed}
        return {c: now[c] - true[c] for c in (*pushed, *rubbing)}

    def _of(self, *pushes: Push) -> Channels:
        """Return by how much the force channels change where bodies are pushed; on the ground it is nothing."""
        # With more generalised forces dQ on the same motion, J^T (dλ) = -dQ, so dλ = -J^-T dQ. In the sum `n` counts
        # the samples, `m` the coordinates and `c` the force channels.
        forces = generalised(self, pushes, self.evidence.reference.mechanics.size)
        changed = -np.einsum("nm,nmc->nc", forces, self._inverse)
        return dict(zip(self.scene.channels.names(Role.force), changed.T, strict=True))

    def instead(
        self, element: Element, text: str, *pushes: Push, amounts: Sequence[float] = (), names: Sequence[str] = ()
    ) -> Hypothesis:
        """Return other pushes in place of those of a load or a spring."""
        removed = (Push(push.body, -push.force, push.at, -push.moment) for push in of_element(self, element))
        predicted = self.evidence.changed((1.0,), [self.change(*removed, *pushes)])
        return Hypothesis(
            Cause(kind_of(element), element.spot, text, tuple(amounts), tuple(names)), predicted, len(amounts)
        )

    @property
    def resisting(self) -> list[Push]:
        """What all friction does on the bodies."""
        return [push for contact in self.scene.friction for push in of_element(self, contact)]


def _carried(evidence: Evidence, motion: Motion) -> Carried:
    return Carried(evidence.scene, motion, evidence=evidence).pressed(evidence.reference.stroke_ends)


def force_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield loads that act elsewhere or otherwise, friction that should not be there, and shares that are left out."""
    if evidence.of_forces:
        carried = _carried(evidence, evidence.true)
        for number, load in enumerate(carried.scene.loads):
            yield from _load(carried, load)
            if load.table is not None:
                rows = {f"loads.{number}.table.{row}.1": f for row, f in enumerate(load.table.values[::-1])}
                other = carried.scene.with_numbers(rows).loads[number]
                yield carried.instead(load, f"the table of {load.named} is backwards", *of_element(carried, other))
        for spring in carried.scene.torsion_springs:
            text = "the torsion spring {place} acts on {one} alone"
            pushes = [*of_element(carried, spring)]
            for push in pushes if len(pushes) > 1 else ():
                yield carried.instead(spring, text, push, names=(push.body,))
        yield from _switches(carried)
        yield from _shares(carried)
        yield from _friction(carried)
        yield from _elsewhere(evidence)


def _load(carried: Carried, load: Load) -> Iterator[Hypothesis]:
    """Yield a load at another point, on another body, or turning with its body."""
    scene, body = carried.scene, load.body
    if (turned := load.turned) is not None:
        text = f"the load at {{place}} {'turns' if load.frame == 'ground' else 'does not turn'} with {{one}}"
        yield carried.instead(load, text, *of_element(carried, turned), names=(body,))
    (_, force, position, moment, *_), *reaction = sorted(of_element(carried, load), key=lambda push: push.body != body)
    if load.is_moment:
        for owner in scene.turning:
            push = Push(owner, force, position, moment)
            yield carried.instead(load, "the moment on {place} acts on {one}", push, names=(owner,))
        return
    for push in reaction:
        alone = Push(body, force, position)
        yield carried.instead(load, "the load at {place} has no reaction on {one}", alone, names=(push.body,))
    for point, owner in ((point, owner) for point, owners in scene.owners.items() for owner in owners):
        if owner != GROUND and (owner, point) != (body, load.at):
            push = Push(owner, force, carried.place(point))
            text = "the load at {place} acts at {one} of {two}"
            yield carried.instead(load, text, push, *reaction, names=(point, owner))
    push = Push(body, force, carried.com(scene.bodies[body])[0])
    yield carried.instead(load, "the load at {place} acts at {one}'s centre of mass", push, *reaction, names=(body,))


def late_loads(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield loads that are late: each as it was where the drive was a few samples before."""
    carried, time = _carried(evidence, evidence.true), evidence.motion["time"]
    step = float(np.ptp(time)) / (len(time) - 1)
    moving = [load for load in carried.scene.loads if evidence.of_forces and not load.steady]
    for lag in (way * rows * step for rows in ROWS_LATE * bool(moving) for way in (1, -1)):
        if late := evidence.late(lag):
            before = _carried(evidence, Motion(late))
            for load in moving:
                pairs = zip(of_element(before, load), of_element(carried, load), strict=True)
                pushes = (then._replace(at=now.at) for then, now in pairs)
                yield carried.instead(load, "the load at {place} is {late}", *pushes, amounts=(lag,))


def _switches(carried: Carried) -> Iterator[Hypothesis]:
    """Press forces that act where they should not, or do not act where they should."""
    for load, end in zip(carried.scene.presses.values(), carried.evidence.reference.stroke_ends, strict=True):
        x, v = carried.displacement(carried.scene.bodies[load.body])
        before_end, closing = (end - x) * load.closing, v * load.closing > 0
        # The length `last` decides only which samples are pressed. All lengths between two samples press the same ones,
        # so that one in the middle of each gap is tried.
        limits = np.unique(before_end[closing])
        lasts = ((limits[1:] + limits[:-1]) / 2).tolist()
        back = replace(load, closing=-load.closing)
        opening = back.acts(x, v, MotionVectors(carried.scene, carried.evidence.reference.cycle).stroke_end(back))
        for how, last, acting in (
            ("always", (), np.ones_like(closing)),
            ("all of the closing stroke", (), closing),
            ("on the way back too", (), before_end <= load.last),
            ("on the way back", (), (before_end <= load.last) & ~closing),
            ("at the end of the opening stroke", (), opening),
            ("at the end of the opening stroke too", (), opening | load.acts(x, v, end)),
            *(("in the last {length}", (last,), (before_end <= last) & closing) for last in lasts),
        ):
            push = Push(load.body, acting * complex(*load.force), carried.place(load.at))
            yield carried.instead(load, f"the press force at {{place}} acts {how}", push, amounts=last)


def _shares(carried: Carried) -> Iterator[Hypothesis]:
    """Yield gravity on one body, and m s w² of all bodies, with another share of it."""
    scene, outwards = carried.scene, list[Push]()
    for name, body in scene.bodies.items() if scene.gravity else ():
        cause = Cause(Kind.gravity, name, "gravity on {place} is {percent}")
        yield carried.evidence.with_amounts(cause, carried.change(weight(carried, body)))
    for name in scene.turning:
        body = scene.bodies[name]
        inertial, (angle, omega, _) = weights(scene, body), carried.turning(name)
        outwards.append(
            Push(name, inertial.mass * omega**2 * np.exp(1j * angle) * inertial.com, carried.place(body.points[0]))
        )
    cause = Cause(Kind.term, "all", "the share m s w^2 of all forces is {percent}")
    yield carried.evidence.with_amounts(cause, carried.change(*outwards))


def _friction(carried: Carried) -> Iterator[Hypothesis]:
    """Yield friction in guides and pins; and what the drive's effort alone has, its own or by power lost in a joint."""
    scene, evidence, fits = carried.scene, carried.evidence, []
    # Three laws of friction for each joint: by the joint's force (Coulomb), of constant size, and by the rate
    # (viscous). Some programs add friction to the drive alone: there the lost power over the drive's rate is the effort
    # that makes up for it. Fits of less than nothing are dropped, since friction takes power.
    rate = inputs_of(scene, evidence.true["time"]).driven().rate
    per_rate = np.divide(1.0, rate, out=np.zeros_like(rate), where=rate != 0)
    efforts = {("drive", "dry"): np.sign(rate), ("drive", "viscous"): rate}
    damped = {spring.at for spring in scene.torsion_springs if spring.damping is not None}  # which is another number
    for cause, rubs, load, against in _rubbing(carried):
        unit = carried.change(*against)
        for how, size in (("Coulomb", load * np.sign(rubs)), ("constant", np.sign(rubs)), ("viscous", rubs)):
            if not (how == "viscous" and cause.place in damped):
                fits.append((replace(cause, names=(how,)), {c: size * change for c, change in unit.items()}))
        for how, resistance in (("Coulomb", load), ("viscous", np.abs(rubs)), ("dry", 1.0)):
            efforts[cause.place, how] = resistance * np.abs(rubs) * per_rate
    effort = scene.channels.drive.effort
    if effort in evidence.names and evidence.outside([effort]) <= MAX_REST_TRIED:
        text = "{two} has {one} friction of {place} that no reaction has"
        for (place, how), course in efforts.items():
            fits.append((Cause(Kind.friction, place, text, names=(how, effort)), {effort: course}))
    for cause, change in fits:
        fit = evidence.with_amounts(cause, change)
        if fit.cause.amounts[0] > 0:
            yield fit._replace(freedom=int(cause.place != "drive"))


def _rubbing(carried: Carried) -> Iterator[tuple[Cause, Samples, Samples, Iterator[Push]]]:
    """Yield joints that may have friction: the rate of their parts on each other, the load, and what resists by one."""
    scene, samples = carried.scene, carried.motion.samples
    resisting, forces = -np.ones_like(samples["time"]), {**samples, **carried.evidence.given.samples}
    joints: list[Friction] = [GuideFriction(slider=name, length=np.inf, coefficient=1.0) for name in scene.slides]
    joints += [PinFriction(at=pin.point, body=pin.second, radius=1.0, coefficient=1.0) for pin in scene.pins]
    for contact in joints:
        channel, joint = contact.channel(scene), CONTACTS[type(contact)].joint
        unit = replace(carried, motion=Motion({**samples, channel: resisting}))
        cause = Cause(Kind.friction, contact.joint(scene), f"{joint} has friction ({{one}}, {{number}})")
        yield cause, friction.rate(carried, contact), friction.load(scene, contact, forces), of_element(unit, contact)


def _elsewhere(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield friction of a pin that acts at another one, besides what that has; it may be shown as the first one's."""
    scene = evidence.scene
    by_channel = {contact.channel(scene): contact for contact in scene.friction}
    pins = {contact.channel(scene): contact for contact in scene.of_type(PinFriction).values()}
    rubbing = [(c, contact) for c, contact in pins.items() if contact.arm]
    for (channel, contact), pin in product(rubbing, scene.pins):
        there = replace(contact, at=pin.point, body=pin.second)
        other = there.channel(scene)
        standing = pins.get(other)
        if standing:
            there = replace(there, radius=there.radius * (1 + standing.arm / contact.arm))
        every = {c: each for c, each in by_channel.items() if c != channel} | {other: there}
        if other != channel and (solved := evidence.solved(replace(scene, friction=tuple(every.values())))):
            shown = 0 * solved[other] if standing else solved[other]
            text = "the friction of {place} acts at {one}"
            cause = Cause(Kind.friction, contact.joint(scene), text, names=(pin.channel,))
            yield Hypothesis(
                cause, {channel: shown, **{c: values for c, values in solved.items() if c in evidence.true}}
            )

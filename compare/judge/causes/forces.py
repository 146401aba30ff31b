"""Causes in the forces on a right motion that are no numbers of the scene: where and when loads act, and friction.

None of them moves anything. What acts on a body besides, its joints carry, with the Jacobian of the constraints at the
motion as it should be:

    J^T λ = M q'' - Q.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene
from scenes.model.motion import Samples, force_channels
from scenes.scene import GROUND, Body, Force, ForceTable, Load

from ...mechanics.bodies import weights
from ...mechanics.motion_vectors import MotionVectors, Vectors, press_forces
from .cause import Cause, Kind, Way
from .evidence import EXPLAINED, Channels, Evidence, Hypothesis, added, with_changes

ROWS_LATE = (0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0)


class Push(NamedTuple):
    """A force on a body, N, where it attacks, m, and a moment, N m, each of shape (n,)."""

    body: str
    force: Vectors
    at: Vectors
    moment: Samples | float = 0.0


@dataclass(frozen=True)
class Carried:
    """What the joints of a right motion carry."""

    evidence: Evidence

    @property
    def scene(self) -> Scene:
        """The linkage."""
        return self.evidence.reference.scene

    @cached_property
    def state(self) -> MotionVectors:
        """The motion as it should be, with its press forces."""
        state = MotionVectors(self.scene, self.evidence.true)
        ends = zip(press_forces(self.scene), self.evidence.reference.stroke_ends, strict=True)
        moved = [(load, state.displacement(self.scene.bodies[load.body]), end) for load, end in ends]
        return replace(state, acting=[load.acts(x, v, end) for load, (x, v, _), end in moved])

    @cached_property
    def _of_coordinates(self) -> NDArray[np.float64]:
        """The force channels for a unit of each coordinate's share of M q'' - Q, shape (n, channels, coordinates)."""
        constraints = self.evidence.reference.mechanics.constraints
        size = np.tile([constraints.size, constraints.size, 1.0], len(self.scene.bodies))
        inverse = np.concatenate([constraints.closed(part).inverse for part in constraints.blocks(self.evidence.true)])
        return np.asarray(inverse.swapaxes(1, 2) / constraints.units[:, np.newaxis] * size)

    def change(self, *pushes: Push) -> Channels:
        """Return by how much the force channels change where bodies are pushed; on the ground it is nothing."""
        order = {name: number for number, name in enumerate(self.scene.bodies)}
        needed = np.zeros((len(self.evidence.rows), len(order), 3))
        for body, force, at, moment in (push for push in pushes if push.body != GROUND):
            arm = at - self.state.place(self.scene.bodies[body].points[0])
            about = np.imag(np.conj(arm) * force) + moment
            needed[:, order[body]] -= np.stack(np.broadcast_arrays(np.real(force), np.imag(force), about), axis=1)
        changed = np.einsum("ncm,nm->nc", self._of_coordinates, needed.reshape(len(needed), -1))
        return dict(zip(force_channels(self.scene), changed.T, strict=True))

    def force(self, load: Load) -> Vectors:
        """Return the force of one load."""
        acting = [a for a, one in zip(self.state.acting, press_forces(self.scene), strict=True) if one is load]
        alone = replace(self.scene, loads=(load,), springs=(), gravity=None)
        (push,) = replace(self.state, scene=alone, acting=acting).applied(self.scene.bodies[load.body])
        return push.force

    def place(self, load: Load) -> Vectors:
        """Return where a load acts."""
        return self.state.place(load.at)


def force_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield loads that act elsewhere or otherwise, friction that should not be there, and shares that are left out."""
    if not evidence.of_forces:
        return
    carried = Carried(evidence)
    for load in carried.scene.loads:
        yield from _load(carried, load)
    yield from _switches(carried)
    yield from _shares(carried)
    yield from _friction(carried)
    yield from _effort(carried)


def _instead(carried: Carried, load: Load, *pushes: Push) -> Channels:
    """Return the force channels with other pushes in place of a load."""
    own = Push(load.body, -carried.force(load), carried.place(load))
    return with_changes(carried.evidence, (1.0,), [carried.change(own, *pushes)])


def _load(carried: Carried, load: Load) -> Iterator[Hypothesis]:
    """Yield a load at another point, on another body, turning with its body, or by its table backwards."""
    scene, force, at = carried.scene, carried.force(load), carried.place(load)
    if isinstance(load, ForceTable):
        backwards = Push(load.body, carried.force(replace(load, forces=load.forces[::-1])), at)
        yield Hypothesis(Cause(Kind.load, load.at, Way.table_backwards), _instead(carried, load, backwards))
    if isinstance(load, Force):
        turning = Push(load.body, force * np.exp(1j * carried.state.angle(load.body)), at)
        cause = Cause(Kind.load, load.at, Way.load_turning, names=(load.body,))
        yield Hypothesis(cause, _instead(carried, load, turning))
    owned = [(point, owner) for point, owners in scene.owners.items() for owner in owners if owner != GROUND]
    for point, owner in owned:
        if (owner, point) != (load.body, load.at):
            cause = Cause(Kind.load, load.at, Way.load_elsewhere, names=(point, owner))
            yield Hypothesis(cause, _instead(carried, load, Push(owner, force, carried.state.place(point))))
    com = carried.state.com(scene.bodies[load.body])[0]
    cause = Cause(Kind.load, load.at, Way.load_at_com, names=(load.body,))
    yield Hypothesis(cause, _instead(carried, load, Push(load.body, force, com)))


def late_loads(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield loads that are late: each as it was where the drive was a few samples before."""
    carried, reference, time = Carried(evidence), evidence.reference, evidence.true["time"]
    drive, step = reference.scene.drive, float(np.ptp(evidence.motion["time"])) / (len(evidence.motion["time"]) - 1)
    moving = [load for load in carried.scene.loads if evidence.of_forces and not isinstance(load, Force)]
    for by in (way * rows * step for rows in ROWS_LATE * bool(moving) for way in (1, -1)):
        then = time - by
        then = then if drive.repeats else np.clip(then, 0.0, drive.cycle)
        try:
            before = Carried(replace(evidence, true=reference.at(drive.at(then).position, then)))
        except Failure:
            continue
        for load in moving:
            push = Push(load.body, before.force(load), carried.place(load))
            cause = Cause(Kind.load, load.at, Way.load_late, (by,))
            yield Hypothesis(cause, _instead(carried, load, push), 1)


def _switches(carried: Carried) -> Iterator[Hypothesis]:
    """Press forces that act where they should not, or do not act where they should."""
    for load, end in zip(press_forces(carried.scene), carried.evidence.reference.stroke_ends, strict=True):
        x, v, _ = carried.state.displacement(carried.scene.bodies[load.body])
        before_end, closing = (end - x) * load.closing, v * load.closing > 0
        limits = np.unique(before_end[closing])
        lasts = ((limits[1:] + limits[:-1]) / 2).tolist()
        back = replace(load, closing=-load.closing)
        opening = back.acts(x, v, MotionVectors(carried.scene, carried.evidence.reference.cycle).stroke_end(back))
        for way, last, acting in (
            (Way.press_always, (), np.ones_like(closing)),
            (Way.press_closing, (), closing),
            (Way.press_both_ways, (), before_end <= load.last),
            (Way.press_back, (), (before_end <= load.last) & ~closing),
            (Way.press_opening, (), opening),
            (Way.press_opening_too, (), opening | load.acts(x, v, end)),
            *((Way.press_last, (last,), (before_end <= last) & closing) for last in lasts),
        ):
            push = Push(load.body, acting * complex(*load.force), carried.place(load))
            cause = Cause(Kind.load, load.at, way, last)
            yield Hypothesis(cause, _instead(carried, load, push), len(last))


def _shares(carried: Carried) -> Iterator[Hypothesis]:
    """Yield gravity on one body, and m s w² of all bodies, with another share of it."""
    scene, state, ways = carried.scene, carried.state, []
    if scene.gravity is not None:
        for name, body in scene.bodies.items():
            com = state.com(body)[0]
            weight = Push(name, np.full(com.shape, (body.mass or 0.0) * complex(*scene.gravity)), com)
            ways.append((Cause(Kind.gravity, name, Way.gravity_on), carried.change(weight)))
    outwards = []
    for name in scene.turning:
        body = scene.bodies[name]
        own, (angle, omega, _) = weights(scene, body), state.turning(name)
        first = state.place(body.points[0])
        outwards.append(Push(name, own.mass * omega**2 * np.exp(1j * angle) * own.com, first))
    ways.append((Cause(Kind.term, "all", Way.centripetal_share), carried.change(*outwards)))
    for cause, change in ways:
        (amount,), predicted = added(carried.evidence, [change])
        yield Hypothesis(replace(cause, amounts=(float(amount),)), predicted, 1)


class Rubbing(NamedTuple):
    """A joint that may have friction."""

    cause: Cause
    rate: Samples  # of its parts on each other, m/s or rad/s
    load: Samples  # N
    against: tuple[Push, Push]  # a resistance of 1 N or 1 N m to a positive rate

    def resisting(self, size: Samples) -> tuple[Push, ...]:
        """Return a resistance of another size."""
        return tuple(Push(p.body, size * p.force, p.at, size * p.moment) for p in self.against)


def _rubbing(carried: Carried) -> Iterator[Rubbing]:
    scene, state, given = carried.scene, carried.state, carried.evidence.given
    for body in scene.bodies.values():
        if body.slide is not None:
            rate, along = _sliding(carried, body)
            at, force = state.place(body.points[0]), f"{body.name}.guide_force"
            load = np.abs(given[force]) if force in carried.evidence.names else np.zeros_like(rate)
            pushes = Push(body.name, -along, at), Push(body.slide.on, along, at)
            yield Rubbing(Cause(Kind.friction, body.name, Way.guide_friction), rate, load, pushes)
    for pin in scene.pins:
        rate = state.turning(pin.second)[1] - state.turning(pin.first)[1]
        at, still = state.place(pin.point), np.zeros(rate.shape, complex)
        pushes = Push(pin.second, still, at, -np.ones_like(rate)), Push(pin.first, still, at, np.ones_like(rate))
        load = np.abs(state.vector(f"{pin.channel}.", "fx", "fy"))
        yield Rubbing(Cause(Kind.friction, pin.channel, Way.pin_friction), rate, load, pushes)


def _friction(carried: Carried) -> Iterator[Hypothesis]:
    """Friction in guides and pins: by the load, constant, or viscous."""
    for joint in _rubbing(carried):
        sizes = {"Coulomb": joint.load * np.sign(joint.rate), "constant": np.sign(joint.rate), "viscous": joint.rate}
        for how, size in sizes.items():
            (amount,), predicted = added(carried.evidence, [carried.change(*joint.resisting(size))])
            if amount > 0:
                cause = replace(joint.cause, amounts=(float(amount),), names=(how,))
                yield Hypothesis(cause, predicted, 1)


def _effort(carried: Carried) -> Iterator[Hypothesis]:
    """Yield friction that the drive's effort alone has: in the drive itself, or by the power lost in a joint."""
    scene, evidence = carried.scene, carried.evidence
    effort = "drive.torque" if scene.driven_slide is None else "drive.force"
    if effort not in evidence.names or evidence.outside([effort]) > EXPLAINED:
        return
    rate = scene.drive.at(evidence.true["time"]).rate
    ways = {("drive", "dry"): np.sign(rate), ("drive", "viscous"): rate}
    per_rate = np.divide(1.0, rate, out=np.zeros_like(rate), where=rate != 0)
    for joint in _rubbing(carried):
        for how, resistance in (("Coulomb", joint.load), ("viscous", np.abs(joint.rate)), ("dry", 1.0)):
            ways[joint.cause.place, how] = resistance * np.abs(joint.rate) * per_rate
    for (place, how), course in ways.items():
        (size,), predicted = added(evidence, [{effort: course}])
        if size > 0:
            cause = Cause(Kind.friction, place, Way.effort_friction, (float(size),), (how, effort))
            yield Hypothesis(cause, predicted, int(place != "drive"))


def _sliding(carried: Carried, body: Body) -> tuple[Samples, Vectors]:
    """Return how fast a body slides along its guide, m/s, and the guide's direction."""
    assert body.slide is not None
    z, v, _ = carried.state.point(body.points[0])
    along = np.exp(1j * carried.state.angle(body.slide.on)) * complex(*body.slide.along)
    if body.slide.on != GROUND:
        carrier = carried.scene.bodies[body.slide.on]
        first, rate, _ = carried.state.point(carrier.points[0])
        v = v - rate - 1j * carried.state.turning(carrier.name)[1] * (z - first)
    return (along.conj() * v).real, along

"""Causes in the forces that act on a right motion from without: loads, springs, gravity, friction."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from scenes import Failure
from scenes.motion import Samples
from scenes.scene import GROUND, Body, Force, ForceTable, Load, PressForce

from ...engines.motion_vectors import Vectors
from .evidence import EXPLAINED, Channels, Evidence, Hypothesis, Kind, factor_of_change, fitted
from .force import Carried, Wrenches, both, percent

ROWS_LATE = (0.5, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0)
STANDARD_GRAVITY = -9.81j  # m/s^2


def load_causes(evidence: Evidence, carried: Carried) -> Iterator[Hypothesis]:
    """Yield another load, spring, gravity, or a friction that should not be there."""
    for load in carried.scene.loads:
        yield from _load(evidence, carried, load)
    yield from _switches(evidence, carried)
    yield from _springs(evidence, carried)
    yield from _gravity(evidence, carried)
    yield from _friction(evidence, carried)
    yield from _effort(evidence, carried)


def _along(evidence: Evidence, carried: Carried, ways: Sequence[Wrenches]) -> tuple[Samples, Channels]:
    """Return the amounts of wrenches that leave least over, and the channels then."""
    return fitted(evidence, lambda x: carried.changed(both(*map(_times, x, ways))), np.ones(len(ways)))


def _times(amount: float | Samples, wrenches: Wrenches) -> Wrenches:
    return {name: (amount * force, amount * moment) for name, (force, moment) in wrenches.items()}


def _load(evidence: Evidence, carried: Carried, load: Load) -> Iterator[Hypothesis]:
    """Yield a load that is another, missing, at another point, on another body, or turning with its body."""
    scene, state, body = carried.scene, carried.state, load.body
    force, at, name = _force(carried, load), state.place(load.at), f"the load at {load.at}"
    own = carried.push(body, force, at)

    def instead(owner: str, force: Vectors, at: Vectors) -> Channels:
        return carried.changed(both(carried.push(owner, force, at), _times(-1, own)))

    (amount,), predicted = _along(evidence, carried, [own])
    yield Hypothesis(Kind.load, load.at, percent(amount), f"{name} is {percent(amount)}", predicted, 1)
    if isinstance(load, ForceTable):
        yield from _tables(evidence, load, lambda other: instead(body, _force(carried, other), at))
    if isinstance(load, Force):
        (amount, across), predicted = _along(evidence, carried, [own, carried.push(body, 1j * force, at)])
        other = (1 + amount + 1j * across) * complex(*load.force)
        how = f"{scene.amount('force', abs(other))} at {scene.amount('angle', float(np.angle(other)), 3)}"
        yield Hypothesis(Kind.load, load.at, how, f"{name} is {how}", predicted, 2)
        turning = instead(body, force * np.exp(1j * state.angle(body)), at)
        yield Hypothesis(Kind.load, load.at, "in the body's frame", f"{name} turns with {body}", turning)
    owned = [(point, owner) for point, owners in scene.owners.items() for owner in owners if owner != GROUND]
    places = {f"{p} of {owner}": (owner, state.place(p)) for p, owner in owned if (owner, p) != (body, load.at)}
    places[f"{body}'s centre of mass"] = body, state.com(scene.bodies[body])[0]
    for where, (owner, place) in places.items():
        predicted = instead(owner, force, place)
        yield Hypothesis(Kind.load, load.at, f"at {where}", f"{name} acts at {where}", predicted)


def _tables(evidence: Evidence, load: ForceTable, instead: Callable[[ForceTable], Channels]) -> Iterator[Hypothesis]:
    """Yield a table that is shifted, or backwards."""
    reach, name = float(np.ptp(load.displacements)), f"the table of the load at {load.at}"

    def predict(x: Samples) -> Channels:
        return instead(replace(load, displacements=tuple(s + float(x[0]) for s in load.displacements)))

    (by,), predicted = fitted(evidence, predict, np.full(1, 1e-3 * reach), 4)
    off = evidence.reference.scene.length(by, 3)
    yield Hypothesis(Kind.load, load.at, off, f"{name} is shifted by {off}", predicted, 1)
    backwards = instead(replace(load, forces=load.forces[::-1]))
    yield Hypothesis(Kind.load, load.at, "backwards", f"{name} is backwards", backwards)


def _force(carried: Carried, load: Load) -> Vectors:
    """Return the force of one load."""
    scene = replace(carried.scene, loads=(load,), springs=(), gravity=None)
    presses = [one for one in carried.scene.loads if isinstance(one, PressForce)]
    acting = [a for a, one in zip(carried.state.acting, presses, strict=True) if one is load]
    (push,) = replace(carried.state, scene=scene, acting=acting).applied(scene.bodies[load.body])
    return push.force


def late_loads(evidence: Evidence, carried: Carried) -> Iterator[Hypothesis]:
    """Yield loads that are late: each as it was where the drive was a few samples before."""
    reference, time, drive = evidence.reference, evidence.true["time"], evidence.reference.scene.drive
    step = float(np.ptp(evidence.motion["time"])) / (len(evidence.motion["time"]) - 1)
    for by in (way * rows * step for rows in ROWS_LATE for way in (1, -1)):
        then = time - by
        then = then if drive.repeats else np.clip(then, 0.0, drive.cycle)
        try:
            before = Carried(replace(evidence, true=reference.at(drive.at(then).position, then)))
        except Failure:
            continue
        for load in (one for one in carried.scene.loads if not isinstance(one, Force)):
            more, at = _force(before, load) - _force(carried, load), carried.state.place(load.at)
            predicted = carried.changed(carried.push(load.body, more, at))
            how = f"{1e3 * abs(by):.3g} ms {'late' if by > 0 else 'early'}"
            yield Hypothesis(Kind.load, load.at, how, f"the load at {load.at} is {how}", predicted, 1)


def _switches(evidence: Evidence, carried: Carried) -> Iterator[Hypothesis]:
    """Press forces that act where they should not, or do not act where they should."""
    presses = [load for load in carried.scene.loads if isinstance(load, PressForce)]
    ends = evidence.reference.stroke_ends
    for load, acts, end in zip(presses, carried.state.acting, ends, strict=True):
        x, v, _ = carried.state.displacement(carried.scene.bodies[load.body])
        before_end = (end - x) * load.closing
        at, name = carried.state.place(load.at), f"the press force at {load.at}"
        ways = {
            "always": np.ones_like(acts),
            "all of the closing stroke": v * load.closing > 0,
            "on the way back too": before_end <= load.last,
            "on the way back": (before_end <= load.last) & (v * load.closing < 0),
        }
        limits = np.unique(before_end[v * load.closing > 0])
        for last in (limits[1:] + limits[:-1]) / 2:
            ways[f"in the last {carried.scene.length(last, 3)}"] = (before_end <= last) & (v * load.closing > 0)
        for how, acting in ways.items():
            more = (acting.astype(float) - acts) * complex(*load.force)
            predicted = carried.changed(carried.push(load.body, more, at))
            free = int(how.startswith("in the last"))
            yield Hypothesis(Kind.load, load.at, how, f"{name} acts {how}", predicted, free)


def _springs(evidence: Evidence, carried: Carried) -> Iterator[Hypothesis]:
    for spring in carried.scene.springs:
        (one, p), (other, q) = spring.first, spring.second
        towards = carried.state.place(q) - carried.state.place(p)
        distance = np.abs(towards)
        unit = towards / np.where(distance > 0, distance, 1.0)
        name = f"the spring {p}-{q}"
        for what, size in (("stiffness", distance - spring.length), ("length", -np.full_like(distance, spring.length))):
            pull = spring.stiffness * size * unit
            pair = both(
                carried.push(one, pull, carried.state.place(p)), carried.push(other, -pull, carried.state.place(q))
            )
            (amount,), predicted = _along(evidence, carried, [pair])
            how = percent(amount)
            sentence = f"{name} is missing" if how == "missing" and what == "stiffness" else f"{name}'s {what} is {how}"
            yield Hypothesis(Kind.spring, f"{p}-{q}", f"{what} {how}", sentence, predicted, 1)


def _gravity(evidence: Evidence, carried: Carried) -> Iterator[Hypothesis]:
    """Gravity that is another, or not on one of the bodies."""
    own = complex(*carried.scene.gravity) if carried.scene.gravity is not None else 0j
    pulls = {}
    for name, body in carried.scene.bodies.items():
        com = carried.state.com(body)[0]
        weight = np.full(com.shape, (body.mass or 0.0) * (own or STANDARD_GRAVITY))
        pulls[name] = carried.push(name, weight, com), carried.push(name, 1j * weight, com)
    down, across = (both(*pulls_of) for pulls_of in zip(*pulls.values(), strict=True))
    (amount,), predicted = _along(evidence, carried, [down])
    how = percent(amount) if own else f"{amount * 9.81:.4g} m/s^2"
    yield Hypothesis(Kind.gravity, "all", how, f"gravity is {how}", predicted, 1)
    (amount, turned), predicted = _along(evidence, carried, [down, across])
    other = own + (amount + 1j * turned) * (own or STANDARD_GRAVITY)
    how = f"({other.real:.3g}, {other.imag:.3g}) m/s^2"
    yield Hypothesis(Kind.gravity, "all", how, f"gravity is {how}", predicted, 2)
    if own:
        for name, (pull, _) in pulls.items():
            (amount,), predicted = _along(evidence, carried, [pull])
            how = percent(amount)
            yield Hypothesis(Kind.gravity, name, how, f"gravity on {name} is {how}", predicted, 1)


class Rubbing(NamedTuple):
    """A joint that may have friction."""

    place: str
    name: str
    rate: Samples  # of its parts on each other, m/s or rad/s
    load: Samples  # N
    against: Wrenches  # a resistance of 1 N or 1 N m to a positive rate


def _rubbing(evidence: Evidence, carried: Carried) -> Iterator[Rubbing]:
    scene, state = carried.scene, carried.state
    for body in scene.bodies.values():
        if body.slide is not None:
            rate, along = _sliding(carried, body)
            given, at = f"{body.name}.guide_force", state.place(body.points[0])
            load = np.abs(evidence.given[given]) if given in evidence.names else np.zeros_like(rate)
            against = both(carried.push(body.name, -along, at), carried.push(body.slide.on, along, at))
            yield Rubbing(body.name, f"{body.name}'s guide", rate, load, against)
    for pin in scene.pins:
        rate = state.turning(pin.second)[1] - state.turning(pin.first)[1]
        sides = {pin.second: np.ones_like(rate), pin.first: -np.ones_like(rate)}
        against = {name: (np.zeros(rate.shape, complex), side) for name, side in sides.items() if name != GROUND}
        load = np.abs(state.vector(f"{pin.channel}.", "fx", "fy"))
        yield Rubbing(pin.channel, f"the pin {pin.channel}", rate, load, against)


def _friction(evidence: Evidence, carried: Carried) -> Iterator[Hypothesis]:
    """Friction in guides and pins: by the load, constant, or viscous."""
    for place, name, rate, load, against in _rubbing(evidence, carried):
        for how, size in (("Coulomb", load * np.sign(rate)), ("constant", np.sign(rate)), ("viscous", rate)):
            (amount,), predicted = _along(evidence, carried, [_times(size, against)])
            how = f"{how}, {amount:.3g}"
            if amount > 0:
                yield Hypothesis(Kind.friction, place, how, f"{name} has friction ({how})", predicted, 1)


def _effort(evidence: Evidence, carried: Carried) -> Iterator[Hypothesis]:
    """Yield friction that the drive's effort alone has: in the drive itself, or by the power lost in a joint."""
    scene = carried.scene
    effort = "drive.torque" if scene.driven_slide is None else "drive.force"
    if effort not in evidence.names or evidence.outside([effort]) > EXPLAINED:
        return
    rate = scene.drive.at(evidence.true["time"]).rate
    ways: dict[tuple[str, str], Samples] = {("drive", "dry"): np.sign(rate), ("drive", "viscous"): rate}
    per_rate = np.divide(1.0, rate, out=np.zeros_like(rate), where=rate != 0)
    for joint in _rubbing(evidence, carried):
        for how, resistance in (("Coulomb", joint.load), ("viscous", np.abs(joint.rate)), ("dry", 1.0)):
            ways[joint.place, how] = resistance * np.abs(joint.rate) * per_rate
    for (place, how), course in ways.items():
        size = factor_of_change(evidence, effort, course)
        predicted = {effort: evidence.true[effort] + size * course}
        sentence = f"{effort} has {how} friction of {place} that no reaction has"
        if size > 0:
            yield Hypothesis(Kind.friction, place, f"{how}, {size:.3g}", sentence, predicted, 1 - (place == "drive"))


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

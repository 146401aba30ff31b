"""Causes in what loads a right motion: masses, centres of mass, gravity, loads, springs, friction.

None of them moves anything. What a cause adds to m a and I alpha, or takes from it, the reactions carry:

    J^T λ = M q'' - Q

with the Jacobian of the motion as it should be.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.motion import Samples, force_channels
from scenes.scene import GROUND, Body, PressForce

from ...engines.motion_vectors import MotionVectors, Vectors, arms
from ...engines.weights import Weights, weights
from ..constraints import blocks, constraints_of
from .evidence import Channels, Evidence, Hypothesis, Kind, fitted

NONE = -1.005  # of a mass or a moment of inertia, by so much of itself too small: none at all, but for rounding

Wrench = tuple[Vectors, Samples]  # a force, N, and a moment about the body's first point, N m
Wrenches = Mapping[str, Wrench]  # by body; on the ground none


@dataclass(frozen=True)
class Carried:
    """What the reactions of a motion carry."""

    evidence: Evidence

    @property
    def scene(self) -> Scene:
        """The linkage."""
        return self.evidence.reference.scene

    @cached_property
    def state(self) -> MotionVectors:
        """The motion as it should be."""
        ends = self.evidence.reference.stroke_ends
        state = MotionVectors(self.scene, self.evidence.true)
        presses = [load for load in self.scene.loads if isinstance(load, PressForce)]
        acting = [share(state, load, end) for load, end in zip(presses, ends, strict=True)]
        return MotionVectors(self.scene, self.evidence.true, acting)

    @cached_property
    def _solved(self) -> NDArray[np.float64]:
        """The force channels that each coordinate's share of M q'' - Q gives, shape (n, channels, coordinates)."""
        constraints = constraints_of(self.scene)
        size = np.tile([constraints.size, constraints.size, 1.0], len(self.scene.bodies))
        return np.concatenate(
            [
                np.linalg.inv(constraints.jacobian(constraints.poses(block))).swapaxes(1, 2)
                / constraints.units[:, np.newaxis]
                * size
                for block in blocks(constraints, self.evidence.true)
            ]
        )

    def changed(self, added: Wrenches) -> Channels:
        """Return the force channels where the bodies need this much more."""
        n = len(self.evidence.rows)
        needed = np.zeros((n, len(self.scene.bodies), 3))
        for number, name in enumerate(self.scene.bodies):
            if name in added:
                force, moment = added[name]
                needed[:, number, 0], needed[:, number, 1], needed[:, number, 2] = force.real, force.imag, moment
        found = np.einsum("ncm,nm->nc", self._solved, needed.reshape(n, -1))
        true = self.evidence.true
        return {c: true[c] + more for c, more in zip(force_channels(self.scene), found.T, strict=True)}

    def needed(self, body: Body, weights: Weights, gravity: complex | None = None) -> Wrench:
        """Return what a body of such weights needs to move as it does."""
        if gravity is None:
            gravity = complex(*self.scene.gravity) if self.scene.gravity is not None else 0j
        _, _, a = self.state.point(body.points[0])
        angle, omega, alpha = self.state.turning(body.name)
        r = np.exp(1j * angle) * weights.com
        force = weights.mass * (a + (1j * alpha - omega**2) * r - gravity)
        return force, weights.inertia * alpha + _cross(r, force)

    def centripetal(self, name: str, weights: Weights) -> Wrench:
        """Return what a body needs for its centre of mass to go round its first point: a force along the arm."""
        angle, omega, _ = self.state.turning(name)
        return -weights.mass * omega**2 * np.exp(1j * angle) * weights.com, np.zeros(angle.shape)

    def push(self, name: str, force: Vectors, at: Vectors) -> Wrenches:
        """Return what a force on a body takes from what its joints carry; nothing on the ground."""
        if name == GROUND:
            return {}
        first = self.state.place(self.scene.bodies[name].points[0])
        return {name: (-force, -_cross(at - first, force))}


def share(state: MotionVectors, load: PressForce, end: float) -> NDArray[np.bool_]:
    """Return where a press force acts."""
    x, v, _ = state.displacement(state.scene.bodies[load.body])
    return load.acts(x, v, end)


def _cross(arm: Vectors, force: Vectors) -> Samples:
    cross: Samples = np.imag(np.conj(arm) * force)
    return cross


def both(*wrenches: Wrenches) -> Wrenches:
    """Return the sum of wrenches."""
    found: dict[str, Wrench] = {}
    for wrench in wrenches:
        for name, (force, moment) in wrench.items():
            f, m = found.get(name, (0j, 0.0))
            found[name] = (force + f, moment + m)
    return found


def less(one: Wrench, other: Wrench) -> Wrench:
    """Return by how much a wrench is more than another."""
    return one[0] - other[0], one[1] - other[1]


def percent(share: float) -> str:
    """Return by how much something is off, in words."""
    if abs(share + 1) < 5e-3:
        return "missing"
    if abs(share + 2) < 1e-2:
        return "of the opposite sign"
    if share > 2:
        return f"{share + 1:.4g} times too large"
    return f"{abs(100 * share):.3g} % too {'large' if share > 0 else 'small'}"


def weight_causes(evidence: Evidence, carried: Carried) -> Iterator[Hypothesis]:
    """Yield another mass, moment of inertia or centre of mass of a body, or of all; two bodies' masses swapped.

    Less than none is no cause.
    """
    scene = carried.scene
    own = {name: weights(scene, body) for name, body in scene.bodies.items()}

    def changed(to: Mapping[str, Weights]) -> Channels:
        return carried.changed(
            {
                n: less(carried.needed(scene.bodies[n], w), carried.needed(scene.bodies[n], own[n]))
                for n, w in to.items()
            }
        )

    def by_factor(names: Sequence[str], mass: bool, inertia: bool) -> tuple[float, Channels]:
        """Return by what share masses, or moments of inertia, or both, are larger."""

        def predict(x: Samples) -> Channels:
            more = 1 + x[0]
            w = {name: own[name] for name in names}
            return changed({n: Weights(more**mass * v.mass, v.com, more**inertia * v.inertia) for n, v in w.items()})

        (amount,), predicted = fitted(evidence, predict, np.ones(1))
        return float(amount), predicted

    turning = [name for name in scene.turning if own[name].inertia]
    for name, body in scene.bodies.items():
        uniform = body.inertia is None and name in turning
        for with_inertia in dict.fromkeys((uniform, False)):
            amount, predicted = by_factor([name], True, with_inertia)
            if amount > NONE:
                yield Hypothesis(Kind.mass, name, percent(amount), f"{name}'s mass is {percent(amount)}", predicted, 1)
        if name in turning:
            amount, predicted = by_factor([name], False, True)
            how = _inertia_of(body, amount)
            if amount > NONE:
                yield Hypothesis(Kind.inertia, name, how, f"{name}'s moment of inertia is {how}", predicted, 1)
        if name in scene.turning and own[name].mass:
            yield _com(evidence, carried, body, own[name], changed)
    for kind, names in ((Kind.mass, list(scene.bodies)), (Kind.inertia, turning)):
        if len(names) > 1:
            amount, predicted = by_factor(names, kind is Kind.mass, True)
            if amount > NONE:
                yield Hypothesis(kind, "all", percent(amount), f"each body's {kind} is {percent(amount)}", predicted, 1)
    whole = {n: carried.needed(scene.bodies[n], w, gravity=0j) for n, w in own.items()}
    shares = {"inertia's share of all forces": (Kind.mass, whole)} if scene.gravity is not None else {}
    shares["the share m s w^2 of all forces"] = (Kind.term, {n: carried.centripetal(n, own[n]) for n in turning})
    for what, (kind, share) in shares.items():  # without gravity inertia's is the same as each body's mass
        yield _share(evidence, carried, kind, what, share)
    for one, two in combinations(own, 2):
        a, b = own[one], own[two]
        swapped = {
            n: Weights(m, v.com, v.inertia * m / v.mass if scene.bodies[n].inertia is None and v.mass else v.inertia)
            for n, v, m in ((one, a, b.mass), (two, b, a.mass))
        }
        sentence = f"the masses of {one} and {two} are swapped"
        yield Hypothesis(Kind.mass, one, f"swapped with {two}'s", sentence, changed(swapped))


def _share(evidence: Evidence, carried: Carried, kind: Kind, what: str, share: Wrenches) -> Hypothesis:
    """Return forces without a share, as a static solution is without m a and I alpha, or with another one of it."""
    (amount,), predicted = fitted(
        evidence, lambda x: carried.changed({n: (x[0] * f, x[0] * m) for n, (f, m) in share.items()}), np.ones(1)
    )
    how = percent(amount)
    return Hypothesis(kind, "all", how, f"{what} is {how}", predicted, 1)


def _com(
    evidence: Evidence, carried: Carried, body: Body, w: Weights, changed: Callable[[Mapping[str, Weights]], Channels]
) -> Hypothesis:
    """Return another centre of mass; its moment has the square of the distance in it."""
    corners = arms(carried.scene, body)
    length = max(map(abs, corners.values())) or evidence.reference.stroke

    def predict(x: Samples) -> Channels:
        return changed({body.name: Weights(w.mass, w.com + complex(*x), w.inertia)})

    shift, predicted = fitted(evidence, predict, np.full(2, 1e-3 * length), 3)
    com = w.com + complex(*shift)
    known = {f"at {point}": at for point, at in corners.items()}
    known |= {"mirrored": w.com.conjugate(), "on the opposite side": -w.com}
    off = f"{carried.scene.length(abs(complex(*shift)), 3)} off"
    where = next((n for n, at in known.items() if abs(com - at) < 5e-3 * length), off)
    return Hypothesis(Kind.com, body.name, where, f"{body.name}'s centre of mass is {where}", predicted, 2)


def _inertia_of(body: Body, amount: float) -> str:
    """Return by how much a moment of inertia is off, or what it is that of."""
    known = {2: {3.0: "that about its end", 2.0: "that of two points"}, 3: {3.0: "that of three points"}}
    for share, what in known.get(len(body.corners), {}).items():
        if body.inertia is None and abs(amount - share) < 2e-2:
            return what
    return percent(amount)

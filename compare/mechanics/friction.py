"""Friction as the judge has it: what a motion's own channels of it do to the bodies, and what its law asks of them."""

from collections.abc import Mapping

import numpy as np

from scenes import Motion, Scene
from scenes.channels import POWER
from scenes.model.motion import Samples
from scenes.scene import Friction

from .contacts import CONTACTS
from .elements import generalised, of_element
from .mechanics import Mechanics
from .motion_vectors import MotionVectors


def rate(state: MotionVectors, friction: Friction) -> Samples:
    """How fast the parts of a joint move on each other."""
    return CONTACTS[type(friction)].rate(friction, state)


def load(scene: Scene, friction: Friction, forces: Mapping[str, Samples]) -> Samples:
    """What friction goes by, N, from channels of forces: that of a pin, or of both ends of a guide's contact."""
    return CONTACTS[type(friction)].load(friction, scene, forces)


def coefficient(friction: Friction) -> float:
    """Friction by its load: the radius of a pin's friction circle, m, or the coefficient of a guide."""
    return CONTACTS[type(friction)].coefficient(friction)


def newtons(mechanics: Mechanics, state: MotionVectors) -> dict[str, Samples]:
    """By channel of friction how much a newton more in every joint makes of it, at most, shape (n,)."""
    each, power = dict[str, Samples](), np.zeros_like(state.motion["time"])
    for friction in mechanics.scene.friction:
        changed = np.full_like(power, coefficient(friction) * CONTACTS[type(friction)].share(friction, mechanics.size))
        each[friction.channel(mechanics.scene)] = changed
        power = power + changed * np.abs(rate(state, friction))
    return {**each, POWER: power} if each else each


def by_law(state: MotionVectors, forces: Mapping[str, Samples]) -> dict[str, Samples]:
    """By channel what the friction should be of a motion, its sense its own, under forces of joints."""
    scene, law = state.scene, dict[str, Samples]()
    for friction in scene.friction:
        moving = rate(state, friction)
        sense = np.sign(moving) if friction.smooth is None else np.tanh(moving / friction.smooth)
        law[friction.channel(scene)] = (
            -sense * coefficient(friction) * load(scene, friction, forces) - (friction.viscous or 0.0) * moving
        )
    power = sum(state.motion[friction.channel(scene)] * rate(state, friction) for friction in scene.friction)
    return {**law, POWER: np.asarray(power)} if law else law


# Coulomb friction is a fixed point: loads of joints give friction, which changes the loads. Column j of `gains` is the
# change of all loads by a unit of the friction of joint j, an upper bound since |.| is Lipschitz with constant one;
# times the coefficients it is the matrix of the map. Its spectral radius below one makes the fixed point unique.
def contraction(mechanics: Mechanics, motion: Motion) -> Samples:
    """By how much the joints' loads change at most with what their friction was found by, shape (n,).

    Below one, the forces have one solution and no other (Banach); else that is not proven. It is the spectral radius of
    the loads' changes by each other.
    """
    scene, constraints, found = mechanics.scene, mechanics.constraints, []
    for part in constraints.blocks(motion):
        ones = dict.fromkeys(mechanics.friction, np.ones_like(part["time"]))
        unit = MotionVectors(scene, Motion({**part.samples, **ones}))
        of_each = [generalised(unit, of_element(unit, friction), mechanics.size) for friction in scene.friction]
        changes = np.stack(of_each, axis=1) @ constraints.closed(part).inverse / constraints.units
        forces = dict(zip(mechanics.forces, np.moveaxis(changes, -1, 0), strict=True))
        gains = np.stack([load(scene, friction, forces) for friction in scene.friction], axis=1)
        found.append(np.abs(np.linalg.eigvals(gains * [*map(coefficient, scene.friction)])).max(axis=1))
    return np.concatenate(found)

"""All loads and springs of a scene, and the weight, as one generalised force; a rule for each is in `elements`."""

from collections.abc import Mapping

from flint import acb, arb, arb_mat

from .constraints import LinkageEquations
from .elements import RULES, Assembled, GeneralisedForce


def generalised_force(linkage: LinkageEquations, ends: Mapping[str, float], start: arb_mat) -> GeneralisedForce:
    """Return Q of all loads, springs and the weight; `ends` are those of the press forces' strokes, by place, m.

    `start` is the pose at time zero. Q raises a Failure where the ends of a spring meet, so that it has no direction.
    """
    scene, to = linkage.scene, Assembled(linkage, ends, start)
    weight = linkage.rows(1)  # Σ m g·r, its work
    forces = [RULES[type(element)](element, place, to) for place, element in scene.elements]
    if scene.gravity is not None:
        for i in linkage.index.values():
            weight.add_point(0, linkage.mass[3 * i] * acb(*scene.gravity), i, acb(0))

    def total(q: arb_mat, velocity: arb_mat, time: arb) -> arb_mat:
        Q = weight.jacobian(q).transpose()
        for force in forces:
            Q = Q + force(q, velocity, time)
        return Q

    return total

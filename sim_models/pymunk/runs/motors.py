"""Friction as an impulse engine has it: a motor of no rate at a pin, a groove across a guide, of a largest force.

The motion turns and slides them all the same, so they give way and resist with their largest, in the sense that the
engine finds by itself. They would not change a run's motion: the steps of its samples are taken once more with them.
"""

from collections.abc import Mapping

import numpy as np
import pymunk
from numpy.typing import NDArray

from scenes.model.motion import Samples
from scenes.scene import GROUND, Friction

from ..constraints import LinkageConstraints
from ..contacts import CONTACTS
from ..friction import directions
from ..planes import PoseArray, pair
from ..space import Bodies
from .stepping import FIRST_SWEEPS, Integration


def forces_with_motors(
    linkage: LinkageConstraints, run: Integration, forces: PoseArray, found: Mapping[str, Samples]
) -> tuple[Samples, NDArray[np.bool_]]:
    """The engine's own forces, shape (n, joints), N, with friction as large as `found`; and where it has its sense.

    `forces`, (n, bodies, 3), act besides. The rates of a step are those of its middle, half a step later.
    """
    size, before, after = run.steps.size, run.record[: -1 : run.steps.stride], run.record[1 :: run.steps.stride]
    rates, prescribed = before[..., 3:].copy(), [linkage.moved[name].prescribed for name in linkage.members]
    rates[:, prescribed] = after[:, prescribed, 3:]
    # The step that leads to a sample is taken again from where it began: the pose after it less one move by its rates;
    # a prescribed body has the rate that is set before the step.
    begin = after[..., :3] - size * rates
    model = run.model(begin[:1], rates[:1])
    bodies, sweeps = model.bodies | {GROUND: model.space.static_body}, model.space.iterations
    channels = {friction.channel(linkage.scene): friction for friction in linkage.scene.friction}
    motors = {name: motor for name, friction in channels.items() if (motor := _motor(linkage, friction, bodies))}
    model.space.add(*motors.values())
    impulses = np.empty((len(begin), len(model.joints)))
    for k in range(len(begin)):
        model.place(begin[k : k + 1], rates[k : k + 1])
        for body, (x, y, moment) in zip(model.bodies.values(), forces[k].tolist(), strict=True):
            body.force, body.torque = (x, y), moment
        for name, motor in motors.items():
            motor.max_force = abs(found[name][k])
        model.space.step(size)
        model.space.iterations = sweeps // FIRST_SWEEPS
        impulses[k] = [joint.impulse / size for joint in model.joints.values()]
    # A motor's sense is what the engine finds; a sample counts only where the friction found there opposes the slip.
    slips = np.einsum("nkbi,nbi->nk", directions(linkage, after[..., :3]), after[..., 3:])
    return impulses, np.all(slips * np.stack([found[name] for name in channels], axis=1) <= 0, axis=1)


def _motor(linkage: LinkageConstraints, friction: Friction, bodies: Bodies) -> pymunk.Constraint | None:
    """What resists the joint's motion, and corrects no position; None between bodies that forces do not move."""
    groove = CONTACTS[type(friction)].groove(friction, linkage, len(bodies) * linkage.size)  # no body gets further
    ends, places = friction.joined(linkage.scene), [pair(place) for place in groove]
    earlier, later = (bodies[name] for name in ends)
    if pymunk.Body.DYNAMIC not in (earlier.body_type, later.body_type):
        return None
    motor = pymunk.GrooveJoint(earlier, later, *places) if places else pymunk.SimpleMotor(earlier, later, 0)
    motor.error_bias = 1
    return motor

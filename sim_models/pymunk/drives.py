"""A drive between two moving bodies: a joint that is told before every step where the drive is to be after it.

An elbow is a gear of ratio 1, whose phase is the drive's position. A cylinder is a bar of a changing length, beside the
groove: it leads along the guide to the body's first point, from a point of the carrier so far back on the guide that
the length is never zero. Such a length is not linear in the coordinates, and the engine's steps are; so it is told the
one that a step in all coordinates, by the same linear equations, takes to the drive's position.
"""

from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
import pymunk

from .bodies import pair
from .constraints import LinkageConstraints, PoseArray, solved

AIMS = 6  # at most; each is off by a hundredth of the one before, by how far a step turns the bodies
ON_TARGET = 1e-14  # of the linkage's size

DriveJoint: TypeAlias = pymunk.GearJoint | pymunk.PinJoint


def drive_joint(linkage: LinkageConstraints, bodies: Mapping[str, pymunk.Body]) -> DriveJoint:
    """The joint between what drives and what is driven."""
    scene = linkage.scene
    ends = bodies[scene.drive_on], bodies[scene.drive.body]
    if scene.driven_slide is None:
        return pymunk.GearJoint(*ends, 0, 1)
    return pymunk.PinJoint(*ends, pair(linkage.back_end), pair(linkage.first_arm(scene.drive.body)))


def aim(joint: DriveJoint, linkage: LinkageConstraints, record: PoseArray, position: float, dt: float) -> None:
    """Set the joint so that the next step takes the drive to a position, rad or m; `record`, (bodies, 6), is now."""
    if isinstance(joint, pymunk.GearJoint):
        joint.phase = position
        return
    q = (record[:, :3] + dt * record[:, 3:])[None]  # where the step begins
    J, gaps = linkage.jacobian(q), linkage.gaps(q, np.array([position]))
    step, ratio = solved(np.concatenate([J, J]), np.stack([-gaps[0], np.eye(gaps.size)[-1]]))
    aimed, missed = position, np.inf
    for _ in range(AIMS):
        if abs(missed) > ON_TARGET * linkage.size:
            missed = float(linkage.drive_position(q + step + (aimed - position) * ratio)[0]) - position
            aimed -= missed
    joint.distance = aimed - linkage.back

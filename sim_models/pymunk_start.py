"""A consistent start for pymunk: the pose on the sketch's branch, by continuation.

pymunk closes open joints by itself, but onto whichever branch is near. Hence the sketch's gaps are closed little by
little, and the crank is turned little by little, with Newton's method after each step; no step may change the branch.
"""

from collections.abc import Callable
from math import copysign, degrees, pi, radians, remainder

import numpy as np

from scenes import Failure, Status
from scenes.motion import Samples

from .pymunk_linkage import Linkage, Poses, branch

LARGEST_TURN = radians(3.0)  # of the crank in one continuation step
LARGEST_CLOSING = 0.1  # of the sketch's gaps in one continuation step
SMALLEST_STEP = 1e-6  # of a whole path; a linkage that needs smaller ones is locked
NEWTON_STEPS = 6  # near a solution 3 or 4 are enough; more means a jump to somewhere else
CLOSED = 1e-12  # how far from zero a constraint may stay, by the linkage's size; well above rounding


def start(linkage: Linkage) -> Poses:
    """Return the pose at the drive's start angle, on the sketch's branch, shape (1, bodies, 3).

    Raises:
        Failure: cannot_assemble, here or somewhere on the crank's way around, with the crank angle.
    """
    drive = linkage.scene.drive
    sketched = drive.start - remainder(drive.start - linkage.scene.sketch.angle, 2 * pi)
    q = _sketch(linkage, sketched)
    gaps = linkage.gaps(q, np.array([sketched]))
    q = _follow(linkage, q, lambda s: (sketched, (1 - s) * gaps), LARGEST_CLOSING)
    q = turn(linkage, q, sketched, drive.start)
    turn(linkage, q, drive.start, drive.start + copysign(2 * pi, drive.speed))
    return q


def turn(linkage: Linkage, q: Poses, here: float, there: float) -> Poses:
    """Return the pose q, shape (1, bodies, 3), carried along from one crank angle to another, rad.

    Raises:
        Failure: cannot_assemble, with the crank angle.
    """
    closed = np.zeros(q.size)
    largest = LARGEST_TURN / max(abs(there - here), LARGEST_TURN)
    return _follow(linkage, q, lambda s: (here + s * (there - here), closed), largest)


def rates(linkage: Linkage, q: Poses, crank_speed: float) -> Poses:
    """Return dq/dt on the constraints, shape (1, bodies, 3)."""
    prescribed = np.zeros(q.size)
    prescribed[-1] = crank_speed
    return np.linalg.solve(linkage.jacobian(q)[0], prescribed).reshape(q.shape)


def _sketch(linkage: Linkage, crank_angle: float) -> Poses:
    """Return the pose that fits the sketch best, body by body, shape (1, bodies, 3); its joints gape."""
    scene = linkage.scene
    drawn = {point: complex(*place) for point, place in [*scene.ground.items(), *scene.sketch.points.items()]}
    q = np.zeros((1, len(linkage.members), 3))
    for name, member in linkage.members.items():
        known = [point for point in member.arms if point in drawn]
        arms = np.array([member.arms[point] for point in known])
        places = np.array([drawn[point] for point in known])
        if name == scene.drive.body:
            theta = crank_angle
        elif scene.bodies[name].slide is not None:
            theta = 0.0
        else:
            theta = float(np.angle(np.vdot(arms - arms.mean(), places - places.mean())))
        z = (places - arms * np.exp(1j * theta)).mean()
        q[0, linkage.index[name]] = z.real, z.imag, theta
    return q


def _follow(linkage: Linkage, q: Poses, path: Callable[[float], tuple[float, Samples]], largest: float) -> Poses:
    """Return where the solution of C(q) = gaps arrives on a path s -> (crank angle, gaps), 0 <= s <= 1."""
    here = branch(linkage.jacobian(q))
    s, step = 0.0, largest
    while s < 1:
        ahead = min(1.0, s + step)
        found = _newton(linkage, q, *path(ahead))
        if found is not None and branch(linkage.jacobian(found)) == here:
            q, s, step = found, ahead, min(largest, 2 * step)
        elif step > SMALLEST_STEP:
            step /= 2
        else:
            angle = degrees(path(ahead)[0])
            raise Failure(
                Status.cannot_assemble, f"the bodies cannot be put together at a crank angle of {angle:.2f} deg"
            )
    return q


def _newton(linkage: Linkage, q: Poses, crank_angle: float, gaps: Samples) -> Poses | None:
    """Return the solution of C(q) = gaps near q, or None."""
    for _ in range(NEWTON_STEPS):
        excess = linkage.gaps(q, np.array([crank_angle])) - gaps
        if np.abs(excess).max() <= CLOSED * linkage.size:
            return q
        try:
            q = q - np.linalg.solve(linkage.jacobian(q)[0], excess.ravel()).reshape(q.shape)
        except np.linalg.LinAlgError:
            return None
    return None

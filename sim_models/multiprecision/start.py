"""The start: the linkage closed from its sketch, and moved to the drive's start."""

from fractions import Fraction
from math import remainder, tau

import numpy as np
from flint import arb, arb_mat

from scenes.scene import GROUND

from .constraints import LinkageEquations
from .continuation import Continuation

INSTANTS = 180  # a cycle, among which are the ends of a crank's range to a fraction of a degree
FULL_TURN = tau - 1e-6  # rad, but for roundings


def start(linkage: LinkageEquations, continuation: Continuation) -> arb_mat:
    """Return the pose at the drive's start, shape (3 bodies, 1).

    Raises:
        Failure: the linkage cannot be assembled as sketched, or is singular on the way to the start.
    """
    scene = linkage.scene
    begin, sketched = linkage.law.at(Fraction(0)).position, scene.sketch.drive
    if scene.driven_slide is None:
        way = [float(linkage.law.at(Fraction(k, INSTANTS)).position) for k in range(INSTANTS + 1)]
        low, high = min(way), max(way)
        # Past either end of its range a crank may lock; one that turns fully goes the short way round to the start.
        near = (low + high) / 2 if high - low < FULL_TURN else float(begin)
        sketched = near + remainder(sketched - near, tau)
    return continuation.follow(assembled(linkage, continuation, sketched), linkage.drive(begin))


def assembled(linkage: LinkageEquations, continuation: Continuation, position: float) -> arb_mat:
    """Return the pose closed from the sketch with the drive at a position, rad or m, shape (3 bodies, 1).

    Raises:
        Failure: the linkage cannot be assembled as sketched.
    """
    return continuation.follow(sketched_pose(linkage, position), linkage.drive(position))


def sketched_pose(linkage: LinkageEquations, position: float) -> arb_mat:
    """Return the pose where the bodies fit the sketch best, shape (3 bodies, 1), with the drive at a position.

    The turn that carries points s onto points z with the least squares is arg Σ z conj(s), both about the means of
    their bodies; bodies that slides align are turned by one angle, whose sum runs over the points of all.
    """
    scene, known = linkage.scene, linkage.sketched
    middle = complex(np.mean([complex(*at) for at in known.values()] or [0j]))
    own, at = {}, {}
    for name, arms in linkage.arms.items():
        shown = [point for point in scene.bodies[name].points if point in known]
        own[name] = np.array([complex(float(arms[p][0]), float(arms[p][1])) for p in shown] or [0j])
        at[name] = np.array([complex(*known[p]) for p in shown] or [middle])
    turn = {name: np.vdot(own[name] - own[name].mean(), at[name] - at[name].mean()) for name in own}
    q = arb_mat(3 * len(linkage.index), 1)
    for name, i in linkage.index.items():
        aligned = scene.aligned[name]
        if GROUND in aligned:
            angle = 0.0
        elif scene.drive.body in aligned:
            angle = position
        else:
            angle = float(np.angle(sum(turn[other] for other in linkage.index if other in aligned)))
        r = at[name].mean() - np.exp(1j * angle) * own[name].mean()
        q[3 * i, 0], q[3 * i + 1, 0], q[3 * i + 2, 0] = arb(r.real), arb(r.imag), arb(angle)
    return q

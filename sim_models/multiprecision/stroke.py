"""The end of a press force's stroke: as far against the force as a cycle of the drive takes its slider."""

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from flint import arb, arb_mat

from scenes import Scene
from scenes.loads import PressForce

from .blocks import solved
from .constraints import LinkageEquations
from .continuation import Continuation

INSTANTS = 180  # a cycle; the slider does not turn round twice between two of them
HALVINGS = 24  # of the way between two of them: 1e-9 of a cycle, to 1e-17 of the stroke where the slider stands still

Move: TypeAlias = Callable[[arb_mat, Fraction], tuple[arb_mat, bool, float]]


def stroke_ends(linkage: LinkageEquations, continuation: Continuation, q: arb_mat) -> dict[PressForce, float]:
    """Return the end of every press force's stroke, see `end_of_stroke`."""
    presses = [load for load in linkage.scene.loads if isinstance(load, PressForce)]
    strokes = {load: (load.body, closing_sign(linkage.scene, load)) for load in presses}
    ends = {
        stroke: end_of_stroke(linkage, continuation, q, load)
        for stroke, load in {stroke: load for load, stroke in strokes.items()}.items()
    }
    return {load: ends[stroke] for load, stroke in strokes.items()}


def end_of_stroke(linkage: LinkageEquations, continuation: Continuation, q: arb_mat, load: PressForce) -> float:
    """Return the slider's displacement at the end of its closing stroke, m: at a dead point, or where a run ends.

    Args:
        linkage: the equations
        continuation: follows the pose
        q: the pose at the drive's start, shape (3 bodies, 1)
        load: the force that resists the stroke

    Raises:
        Failure: the linkage is singular within the cycle.
    """
    displacement, closing = linkage.displacement(load.body), closing_sign(linkage.scene, load)

    def move(q: arb_mat, cycles: Fraction) -> tuple[arb_mat, bool, float]:
        """Return the pose after some cycles, whether the slider closes there, and how far it has closed, m."""
        command = linkage.law.at(cycles)
        q = continuation.follow(q, linkage.drive(command.position))
        motion = solved(linkage.groups, linkage.constraints.jacobian(q), linkage.drive(command.rate))
        velocity = (displacement.jacobian(q) * motion)[0, 0]
        return q, bool(velocity * closing > 0), closing * float(displacement.value(q)[0, 0])

    instants = [Fraction(k, INSTANTS) for k in range(INSTANTS + 1)]
    q, closes, farthest = move(q, instants[0])
    for early, late in pairwise(instants):
        closed_before = closes
        q, closes, closed = move(q, late)
        farthest = max(farthest, closed)
        if closed_before and not closes:
            farthest = max(farthest, _dead_point(move, q, early, late))
    return closing * farthest


def closing_sign(scene: Scene, load: PressForce) -> int:
    """Return the sign of the displacement's rate while the slider closes: it then moves against the force."""
    slide = scene.bodies[load.body].slide
    assert slide is not None
    push = sum((arb(f) * e for f, e in zip(load.force, slide.along, strict=True)), arb(0))
    return 1 if push < 0 else -1


def _dead_point(move: Move, q: arb_mat, early: Fraction, late: Fraction) -> float:
    """Return how far the slider has closed where it turns round between two instants, by bisection, m."""
    closed = -np.inf
    for _ in range(HALVINGS):
        middle = (early + late) / 2
        q, closes, closed = move(q, middle)
        early, late = (middle, late) if closes else (early, middle)
    return closed

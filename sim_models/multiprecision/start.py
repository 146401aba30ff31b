"""The start: the linkage closed from its sketch, and moved to the drive's start; and the ends of press forces' strokes.

A press force's stroke ends as far against the force as a cycle of the drive takes its slider.
"""

from fractions import Fraction
from functools import cache, partial
from itertools import pairwise, product
from math import remainder, sqrt, tau

import numpy as np
from flint import arb, arb_mat

from scenes import Scene
from scenes.elements.loads import PressForce
from scenes.scene import GROUND

from .constraints import LinkageEquations
from .continuation import Continuation
from .rows import solved

# A cycle: the ends of a crank's range are among them to a fraction of a degree, and no slider turns round twice between
# two of them.
INSTANTS = 180
HALVINGS = 24  # of the way between two of them: 1e-9 of a cycle, to 1e-17 of the stroke where the slider stands still
MIN_DISPLACEMENT = 1e-3  # of the linkage's size, where the sketch shows a slider's points too near
FULL_TURN = tau - 1e-6  # rad, but for roundings


def start(linkage: LinkageEquations, continuation: Continuation) -> arb_mat:
    """Return the pose at the drive's start, shape (3 bodies, 1); Failure as of `Continuation.follow`."""
    scene = linkage.scene
    begin, sketched = linkage.law(Fraction(0)).position, scene.sketch.drive
    if linkage.prescribed.slide is None:
        way = [float(linkage.law(Fraction(k, INSTANTS)).position) for k in range(INSTANTS + 1)]
        low, high = min(way), max(way)
        # Past either end of its range a crank may lock; one that turns fully goes the short way round to the start.
        near = (low + high) / 2 if high - low < FULL_TURN else float(begin)
        sketched = near + remainder(sketched - near, tau)
    assembled = continuation.follow(sketched_pose(linkage, sketched), linkage.drive(sketched))
    return continuation.follow(assembled, linkage.drive(begin))


def sketched_pose(linkage: LinkageEquations, position: float) -> arb_mat:
    """Return the pose where the bodies fit the sketch best, shape (3 bodies, 1), with the drive at a position.

    The turn that carries points s onto points z with the least squares is arg Σ z conj(s), both about the means of
    their bodies; bodies that slides align are turned by one angle, whose sum runs over the points of all. The
    driven one is turned from what the drive moves it against.
    """
    scene, known = linkage.scene, linkage.scene.drawn
    middle = complex(np.mean([*known.values()] or [0j]))
    in_body, drawn = {}, {}
    for name, arms in linkage.arms.items():
        shown = [point for point in scene.bodies[name].points if point in known]
        in_body[name] = np.array([complex(arms[p]) for p in shown] or [0j])
        drawn[name] = np.array([known[p] for p in shown] or [middle])
    turn = {name: np.vdot(in_body[name] - in_body[name].mean(), drawn[name] - drawn[name].mean()) for name in in_body}
    total = {name: sum(turn[other] for other in turn if other in scene.aligned[name]) for name in turn}
    for name, slide in scene.slides.items():
        if slide.on != GROUND and total[name] == 0:
            total |= dict.fromkeys(scene.aligned[name], turn_of_guide(linkage, name, position))
    angle = {name: 0.0 if GROUND in scene.aligned[name] else float(np.angle(total[name])) for name in in_body}
    if linkage.prescribed.slide is None:
        angle |= dict.fromkeys(scene.aligned[linkage.prescribed.body], angle.get(linkage.prescribed.on, 0.0) + position)
    q = arb_mat(3 * len(linkage.index), 1)
    for name, i in linkage.index.items():
        r = drawn[name].mean() - np.exp(1j * angle[name]) * in_body[name].mean()
        q[3 * i, 0], q[3 * i + 1, 0], q[3 * i + 2, 0] = arb(r.real), arb(r.imag), arb(angle[name])
    return q


def turn_of_guide(linkage: LinkageEquations, slider: str, position: float) -> complex:
    """Return the turn that a slider and its carrier show by a point of each: B - A by that in their own frame.

    That is w + along s; the driven slider's displacement s is the drive's position, another's positive where w allows.
    """
    scene, slide, known = linkage.scene, linkage.scene.slides[slider], linkage.scene.drawn

    def place(name: str, point: str) -> complex:
        return complex(linkage.arms[name][point] - linkage.origins[name])

    first = scene.bodies[slider].points[0]
    for A, B in product(scene.bodies[slide.on].points, scene.bodies[slider].points):
        if A in known and B in known and A != B:
            along, way = complex(*slide.along), known[B] - known[A]
            w = complex(*slide.through) + place(slider, B) - place(slider, first) - place(slide.on, A)
            ahead, aside = (w * along.conjugate()).real, (w * along.conjugate()).imag
            s = sqrt(max(abs(way) ** 2 - aside**2, 0.0)) - ahead
            s = position if slider == linkage.prescribed.body else max(s, MIN_DISPLACEMENT * linkage.size)
            return way * (w + along * s).conjugate()
    return 0j


def stroke_ends(linkage: LinkageEquations, continuation: Continuation, q: arb_mat) -> dict[str, float]:
    """Return the end of every press force's stroke, by its place in the file, see `end_of_stroke`."""
    end = cache(partial(end_of_stroke, linkage, continuation, q))
    presses = linkage.scene.presses.items()
    return {place: end(load.body, closing_sign(linkage.scene, load)) for place, load in presses}


def end_of_stroke(linkage: LinkageEquations, continuation: Continuation, q: arb_mat, body: str, closing: int) -> float:
    """Return a slider's displacement at the end of its closing stroke, m: at a dead point, or where a run ends."""
    displacement = linkage.displacement(body)

    def move(q: arb_mat, cycles: Fraction) -> tuple[arb_mat, bool, float]:
        """Return the pose after some cycles, whether the slider closes there, and how far it has closed, m."""
        command = linkage.law(cycles)
        q = continuation.follow(q, linkage.drive(command.position))
        motion = solved(linkage.groups, linkage.constraints.jacobian(q), linkage.drive(command.rate))
        velocity = (displacement.jacobian(q) * motion)[0, 0]
        return q, bool(velocity * closing > 0), closing * float(displacement.value(q)[0, 0])

    instants = [Fraction(k, INSTANTS) for k in range(INSTANTS + 1)]
    q, closes, farthest = move(q, instants[0])  # from the pose at the drive's start, shape (3 bodies, 1)
    for early, late in pairwise(instants):
        closed_before = closes
        q, closes, closed = move(q, late)
        farthest = max(farthest, closed)
        # Bisection on the closing rate's sign, each pose followed from the last one. At a dead point the displacement
        # is flat: 2^-24 of the way leaves its square in the stroke.
        if closed_before and not closes:
            there = q  # it turns round between the two
            for _ in range(HALVINGS):
                middle = (early + late) / 2
                there, before, closed = move(there, middle)
                early, late = (middle, late) if before else (early, middle)
            farthest = max(farthest, closed)
    return closing * farthest


def closing_sign(scene: Scene, load: PressForce) -> int:
    """Return the sign of the displacement's rate while the slider closes: it then moves against the force."""
    push = sum((arb(f) * e for f, e in zip(load.force, scene.slides[load.body].along, strict=True)), arb(0))
    return 1 if push < 0 else -1

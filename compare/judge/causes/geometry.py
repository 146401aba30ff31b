"""Causes in the places, lengths and guides of a scene, and in its drive: they move all that hangs on them."""

from collections.abc import Callable, Iterator, Sequence
from heapq import nsmallest
from typing import NamedTuple

import numpy as np

from scenes import Motion, Scene
from scenes.loads import Vector
from scenes.motion import Samples

from ..constraints import constraints_of
from ..perturbation import Input, Path, inputs, put
from ..projection import projected
from .evidence import EXACT, Channels, Evidence, Hypothesis, Kind, fitted, thinned
from .parts import in_words

HAIR = 1e-6  # of the stroke, or rad: what an input is varied by, for a slope
CLOSER = 4  # inputs that are fitted, of all whose slopes were
ROUNDS = 4
WORK = 3e7  # squares of the constraints, for all slopes: of 15 constraints 8000 rows, of 87 the 60 that take seconds


class InputChange(NamedTuple):
    """One input of a scene, and the scene that differs in it by k numbers."""

    kind: Kind
    place: str
    what: str
    scene: Callable[[Samples], Scene]
    steps: Samples  # shape (k,)
    amount: Callable[[Samples], str]


def geometry_causes(evidence: Evidence) -> Iterator[Hypothesis]:
    """Yield other inputs of the geometry: those whose slopes explain most, fitted, until one explains all."""
    first, still = [], np.ones((1, len(evidence.rows)))
    turn = 2 * np.pi * evidence.true["time"] / evidence.reference.scene.drive.cycle
    for number, change in enumerate(_changes(evidence)):
        slopes = [solved(change.scene(step), evidence.true, 1) for step in np.diag(change.steps)]
        _, predicted = _along(evidence, change, slopes, still)
        first.append((evidence.left(predicted) if predicted else np.inf, number, change))
        if change.kind is Kind.length and len(slopes) == 1:
            x, predicted = _along(evidence, change, slopes, np.array([*still, np.cos(turn), np.sin(turn)]))
            amount = f"{evidence.reference.scene.length(np.hypot(*x[1:]), 3)} over the turn"
            yield Hypothesis(change.kind, change.place, amount, f"{change.what} varies by {amount}", predicted, len(x))
    for _, _, change in nsmallest(CLOSER, first):
        x, predicted = _fitted(evidence, change)
        if predicted:
            amount = change.amount(x)
            yield Hypothesis(change.kind, change.place, amount, f"{change.what} is {amount}", predicted, len(x))
            if evidence.left(predicted) <= EXACT:
                return


def affordable(evidence: Evidence) -> Evidence:
    """Return the evidence at so many rows that all slopes are found in seconds: of few bodies all of them."""
    scene = evidence.reference.scene
    numbers, equations = sum(1 for _ in _changes(evidence)), len(constraints_of(scene).units)
    return thinned(evidence, int(WORK / (numbers * equations**2)))


def _along(
    evidence: Evidence, change: InputChange, slopes: Sequence[Motion], courses: Samples
) -> tuple[Samples, Channels]:
    """Return numbers by which an input is off along courses, shape (m, n), and the motion then, by its slopes."""
    true = evidence.true
    steps = np.repeat(change.steps, len(courses))

    def along(x: Samples) -> Channels:
        by = (x / steps).reshape(len(slopes), -1) @ courses
        return {c: true[c] + sum(b * (s[c] - true[c]) for b, s in zip(by, slopes, strict=True)) for c in evidence.names}

    return fitted(evidence, along, steps)


def _fitted(evidence: Evidence, change: InputChange) -> tuple[Samples, Channels]:
    """Return the numbers by which an input is off, and the motion then, each found from the one before."""
    near = evidence.true

    def predict(x: Samples) -> Channels:
        nonlocal near
        close = np.abs(x - last).max(initial=0.0) <= change.steps.max()
        found = solved(change.scene(x), near, 1 if close else 3)
        if not close and np.isfinite([*found.samples.values()]).all():
            near, last[:] = found, x
        return found.samples

    last = np.zeros(len(change.steps))
    return fitted(evidence, predict, change.steps, ROUNDS)


def solved(scene: Scene, near: Motion, times: int) -> Motion:
    """Return the motion of a scene with the drive where it is, from another that is near, by steps of Newton."""
    with np.errstate(all="ignore"):
        for _ in range(times):
            near = projected(scene, near).closed
    return near


def _changes(evidence: Evidence) -> Iterator[InputChange]:
    scene, hair = evidence.reference.scene, HAIR * evidence.reference.stroke
    for found in inputs(scene):
        if found.geometry and found.path[0] in ("ground", "bodies") and found.path[-1] != "com":
            yield _moved(scene, found, hair)
        elif found.direction:
            yield _tilted(scene, found)
    how = lambda x: in_words(1 + float(x[0]))[1]  # noqa: E731
    scaled = lambda x: rescaled(scene, 1 + float(x[0]))  # noqa: E731
    yield InputChange(Kind.length, "all", "each length", scaled, np.full(1, HAIR), how)


def rescaled(scene: Scene, by: float) -> Scene:
    """Return the whole linkage larger or smaller; its forces and speeds stay.

    Args:
        scene: the linkage.
        by: the factor of each length.

    Returns:
        Another scene.
    """
    other = scene
    for path, value, is_length, _ in inputs(scene):
        if is_length:
            other = put(other, path, (by * value[0], by * value[1]) if isinstance(value, tuple) else by * value)
    return other


def _moved(scene: Scene, found: Input, hair: float) -> InputChange:
    path, value = found.path, found.value
    *_, where, last = path
    if isinstance(value, tuple):
        a, b = value
        if where == "slide":
            return _beside(scene, found, hair)

        def moved(x: Samples) -> Scene:
            return _with(scene, path, (a + float(x[0]), b + float(x[1])))

        on_ground = path[0] == "ground"
        kind = Kind.place if on_ground else Kind.length
        place = str(last if on_ground else path[1])
        what = str(last) if on_ground else f"{place}'s point {last}"
        return InputChange(kind, place, what, moved, np.full(2, hair), lambda x: f"{scene.length(np.hypot(*x), 3)} off")
    assert isinstance(last, frozenset)

    def longer(x: Samples) -> Scene:
        return _with(scene, path, value + float(x[0]))

    name = "-".join(point for point in scene.bodies[str(path[1])].points if point in last)
    what = f"{path[1]}'s length {name}"
    how = lambda x: f"{scene.length(abs(x[0]), 3)} too {'long' if x[0] > 0 else 'short'}"  # noqa: E731
    return InputChange(Kind.length, str(path[1]), what, longer, np.full(1, hair), how)


def _beside(scene: Scene, found: Input, hair: float) -> InputChange:
    """Return a guide beside its place; along itself it stays the same."""
    name = str(found.path[1])
    slide = scene.bodies[name].slide
    assert slide is not None
    through, beside = complex(*slide.through), 1j * complex(*slide.along)

    def moved(x: Samples) -> Scene:
        place = through + float(x[0]) * beside
        return _with(scene, found.path, (place.real, place.imag))

    how = lambda x: f"{scene.length(abs(x[0]), 3)} beside its place"  # noqa: E731
    return InputChange(Kind.guide, name, f"{name}'s guide", moved, np.full(1, hair), how)


def _tilted(scene: Scene, found: Input) -> InputChange:
    assert isinstance(found.value, tuple)
    along = complex(*found.value)

    def tilted(x: Samples) -> Scene:
        turned = along * np.exp(1j * x[0])
        return _with(scene, found.path, (float(turned.real), float(turned.imag)))

    how = lambda x: f"turned by {scene.amount('angle', x[0], 3)}"  # noqa: E731
    name = str(found.path[1])
    return InputChange(Kind.guide, name, f"{name}'s guide", tilted, np.full(1, HAIR), how)


def _with(scene: Scene, path: Path, value: float | Vector) -> Scene:
    other: Scene = put(scene, path, value)
    return other

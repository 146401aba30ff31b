"""Linkages drawn at random whose drive is between moving bodies: cylinders, from the ground or not, and elbows.

A lever rocks, dyads hang on it as in `linkages`, and the drive is where its position goes with the lever's all the way,
nowhere by less than a third of the most. Cylinders that do not drive are added to any linkage in the same way.
"""

from collections.abc import Iterator
from itertools import combinations
from typing import NamedTuple

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenes.scene import GROUND

from .linkages import STEPS, Drawing, Path, directions, drawing_of, hang, numbers, signs, vectors

DRIVES = ("", "cylinder on the ground", "cylinder", "elbow")  # the first is on the ground, as in `linkages`
THERE = slice(len(STEPS) // 4, 3 * len(STEPS) // 4 + 1)  # of the lever's way there and back
LEAST = 0.3  # of the drive's largest rate by the lever's angle


class End(NamedTuple):
    """Where a cylinder's pin may be: at a point of a body, or off it."""

    body: str
    point: str
    off: complex
    path: Path


@st.composite
def moving_drawings(draw: st.DrawFn, first: str, kind: str) -> Drawing:
    """Draw a linkage with a drive of a kind, and perhaps with a cylinder that does not drive."""
    if kind:
        pivot, t = draw(vectors(2)), draw(directions())
        lever = draw(numbers(0.4, 0.8)) * np.sin(STEPS)
        u = np.exp(1j * lever)
        path = {"O": np.full(STEPS.shape, pivot), "A": pivot + t * u}
        drawing = Drawing(path, {GROUND: np.ones(STEPS.shape, complex)}, {}, ["O"])
        drawing.add("lever", ["O", "A"], u)
        hang(draw, drawing, first)
        _drive(draw, drawing, kind, lever)
    else:
        drawing = draw(drawing_of(first))
    spans = [ends for ends in combinations(_ends(draw, drawing), 2) if _spans(ends) and np.ptp(_length(ends)) > 0.05]
    if spans and draw(signs) > 0:
        _add_cylinder(draw, drawing, draw(st.sampled_from(spans)), ("barrel", "rod"))
    return drawing


def _drive(draw: st.DrawFn, drawing: Drawing, kind: str, lever: NDArray[np.float64]) -> None:
    def goes_with(position: NDArray[np.float64]) -> bool:
        slope = np.gradient(position[THERE], lever[THERE])
        return bool((slope * slope[0]).min() > 0 and np.abs(slope).min() > max(LEAST * np.abs(slope).max(), 0.1))

    if kind == "elbow":
        elbows = [
            (body, on)
            for pair in combinations(drawing.points, 2)
            for body, on in (pair, pair[::-1])
            if len({*drawing.points[body]} & {*drawing.points[on]}) == 1
            and body not in drawing.slides
            and goes_with(np.unwrap(np.angle(drawing.u[body] / drawing.u[on])))
        ]
        if elbows:
            drawing.driver, drawing.driven_on = draw(st.sampled_from(elbows))
            return
    ends = [end for end in _ends(draw, drawing) if end.body != GROUND] if kind == "cylinder" else []
    spans = [span for span in combinations(ends, 2) if _spans(span) and goes_with(_length(span))]
    if spans:
        span = draw(st.sampled_from(spans))
    else:  # about square to the lever, all the way
        pivot, A = drawing.path["O"][0], drawing.path["A"]
        beside = np.exp(1j * draw(signs) * draw(numbers(1.3, 1.8)))
        ground = pivot + draw(numbers(1.2, 3)) * (A[0] - pivot) * beside
        span = End(GROUND, "", ground, np.full(STEPS.shape, ground)), End("lever", "A", 0j, A)
    _add_cylinder(draw, drawing, span, ("tube", "driver"))
    drawing.driver, drawing.driven_on = "driver", "tube"


def _ends(draw: st.DrawFn, drawing: Drawing) -> Iterator[End]:
    """Yield a point of each body, and a place of each off its points; and a place on the ground."""
    for body, points in [*drawing.points.items()]:
        point, off = draw(st.sampled_from(points)), draw(numbers(0.3, 1)) * draw(directions())
        for of in (0j, off):
            yield End(body, point, of, drawing.path[point] + of * drawing.u[body])
    ground = draw(vectors(3))
    yield End(GROUND, "", ground, np.full(STEPS.shape, ground))


def _length(ends: tuple[End, End]) -> NDArray[np.float64]:
    length: NDArray[np.float64] = np.abs(ends[1].path - ends[0].path)
    return length


def _spans(ends: tuple[End, End]) -> bool:
    """Whether a cylinder between two ends is long enough all the way."""
    return ends[0].body != ends[1].body and bool(_length(ends).min() > 0.4)


def _add_cylinder(draw: st.DrawFn, drawing: Drawing, ends: tuple[End, End], names: tuple[str, str]) -> None:
    """Add a body at each end, one of which slides along the other: displaced to the positive side, past both pins."""
    P, Q = (_pin(drawing, end) for end in (ends if draw(st.booleans()) else ends[::-1]))
    d = drawing.path[Q] - drawing.path[P]
    beside = 0.4 * float(np.abs(d).min()) * draw(st.just(0.0) | numbers(-1, 1))
    ahead = np.sqrt(np.abs(d) ** 2 - beside**2)
    w = d / (ahead + 1j * beside)
    for name, point in zip(names, (P, Q), strict=True):
        drawing.add(name, [point], w / w[0])
    drawing.slides[names[1]] = names[0], complex(w[0])
    drawing.displaced[names[1]] = float(ahead[0]) - draw(numbers(-0.5, 0.8)) * float(ahead.min())


def _pin(drawing: Drawing, end: End) -> str:
    """Return the name of the point at an end, which is new where it is off the others or on the ground."""
    if end.body != GROUND:
        return drawing.carried(end.body, end.point, end.off) if end.off else end.point
    name = f"G{len(drawing.path)}"
    drawing.path[name] = end.path
    drawing.ground.append(name)
    return name

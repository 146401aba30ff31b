"""Linkages drawn at random that turn fully, clear of lock; their geometry is worked out here, by circles and lines.

The crank is 1 m long. Every dyad is sized to its foot's path over the whole turn, so no drawing is thrown away: the two
bars of an RRR dyad stay at 20 to 160 degrees to each other, the bar of an RRP dyad within 70 degrees of its guide.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import combinations
from math import cos, pi, radians, sin, sqrt
from types import MappingProxyType

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenes import Scene
from scenes.scene import Body, Drive, Load, Sketch, Slide, Vector

Path = NDArray[np.complex128]  # positions at each step of the crank, m

STEPS = np.linspace(0, 2 * pi, 96, endpoint=False)


def xy(z: complex) -> Vector:
    return z.real, z.imag


def numbers(low: float, high: float) -> st.SearchStrategy[float]:
    """Draw from a thousand steps: plain to read when shrunk, and never a size that only roundings could explain."""
    return st.integers(0, 1000).map(lambda n: low + (high - low) * n / 1000)


def vectors(most: float) -> st.SearchStrategy[complex]:
    return st.builds(complex, numbers(-most, most), numbers(-most, most))


def directions() -> st.SearchStrategy[complex]:
    return numbers(-3.1, 3.1).map(lambda angle: complex(cos(angle), sin(angle)))


signs = st.sampled_from((1, -1))


@dataclass
class _Drawing:
    """What is drawn so far: each point's path over one turn, each body's points, each slider's guide."""

    path: dict[str, Path]
    points: dict[str, list[str]]
    ground: list[str] = field(default_factory=lambda: ["O"])
    slides: dict[str, Slide] = field(default_factory=dict)


@st.composite
def drawn_linkages(draw: st.DrawFn) -> tuple[Scene, dict[str, Path]]:
    """Draw a linkage of one dyad or two, and where its moving points are at the steps after the sketched angle."""
    pivot = draw(vectors(2))
    path = {"O": np.full(STEPS.shape, pivot), "A": pivot + draw(directions()) * np.exp(1j * STEPS)}
    drawing = _Drawing(path, {"crank": ["O", "A"]})
    _hang(draw, drawing, "A", 1)
    if draw(st.booleans()):
        _hang(draw, drawing, _coupler_point(draw, drawing), 2)
    return _scene(draw, drawing), {point: z for point, z in path.items() if point not in drawing.ground}


def linkages() -> st.SearchStrategy[Scene]:
    return drawn_linkages().map(lambda drawn: drawn[0])


def _coupler_point(draw: st.DrawFn, drawing: _Drawing) -> str:
    """Return where the second dyad hangs: a bar's point beside its pins, or a pin that the first dyad has already."""
    feet = {"bar1": "A"} | ({"rocker1": "B1"} if "rocker1" in drawing.points else {})
    carrier = draw(st.sampled_from(["A", "P1", *feet, *feet]))
    if carrier not in feet:
        return carrier
    foot = drawing.path[feet[carrier]]
    drawing.path["T"] = foot + complex(draw(numbers(-0.5, 1.5)), draw(signs) * draw(numbers(0.2, 1))) * (
        drawing.path["P1"] - foot
    )
    drawing.points[carrier].append("T")
    return "T"


def _hang(draw: st.DrawFn, drawing: _Drawing, A: str, number: int) -> None:
    """Hang a dyad on point A: a bar to P, and there a rocker about a new ground point B or a slider."""
    foot = drawing.path[A]
    centre = complex(np.ptp(foot.real), np.ptp(foot.imag)) / 2 + complex(foot.real.min(), foot.imag.min())
    radius = max(0.5, float(np.abs(foot - centre).max()))  # not much smaller than the crank
    P, B, slider = f"P{number}", f"B{number}", f"slider{number}"
    drawing.points[f"bar{number}"] = [A, P]
    if draw(st.booleans()):
        around = draw(st.booleans()) and A == "A"  # a crank about B: four-bars with two cranks
        pivot = centre + radius * draw(numbers(0.2, 0.4) if around else numbers(2.5, 4)) * draw(directions())
        drawing.path[B], drawing.path[P] = np.full(STEPS.shape, pivot), _meet(draw, foot, pivot)
        drawing.points[f"rocker{number}"] = [P, B]
        drawing.ground.append(B)
    else:
        t, offset = draw(directions()), draw(st.just(0.0) | numbers(-0.8, 0.8))
        r = radius * (1 + abs(offset)) / sin(radians(draw(numbers(25, 70))))
        through = centre + radius * offset * 1j * t
        e = (foot - through) * t.conjugate()
        drawing.path[P] = through + t * (e.real + draw(signs) * np.sqrt(r**2 - e.imag**2))
        drawing.points[slider] = [P]
        if draw(st.booleans()):  # the guided point beside the pin
            aside = 0.1 + draw(vectors(1))
            drawing.path[f"G{number}"] = drawing.path[P] - aside
            drawing.points[slider] = [f"G{number}", P]
            through -= aside
        drawing.slides[slider] = Slide(xy(through + draw(numbers(-2, 2)) * t), xy(t))


def _meet(draw: st.DrawFn, A: Path, B: complex) -> Path:
    """Return where bars of drawn lengths from A and from B meet, on either side of A-B.

    With lengths r and k r at an angle mu, |A - B| = r f(mu). B was drawn so that the least distance is over 3/7 of the
    greatest, and f(20 deg) is under 3/8 of f(160 deg), so there is always room for r.
    """
    k = draw(numbers(0.5, 2))
    folded, stretched = (sqrt(1 + k**2 - 2 * k * cos(radians(mu))) for mu in (20, 160))
    D = np.abs(B - A)
    r = draw(numbers(float(D.max()) / stretched, float(D.min()) / folded))
    x = (D**2 + r**2 - (k * r) ** 2) / (2 * D)
    meet: Path = A + (x + draw(signs) * 1j * np.sqrt(r**2 - x**2)) * (B - A) / D
    return meet


def _scene(draw: st.DrawFn, drawing: _Drawing) -> Scene:
    """Return the scene with its bodies in any order, masses, loads and weights."""
    at = {point: complex(z[0]) for point, z in drawing.path.items()}
    bodies, angle = {}, 0.0
    for name in draw(st.permutations(list(drawing.points))):
        bodies[name], turned = _body(draw, name, drawing.points[name], at, drawing.slides.get(name))
        angle = turned if name == "crank" else angle
    places = [(name, point) for name, body in bodies.items() for point in body.points]
    loads = draw(st.lists(st.tuples(st.sampled_from(places), vectors(20)), max_size=3))
    return Scene(
        name="drawn",
        title="drawn",
        source="",
        file="drawn.toml",
        ground=MappingProxyType({point: xy(at[point]) for point in drawing.ground}),
        bodies=MappingProxyType(bodies),
        drive=Drive("crank", draw(signs) * draw(numbers(0.5, 20)), draw(numbers(-3, 3))),
        loads=tuple(Load(*place, xy(force)) for place, force in loads),
        gravity=draw(vectors(10).map(xy) | st.none()),
        sketch=Sketch(angle, MappingProxyType({p: _rough(z) for p, z in at.items() if p not in drawing.ground})),
        output="A",
        tolerances=MappingProxyType({}),
    )


def _rough(z: complex) -> Vector:
    return round(z.real, 2), round(z.imag, 2)


def _body(
    draw: st.DrawFn, name: str, points: list[str], at: dict[str, complex], slide: Slide | None
) -> tuple[Body, float]:
    """Return a body, by its lengths or in some frame of its own, and the angle of its x axis as sketched."""
    local = lengths = None
    if slide is None:
        points = draw(st.permutations(points))
    if slide is None and draw(st.booleans()):
        lengths = MappingProxyType({frozenset(pair): abs(a - b) for pair, a, b in _pairs(points, at)})
        angle = float(np.angle(at[points[1]] - at[points[0]]))
    else:
        angle = 0.0 if slide is not None else draw(numbers(-3, 3))
        origin, back = at[points[-1]] + draw(vectors(1)), complex(cos(angle), -sin(angle))
        local = MappingProxyType({point: xy((at[point] - origin) * back) for point in points})
    mass = draw(numbers(0.1, 10) if name == "bar1" else st.just(0.0) | numbers(0.1, 10))  # bar1: never all without
    com = draw(vectors(1).map(xy) | st.none())
    inertia = None if com is None else mass * draw(numbers(0.01, 2))
    return Body(name, tuple(points), local, lengths, mass, com, inertia, slide), angle


def _pairs(points: list[str], at: dict[str, complex]) -> Iterator[tuple[tuple[str, str], complex, complex]]:
    for p, q in combinations(points, 2):
        yield (p, q), at[p], at[q]

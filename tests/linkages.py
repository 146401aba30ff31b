"""Linkages drawn at random that move all the way, clear of lock; their geometry is found here, by circles and lines.

The crank is 1 m long, a driven slider moves 1 m to either side. Every dyad is sized to the paths of what it hangs on,
so no drawing is thrown away: two bars meet at 20 to 160 degrees, a bar is within 70 degrees of its guide, two guides
cross at 27 degrees or more, and the pins of a dyad with an inner guide are never squarer to it than 45 degrees.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import combinations
from math import cos, pi, radians, sin, sqrt
from typing import TypeAlias

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from scenes.scene import GROUND, Vector

Path = NDArray[np.complex128]  # positions at each step of the drive, m

STEPS = np.linspace(0, 2 * pi, 96, endpoint=False)  # of the crank, rad; a driven slider follows their sine


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
class Drawing:
    """What is drawn so far, on the ground and on moving bodies, over all steps."""

    path: dict[str, Path]  # by point
    u: dict[str, Path]  # by body: how it has turned since the first step
    points: dict[str, list[str]]  # by body
    ground: list[str] = field(default_factory=list)
    slides: dict[str, tuple[str, complex]] = field(default_factory=dict)  # by slider: on what, along what at first
    displaced: dict[str, float] = field(default_factory=dict)  # by slider, at first, where it is not any, m
    driver: str = "driver"
    driven_on: str = GROUND

    def add(self, body: str, points: list[str], u: Path) -> None:
        self.points[body], self.u[body] = points, u

    def slide(self, draw: st.DrawFn, body: str, on: str, t: complex) -> None:
        """Let two bodies slide on each other, and draw which of them is the slider."""
        free = on not in (GROUND, "driver") and on not in self.slides
        if body in self.slides or (free and draw(st.booleans())):
            body, on = on, body
        self.slides[body] = on, t

    def carried(self, body: str, point: str, off: complex) -> str:
        """Give a body one point more, off another one of the body."""
        name = f"T{len(self.path)}"
        self.path[name] = self.path[point] + off * self.u[body]
        self.points[body].append(name)
        return name


def _foot(draw: st.DrawFn, drawing: Drawing) -> str:
    """Return where a dyad hangs: at a pin that there is, or at a new point of a body."""
    body = draw(st.sampled_from(list(drawing.points)))
    point = draw(st.sampled_from(drawing.points[body]))
    if point not in drawing.ground and draw(st.booleans()):
        return point
    return drawing.carried(body, point, draw(numbers(0.3, 1.2)) * draw(directions()))


def _around(path: Path) -> tuple[complex, float]:
    """Return the middle of a path and how far it goes from there, at least as far as half a crank."""
    middle = complex(np.ptp(path.real), np.ptp(path.imag)) / 2 + complex(path.real.min(), path.imag.min())
    return middle, max(0.5, float(np.abs(path - middle).max()))


def _other_foot(draw: st.DrawFn, drawing: Drawing, A: str, B: str) -> str:
    """Return a point whose distance from A does not change too much: on the ground, B, or another one that moves."""
    foot = drawing.path[A]
    apart = {point: np.abs(z - foot) for point, z in drawing.path.items() if point not in drawing.ground}
    moving = [point for point, d in apart.items() if d.min() > 3 / 7 * d.max() > 0.2 and np.ptp(d) > 0.01]
    if moving and draw(signs) > 0:
        return draw(st.sampled_from(moving))
    middle, radius = _around(foot)
    inside = np.ptp(np.abs(foot - middle)) < 1e-9 and draw(st.booleans())  # a circle: four-bars with two cranks
    pivot = middle + radius * draw(numbers(0.2, 0.4) if inside else numbers(2.5, 4)) * draw(directions())
    drawing.path[B] = np.full(STEPS.shape, pivot)
    drawing.ground.append(B)
    return B


def _guide(draw: st.DrawFn, drawing: Drawing, on: str, near: Path) -> Path:
    """Return a point of a guide, fixed to a body, over all steps."""
    if on == GROUND:
        middle, radius = _around(near)
        return np.full(STEPS.shape, middle + 0.8 * radius * draw(vectors(1)))
    at: Path = drawing.path[drawing.points[on][0]] + draw(vectors(1)) * drawing.u[on]
    return at


def _bar(drawing: Drawing, body: str, A: str, P: str) -> None:
    arm = drawing.path[P] - drawing.path[A]
    drawing.add(body, [A, P], arm / arm[0])


def _sliding(draw: st.DrawFn, drawing: Drawing, body: str, on: str, P: str) -> None:
    """Add a block with its pin P, and perhaps another point before it, that turns with what it slides on."""
    drawing.add(body, [P], drawing.u[on])
    if draw(st.booleans()):
        drawing.carried(body, P, 0.1 + draw(vectors(1)))


def _rrr(draw: st.DrawFn, drawing: Drawing, A: str, n: str) -> None:
    B, P = _other_foot(draw, drawing, A, f"B{n}"), f"P{n}"
    drawing.path[P] = _meet(draw, drawing.path[A], drawing.path[B])
    _bar(drawing, f"bar{n}", A, P)
    _bar(drawing, f"rocker{n}", B, P)


def _meet(draw: st.DrawFn, A: Path, B: Path) -> Path:
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


def _rrp(draw: st.DrawFn, drawing: Drawing, A: str, n: str) -> None:
    """Hang a bar on A whose end runs on a guide of the ground or of a body that A is not on."""
    on = draw(st.sampled_from([GROUND, *(body for body, points in drawing.points.items() if A not in points)]))
    foot, t = drawing.path[A], draw(directions()) * drawing.u[on]
    across = ((_guide(draw, drawing, on, foot) - foot) * t.conj()).imag
    r = max(0.5, float(np.abs(across).max())) / sin(radians(draw(numbers(25, 70))))
    drawing.path[f"P{n}"] = foot + t * (draw(signs) * np.sqrt(r**2 - across**2) + 1j * across)
    _bar(drawing, f"bar{n}", A, f"P{n}")
    _sliding(draw, drawing, f"block{n}", on, f"P{n}")
    drawing.slide(draw, f"block{n}", on, complex(t[0]))


def _rpr(draw: st.DrawFn, drawing: Drawing, A: str, n: str) -> None:
    """Hang a block on A and a lever elsewhere, with d = A - B = w (sigma + i h), h constant and w turning with both."""
    B = _other_foot(draw, drawing, A, f"B{n}")
    d = drawing.path[A] - drawing.path[B]
    h = 0.7 * float(np.abs(d).min()) * draw(st.just(0.0) | numbers(-1, 1))
    w = d / (draw(signs) * np.sqrt(np.abs(d) ** 2 - h**2) + 1j * h)
    drawing.add(f"lever{n}", [B], w / w[0])
    drawing.carried(f"lever{n}", B, draw(numbers(0.3, 1.5)) * draw(directions()))
    drawing.add(f"block{n}", [A], w / w[0])
    if draw(st.booleans()):
        drawing.carried(f"block{n}", A, 0.1 + draw(vectors(1)))
    drawing.slide(draw, f"block{n}", f"lever{n}", complex(w[0]))


def _prp(draw: st.DrawFn, drawing: Drawing, A: str, n: str) -> None:
    """Pin two blocks to each other, on guides of two bodies that turn little against each other; A is unused."""
    pairs = {pair: np.unwrap(np.angle(drawing.u[pair[1]] / drawing.u[pair[0]])) for pair in combinations(drawing.u, 2)}
    one, two = draw(st.sampled_from([pair for pair, turned in pairs.items() if np.ptp(turned) < 2.2] or [("", "")]))
    if not one:
        return _rrp(draw, drawing, A, n)
    turned = pairs[one, two]
    room = 1.1 - np.ptp(turned) / 2
    square = draw(signs) * pi / 2 - (turned.max() + turned.min()) / 2 + draw(numbers(-room, room))
    t = draw(directions())
    t1, t2 = t * drawing.u[one], t * np.exp(1j * square) * drawing.u[two]
    drawing.path[f"P{n}"] = _crossing(
        _guide(draw, drawing, one, drawing.path[A]), t1, _guide(draw, drawing, two, drawing.path[A]), t2
    )
    for body, on, along in ((f"first{n}", one, t1), (f"second{n}", two, t2)):
        _sliding(draw, drawing, body, on, f"P{n}")
        drawing.slide(draw, body, on, complex(along[0]))
    return None


def _rpp(draw: st.DrawFn, drawing: Drawing, A: str, n: str) -> None:
    """Hang a block on A that runs in a yoke, which slides on the ground or a body."""
    on = draw(st.sampled_from(list(drawing.u)))
    u, crossing = drawing.u[on], radians(draw(numbers(30, 150)))
    t1 = draw(directions()) * u
    t2 = t1 * np.exp(1j * draw(signs) * crossing)
    through = drawing.path[A] + draw(vectors(0.5)) * u
    drawing.path[f"Y{n}"] = _crossing(_guide(draw, drawing, on, drawing.path[A]), t1, through, t2)
    drawing.add(f"block{n}", [A], u)
    _sliding(draw, drawing, f"yoke{n}", on, f"Y{n}")
    drawing.slide(draw, f"yoke{n}", on, complex(t1[0]))
    drawing.slide(draw, f"block{n}", f"yoke{n}", complex(t2[0]))


def _crossing(G1: Path, t1: Path, G2: Path, t2: Path) -> Path:
    along = ((G2 - G1).conj() * t2).imag / (t1.conj() * t2).imag
    crossing: Path = G1 + along * t1
    return crossing


Draw: TypeAlias = Callable[[st.DrawFn, Drawing, str, str], None]
_DYADS: Mapping[str, Draw] = {"RRR": _rrr, "RRP": _rrp, "RPR": _rpr, "PRP": _prp, "RPP": _rpp}


@st.composite
def drawing_of(draw: st.DrawFn, first: str) -> Drawing:
    """Draw the bodies of one dyad or two; `first` says of which kind the first one is."""
    pivot, t = draw(vectors(2)), draw(directions())
    drawing = Drawing({}, {GROUND: np.ones(STEPS.shape, complex)}, {})
    if draw(st.booleans()):
        drawing.path |= {"O": np.full(STEPS.shape, pivot), "A": pivot + t * np.exp(1j * STEPS)}
        drawing.ground.append("O")
        drawing.add("driver", ["O", "A"], np.exp(1j * STEPS))
    else:
        drawing.path["A"] = pivot + t * np.sin(STEPS)
        drawing.add("driver", ["A"], drawing.u[GROUND])
        drawing.slides["driver"] = GROUND, t
    hang(draw, drawing, first)
    return drawing


def hang(draw: st.DrawFn, drawing: Drawing, first: str) -> None:
    """Hang one dyad or two on what moves A."""
    _DYADS[first or draw(st.sampled_from(list(_DYADS)))](draw, drawing, "A", "1")
    if draw(st.booleans()):
        _DYADS[draw(st.sampled_from(list(_DYADS)))](draw, drawing, _foot(draw, drawing), "2")

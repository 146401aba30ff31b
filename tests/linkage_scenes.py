"""Scenes of linkages drawn at random: frames, masses, drives, loads and springs, by what their bodies may have."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations
from math import pi
from types import MappingProxyType

import numpy as np
from hypothesis import strategies as st

from scenes import Scene
from scenes.bodies import GROUND, Body, Slide
from scenes.drive import ConstantSpeed, Drive, DriveLaw, MotionLaw, Samples
from scenes.elements.loads import ForceTable
from scenes.elements.tables import LoadCurve
from scenes.laws import LAWS, HarmonicLaw, SegmentedLaw
from scenes.scene import Force, Load, PressForce, Sketch, Spring

from .linkages import STEPS, Drawing, Path, directions, drawing_of, numbers, signs, vectors, xy


@st.composite
def drawn_linkages(draw: st.DrawFn, first: str = "") -> tuple[Scene, Samples, dict[str, Path]]:
    """Draw a linkage of one dyad or two, the first of a kind, positions of its drive, and its moving points there."""
    drawing = draw(drawing_of(first))
    scene, positions = scene_of(draw, drawing)
    return scene, positions, {point: z for point, z in drawing.path.items() if point not in drawing.ground}


def linkages(first: str = "") -> st.SearchStrategy[Scene]:
    return drawn_linkages(first).map(lambda drawn: drawn[0])


def scene_of(draw: st.DrawFn, drawing: Drawing) -> tuple[Scene, Samples]:
    """The scene with its bodies in any order, masses, loads, springs and weights; and positions of its drive."""
    at = {point: complex(z[0]) for point, z in drawing.path.items()}
    order = {name: draw(st.permutations(points)) for name, points in drawing.points.items()}
    x_axes, by_lengths = _x_axes(draw, drawing, order, at)
    origins = {GROUND: 0j} | {
        name: at[points[0]] + (0 if name in by_lengths else draw(vectors(1))) for name, points in order.items()
    }
    slides = {}
    for slider, (on, t) in drawing.slides.items():
        first, displaced = at[order[slider][0]], drawing.displaced.get(slider)
        through = first + draw(numbers(-2, 2)) * t if displaced is None else first - displaced * t
        slides[slider] = Slide(on, xy((through - origins[on]) / x_axes[on]), xy(t / x_axes[on]))
    bodies = {}
    for name in draw(st.permutations(list(order))):
        local = {point: (at[point] - origins[name]) / x_axes[name] for point in order[name]}
        bodies[name] = _body(draw, name, local, slides.get(name), by_lengths=name in by_lengths)
    positions = _positions(drawing, x_axes, order, origins, slides.get(drawing.driver))
    ground = MappingProxyType({point: xy(at[point]) for point in drawing.ground})
    bounded = drawing.driver in slides or drawing.driven_on != GROUND
    drive = Drive(drawing.driver, _law(draw, positions, slides=bounded), drawing.driven_on)
    springs = tuple(_springs(draw, drawing))
    gravity = draw(vectors(10).map(xy) | st.none())
    rough = {point: (round(z.real, 2), round(z.imag, 2)) for point, z in at.items() if point not in ground}
    sketch = Sketch(float(positions[0]), MappingProxyType(rough))
    given = "drawn", "drawn", "", "drawn.toml", ground, MappingProxyType(bodies), (drive,)
    scene = Scene(*given, gravity, sketch, "A", MappingProxyType({}), springs=springs)
    return replace(scene, loads=tuple(draw(loads_on(scene)) for _ in range(draw(st.integers(0, 3))))), positions


def _x_axes(
    draw: st.DrawFn, drawing: Drawing, order: Mapping[str, list[str]], at: Mapping[str, complex]
) -> tuple[dict[str, complex], set[str]]:
    """The x axis of each frame at first, the same of bodies that slide on each other; and which are by lengths.

    One body at most of those that slide on each other is: its axis lies along its points.
    """
    groups = {name: {name} for name in (GROUND, *order)}
    for slider, (on, _) in drawing.slides.items():
        joined = groups[slider] | groups[on]
        groups |= dict.fromkeys(joined, joined)
    x_axes: dict[str, complex] = {}
    by_lengths = set()
    for name, group in groups.items():
        if name not in x_axes:
            shaped = [other for other in order if other in group and _well_shaped([at[p] for p in order[other]])]
            x_axis = 1 + 0j if GROUND in group else draw(directions())
            if GROUND not in group and shaped and draw(st.booleans()):
                chosen = draw(st.sampled_from(shaped))
                by_lengths.add(chosen)
                side = at[order[chosen][1]] - at[order[chosen][0]]
                x_axis = side / abs(side)
            x_axes |= dict.fromkeys(group, x_axis)
    return x_axes, by_lengths


def _well_shaped(corners: list[complex]) -> bool:
    """Whether lengths and a rough sketch say where the points of a body are."""
    if len(corners) < 2:
        return False
    first, second, *others = corners
    side = second - first
    return abs(side) > 0.1 and all(abs((side.conjugate() * (z - first)).imag) > 0.1 * abs(side) for z in others)


def _body(draw: st.DrawFn, name: str, local: Mapping[str, complex], slide: Slide | None, *, by_lengths: bool) -> Body:
    points, lengths = list(local), None
    if by_lengths:
        pairs = [pair for pair in combinations(points, 2) if pair[0] in points[:2]]
        lengths = MappingProxyType({frozenset((p, q)): abs(local[p] - local[q]) for p, q in pairs})
    moved = name.endswith("1")  # some bodies have a mass in every linkage
    mass = draw(numbers(0.1, 10) if moved else st.just(0.0) | numbers(0.1, 10))
    com = draw(vectors(1).map(xy) if len(points) > 3 else vectors(1).map(xy) | st.none())
    inertia = None if com is None else mass * draw(numbers(0.01, 2))
    places = None if by_lengths else MappingProxyType({point: xy(z) for point, z in local.items()})
    return Body(name, tuple(points), places, lengths, tuple(points), mass, com, inertia, slide)


def _positions(
    drawing: Drawing,
    x_axes: Mapping[str, complex],
    order: Mapping[str, list[str]],
    origins: Mapping[str, complex],
    slide: Slide | None,
) -> Samples:
    """The drive's positions over all steps."""
    name, on, path = drawing.driver, drawing.driven_on, drawing.path
    if slide is None:
        if on == GROUND:
            turned: Samples = np.angle(x_axes[name]) + STEPS
            return turned
        return np.unwrap(np.angle(x_axes[name] * drawing.u[name] / (x_axes[on] * drawing.u[on])))
    at = path[order[name][0]]
    if on != GROUND:
        foot = path[order[on][0]]
        at = (at - foot) / (x_axes[on] * drawing.u[on]) + (foot[0] - origins[on]) / x_axes[on]
    displaced: Samples = ((at - complex(*slide.through)) * complex(*slide.along).conjugate()).real
    return displaced


def _law(draw: st.DrawFn, positions: Samples, *, slides: bool) -> DriveLaw:
    """A constant speed or a law; a slider keeps within the positions."""
    least, most = float(positions.min()), float(positions.max())
    if draw(st.booleans()):
        speed = draw(signs) * draw(numbers(0.5, 20))
        if not slides and draw(st.booleans()):
            return ConstantSpeed(speed, draw(numbers(-3, 3)), None)
        return ConstantSpeed(speed, *((least, most) if speed > 0 else (most, least)))
    times = np.cumsum([0.0, *(draw(numbers(0.1, 1)) for _ in range(4))])
    periodic = draw(st.booleans())
    gain = 0.0 if slides else draw(st.sampled_from((0, 1, -1))) * 2 * pi
    rough = [0.0, draw(numbers(0.3, 1)), *(draw(numbers(-1, 1)) for _ in range(2))]
    last = gain if periodic else draw(numbers(-1, 1))
    law = MotionLaw(tuple(times.tolist()), (*rough, last), periodic)
    if not law.beyond <= 1:  # a file with such a law is refused: a spline overshoots most where intervals differ most
        law = replace(law, times=tuple(np.linspace(0.0, times[-1], len(times)).tolist()))
    if not slides:
        return law
    low, high = law.extent  # of a spline, which overshoots: shrink it to fit
    scale, offset = 0.99 * (most - least) / (high - low), (most + least) / 2
    return replace(law, positions=tuple(offset + scale * (x - (low + high) / 2) for x in law.positions))


@st.composite
def by_formula(draw: st.DrawFn) -> Scene:
    """A linkage whose drive goes through the same range by segments, for ever or once, or by two sines."""
    scene = draw(linkages())
    low, high = scene.drive.law.extent
    if draw(st.booleans()):
        size, frequency, share = (high - low) / 2, draw(st.integers(2, 20)) / 4, draw(numbers(0, 1))
        phases, frequencies = (draw(numbers(-3, 3)), draw(numbers(-3, 3))), (2 * frequency, 3 * frequency)
        return scene.with_law(HarmonicLaw(low + size, (share * size, (1 - share) * size), frequencies, phases))
    places = [low, *(low + draw(numbers(0, 1)) * (high - low) for _ in range(3)), high]
    periodic = draw(st.booleans())
    turns = scene.drive.slide is None and scene.periodic
    parts: list[tuple[float | None, float, str | None]] = [
        (to, draw(numbers(0.1, 1)), draw(st.sampled_from([*LAWS])))
        for to in (*places[1:], *((low + draw(st.sampled_from((0, 2 * pi))) * turns,) if periodic else ()))
    ]
    parts.insert(draw(st.integers(0, len(parts))), (None, draw(numbers(0.1, 1)), None))
    ends, durations, laws = zip(*parts, strict=True)
    return scene.with_law(SegmentedLaw(low, ends, durations, laws, periodic))


def loads_on(scene: Scene) -> st.SearchStrategy[Load]:
    """Draw a force on any point, or on a body that slides on the ground one that depends on where that is."""
    places = [(name, point) for name, body in scene.bodies.items() for point in body.points]
    constant = st.builds(lambda place, f: Force(place[0], place[1], xy(f)), st.sampled_from(places), vectors(20))
    sliding = [place for place in places if (s := scene.bodies[place[0]].slide) is not None and s.on == GROUND]
    if not sliding:
        return constant
    table = st.tuples(numbers(-20, 20), numbers(-20, 20), numbers(-20, 20))
    curves = st.builds(lambda forces: LoadCurve(displacements=(-1.0, 0.1, 1.5), forces=forces), table)
    tables = st.builds(lambda p, of: ForceTable(p[0], p[1], None, of), st.sampled_from(sliding), curves)
    return constant | tables | st.builds(_press, st.just(scene), st.sampled_from(sliding), signs, numbers(1, 20))


def _press(scene: Scene, place: tuple[str, str], closing: int, push: float) -> PressForce:
    slide = scene.bodies[place[0]].slide
    assert slide is not None
    force = -closing * push * complex(*slide.along) * complex(1, 0.2)
    return PressForce(*place, xy(force), 0.3, closing)


def _springs(draw: st.DrawFn, drawing: Drawing) -> Iterator[Spring]:
    """Yield springs between points that never come near each other, where they would have no direction."""
    points = [(GROUND, point) for point in drawing.ground]
    points += [(body, point) for body, of in drawing.points.items() for point in of]
    path = drawing.path
    far = [
        (one, two)
        for one, two in combinations(points, 2)
        if one[0] != two[0] and np.abs(path[one[1]] - path[two[1]]).min() > 0.2
    ]
    for _ in range(draw(st.integers(0, 2)) if far else 0):
        yield Spring(*draw(st.sampled_from(far)), draw(numbers(1, 20)), draw(numbers(0, 2)))

"""The linkage as one SVG: at the first sample of a motion, or moving by itself.

Each sign is drawn once in the frame of its body; what is not to scale, as a pin, is in pixels (class `sign`), and what
scales along its x alone, as a guide, is so across (class `across`).
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, degrees
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement, tostring
from zlib import crc32

import numpy as np

from scenes.elements.element import Element as Acting
from scenes.elements.springs import Damper, PointPair, Spring, TorsionSpring
from scenes.model.motion import Samples
from scenes.scene import GROUND, Body, Moment, Slide

from ...mechanics.bodies import first_point
from ...mechanics.motion_vectors import Vectors
from ..figures.figure import extremes
from .drawing import PX, Arrow, Drawing, foot

MAX_FRAMES = 72  # poses of a picture that moves by itself
PLAY = 5.0  # s that it takes
MAX_PATH_POINTS = 300  # points of a path, at most
GUIDE, SLOT, BLOCK = 12, 9, 15  # px: half the width of a guide and of a slot; half the length of a block
HEAD = 11  # px, of an arrow
ACTION = 70  # px to each side, of the line on which the force of a pin with friction acts
HATCH, TO_NAME, LETTER = 9, 18, 9  # px between two lines of a hatching; from a point to its name; a letter of that
DIRECTIONS = np.exp(1j * np.pi / 4 * np.array([-1, 1, 3, -3, 0, 2, 4, -2]))  # of names, the better ones first


@dataclass(frozen=True)
class Mover:
    """An element that moves: its place in the picture, its angle in degrees clockwise, its stretch along its own x."""

    element: Element
    place: Vectors
    angle: Samples | None = None
    stretch: Samples | None = None
    evenly: bool = False  # and across too

    def transform(self, row: int, *, css: bool = False) -> str:
        """The transform at a row of the motion, as an attribute's text or that of a style."""
        length, turn, gap = ("px", "deg", ",") if css else ("", "", " ")
        text = f"translate({self.place[row].real:.1f}{length}{gap}{self.place[row].imag:.1f}{length})"
        if self.angle is not None:
            text += f" rotate({self.angle[row]:.2f}{turn})"
        if self.stretch is not None:
            text += f" scale({self.stretch[row]:.4g}{gap}{self.stretch[row] if self.evenly else 1:.4g})"
        return text


def by_itself(drawing: Drawing, frames: int) -> str:
    """A drawing that moves by itself through so many poses, or stands where there are none: an SVG without a script."""
    rows = np.linspace(0, len(drawing.motion["time"]) - 1, frames + 1).round().astype(int).tolist()
    root, movers = picture(drawing)
    style, prefix = list[str](), crc32(tostring(root))  # names of its own on a page
    for number, mover in enumerate(movers if frames else []):
        name, shares = f"m{prefix:x}-{number}", np.linspace(0, 100, len(rows))
        mover.element.set("style", f"animation: {name} {PLAY:g}s linear infinite")
        poses = [
            f"{share:.4g}%{{transform:{mover.transform(n, css=True)}}}" for share, n in zip(shares, rows, strict=True)
        ]
        style.append(f"@keyframes {name} {{ {' '.join(poses)} }}")
    return stands_alone(root, drawing.size, style)


def stands_alone(root: Element, size: tuple[float, float], more: Sequence[str] = ()) -> str:
    """A picture, and more of its style, as an SVG of a size in its own units, which needs no page around it."""
    root[0].text = "\n".join([str(root[0].text), text("colours.css"), *more])
    root.attrib |= {side: f"{length / PX:.0f}" for side, length in zip(("width", "height"), size, strict=True)}
    return tostring(root, encoding="unicode")


def picture(drawing: Drawing) -> tuple[Element, list[Mover]]:
    """A drawing at its first sample, its style as the first child, and what in it moves, arrows in their order.

    A group that moves says by what: `data-point`, where it is; `data-turn`, its body; `data-to`, a spring's other end.
    """
    (_, height), scene = drawing.size, drawing.scene
    root = empty(
        f"{scene.title} at {scene.where(float(drawing.motion[scene.channels.drive.position][0]))}", drawing.size
    )
    background(root, drawing)
    movers = [*bodies(root, drawing), *springs(root, drawing), *turning(root, drawing)]
    SubElement(root, "g", {"class": "engines"})
    movers += [*points(root, drawing), *circles(root, drawing)]
    for force in drawing.arrows:
        movers += arrow(root, drawing, force)
    corner = SubElement(root, "g", {"transform": f"translate(0 {height:.1f})"})
    if drawing.scale_text:
        note = SubElement(corner, "text", {"class": "sign scale", "x": "8", "y": "-8"})
        SubElement(note, "tspan", {"class": "joint"}).text = "joint forces"
        if any(force.load for force in drawing.arrows):
            note[0].tail = " and "
            SubElement(note, "tspan", {"class": "load"}).text = "loads"
        note[-1].tail = f": {drawing.scale_text}"
    if drawing.circles:
        larger = f", {drawing.larger} times as large" if drawing.larger > 1 else ""
        SubElement(corner, "text", {"class": "sign scale", "x": "8", "y": "-28"}).text = f"friction circles{larger}"
    for mover in movers:
        mover.element.set("transform", mover.transform(0))
    return root, movers


def empty(label: str, size: tuple[float, float]) -> Element:
    """An SVG of a size in its own units, with nothing in it but the style of a linkage."""
    box = {"class": "linkage", "viewBox": f"0 0 {size[0]:.1f} {size[1]:.1f}", "style": f"--px: {PX:.4f}"}
    root = Element("svg", {"xmlns": "http://www.w3.org/2000/svg", "role": "img", "aria-label": label} | box)
    SubElement(root, "style").text = text("linkage.css")
    return root


def text(name: str) -> str:
    """A file that lies beside this one."""
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def background(root: Element, drawing: Drawing) -> None:
    """Draw what stands still: paths, guides on the ground, the sketch."""
    scene = drawing.scene
    for point in scene.moving_points:
        path = drawing.units(drawing.places[point])
        line(root, "path", path[extremes(path.real, path.imag, MAX_PATH_POINTS)])
    for name, slide in scene.slides.items():
        if slide.on == GROUND:
            _guide(root, drawing.units(drawing.way(name)), _direction(slide), scene.bodies[name].points[0])
    ghost = SubElement(root, "g", {"class": "ghost", "visibility": "hidden"})
    for points in outlines(drawing).values():
        shown = np.array([scene.drawn[point] for point in points if point in scene.drawn], np.complex128)
        line(ghost, "sketch", drawing.units(shown))


def outlines(drawing: Drawing) -> dict[str, tuple[str, ...]]:
    """The points around each body that has several, by its name; of more than two they come back to the first."""
    return {name: _around(drawing, body) for name, body in drawing.scene.bodies.items() if len(body.points) > 1}


def bodies(root: Element, drawing: Drawing) -> Iterator[Mover]:
    """Draw every body with the slots of those that slide on it."""
    scene = drawing.scene
    for body in scene.bodies.values():
        kind = "body driven" if body.name in scene.driven else "body"
        group = SubElement(root, "g", {"class": kind, "data-point": body.points[0], "data-turn": body.name})
        SubElement(group, "title").text = body.name
        places = drawing.own(body)
        outline = np.array([places[point] for point in _around(drawing, body)])
        for slider, slide in scene.slides.items():
            if slide.on == body.name:
                ends = drawing.per_metre * (drawing.way(slider) - first_point(body)).conj()
                _slot(group, ends, _direction(slide), outline)
        if len(body.points) > 1:
            line(group, "bar own" if len(body.points) == 2 else "plate own", outline)
        if body.slide is not None and (rod := drawing.rod(body.name)):
            line(group, "bar", np.array([0j, -drawing.per_metre * rod * complex(*body.slide.along).conjugate()]))
        elif body.slide is not None:
            turn = {"transform": f"rotate({-degrees(atan2(*body.slide.along[::-1])):.3f})"}
            half = SLOT - 2 if body.slide.on != GROUND else GUIDE - 2
            _path(SubElement(group, "g", turn), "sign block", f"M{-BLOCK} {-half}H{BLOCK}V{half}H{-BLOCK}Z")
        elif len(body.points) == 1:
            _path(group, "sign block", "M-11 0A11 11 0 0 0 11 0A11 11 0 0 0 -11 0Z")
        clockwise = -np.degrees(np.unwrap(drawing.state.angle(body.name)))
        yield Mover(group, drawing.units(drawing.places[body.points[0]]), clockwise)


def springs(root: Element, drawing: Drawing) -> Iterator[Mover]:
    """Draw what acts between two points, as long as one unit and stretched between its ends."""
    for pair in drawing.scene.of_type(PointPair).values():
        (_, first), (_, second) = pair.ends
        group = SubElement(root, "g", {"data-point": first, "data-to": second})
        _path(group, "across spring", BETWEEN.get(type(pair), _line)(pair))
        start, end = (drawing.units(drawing.places[point]) for point in (first, second))
        yield Mover(group, start, np.degrees(np.unwrap(np.angle(end - start))), np.maximum(np.abs(end - start), 1e-6))


def _zigzag(spring: Spring) -> str:
    """A zigzag, or a pot for a damper alone."""
    teeth = "".join(f"L{0.2 + 0.05 * n:g} {-7 * (-1) ** n}" for n in range(1, 12))
    return f"M0 0H.2{teeth}L.8 0H1" if spring.stiffness else "M0 0H.4M.65-7H.4V7H.65M.55-5V5M.55 0H1"


def _line(_: PointPair) -> str:
    return "M0 0H1"


# By type, the path of what acts between two points, from 0 to 1 along x; a line of those that are not here.
BETWEEN: Mapping[type[PointPair], Callable[[Any], str]] = {Spring: _zigzag, Damper: _zigzag}
# By type, the class and the path of what turns about a point: a spiral, and an arrow around.
TURNING: Mapping[type[Acting], tuple[str, str]] = {
    TorsionSpring: ("", "M5 0A6 6 0 0 1-7 0A8 8 0 0 1 9 0A10 10 0 0 1-11 0A12 12 0 0 1 13 0H20"),
    Moment: ("force load", "M15 9A17 17 0 1 0-8 15m7-5l-7 5 8 3"),
}


def turning(root: Element, drawing: Drawing) -> Iterator[Mover]:
    """Draw what turns about a point, there."""
    for kind, (style, path) in TURNING.items():
        for element in drawing.scene.of_type(kind).values():
            ((_, point), *_) = element.ends
            group = SubElement(root, "g", {"class": style, "data-point": point})
            _path(group, "sign", path)
            yield Mover(group, drawing.units(drawing.places[point]))


def points(root: Element, drawing: Drawing) -> Iterator[Mover]:
    """Draw every point as a pin with its name, upright, and a fixed one on hatched ground."""
    around = outlines(drawing).values()
    for point in drawing.scene.owners:
        group = SubElement(root, "g", {"data-point": point})
        if point in drawing.scene.ground:
            _path(group, "sign", "M0 0L-11 18H11Z M-17 18H17")
            _path(group, "sign hatch", " ".join(f"M{x} 18l-6 7" for x in range(-13, 18, 6)))
        _path(group, "sign pin", "M-5 0A5 5 0 0 0 5 0A5 5 0 0 0 -5 0Z")
        side = _free(drawing, point, around)
        anchor = "middle" if abs(side.real) < 0.5 else "start" if side.real > 0 else "end"
        place = {"x": f"{TO_NAME * side.real * 0.8:.1f}", "y": f"{5 + TO_NAME * side.imag:.1f}", "text-anchor": anchor}
        SubElement(group, "text", {"class": "sign name"} | place).text = point
        yield Mover(group, drawing.units(drawing.places[point]))


def circles(root: Element, drawing: Drawing) -> Iterator[Mover]:
    """Draw the friction circle of every pin that has one: the line of its force touches it while the pin turns."""
    for point, radius in drawing.circles:
        group = SubElement(root, "g", {"class": "rubbing", "data-point": point})
        SubElement(group, "title").text = f"friction circle of {point}, {drawing.larger} times as large"
        SubElement(group, "circle", {"r": f"{drawing.larger * radius:.2f}"})
        yield Mover(group, drawing.units(drawing.places[point]))


def arrow(root: Element, drawing: Drawing, force: Arrow) -> Iterator[Mover]:
    """Draw a force as an arrow from where it attacks, or a load as one that ends there."""
    place = drawing.units(drawing.places[force.point] + drawing.larger * force.aside)
    way = drawing.drawn(force)
    group, length = SubElement(root, "g", {"class": "force load" if force.load else "force"}), np.abs(way)
    SubElement(group, "title").text = force.name
    shaft, head = SubElement(group, "g"), SubElement(group, "g")
    start, end = (-1, 0) if force.load else (0, 1)  # a filled strip: browsers blur a line that is stretched by itself
    _path(shaft, "head across", f"M{start} -1.25H{end}V1.25H{start}Z")
    _path(head, "sign head", f"M{-HEAD} -5L0 0L{-HEAD} 5Z")
    if force.moment:
        _path(group, "sign action", f"M{-ACTION} 0H{ACTION}")
    still = np.zeros(len(place), complex)
    yield Mover(group, place, np.degrees(np.unwrap(np.angle(way))))
    yield Mover(shaft, still, None, np.maximum(length, 1e-3))
    yield Mover(head, still + end * length, None, np.clip(length / (HEAD * PX), 1e-3, 1), evenly=True)


def _around(drawing: Drawing, body: Body) -> tuple[str, ...]:
    """The points around a body, back to the first of more than two; many in the order around their middle."""
    places = drawing.own(body)
    if len(places) < 3:
        return body.points
    middle = sum(places.values()) / len(places)
    first = places[body.points[0]] - middle or 1.0
    order = sorted(places, key=lambda point: float(np.angle((places[point] - middle) / first) % (2 * np.pi)))
    return (*order, order[0])


def _free(drawing: Drawing, point: str, around: Iterable[Sequence[str]]) -> complex:
    """The direction from a point, x to the right and i times y downwards, that all else leaves free the longest."""
    rows = np.linspace(0, len(drawing.motion["time"]) - 1, 24).astype(int)
    drawn = {name: drawing.units(places[rows]) for name, places in drawing.places.items()}
    names = drawn[point] + 1.2 * TO_NAME * PX * DIRECTIONS[:, np.newaxis]
    gaps = [np.abs(names - other) for name, other in drawn.items() if name != point]
    for outline in around:
        gaps += [np.abs(names - foot(names, drawn[start], drawn[end])) for start, end in pairwise(outline)]
    for force in drawing.arrows:
        way = (-1 if force.load else 1) * np.nan_to_num(drawing.drawn(force)[rows])
        gaps.append(np.abs(names - foot(names, drawn[force.point], drawn[force.point] + way)))
    if point in drawing.scene.ground:
        gaps.append(np.abs(names - drawn[point] - 15j * PX))
    near = np.minimum(np.min(gaps, axis=0), TO_NAME * PX) if gaps else np.ones((len(DIRECTIONS), 1))
    side, wide = np.round(DIRECTIONS.real)[:, np.newaxis], LETTER * PX * len(point)
    left = names.real + (side - 1) / 2 * wide
    near = np.where((left >= 0) & (left + wide <= drawing.size[0]), near, 0.0)  # elsewhere the name is cut off
    return complex(DIRECTIONS[near.mean(axis=1).round(3).argmax()])


def _direction(slide: Slide) -> complex:
    """The direction of a guide in the picture, where y goes downwards."""
    return complex(*slide.along).conjugate()


def _along(root: Element, ends: Vectors, direction: complex) -> tuple[Element, float]:
    """A group whose x axis is a way, from one end of it, and the length of that, which is zero at a single pose."""
    place = f"translate({ends[0].real:.2f} {ends[0].imag:.2f}) rotate({degrees(np.angle(direction)):.3f})"
    return SubElement(root, "g", {"transform": place}), abs(ends[1] - ends[0])


def _guide(root: Element, ends: Vectors, direction: complex, point: str) -> None:
    """Draw a point's guide on the ground: two lines, hatched outside, longer than the way by a block at each end."""
    group, length = _along(root, ends, direction)
    group.set("data-guides", point)
    start, end, aside = -1.6 * BLOCK * PX, length + 1.6 * BLOCK * PX, 0.7 * HATCH * PX
    _path(group, "across guide", " ".join(f"M{start:.1f} {y}H{end:.1f}" for y in (-GUIDE, GUIDE)))
    places = np.arange(start, end, HATCH * PX)
    hatch = (f"M{x:.1f} {GUIDE}l{-aside:.1f} 7M{x:.1f} {-GUIDE}l{aside:.1f} -7" for x in places)
    _path(group, "across hatch", "".join(hatch))


def _slot(group: Element, ends: Vectors, direction: complex, outline: Vectors) -> None:
    """Draw the slot of a carrier, longer than the way by a block at each end, and joined to bars that pass it by."""
    along = np.linspace(ends[0], ends[1], 9)
    bars = [foot(along, np.array(p), np.array(q)) for p, q in pairwise([*outline[:1], *outline])]
    bar, place = divmod(int(np.argmin(np.abs(np.array(bars) - along))), len(along))
    if abs(bars[bar][place] - along[place]) > 2 * SLOT * PX:
        line(group, "bar", np.array([bars[bar][place], along[place]]))
    inner, length = _along(group, ends, direction)
    start, end = -1.4 * BLOCK * PX, length + 1.4 * BLOCK * PX
    _path(inner, "across slot", f"M{start:.1f} {-SLOT}H{end:.1f}V{SLOT}H{start:.1f}Z")


def line(parent: Element, kind: str, corners: Vectors) -> None:
    """Draw a line through corners, in the picture's units; nothing without any."""
    if len(corners):
        _path(parent, kind, "M" + "L".join(f"{corner.real:.1f} {corner.imag:.1f}" for corner in corners))


def _path(parent: Element, kind: str, path: str) -> None:
    SubElement(parent, "path", {"class": kind, "d": path})

"""The linkage as a picture that stands: small, without forces; where it stops and cannot run; its sketch alone."""

from dataclasses import replace
from math import ceil
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from scenes import Motion, Scene
from scenes.channels import Role
from scenes.model.enclosures import MotionRange

from .drawing import MARGIN, PX, SIZE, Drawing
from .svg import TO_NAME, empty, line, picture, stands_alone

MAX_ROWS = 120  # of a motion, for the paths of a small picture
SMALL = 1.7  # times as large signs are in a small picture


def small(scene: Scene, motion: Motion) -> str:
    """A motion's first pose and its paths, without names and forces, for a list of linkages: an SVG."""
    stride = ceil(len(motion["time"]) / MAX_ROWS)
    rows = (scene.channels[name] for name in motion.samples)
    some = {row.name: motion[row.name][::stride] for row in rows if row.role is Role.kinematic and row.order == 0}
    pose = Motion(some | {c: motion[c][::stride] for c in scene.channels.names(Role.time, Role.input)})
    drawing = Drawing(replace(scene, loads=(), friction=()), pose)
    root, _ = picture(drawing)
    root.set("style", f"--px: {SMALL * PX:.4f}")
    return stands_alone(root, drawing.size, [".linkage .name { display: none; }"])


def stopped(scene: Scene, way: MotionRange) -> str:
    """The pose where a linkage stops, its joint that does not close marked, and the sketch dashed: an SVG."""
    drawing = Drawing(replace(scene, loads=(), friction=()), way.motion)
    root, _ = picture(drawing)
    for sketch in root.iterfind("g[@class='ghost']"):
        del sketch.attrib["visibility"]
    body = None if way.joint in scene.owners else scene.bodies.get(way.joint.partition("/")[0])
    if (point := body.points[0] if body else way.joint) in drawing.places:
        _mark(root, complex(drawing.units(drawing.places[point])[0]))
    return stands_alone(root, drawing.size)


def sketched(scene: Scene, joint: str = "") -> str:
    """The sketch of a linkage that has no pose, a joint of it marked: an SVG."""
    drawn = np.array([*scene.drawn.values()])
    low, high = complex(drawn.real.min(), drawn.imag.min()), complex(drawn.real.max(), drawn.imag.max())
    scale = (SIZE - 2 * MARGIN) / (max((high - low).real, (high - low).imag) or 1.0)
    margin = MARGIN * (1 + 1j)
    places = dict(zip(scene.drawn, scale * (drawn - complex(low.real, high.imag)).conj() + margin, strict=True))
    size = scale * (high - low) + 2 * margin
    root = empty(f"{scene.title}: the sketch", (size.real, size.imag))
    for body in scene.bodies.values():
        corners = [places[point] for point in body.points if point in places]
        line(root, "sketch", np.array(corners + (corners[:1] if len(corners) > 2 else [])))  # to and fro is not dashed
    for point, place in places.items():
        group = SubElement(root, "g", {"transform": f"translate({place.real:.1f} {place.imag:.1f})"})
        SubElement(group, "circle", {"class": "sign pin", "r": "5"})
        name = SubElement(group, "text", {"class": "sign name", "x": f"{TO_NAME / 2:g}", "y": f"{-TO_NAME / 2:g}"})
        name.text = point
    if joint in places:
        _mark(root, places[joint])
    return stands_alone(root, (size.real, size.imag))


def _mark(root: Element, place: complex) -> None:
    group = SubElement(root, "g", {"transform": f"translate({place.real:.1f} {place.imag:.1f})"})
    SubElement(group, "circle", {"class": "sign mark", "r": "15"})

"""The linkage as one SVG: at the first sample of a motion, or moving by itself."""

from importlib.resources import files
from xml.etree.ElementTree import Element, SubElement, tostring
from zlib import crc32

import numpy as np

from scenes import Motion, Scene

from . import shapes
from .drawing import PX, Drawing

FRAMES = 72  # poses of a picture that moves by itself, at most
PLAY = 5.0  # s that it takes


def linkage_svg(scene: Scene, motion: Motion, *, moving: bool = True) -> str:
    """The linkage as one SVG over a whole cycle, without a script, light or dark as the reader's system is."""
    return by_itself(Drawing(scene, motion), FRAMES if moving else 0)


def by_itself(drawing: Drawing, frames: int) -> str:
    """A drawing that moves by itself through so many poses, or stands where there are none."""
    rows = np.linspace(0, len(drawing.motion["time"]) - 1, frames + 1).round().astype(int).tolist()
    root, movers = picture(drawing)
    style, own = [text("linkage.css"), text("colours.css")], crc32(tostring(root))  # names of its own on a page
    for number, mover in enumerate(movers if frames else []):
        name, shares = f"m{own:x}-{number}", np.linspace(0, 100, len(rows))
        mover.element.set("style", f"animation: {name} {PLAY:g}s linear infinite")
        poses = [f"{at:.4g}%{{transform:{mover.transform(n, css=True)}}}" for at, n in zip(shares, rows, strict=True)]
        style.append(f"@keyframes {name} {{ {' '.join(poses)} }}")
    root[0].text = "\n".join(style)
    for side, length in zip(("width", "height"), drawing.size, strict=True):
        root.set(side, f"{length / PX:.0f}")
    return tostring(root, encoding="unicode")


def picture(drawing: Drawing) -> tuple[Element, list[shapes.Mover]]:
    """A drawing at its first sample, its style as the first child, and what in it moves.

    A group that moves names what moves it: `data-point`, where it is; `data-turn`, the body it turns with; `data-to`,
    the point at the other end of a spring. Those of arrows are in the order of the drawing's.
    """
    (width, height), scene = drawing.size, drawing.scene
    label = f"{scene.title} at {scene.where(float(drawing.motion[scene.drive_channel][0]))}"
    box = {"class": "linkage", "viewBox": f"0 0 {width:.1f} {height:.1f}", "style": f"--px: {PX:.4f}"}
    root = Element("svg", {"xmlns": "http://www.w3.org/2000/svg", "role": "img", "aria-label": label} | box)
    SubElement(root, "style").text = text("linkage.css")
    shapes.background(root, drawing)
    movers = [*shapes.bodies(root, drawing), *shapes.springs(root, drawing)]
    SubElement(root, "g", {"class": "engines"})
    movers += shapes.points(root, drawing)
    for arrow in drawing.arrows:
        movers += shapes.arrow(root, drawing, arrow)
    if drawing.scale_text:
        corner = SubElement(root, "g", {"transform": f"translate(0 {height:.1f})"})
        note = SubElement(corner, "text", {"class": "sign scale", "x": "8", "y": "-8"})
        SubElement(note, "tspan", {"class": "joint"}).text = "joint forces"
        if any(arrow.load for arrow in drawing.arrows):
            note[0].tail = " and "
            SubElement(note, "tspan", {"class": "load"}).text = "loads"
        note[-1].tail = f": {drawing.scale_text}"
    for mover in movers:
        mover.element.set("transform", mover.transform(0))
    return root, movers


def text(name: str) -> str:
    """A file that lies beside this one."""
    return files("compare.report.linkage").joinpath(name).read_text(encoding="utf-8")

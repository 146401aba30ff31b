"""What a designer should know of a scene's own numbers and sketch, since they may be meant otherwise."""

from collections.abc import Iterator

import numpy as np

from scenes import Failure, Scene
from scenes.bodies import heights
from scenes.scene import MotionLaw

from ..mechanics.reference import Reference

BEYOND = 0.01  # of a motion law's table: its spline may leave it by so much without a word
FAR = 0.1  # of the largest length: shipped sketches are within 0.012 of it, a leg upside down is 0.28 and more off
NARROW = 0.05  # of its longest side: a plate no higher is as likely meant to be a bar


def notes(scene: Scene) -> Iterator[str]:
    """Yield a sentence on a motion law that leaves its table, and on each plate that is nearly a bar."""
    law = scene.drive
    if isinstance(law, MotionLaw) and law.beyond > BEYOND:
        leaves = f"drives from {scene.between(law.extent)}, beyond its table's {scene.between(law.table)}"
        yield f"the motion law's spline {leaves}: more rows where the motion changes keep it closer"
    for name, body in scene.bodies.items():
        if body.mass and body.com is None and len(body.corners) == 3:
            for height in heights(body.corners, body.points, body.local, body.lengths):
                if height <= NARROW:
                    flat = f"a height of {100 * height:.2g} % of its longest side"
                    yield (
                        f"{name}, of three points nearly on one line ({flat}), is taken for a uniform triangular plate;"
                        " a bar has up to twice the inertia: give com and inertia, or put the points on the line"
                    )


def off_sketch(reference: Reference) -> dict[str, float]:
    """How far each sketched point is from where the reference has it, m; none where it has no pose."""
    sketch = reference.scene.sketch
    try:
        motion = reference.at(np.array([sketch.drive]), np.array([0.0]))
    except Failure:
        return {}
    return {p: abs(complex(motion[f"{p}.x"][0] - x, motion[f"{p}.y"][0] - y)) for p, (x, y) in sketch.points.items()}


def warnings(reference: Reference) -> Iterator[str]:
    """Yield a sentence on the points that are far from their sketch: those of the driven body, then the others."""
    scene, limit = reference.scene, FAR * reference.mechanics.size
    off = {point: distance for point, distance in off_sketch(reference).items() if not distance <= limit}
    driven = {point for point in off if scene.drive.body in scene.owners[point]}
    position = "angle" if scene.driven_slide is None else "displacement"
    for points, what_follows in (
        (driven, f"check that sketch.{position} is where the {scene.drive.body} is drawn"),
        (off.keys() - driven, "it picks the assembly branch: check that they are drawn on the side meant"),
    ):
        if points:
            far = ", ".join(f"{p} by {scene.length(off[p])}" for p in sorted(points, key=lambda p: -off[p]))
            yield f"the sketch is far from where the lengths put its points: {far}; {what_follows}"

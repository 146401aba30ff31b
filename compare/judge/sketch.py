"""How far the sketch is from the linkage: lengths rule, but a point drawn on the wrong side picks another branch."""

from collections.abc import Iterator

import numpy as np

from scenes import Failure, Motion

from ..engines.reference import Reference
from .constraints import largest_length

FAR = 0.1  # of the largest length: shipped sketches are within 0.012 of it, a leg upside down is 0.28 and more off


def at_sketch(reference: Reference) -> Motion | None:
    """Return the reference's motion at the sketch's position of the drive, one sample; None where it has none."""
    try:
        return reference.at(np.array([reference.scene.sketch.drive]), np.array([0.0]))
    except Failure:
        return None


def distances(reference: Reference) -> dict[str, float]:
    """Return how far each sketched point is from where the reference has it, m; none where it has no pose."""
    motion = at_sketch(reference)
    if motion is None:
        return {}
    drawn = reference.scene.sketch.points
    return {p: abs(complex(motion[f"{p}.x"][0] - x, motion[f"{p}.y"][0] - y)) for p, (x, y) in drawn.items()}


def warnings(reference: Reference) -> Iterator[str]:
    """Yield a sentence on the points that are far from their sketch: those of the driven body, then the others."""
    scene, limit = reference.scene, FAR * largest_length(reference.scene)
    off = {point: distance for point, distance in distances(reference).items() if not distance <= limit}
    driven = {point for point in off if scene.drive.body in scene.owners[point]}
    position = "angle" if scene.driven_slide is None else "displacement"
    for points, what_follows in (
        (driven, f"check that sketch.{position} is where the {scene.drive.body} is drawn"),
        (off.keys() - driven, "it picks the assembly branch: check that they are drawn on the side meant"),
    ):
        if points:
            far = ", ".join(f"{p} by {scene.length(off[p])}" for p in sorted(points, key=lambda p: -off[p]))
            yield f"the sketch is far from where the lengths put its points: {far}; {what_follows}"

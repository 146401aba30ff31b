"""What a designer should know of a scene's own numbers, since it follows from them otherwise than one may think."""

from collections.abc import Iterator

from scenes import Scene
from scenes.corners import heights
from scenes.scene import MotionLaw

BEYOND = 0.01  # of a motion law's table: its spline may leave it by so much without a word
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

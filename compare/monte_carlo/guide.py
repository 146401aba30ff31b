"""How what is counted along the output's guide changes with the guide itself, while the point moves as it does."""

import numpy as np

from scenes import Motion, Scene
from scenes.motion import Samples

from ..judge.peaks.curves import Curve

QUANTITIES = {"displacement": "", "velocity": "v", "acceleration": "a"}  # of channels, by kind of curve


def by_guide(scene: Scene, path: str, curve: Curve, motion: Motion) -> Samples:
    """Return how a curve changes with a number of the output's guide, shape (n,); not at all with any other number."""
    nothing, guided = np.zeros(motion["time"].shape), scene.guided(scene.output)
    if guided is None or curve.kind not in QUANTITIES or not path.startswith(f"bodies.{guided[0]}.slides."):
        return nothing
    _, slide = guided
    *_, key, axis = path.split(".")
    through, along, unit = np.array(slide.through), np.array(slide.along), np.eye(2)[int(axis)]
    place = curve.kind == "displacement"
    if key == "through":
        return nothing - place * float(along @ unit) * scene.length_unit[1]
    x, y = (motion[f"{curve.of}.{QUANTITIES[curve.kind]}{axis}"] for axis in "xy")
    turn = (unit - along * (along @ unit)) / slide.drawn
    return np.asarray(turn[0] * (x - place * through[0]) + turn[1] * (y - place * through[1]))

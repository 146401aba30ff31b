"""What the tests of the pymunk model share: runs, scenes, and errors against absolute coordinates."""

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Sampling, Scene
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk.engine import DEFAULT
from sim_models.pymunk.settings import AnySettings
from tests import absolute_coordinates, scene_files

Array = NDArray[np.float64]

# The slider-crank in decimetres, heavy all over, that pushes with an eccentric point.
SLIDER = {"points": {"B": [0, 0], "C": [0.2, 0.5]}, "mass": 1, "com": [0.1, 0.3], "inertia": 0.1}
SLIDER_CRANK = {
    "units": {"length": "dm"},
    "drive": {"body": "crank", "speed": 0.1, "start": 0.3},
    "bodies.crank.mass": 1,
    "bodies.rod.mass": 1,
    "bodies.slider": {**SLIDER, "slides": {"through": [0, 0], "along": [1, 0]}},
    "loads": [{"body": "slider", "at": "C", "force": [-1000, 0]}],
}


def slider_crank(changes: scene_files.Changes = scene_files.NONE) -> Scene:
    return scene_files.load("slider_crank", {**SLIDER_CRANK, **changes})


def driven_slider(start: float) -> Scene:
    """The slider-crank driven by its slider, towards the crank; start in dm."""
    drive = {"body": "slider", "speed": -0.1, "start": start, "end": 2.5}
    return slider_crank({"drive": drive, "sketch": {"displacement": 3.8, "A": [1, 0.3], "B": [3.8, 0]}})


def solve(scene: Scene, settings: AnySettings = DEFAULT, sampling: Sampling | None = None) -> Motion:
    simulation = pymunk_model.build(scene, settings, sampling or Sampling())
    simulation.solve()
    return simulation.read()


def off(values: Array, expected: Array | float) -> float:
    """The largest error, relative to the largest value expected."""
    return float(np.max(np.abs(values - expected)) / np.max(np.abs(expected)))


def reference(scene: Scene, sampling: Sampling) -> dict[str, Array]:
    """Every channel but the time, by formulas that no model shares."""
    return absolute_coordinates.solve(scene, *scene.drive.law.at(sampling.times(scene)))

"""What the tests of the pymunk model share: runs, scenes, and errors against absolute coordinates."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Sampling, Scene
from scenes.motion import quantity
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk.engine import DEFAULT
from sim_models.pymunk.settings import AnySettings
from tests import absolute_coordinates, scene_files

Array = NDArray[np.float64]

ALIKE = {"y": "x", "vy": "vx", "ay": "ax", "fy": "fx", "guide_force": "fx", "force": "fx", "guide_moment": "torque"}

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
    """Return the slider-crank driven by its slider, towards the crank; start in dm."""
    drive = {"body": "slider", "speed": -0.1, "start": start, "end": 2.5}
    return slider_crank({"drive": drive, "sketch": {"displacement": 3.8, "A": [1, 0.3], "B": [3.8, 0]}})


def solve(scene: Scene, settings: AnySettings = DEFAULT, sampling: Sampling | None = None) -> Motion:
    simulation = pymunk_model.build(scene, settings, sampling or Sampling())
    simulation.solve()
    return simulation.read()


def off(values: Array, expected: Array | float) -> float:
    """Return the largest error, relative to the largest value expected."""
    return float(np.max(np.abs(values - expected)) / np.max(np.abs(expected)))


def reference(scene: Scene, sampling: Sampling) -> dict[str, Array]:
    """Return every channel but the time, by formulas that no model shares."""
    return absolute_coordinates.solve(scene, *scene.drive.at(sampling.times(scene)))


def kind(channel: str) -> str:
    """Return which channels are measured by one scale."""
    return ALIKE.get(quantity(channel), quantity(channel))


def errors(motion: Motion, expected: Mapping[str, Array]) -> dict[str, Array]:
    """Return |error| of each channel but the time, shape (n,).

    It is relative to the range of its kind, or to the peak, of a force or of what is constant.
    """
    sizes: dict[str, float] = {}
    for name, values in expected.items():
        peak = float(np.abs(values).max())
        changes = kind(name) not in ("fx", "torque") and np.ptp(values) > 1e-9 * peak  # not by rounding alone
        sizes[kind(name)] = max(sizes.get(kind(name), 0.0), float(np.ptp(values)) if changes else peak)
    if "alpha" in sizes:
        sizes["alpha"] = max(sizes["alpha"], 1e-9 * sizes["omega"] ** 2)  # a constant rate but for rounding
    found = {}
    for name, values in expected.items():
        error = motion[name] - values
        if name.endswith(".angle"):
            error = np.remainder(error + np.pi, 2 * np.pi) - np.pi
        found[name] = np.abs(error) / (sizes[kind(name)] or 1.0)
    return found

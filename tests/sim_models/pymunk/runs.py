"""What the tests of the pymunk model share: runs, scenes, and errors against absolute coordinates."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import scenes
from scenes import Motion, Sampling, Scene
from scenes.motion import quantity
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk.engine import DEFAULT, PymunkSettings, Textbook
from tests import absolute_coordinates

Array = NDArray[np.float64]

ALIKE = {"y": "x", "vy": "vx", "ay": "ax", "fy": "fx", "guide_force": "fx", "force": "fx", "guide_moment": "torque"}

SLIDER_CRANK = """
ground.points = { O = [0, 0] }
drive = { body = "crank", speed = 0.1, start = 0.3 }
output = { slider = "B" }
[bodies]
crank = { points = { O = [0, 0], A = [0.1, 0] }, mass = 1 }
rod = { lengths = { "A-B" = 0.3 }, mass = 1 }
[bodies.slider]
points = { B = [0, 0], C = [0.02, 0.05] }
mass = 1
com = [0.01, 0.03]
inertia = 0.001
slides = { through = [0, 0], along = [1, 0] }
[[loads]]
body = "slider"
at = "C"
force = [-1000, 0]
[sketch]
angle = 0.3
A = [0.1, 0.03]
B = [0.38, 0]
C = [0.4, 0.05]
"""

DRIVEN_SLIDER = SLIDER_CRANK.replace(
    'drive = { body = "crank", speed = 0.1, start = 0.3 }',
    'drive = { body = "slider", speed = -0.1, start = START, end = 0.25 }',
).replace("sketch]\nangle = 0.3", "sketch]\ndisplacement = 0.38")

FOUR_BAR = """
gravity = [0, -9.81]
ground.points = { Q = [0.9, 0.1], O = [0.4, -0.2] }
drive = { body = "crank", speed = -8, start = 2 }
output = { point = "T" }
[bodies]
rocker = { lengths = { "B-Q" = 0.35 }, mass = 2 }
crank = { lengths = { "A-O" = 0.12 }, mass = 3 }
coupler = { points = { T = [0.1, 0.3], A = [-0.1, 0], B = [0.35, 0.05] }, mass = 4, com = [0.1, 0.08], inertia = 0.09 }
[[loads]]
body = "coupler"
at = "T"
force = [30, -50]
[[loads]]
body = "crank"
at = "A"
force = [-20, 10]
[sketch]
angle = 3.1
A = [0.5, -0.2]
B = [0.8, 0.45]
"""


def solve(scene: Scene, settings: PymunkSettings | Textbook = DEFAULT, sampling: Sampling | None = None) -> Motion:
    simulation = pymunk_model.build(scene, settings, sampling or Sampling())
    simulation.solve()
    return simulation.read()


def scene_of(text: str, folder: Path) -> Scene:
    path = folder / "scene.toml"
    path.write_text("format = 1\nname = 'test'\n" + text, encoding="utf-8")
    return scenes.load(path)


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

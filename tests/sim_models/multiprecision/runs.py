"""What the tests of the arbitrary-precision model share: scenes, and runs of them."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import scenes
from scenes import Motion, Sampling, Scene
from tests.mechanisms import MECHANISMS

flint = pytest.importorskip("flint")

from sim_models.multiprecision import constraints as multiprecision_linkage  # noqa: E402  (their engine is there)
from sim_models.multiprecision import engine as model  # noqa: E402
from sim_models.multiprecision import march as multiprecision_march  # noqa: E402

EPS = 2.0**-52
Array = NDArray[np.float64]
Complex = NDArray[np.complexfloating[Any, Any]]

SLIDER_CRANK = """
format = 1
name = "slider_crank"
ground.points = { O = [0, 0] }
drive = { body = "crank", speed = 2.0 }
output = { slider = "B" }
[bodies.crank]
points = { O = [0, 0], A = [1, 0] }
mass = 0
[bodies.rod]
lengths = { "A-B" = 2 }
mass = 0
[bodies.slider]
points = { B = [0, 0], C = [0, 0.5] }
slides = { through = [0, 0], along = [1, 0] }
mass = 0
[sketch]
A = [1, 0]
B = [3, 0]
"""

FOUR_BAR = """
format = 1
name = "four_bar"
gravity = [0.3, -9.81]
ground.points = { O = [0, 0], D = [4, 0.5] }
drive = { body = "crank", speed = -7.0, start = 0.4 }
output = { point = "T" }
[bodies.crank]
lengths = { "A-O" = 1.0 }  # its x axis points at its pivot
mass = 2.0
[bodies.coupler]
lengths = { "A-B" = 3.5, "B-T" = 1.5, "A-T" = 3.0 }
mass = 3.0
[bodies.rocker]
points = { D = [0.1, -0.2], B = [2.4, 0.3], Q = [1.0, 1.0] }
mass = 1.5
com = [0.7, 0.4]
inertia = 0.9
[[loads]]
body = "coupler"
at = "T"
force = [3, -5]
[[loads]]
body = "rocker"
at = "Q"
force = [-2, 4]
[sketch]
angle = 3.14
A = [1, 0.1]
B = [3.6, 2.5]
T = [2.2, 3.0]
"""

# Two rods on one crank pin, to sliders on either side: both come near their lock at the same crank angle.
TWO_RODS = """
format = 1
name = "two_rods"
ground.points = { O = [0, 0] }
drive = { body = "crank", speed = 3.0 }
output = { slider = "B" }
[bodies.crank]
points = { O = [0, 0], A = [1, 0] }
mass = 1.0
[bodies.right]
lengths = { "A-B" = ROD }
mass = 0.5
[bodies.left]
lengths = { "A-C" = ROD }
mass = 0.7
[bodies.slider]
points = { B = [0, 0], E = [0.2, 0.3] }
slides = { through = [0, 0], along = [1, 0] }
mass = 2.0
com = [0.1, 0.2]
inertia = 0.3
[bodies.other]
points = { C = [0, 0] }
slides = { through = [0, 0], along = [-1, 0] }
mass = 3.0
[[loads]]
body = "slider"
at = "E"
force = [7, -2]
[sketch]
angle = 0.5
A = [0.9, 0.5]
B = [2, 0]
C = [-0.5, 0]
"""


def scene_of(tmp_path: Path, text: str) -> Scene:
    path = tmp_path / "scene.toml"
    path.write_text(text)
    return scenes.load(path)


def run(scene: Scene, samples: int = 36, digits: int = 50) -> Motion:
    simulation = model.build(scene, model.MultiprecisionSettings("test", digits), Sampling(samples))
    simulation.solve()
    return simulation.read()


SMOOTH = {"four_bar": FOUR_BAR, "two_rods": TWO_RODS.replace("ROD", "1.4")}
ALL = ["toggle_press", *SMOOTH, *MECHANISMS]


def named(folder: Path, name: str) -> Scene:
    texts = SMOOTH | MECHANISMS
    return scene_of(folder, texts[name]) if name in texts else scenes.load(name)


def closed(linkage: multiprecision_linkage.Linkage, march: multiprecision_march.March) -> Any:
    at = linkage.scene.sketch.drive
    return march.follow(linkage.sketched_pose(at), linkage.drive(at))

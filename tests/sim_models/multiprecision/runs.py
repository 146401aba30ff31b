"""What the tests of the arbitrary-precision model share: scenes, and runs of them."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from scenes import Motion, ProcessorBudget, Sampling, Scene
from tests import scene_files

flint = pytest.importorskip("flint")

from sim_models.multiprecision import engine as model  # noqa: E402
from sim_models.multiprecision.constraints import LinkageEquations  # noqa: E402  (their engine is there)
from sim_models.multiprecision.continuation import Continuation  # noqa: E402
from sim_models.multiprecision.start import sketched_pose  # noqa: E402

EPS = 2.0**-52
Array = NDArray[np.float64]


def run(scene: Scene, samples: int = 36, digits: int = 50) -> Motion:
    simulation = model.build(scene, model.MultiprecisionSettings("test", digits=digits), Sampling(samples))
    simulation.solve()
    return simulation.read()


@cache
def named(name: str, samples: int = 36) -> Motion:
    return run(scene_files.load(name), samples)


ALL = ("toggle_press", "loaded_four_bar", "two_rods", *scene_files.MECHANISMS)


def slider_crank(changes: scene_files.Changes = scene_files.NONE) -> Scene:
    """Return a massless slider-crank of 1 m and 2 m, with a corner C half a metre above the slider's pin."""
    slider = {"points": {"B": [0, 0], "C": [0, 0.5]}, "mass": 0, "slides": {"through": [0, 0], "along": [1, 0]}}
    base = {"bodies.rod.lengths.A-B": 2, "bodies.slider": slider, "drive.speed": 2, "loads": []}
    return scene_files.load("slider_crank", {**base, "sketch": {"A": [1, 0], "B": [3, 0]}, **changes})


def two_rods(length: float) -> Scene:
    return scene_files.load("two_rods", dict.fromkeys(("bodies.right.lengths.A-B", "bodies.left.lengths.A-C"), length))


def continuing(linkage: LinkageEquations) -> Continuation:
    return Continuation(linkage, 50, ProcessorBudget(60.0, "a test"))


def closed(linkage: LinkageEquations, continuation: Continuation) -> Any:
    drawn = linkage.scene.sketch.drive
    return continuation.follow(sketched_pose(linkage, drawn), linkage.drive(drawn))

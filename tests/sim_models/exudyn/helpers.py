"""What the tests of the Exudyn model share: runs of it, and errors against equations written in the tests."""

from functools import cache
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from scenes import Motion, Sampling, Scene
from scenes.motion import quantity
from sim_models.exudyn import engine as model
from sim_models.exudyn.engine import DEFAULT, EXACT
from sim_models.exudyn.settings import ExudynSettings
from tests import scene_files
from tests.absolute_coordinates import solve

NAMES = (*scene_files.MECHANISMS, "wedge", "wedge_of_points", "oldham")
ROD = "bodies.rod.lengths.P4-P5"
BOTH_ROUTES = pytest.mark.parametrize("settings", [DEFAULT, EXACT], ids=lambda settings: settings.label)


def run(
    scene: Scene,
    settings: ExudynSettings,
    samples: int = 72,
    turns: int = 1,
    channels: frozenset[str] | None = None,
) -> Motion:
    simulation = model.build(scene, settings, Sampling(samples, turns, channels=channels))
    simulation.solve()
    return simulation.read()


def point(motion: Motion, name: str, prefix: str = "") -> NDArray[np.complex128]:
    return motion[f"{name}.{prefix}x"] + 1j * motion[f"{name}.{prefix}y"]


def force(motion: Motion, pin: str) -> NDArray[np.complex128]:
    return motion[f"{pin}.fx"] + 1j * motion[f"{pin}.fy"]


def dot(a: NDArray[Any] | complex, b: NDArray[Any]) -> Any:
    return (np.conj(a) * b).real


def locking(start: float, end: float = 100, sketch: scene_files.Changes = scene_files.NONE) -> Scene:
    """Return the toggle press with a short rod, which locks at -95.06 and at 166.09 deg, driven between those."""
    drive = {"body": "crank", "speed": 60 if end > start else -60, "start": start, "end": end}
    return scene_files.load("toggle_press", {ROD: 200, "drive": drive, **sketch})


def meeting_spring(length: float) -> scene_files.Changes:
    """Return a spring for the slider-crank whose ends meet at the start."""
    spring = {"between": ["ground.P", "slider.B"], "stiffness": 1000, "length": length}
    return {"ground.points.P": [4, 0], "springs": [spring]}


@cache
def referred(name: str) -> tuple[Scene, dict[str, NDArray[np.float64]]]:
    """Return a scene, and its motion at 61 instants from equations written in the tests."""
    scene = scene_files.load(name)
    return scene, solve(scene, *scene.drive.at(Sampling(60).times(scene)))


LEVELS = {
    "position": ("x", "y", "crank_angle", "displacement", "angle"),
    "velocity": ("vx", "vy", "omega"),
    "acceleration": ("ax", "ay", "alpha"),
    "force": ("fx", "fy", "guide_force", "force"),
    "moment": ("guide_moment", "torque"),
}


def errors(scene: Scene, motion: Motion, reference: dict[str, NDArray[np.float64]]) -> dict[str, float]:
    """Return the largest error of each level, lengths and angles apart, over the reference's peak there."""
    worst = dict.fromkeys(LEVELS, 0.0)
    for level, quantities in LEVELS.items():
        for turning in (True, False):
            names = [
                name
                for name in reference
                if quantity(name) in quantities
                and turning == (quantity(name) in ("crank_angle", "angle", "omega", "alpha"))
            ]
            gaps = [motion[name] - reference[name] for name in names]
            if level == "position" and turning:
                gaps = [np.angle(np.exp(1j * gap)) for gap in gaps]
            peak = max((np.abs(reference[name]).max() for name in names), default=0.0)
            if level == "acceleration" and turning:
                peak = max(peak, scene.drive.peak_rate**2)  # where nothing turns faster and faster
            gap = max((np.abs(gap).max() for gap in gaps), default=0.0)
            worst[level] = max(worst[level], gap / peak if gap > 0 else 0.0)
    return worst


def check(found: dict[str, float], limits: dict[str, float]) -> None:
    assert set(found) == set(limits)
    for level, limit in limits.items():
        assert found[level] <= limit, f"{level}: {found}"

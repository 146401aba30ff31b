"""What the tests of the Exudyn model share: runs of it, and errors against equations written in the tests."""

from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from scenes import Motion, Sampling, Scene
from sim_models.exudyn import engine as model
from sim_models.exudyn.engine import DEFAULT, EXACT, LONG_WORK_PRECISION
from sim_models.exudyn.settings import ExudynSettings
from tests import scene_files
from tests.absolute_coordinates import solve
from tests.agreement import errors, worst

NAMES = (
    *scene_files.MECHANISMS,
    *("wedge", "wedge_of_points", "oldham", "shared_pivot", "toggle_press", "loaded_four_bar", "three_at_a_pin"),
    *("elements", "busy_bucket", "elbow", "sleeved_elbow", "swung_bucket", "lift"),
)
ROD = "bodies.rod.lengths.P4-P5"
CHEAP = next(settings for settings in LONG_WORK_PRECISION if settings.label == "trapezoidal, loose Newton, 144")
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


def locking(start: float, end: float = 100) -> Scene:
    """The toggle press with a short rod, which locks at -95.06 and at 166.09 deg, driven between those."""
    drive = {"body": "crank", "speed": 60 if end > start else -60, "start": start, "end": end}
    return scene_files.load("toggle_press", {ROD: 200, "drive": drive})


def meeting_spring(length: float, **more: float) -> scene_files.Changes:
    """A spring for the slider-crank whose ends meet at the start."""
    spring = {"between": ["ground.P", "slider.B"], "stiffness": 1000, "length": length, **more}
    return {"ground.points.P": [4, 0], "springs": [spring]}


@cache
def referred(name: str) -> tuple[Scene, dict[str, NDArray[np.float64]]]:
    """A scene, and its motion at 61 instants from equations written in the tests."""
    scene = scene_files.load(name)
    return scene, solve(scene, *scene.drive.law.at(Sampling(60).times(scene)))


LEVEL = {
    **dict.fromkeys(("x", "displacement", "angle", "crank_angle"), "position"),
    **{"vx": "velocity", "omega": "velocity", "ax": "acceleration", "alpha": "acceleration"},
    **{"fx": "force", "torque": "moment"},
}


def by_level(motion: Motion, expected: Mapping[str, NDArray[np.float64]]) -> dict[str, float]:
    """The largest error of each level."""
    found = dict.fromkeys(LEVEL.values(), 0.0)
    for kind, error in worst(errors(motion, expected)).items():
        found[LEVEL[kind]] = float(np.maximum(found[LEVEL[kind]], error))
    return found


def check(found: dict[str, float], limits: dict[str, float]) -> None:
    assert set(found) == set(limits)
    for level, limit in limits.items():
        assert found[level] <= limit, f"{level}: {found}"

"""What tests of engines share: scenes, runs, and the truth from equations written in the tests."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from scenes import Motion, Request, Sampling, Scene, Settings, shipped
from scenes.elements import PLAIN_KINDS
from scenes.model.motion import Samples
from tests import scene_files
from tests.absolute_coordinates import solve
from tests.agreement import errors

SAMPLING = Sampling(24)
ALL = (  # of what these engines know
    *(name for name in shipped() if scene_files.load(name).kinds <= PLAIN_KINDS),
    *scene_files.MECHANISMS,
    "loaded_four_bar",
    "wedge_of_points",
    "oldham",
    "two_rods",
    "busy",
    "carried_yoke",
    "cross_slide",
)


def run(engine: Any, scene: Scene, settings: Settings | None = None, request: Request = SAMPLING) -> Motion:
    """Return the motion that an engine's module finds."""
    simulation = engine.build(scene, settings or engine.DEFAULT, request)
    simulation.solve()
    motion: Motion = simulation.read()
    return motion


@cache
def truth(name: str) -> tuple[Scene, Mapping[str, Samples]]:
    """Return a scene, and its motion from redundant coordinates."""
    scene = scene_files.load(name)
    time = SAMPLING.times(scene)
    return scene, solve(scene, *scene.drive.law.at(time), time)


def off(engine: Any, name: str, settings: Settings | None = None) -> dict[str, float]:
    """Return the largest relative error of every channel of a scene, all of which have to be there."""
    scene, expected = truth(name)
    motion = run(engine, scene, settings)
    assert set(motion.samples) == set(scene.channels.names())
    return {channel: float(error.max()) for channel, error in errors(motion, expected).items()}

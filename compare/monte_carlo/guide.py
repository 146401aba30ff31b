"""The guide of the output, where that varies too: displacements are along it, from its own `through`."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np

from scenes import Motion, Scene, numbers_in
from scenes.motion import Samples

from ..judge.peaks.curves import Curve

QUANTITIES = {"displacement": "", "velocity": "v", "acceleration": "a"}  # of channels, by kind of curve


def with_guide(scene: Scene, changes: Mapping[str, Samples]) -> Scene:
    """Return the scene of m machines whose output's guide has numbers of shape (m, 1), where they differ."""
    paths = _paths(scene)
    if not set(paths) & changes.keys():
        return scene
    drawn = dict(zip(paths, numbers_in(scene.file, paths), strict=True))
    x, y, ax, ay = (changes[path][:, np.newaxis] if path in changes else np.array(drawn[path]) for path in paths)
    name, slide = _guided(scene)
    size, unit = np.hypot(ax, ay), scene.length_unit[1]
    through: Any = (unit * x, unit * y)
    along: Any = (ax / size, ay / size)
    body = replace(scene.bodies[name], slide=replace(slide, through=through, along=along))
    return replace(scene, bodies=MappingProxyType({**scene.bodies, name: body}))


def by_guide(scene: Scene, path: str, curve: Curve, motion: Motion) -> Samples:
    """Return how a curve changes with a number of the output's guide while the point moves as it does, shape (n,)."""
    nothing = np.zeros(motion["time"].shape)
    if curve.kind not in QUANTITIES or path not in (paths := _paths(scene)):
        return nothing
    _, slide = _guided(scene)
    through, along = np.array(slide.through), np.array(slide.along)
    part = np.eye(2)[paths.index(path) % 2]
    if path in paths[:2]:
        return nothing - (along @ part * scene.length_unit[1] if curve.kind == "displacement" else 0.0)
    x, y = (motion[f"{curve.of}.{QUANTITIES[curve.kind]}{axis}"] for axis in "xy")
    if curve.kind == "displacement":
        x, y = x - through[0], y - through[1]
    turn = (part - along * (along @ part)) / float(np.linalg.norm(numbers_in(scene.file, paths[2:])))
    return np.asarray(turn[0] * x + turn[1] * y)


def _paths(scene: Scene) -> list[str]:
    if scene.guided(scene.output) is None:
        return []
    return [f"bodies.{_guided(scene)[0]}.slides.{key}.{axis}" for key in ("through", "along") for axis in (0, 1)]


def _guided(scene: Scene) -> Any:
    guided = scene.guided(scene.output)
    assert guided is not None
    return guided

"""Scenes with friction in every joint."""

from dataclasses import replace
from typing import Any

import numpy as np

from scenes import Scene
from scenes.elements.friction import Friction, GuideFriction, PinFriction


def everywhere(scene: Scene, coefficient: float = 0.1, **more: Any) -> Scene:
    """A scene with friction in every joint: pins of a fiftieth of its sketch's size, contacts of 0.3 of it."""
    places = np.array([*scene.ground.values(), *scene.sketch.points.values()])
    size = float(np.ptp(places, axis=0).max()) or 1.0
    kinds = [PinFriction(at=p.point, body=p.second, radius=0.02 * size, coefficient=coefficient) for p in scene.pins]
    guides = [GuideFriction(slider=name, length=0.3 * size, coefficient=coefficient) for name in scene.slides]
    every: list[Friction] = [*kinds, *guides]
    return replace(scene, friction=tuple(replace(one, **more) for one in every))

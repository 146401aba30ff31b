"""Scenes with friction: in every joint of another scene, and where statics by hand say what it does."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

import scenes
from scenes import Scene
from scenes.elements.friction import Friction, GuideFriction, PinFriction

# A drawer that is pulled through a link whose line runs 0.3 m beside the guide's, against 10 N, without masses.
DRAWER = """
format = 1
name = "drawer"
ground.points = {{ O = [0, 0] }}
bodies.drawer = {{ points = {{ A = [0, 0], D = [0, 0.3] }}, mass = 0, slides = {{ through = [0, 0], along = [1, 0] }} }}
bodies.link = {{ points = {{ D = [0, 0], H = [1, 0] }}, mass = 0 }}
bodies.puller = {{ points = {{ H = [0, 0] }}, mass = 0, slides = {{ through = [0, 0.3], along = [1, 0] }} }}
drive = {{ body = "puller", speed = 1, start = 1, end = 2 }}
loads = [{{ body = "drawer", at = "A", force = [-10, 0] }}]
friction = [{{ slider = "drawer", length = {length}, coefficient = 0.25 }}]
sketch = {{ displacement = 1, A = [0, 0], D = [0, 0.3], H = [1, 0.3] }}
output = {{ slider = "A" }}
"""


def drawer(length: float) -> Scene:
    """The drawer with a contact of that length, m."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "drawer.toml"
        file.write_text(DRAWER.format(length=length), encoding="utf-8")
        return scenes.load(file)


def everywhere(scene: Scene, coefficient: float = 0.1, **more: Any) -> Scene:
    """A scene with friction in every joint: pins of a fiftieth of its sketch's size, contacts of 0.3 of it."""
    places = np.array([*scene.ground.values(), *scene.sketch.points.values()])
    size = float(np.ptp(places, axis=0).max()) or 1.0
    kinds = [PinFriction(at=p.point, body=p.second, radius=0.02 * size, coefficient=coefficient) for p in scene.pins]
    guides = [GuideFriction(slider=name, length=0.3 * size, coefficient=coefficient) for name in scene.slides]
    every: list[Friction] = [*kinds, *guides]
    return replace(scene, friction=tuple(replace(one, **more) for one in every))

"""What several tests need: the toggle press, and scene files made on the spot."""

from collections.abc import Callable
from pathlib import Path

import pytest

import scenes
from scenes import Scene

SceneFrom = Callable[[str], Scene]

TOGGLE_PRESS = (scenes.LIBRARY / "toggle_press.toml").read_text(encoding="utf-8")


@pytest.fixture
def toggle_press() -> Scene:
    return scenes.load("toggle_press")


@pytest.fixture
def scene_from(tmp_path: Path) -> SceneFrom:
    """Return a function that loads a scene from the text of its file."""

    def load(text: str) -> Scene:
        file = tmp_path / "scene.toml"
        file.write_text(text, encoding="utf-8")
        return scenes.load(file)

    return load

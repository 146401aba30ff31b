"""What several tests need: the toggle press, its reference, and engines that end as told."""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from tempfile import gettempdir

import pytest
from hypothesis import settings
from hypothesis.configuration import set_hypothesis_home_dir

import scenes
from compare.engines import registry
from compare.engines.reference import Reference, establish, found
from scenes import Motion, Scene

from . import scene_files
from .comparisons import Outcome, Plug, References, Stub, commanded

set_hypothesis_home_dir(Path(gettempdir()) / "hypothesis")
settings.register_profile("no leftovers", database=None)
settings.load_profile("no leftovers")

SceneFrom = Callable[[str], Scene]


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


# --- the comparison -----------------------------------------------------------------------------------------------


@pytest.fixture(scope="session")
def reference() -> Reference:
    return establish(scenes.load("toggle_press"))


@pytest.fixture
def motion(reference: Reference) -> Motion:
    return commanded(reference)


@pytest.fixture(scope="session")
def references() -> References:
    """Return a function that solves the reference of a mechanism, without its floor, and only once."""
    return cache(lambda name: found(scene_files.load(name)))


@pytest.fixture
def plug(monkeypatch: pytest.MonkeyPatch) -> Plug:
    """Return a function that makes the engine named `stub` end as told."""
    real = registry.engine
    entry = registry.Entry("a stub", "", 1e-3, "numpy", "numpy", "")
    monkeypatch.setitem(registry.ENTRIES, "stub", entry)

    def plug(outcome: Outcome) -> None:
        monkeypatch.setattr(registry, "engine", lambda name: Stub(outcome) if name == "stub" else real(name))

    return plug

"""What several tests need: the toggle press, and scene files made on the spot."""

from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path
from tempfile import gettempdir

import pytest
from hypothesis import settings
from hypothesis.configuration import set_hypothesis_home_dir

import scenes
from compare.engines import registry
from compare.engines.reference import Floor, Reference, establish
from scenes import Motion, Scene

from .comparisons import Outcome, Plug, References, Stub, commanded
from .mechanisms import MECHANISMS

set_hypothesis_home_dir(Path(gettempdir()) / "hypothesis")
settings.register_profile("no leftovers", database=None)
settings.load_profile("no leftovers")

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


# --- a scene with something of everything; near 30 degrees rod and guide are almost square --------------------------

_BUSY_HEAD = """
format = 1
name = "busy"
units = { length = "mm", angle = "deg", speed = "rpm" }
gravity = [0.5, -9.81]
[ground.points]
O = [10, 20]
C = [400, 30]
"""
_BUSY_BODIES = {
    "crank": 'lengths = { "A-O" = 100 }\nmass = 2',
    "coupler": "points = { A = [5, 0], B = [300, 20], T = [150, 90], K = [80, -20] }\n"
    "mass = 5\ncom = [140, 30]\ninertia = 9e4",
    "rocker": 'lengths = { "C-B" = 250 }\nmass = 4',
    "rod": 'lengths = { "B-D" = 500, "D-E" = 120, "B-E" = 450 }\nmass = 3',
    "slider": "points = { G = [0, 0], D = [30, -15] }\nmass = 8\ncom = [10, 5]\ninertia = 1e4\n"
    "slides = { through = [700, 500], along = [1, -0.3] }",
}
_BUSY_TAIL = """
[drive]
body = "crank"
speed = -90
start = 40
[[loads]]
body = "slider"
at = "D"
force = [-300, 100]
[[loads]]
body = "coupler"
at = "T"
force = [20, 50]
[sketch]
angle = 220
A = [-60, -50]
B = [230, 220]
D = [700, 490]
E = [650, 380]
[output]
point = "T"
"""


def busy_scene(order: Sequence[int] = (0, 1, 2, 3, 4)) -> str:
    """Return the text of the scene, its bodies in any order."""
    names = list(_BUSY_BODIES)
    return "\n".join([_BUSY_HEAD, *(f"[bodies.{names[i]}]\n{_BUSY_BODIES[names[i]]}" for i in order), _BUSY_TAIL])


# --- the comparison -----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def reference() -> Reference:
    return establish(scenes.load("toggle_press"))


@pytest.fixture
def motion(reference: Reference) -> Motion:
    return commanded(reference)


@pytest.fixture(scope="module")
def references(tmp_path_factory: pytest.TempPathFactory) -> References:
    """Return a function that establishes the reference of a mechanism, without its floor, and only once."""
    folder = tmp_path_factory.mktemp("mechanisms")

    @cache
    def of(name: str) -> Reference:
        file = folder / f"{name}.toml"
        file.write_text(MECHANISMS[name], encoding="utf-8")
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("compare.engines.reference._certify", lambda *_: Floor({}, "not certified here"))
            return establish(scenes.load(file))

    return of


@pytest.fixture
def plug(monkeypatch: pytest.MonkeyPatch) -> Plug:
    """Return a function that makes the engine named `stub` end as told."""
    real = registry.engine
    entry = registry.Entry("a stub", "", "numpy", "numpy", "", 1e-3)
    monkeypatch.setitem(registry.ENTRIES, "stub", entry)

    def plug(outcome: Outcome) -> None:
        monkeypatch.setattr(registry, "engine", lambda name: Stub(outcome) if name == "stub" else real(name))

    return plug

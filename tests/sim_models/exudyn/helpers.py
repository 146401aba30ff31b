"""What the tests of the Exudyn model share: runs of it, and errors against equations written in the tests."""

import re
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import scenes
from scenes import Motion, Sampling, Scene
from scenes.motion import quantity
from sim_models.exudyn import engine as model
from sim_models.exudyn.engine import DEFAULT, EXACT, ExudynSettings
from tests.absolute_coordinates import solve

from .mechanisms import SCENES

BOTH_ROUTES = pytest.mark.parametrize("settings", [DEFAULT, EXACT], ids=lambda settings: settings.label)


def write(folder: Path, text: str) -> Scene:
    path = folder / "scene.toml"
    path.write_text(text)
    return scenes.load(path)


def edited(folder: Path, *changes: tuple[str, str]) -> Scene:
    """Return the toggle press with some of its text replaced."""
    text = scenes.shipped()["toggle_press"].read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return write(folder, text)


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


def locking(folder: Path, start: float, end: float = 100) -> Scene:
    """Return the toggle press with a short rod, which locks at -95.06 and at 166.09 deg, driven between those."""
    text = scenes.shipped()["toggle_press"].read_text().replace('"P4-P5" = 300', '"P4-P5" = 200')
    speed = 60 if end > start else -60
    drive = f'[drive]\nbody = "crank"\nspeed = {speed}\nstart = {start}\nend = {end}\n\n'
    return write(folder, re.sub(r"\[drive\]\n.*?\n\n", drive, text, flags=re.DOTALL))


@cache
def referred(name: str) -> tuple[Scene, dict[str, NDArray[np.float64]]]:
    """Return a scene, and its motion at 61 instants from equations written in the tests."""
    with TemporaryDirectory() as folder:
        scene = write(Path(folder), SCENES[name])
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

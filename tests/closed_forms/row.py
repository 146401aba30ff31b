"""A row of the table of elements: a scene, and which of its channels are known by a formula."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np

import scenes
from scenes import Motion, Scene
from scenes.channels import Role
from scenes.elements import LISTS, kinds_of
from scenes.elements.element import ElementTable
from tests import scene_files
from tests.scene_files import Changes

Off = tuple[Any, float]  # differences to a formula, and the size that they are relative to


# Of lists that came later a row shows the kinds.
FIRST_KINDS = kinds_of(kind for table in LISTS.values() if table.rank < ElementTable.rank for kind in table.kinds)
ROUNDED = 1e-9  # of all terms, where no step of the time leaves anything
TWO_ROUNDED = 1e-13  # of the larger: a difference of two sums of ten terms


class Row(NamedTuple):
    scene: Callable[[], Scene]
    forces: Callable[[Motion, Motion], Mapping[str, Off]]  # of the motion, and of what the elements add to its forces
    places: Callable[[Motion], Mapping[str, Any]] = lambda _: {}  # differences, m or rad
    turns: int = 1
    added: bool = False  # forces are those beyond the scene's without loads and springs
    least: float = 0.0  # of a force's size: what doubles leave of it, whatever the engine
    most: Mapping[str, float] = {}  # where an engine's steps leave less than they do of others


def without_elements(scene: Scene) -> Scene:
    none: dict[str, Any] = {key: () for key, table in LISTS.items() if not table.kinds[0].by_joints}
    return replace(scene, **none)


def difference(motion: Motion, before: Motion, scene: Scene) -> Motion:
    """The motion, of whose forces only what has been added is left."""
    return Motion(
        dict(motion.samples) | {name: motion[name] - before[name] for name in scene.channels.names(Role.force)}
    )


def described(text: str) -> Scene:
    """The scene of a file's text."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / "scene.toml"
        file.write_text(text, encoding="utf-8")
        return scenes.load(file)


def off(found: Any, formula: Any, size: float | None = None) -> Off:
    """Differences, relative to a size or to the formula's peak."""
    formula = formula + 0 * found
    return found - formula, float(np.abs(formula).max()) if size is None else size


def within_a_turn(angle: Any) -> Any:
    return np.remainder(angle + np.pi, 2 * np.pi) - np.pi


def dot(a: Any, b: Any) -> Any:
    return (np.conj(a) * b).real


def place(motion: Motion, point: str) -> Any:
    return motion[f"{point}.x"] + 1j * motion[f"{point}.y"]


def velocity(motion: Motion, point: str) -> Any:
    return motion[f"{point}.vx"] + 1j * motion[f"{point}.vy"]


def heading(motion: Motion, body: str) -> Any:
    """The unit vector of a body's x axis."""
    return np.exp(1j * motion[f"{body}.angle"])


class Machine(NamedTuple):
    """A scene whose drive has one rate, and does the work against an element that is put on it."""

    scene: str
    changes: Changes
    effort: str
    rate: float
    turns: int
    added: bool  # it has masses or weights too

    def row(self, changes: Changes, power: Callable[[Motion], Any]) -> Row:
        """Of an element's power, W, by hand: that of the drive and the element's are opposite, whatever the masses."""

        def forces(motion: Motion, added: Motion) -> Mapping[str, Off]:
            by_drive, by_element = added[self.effort] * self.rate, power(motion)
            size = float(np.abs(by_element).max())
            if self.added:
                size = max(size, float(np.abs((motion[self.effort] - added[self.effort]) * self.rate).max()))
            return {"power": off(by_drive, -by_element, size or 1.0)}

        return Row(
            lambda: scene_files.load(self.scene, {**self.changes, **changes}),
            forces,
            turns=self.turns,
            added=self.added,
            least=TWO_ROUNDED * self.added,
        )


CRANK = Machine("crank", {"drive.start": 0.1}, "drive.torque", 3.0, 2, added=False)
CARRIED = Machine("carried_block", {"bodies.block.slides.through": [40, 30]}, "drive.torque", 3 * np.pi, 2, added=True)
CYLINDER = Machine("swung_bucket", {}, "drive.force", 0.1, 1, added=False)

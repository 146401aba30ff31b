"""Many machines of one topology: a scene with arrays of shape (m, 1) in place of the numbers that differ."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import check_changes, doubles, scene_of
from ..drive import Samples
from ..errors import InputError, at_place, nearest
from ..scene import Scene
from .demands import unmet_by_numbers, unmet_together


def machines(scene: Scene, changes: Mapping[str, ArrayLike]) -> Scene:
    """The scene with the numbers of many machines, see `numbers_of`."""
    return scene_of(scene).with_numbers(numbers_of(scene, changes))


def numbers_of(scene: Scene, changes: Mapping[str, ArrayLike]) -> dict[str, Samples]:
    """The numbers of many machines for `Scene.with_numbers`: SI, by the one form of their paths, shape (m, 1).

    They are given by path in the file (`bodies.rod.mass`), in its units, shape (m,); only paths and shapes are checked.

    Raises:
        InputError: no number is at a path, or one that cannot differ: of a motion law or of the sketch; two paths
            lead to the same one; or the numbers are not as many for each path.
    """
    check_changes(changes)
    scene = scene_of(scene)
    arrays = {at_path(scene, path): doubles(path, values) for path, values in changes.items()}
    if len(arrays) < len(changes):
        raise InputError(f"{scene.file}: expected each number once, and two of the paths lead to the same one")
    if len({values.shape for values in arrays.values()}) > 1 or any(values.ndim != 1 for values in arrays.values()):
        raise InputError("changes: expected one number a machine for each path, shape (m,)")
    return {path: values[:, None] * scene.size(scene.numbers[path]) for path, values in arrays.items()}


def at_path(scene: Scene, path: str) -> str:
    """The one form of a path, in which a length has no direction; InputError where machines may not differ there."""
    with at_place(scene.file):
        return one_form(scene, path)


def one_form(scene: Scene, path: str) -> str:
    """The same, whose error does not name the file."""
    before, lengths, pair = path.partition(".lengths.")
    name = before + lengths + "-".join(sorted(pair.split("-")))
    if name not in scene.numbers:
        body = scene.bodies.get(before.removeprefix("bodies."))
        if lengths and body is not None and body.local is not None and {*pair.split("-")} <= {*body.points}:
            straight = f"the points of '{body.name}' are on one line, and with another length they would be on none"
            raise InputError(f"{path}: {straight}; expected a body that is given by 'points'")
        raise InputError(f"{path}: expected the path of a number of the machine{nearest(name, scene.numbers)}")
    return name


def refused(scene: Scene) -> dict[int, str]:
    """Which of many machines have numbers that no file may have, and why: the first thing that does not fit."""
    why: dict[int, str] = {}
    for unmet in (unmet_by_numbers(scene), unmet_together(scene)):
        for demand in unmet:
            for machine in np.flatnonzero(~np.ravel(demand.fits)).tolist() if np.ndim(demand.fits) else ():
                why.setdefault(machine, demand.refusal(machine))
    return why

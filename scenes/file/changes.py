"""Values in a scene file by path, as `bodies.rocker.lengths.O-P3`: read and changed before they are checked.

Many machines of one topology are a scene with arrays of shape (m, 1) in place of the numbers that differ.
"""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import check_changes, doubles, scene_of
from ..drive import Samples
from ..elements import LISTS
from ..errors import InputError, at_place, nearest
from ..scene import Scene
from .demands import unmet_by_numbers, unmet_together

Value: TypeAlias = float | str
ONCE = "expected each number once; this path duplicates an earlier one"
# what machines of one drive may differ in
VARIED = ("ground", "bodies", "drive.speed", *LISTS, "gravity")


def numbers(tables: Mapping[str, Any], paths: Sequence[str]) -> list[float]:
    """The numbers at these paths, in the units of the file; InputError where one has none, or leads to an earlier's."""
    values: dict[tuple[int, str | int], float] = {}
    for path in paths:
        table, key = _place(tables, path, 0.0)
        if (id(table), key) in values:
            raise InputError(f"{path}: {ONCE}")
        values[id(table), key] = float(table[key])
    return [*values.values()]


def change(tables: Mapping[str, Any], changes: Mapping[str, Value]) -> None:
    """Put other numbers and texts at some paths, in place; InputError where one is not of the kind that it replaces."""
    for path, value in changes.items():
        table, key = _place(tables, path, value)
        table[key] = value


def check_variations(tables: Mapping[str, Any], scene: Scene) -> None:
    """Raise InputError for the first variation that is of no number of the linkage, or of the same as another."""
    seen: set[str] = set()
    for number, path in enumerate(variation.path for variation in scene.variations):
        with at_place(f"variations.{number}.path"):
            if not path.startswith(VARIED):
                raise InputError(f"{path}: expected a number of the linkage{nearest(path, VARIED)}")
            numbers(tables, [path])
            if (form := one_form(scene, path)) in seen:
                raise InputError(f"{path}: {ONCE}")
            seen.add(form)


def label(file: object, changes: Mapping[str, Value]) -> str:
    """The name of a scene in messages: its file, and what was changed in it."""
    return ", ".join([str(file), *(f"{path} = {as_text(value)}" for path, value in changes.items())])


def as_text(value: Value) -> str:
    """A value as messages show it; in full, since the rungs of a ladder may differ by very little."""
    return value if isinstance(value, str) else f"{value:.15g}"


def _place(tables: Mapping[str, Any], path: str, like: Value) -> tuple[Any, str | int]:
    """The table or list that holds a number, or a text, at this path, as `like` is one; and its key there."""
    table: Any = None
    key: str | int = ""
    value: Any = tables
    for part in path.split("."):
        if not isinstance(value, dict | list):
            raise InputError(f"{path}: the path goes on after a number or a text, at '{part}'")
        keys, turned = _keys(value), "-".join(reversed(part.split("-")))  # a length has no direction
        if not (known := [name for name in (part, turned) if name in keys]):
            raise InputError(f"{path}: the file has no '{part}' there{nearest(part, keys)}")
        table, key = value, keys[known[0]]
        value = table[key]
    kind, kinds = ("text", str) if isinstance(like, str) else ("number", int | float)
    if isinstance(value, bool) or not isinstance(value, kinds):
        inside = _keys(value) if isinstance(value, dict | list) else ()
        raise InputError(f"{path}: expected the path of a {kind}{nearest('', inside)}")
    return table, key


def _keys(value: dict[str, Any] | list[Any]) -> dict[str, str | int]:
    """The keys of a table or a list, by the parts of paths that name them."""
    return {str(key): key for key in (value if isinstance(value, dict) else range(len(value)))}


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

"""The units of a scene's file, for the numbers of its `summary.json`, which are in SI."""

import re
from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

from scenes import Scene
from scenes.numbers import quantity_at
from scenes.scene import units_of_all

BASE = {"m": "length", "kg": "mass", "N": "force", "rad": "angle"}  # what the file names a unit of


def unit_of(path: Sequence[Any], scene: Mapping[str, Any]) -> tuple[str, float]:
    """The unit that a number of the scene has in its file, and what that is in SI.

    Args:
        path: as `("scene", "bodies", "rod", "mass")`.
        scene: of a `summary.json`.
    """
    quantity = quantity_at(Scene, path[1:])
    if quantity is None:
        return "", 1.0
    slides = scene["bodies"][scene["drive"]["body"]]["slide"] is not None
    name, size = units_of_all(scene["units"], slides=slides)[quantity.dimension]
    return name, size


def in_file(si: str, scene: Mapping[str, Any]) -> tuple[str, float]:
    """A unit of SI, such as N*m, in those of the scene's file, and what that is in SI."""
    names, sizes = ({base: scene["units"][quantity][k] for base, quantity in BASE.items()} for k in (0, 1))
    parts = re.findall(r"(/?)([A-Za-z]+)(?:\^(\d))?", si)
    size = prod(sizes[base] ** (int(power or 1) * (-1) ** bool(over)) for over, base, power in parts if base in sizes)
    return re.sub("[A-Za-z]+", lambda base: names.get(base[0], base[0]), si), float(size)

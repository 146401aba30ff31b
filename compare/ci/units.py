"""The units of a scene's file, for the numbers of its `summary.json`, which are in SI."""

import re
from collections.abc import Mapping, Sequence
from math import prod
from typing import Any

BASE = {"m": "length", "kg": "mass", "N": "force", "rad": "angle"}  # what the file names a unit of
KEY_AT = {"ground": 1, "sketch": 2, "drive": 2, "bodies": 3, "loads": 3, "springs": 3}  # in a path, by its second part
SI = dict.fromkeys(("ground", "points", "local", "lengths", "com", "through", "last", "length", "displacements"), "m")
SI |= {"mass": "kg", "inertia": "kg*m^2", "stiffness": "N/m", "force": "N", "forces": "N"}  # by key
OF_DRIVE = ("drive", "start", "end", "positions")  # keys of positions, by the kind of the drive


def unit_of(path: Sequence[Any], scene: Mapping[str, Any]) -> tuple[str, float]:
    """Return the unit that a number of the scene has in its file, and what that is in SI.

    Args:
        path: as `("scene", "bodies", "rod", "mass")`.
        scene: of a `summary.json`.
    """
    at = KEY_AT.get(path[1], 0)
    at += [*path[at : at + 1]] == ["slide"]
    key = path[at] if at < len(path) else ""  # an odd file has numbers in other places
    if key == "speed":
        return scene["units"]["speed"][0], scene["units"]["speed"][1]
    turns = scene["bodies"][scene["drive"]["body"]]["slide"] is None
    return in_file(("rad" if turns else "m") if key in OF_DRIVE else SI.get(key, ""), scene)


def in_file(si: str, scene: Mapping[str, Any]) -> tuple[str, float]:
    """Return a unit of SI, such as N*m, in those of the scene's file, and what that is in SI."""
    names, sizes = ({base: scene["units"][quantity][k] for base, quantity in BASE.items()} for k in (0, 1))
    parts = re.findall(r"(/?)([A-Za-z]+)(?:\^(\d))?", si)
    size = prod(sizes[base] ** (int(power or 1) * (-1) ** bool(over)) for over, base, power in parts if base in sizes)
    return re.sub("[A-Za-z]+", lambda base: names.get(base[0], base[0]), si), float(size)

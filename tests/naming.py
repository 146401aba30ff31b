"""Scenes under other names: bodies that are called as points are, and both as the drive, the time and inputs are."""

from collections.abc import Iterator, Mapping
from copy import deepcopy
from typing import Any

import scenes
from scenes import Scene
from scenes.scene import GROUND

FOR_BODIES = ("time", "crank_angle", "position", "transmission", "friction", "rate", "bodies", "sketch", "closure")
FOR_POINTS = ("drive", "ground", *FOR_BODIES)
NAMELESS = ("variations", "limits", "results")  # tables by path or channel


def alike(scene: Scene) -> Iterator[tuple[str, Scene]]:
    """The scene, its bodies called as each of its points in turn; and points and bodies by names of other things."""
    points, bodies, tables = [*scene.owners], [*scene.bodies], scene.tables
    same = dict(zip(points, points, strict=True))
    for turn in range(len(points)):
        given = (points[turn:] + points[:turn])[: len(bodies)]
        yield f"bodies as points from {turn}", loaded(tables, same, _named(bodies, given))
    for turn in (0, 4, 7):
        names = (own[turn % len(own) :] + own[: turn % len(own)] for own in (FOR_POINTS, FOR_BODIES))
        yield f"other things from {turn}", loaded(tables, *map(_named, (points, bodies), names))


def _named(names: list[str], given: Any) -> dict[str, str]:
    """Other names as far as there are some."""
    return dict(zip(names, (*given, *(f"{name}_own" for name in names[len(given) :])), strict=False))


def loaded(scene: Mapping[str, Any], points: Mapping[str, str], bodies: Mapping[str, str], limits: Any = None) -> Scene:
    """A scene of these tables with other names, and with limits."""
    named = {GROUND: GROUND, **bodies}
    other = deepcopy({key: table for key, table in scene.items() if key not in NAMELESS}) | {"limits": limits or {}}
    other["ground"] = {"points": {points[name]: xy for name, xy in scene["ground"]["points"].items()}}
    other["bodies"] = {named[name]: _body(table, points, named) for name, table in scene["bodies"].items()}
    other["sketch"] = {points.get(key, key): value for key, value in scene["sketch"].items()}
    other["output"] = {key: points[name] for key, name in scene["output"].items()}
    for table in (
        other["drive"],
        *other.get("loads", ()),
        *other.get("friction", ()),
        *other.get("torsion_springs", ()),
    ):
        table |= {key: points[table[key]] for key in {"at"} & table.keys()}
        table |= {key: named[table[key]] for key in {"body", "slider", "on"} & table.keys()}
        if "between" in table:
            table["between"] = [named[name] for name in table["between"]]
    for table in other.get("springs", ()):
        ends = (end.split(".") for end in table["between"])
        table["between"] = [f"{named[body]}.{points[point]}" for body, point in ends]
    return scenes.from_tables(other, "named.toml")


def _body(table: Mapping[str, Any], points: Mapping[str, str], bodies: Mapping[str, str]) -> dict[str, Any]:
    other = dict(table)
    if "points" in table:
        other["points"] = {points[name]: xy for name, xy in table["points"].items()}
    if "lengths" in table:
        pairs = ((pair.split("-"), length) for pair, length in table["lengths"].items())
        other["lengths"] = {f"{points[a]}-{points[b]}": length for (a, b), length in pairs}
    if "slides" in table:
        other["slides"] = {**table["slides"], "on": bodies[table["slides"].get("on", GROUND)]}
    return other

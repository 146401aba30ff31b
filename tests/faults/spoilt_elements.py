"""Faults in the newer loads and springs that an engine solves: moments, tables, guides' forces, dampers, twists."""

from collections.abc import Iterator
from dataclasses import replace
from math import pi, tau
from typing import Any

from compare.judge.causes.cause import Kind
from scenes.elements.loads import TurningForce
from scenes.elements.tables import COLUMN
from scenes.fields import put
from scenes.scene import GuideForce, Load, Moment, TableForce

from .fault import Clean, Fault

SIZES = (-2.0, 1.0, 0.1, 0.01)


def elements(clean: Clean) -> Iterator[Fault]:
    """Yield other numbers of them, other frames, bodies and reactions, and none at all."""
    scene = clean.scene

    def of_load(kind: str, by: float, number: int, *instead: Any) -> Fault:
        spoilt = replace(scene, loads=(*scene.loads[:number], *instead, *scene.loads[number + 1 :]))
        return Fault("load", kind, by, Kind.load, scene.loads[number].spot, scene=spoilt)

    for number, load in enumerate(scene.loads):
        if isinstance(load, TableForce | Moment) or type(load) is GuideForce:
            what = f"a {load.kind.removesuffix('s')}"
            yield of_load(f"{what} missing", 1, number)
            for by in SIZES:
                yield of_load(f"{what} {'opposite' if by < -1 else 'by a factor'}", by, number, _times(load, 1 + by))
            yield from (of_load(kind, by, number, other) for kind, by, other in _others(clean, load))

    for name in ("springs", "torsion_springs"):
        for number, spring in enumerate(getattr(scene, name)):
            place = spring.at if name == "torsion_springs" else f"{spring.first[1]}-{spring.second[1]}"
            for what in ("damping", "stiffness") if name == "torsion_springs" else ("damping",):
                for by in (-1.0, *SIZES) if getattr(spring, what) else ():
                    spoilt = put(scene, {(name, number, what): (1 + by) * getattr(spring, what)})
                    yield Fault("load", f"{name}' {what}", by, Kind.spring, place, scene=spoilt)
            for by in (tau, 0.1, 0.01) if name == "torsion_springs" and spring.stiffness else ():
                spoilt = put(scene, {(name, number, "angle"): spring.angle + by})
                yield Fault("load", "a torsion spring's angle", by, Kind.spring, place, scene=spoilt)


def _others(clean: Clean, load: Any) -> Iterator[tuple[str, float, Load]]:
    """Yield other loads in the place of one, each with what it is and by how much it is off."""
    bodies = clean.scene.bodies
    if isinstance(load, Moment):
        for owner in [name for name in clean.scene.turning if name not in (load.body, clean.scene.drive.body)][:1]:
            yield "a moment on another body", 1, replace(load, body=owner, at=bodies[owner].points[0])
    if isinstance(load, TableForce):
        yield "a force in the other frame", 1, load.turned
        x, y = load.direction
        for angle in (pi / 2, 0.1):
            yield "a force of another direction", angle, replace(load, along=(x - angle * y, y + angle * x))
    if isinstance(load, GuideForce) and load.force is not None and (slide := bodies[load.body].slide):
        force = load.force * slide.along[0], load.force * slide.along[1]
        yield "a guide's force without reaction", 1, TurningForce(load.body, load.at, force)
    if (table := load.table) is not None:
        column, width = COLUMN[table.over], table.arguments[-1] - table.arguments[0]
        for by in (0.1, 0.01):
            shifted: Any = {column: tuple(x + by * width for x in table.arguments)}
            moved = replace(table, **shifted)
            yield "a table shifted", by, replace(load, table=moved)
        backwards = replace(table, forces=table.forces[::-1], moments=table.moments[::-1])
        yield "a table backwards", 1, replace(load, table=backwards)


def _times(load: Any, by: float) -> Any:
    if load.table is not None:
        forces, moments = (tuple(by * value for value in of) for of in (load.table.forces, load.table.moments))
        return replace(load, table=replace(load.table, forces=forces, moments=moments))
    key = "moment" if isinstance(load, Moment) else "force"
    return replace(load, **{key: by * getattr(load, key)})

"""Faults in the scene that an engine solves: inertia, geometry, loads, gravity, friction, drive."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np

from compare.judge.causes.cause import Kind
from compare.mechanics.bodies import distances, inertia
from compare.mechanics.mechanics import inputs
from scenes import Scene
from scenes.elements.loads import ForceTable, TurningForce
from scenes.fields import put, walk
from scenes.scene import Body, ConstantSpeed, DrawnBody, Force, GuideForce, PressForce

from .fault import Clean, Fault

SIZES = (0.5, 0.1, 0.01, 0.003)


def masses(clean: Clean) -> Iterator[Fault]:
    """Yield other masses, moments of inertia and centres of mass."""
    if not clean.scene.has_masses:
        return
    yield from _as_drawn(clean)
    scene = replace(clean.scene, bodies={name: body.weighed for name, body in clean.scene.bodies.items()})
    heavy = [name for name, body in scene.bodies.items() if body.mass]

    def fault(kind: str, magnitude: float, cause: Kind, name: str, **changes: Any) -> Fault:
        body = replace(scene.bodies[name], **changes)
        return Fault("inertia", kind, magnitude, cause, name, scene=_with_body(scene, name, body))

    for by in (1.0, *SIZES):
        for name in clean.some(heavy, f"mass {by}"):
            heavier = (1 + by) * (scene.bodies[name].mass or 0.0)
            yield fault("mass", by, Kind.mass, name, mass=heavier, **_about_com(scene, name))
        for name in clean.some([one for one in scene.turning if inertia(scene.bodies[one])], f"inertia {by}"):
            yield fault("moment of inertia", by, Kind.inertia, name, **_inertia(scene, name, 1 + by))
    for name in clean.some(heavy, "no mass"):
        yield fault("no mass", 1, Kind.mass, name, mass=0.0, **_about_com(scene, name))
    turning = [name for name in scene.turning if name in heavy]
    for name in clean.some([one for one in turning if inertia(scene.bodies[one])], "no inertia"):
        yield fault("no moment of inertia", 1, Kind.inertia, name, **_inertia(scene, name, 0.0))
    bars = [one for one in turning if len(scene.bodies[one].corners) == 2 and scene.bodies[one].com is None]
    for name in clean.some(bars, "bar"):
        yield fault("a uniform bar's inertia about its end", 3, Kind.inertia, name, **_inertia(scene, name, 4.0))
    for name in clean.some([one for one in turning if len(scene.bodies[one].points) in (2, 3)], "com"):
        body = scene.bodies[name]
        length = max(distances(body).values(), default=0.0)
        for by in (0.5, 0.1, 0.01):
            for way, turn in (("along", 1), ("across", 1j)):
                com = _com(scene, name)
                if com is not None:
                    place = com + by * length * turn
                    changes = {"com": (place.real, place.imag), "inertia": inertia(body)}
                    yield fault(f"centre of mass {way} the body", by, Kind.com, name, **changes)
    for one, other in clean.some(pairwise(heavy), "swapped"):
        if scene.bodies[one].mass != scene.bodies[other].mass:
            masses = {one: scene.bodies[other].mass or 0.0, other: scene.bodies[one].mass or 0.0}
            spoilt = put(scene, {("bodies", name, "mass"): mass for name, mass in masses.items()})
            yield Fault("inertia", "the masses of two bodies swapped", 1, Kind.mass, one, scene=spoilt)
    for kind, factor in {"no masses at all": 0.0, "all masses": 1.1, "all masses in g": 1e3}.items():
        spoilt = scene
        for name in heavy:
            body = scene.bodies[name]
            own = None if body.inertia is None else factor * body.inertia
            spoilt = _with_body(spoilt, name, replace(body, mass=factor * (body.mass or 0.0), inertia=own))
        yield Fault("inertia", kind, abs(factor - 1), Kind.mass, "all", scene=spoilt)


def _as_drawn(clean: Clean) -> Iterator[Fault]:
    """Yield other densities and widths, by which mass and moment of inertia differ together."""
    drawn = {name: body for name, body in clean.scene.bodies.items() if isinstance(body, DrawnBody)}
    for by in SIZES:
        for name in clean.some([*drawn], f"density {by}"):
            other = put(clean.scene, {("bodies", name, "density"): (1 + by) * drawn[name].density})
            yield Fault("inertia", "density", by, Kind.mass, name, scene=other)
        for name in clean.some([one for one, body in drawn.items() if body.width], f"width {by}"):
            other = put(clean.scene, {("bodies", name, "width"): (1 + by) * (drawn[name].width or 0.0)})
            yield Fault("inertia", "width", by, Kind.mass, name, scene=other)


def _with_body(scene: Scene, name: str, body: Body) -> Scene:
    return replace(scene, bodies={**scene.bodies, name: body})


def _com(scene: Scene, name: str) -> complex | None:
    """Return the centre of mass in the body's frame; None where a triangle of lengths hides it."""
    body = scene.bodies[name]
    if body.com is not None:
        return complex(*body.com)
    if body.local is not None:
        return sum(complex(*body.local[point]) for point in body.corners) / len(body.corners)
    return max(distances(body).values()) / 2 + 0j if len(body.points) == 2 else None


def _about_com(scene: Scene, name: str) -> dict[str, Any]:
    """Return what keeps the moment of inertia of a body when its mass changes, where that can be given."""
    com = _com(scene, name)
    return {} if com is None else {"com": (com.real, com.imag), "inertia": inertia(scene.bodies[name])}


def _inertia(scene: Scene, name: str, factor: float) -> dict[str, Any]:
    com = _com(scene, name)
    if com is None:
        return {"mass": scene.bodies[name].mass}
    return {"com": (com.real, com.imag), "inertia": factor * inertia(scene.bodies[name])}


def geometry(clean: Clean) -> Iterator[Fault]:
    """Yield other lengths, places, guides, scales and branches."""
    scene, size = clean.scene, clean.reference.stroke
    bars = [(name, pair) for name, body in scene.bodies.items() for pair in body.lengths or ()]
    arms = [
        (name, p) for name, body in scene.bodies.items() if len(body.points) > 1 for p in list(body.local or ())[1:]
    ]
    used = [point for point in scene.ground if len(scene.owners[point]) > 1]
    guides = [name for name, body in scene.bodies.items() if body.slide is not None]

    def fault(kind: str, magnitude: float, cause: Kind, place: str, spoilt: Scene) -> Fault:
        return Fault("geometry", kind, magnitude, cause, place, scene=spoilt)

    for by in (0.03, 0.003, 5 * clean.promise, -0.01):
        for name, pair in clean.some(bars, f"length {by}"):
            length = (scene.bodies[name].lengths or {})[pair]
            spoilt = put(scene, {("bodies", name, "lengths", pair): (1 + by) * length})
            yield fault("length", by, Kind.length, name, spoilt)
        for name, point in clean.some(arms, f"point {by}"):
            x, y = (scene.bodies[name].local or {})[point]
            for way, dx, dy in (("along", by * x, by * y), ("across", -by * y, by * x)):
                spoilt = put(scene, {("bodies", name, "local", point): (x + dx, y + dy)})
                yield fault(f"a body's point, {way}", by, Kind.length, name, spoilt)
        for point in clean.some(used, f"ground {by}"):
            x, y = scene.ground[point]
            for axis, dx, dy in (("x", by * size, 0.0), ("y", 0.0, by * size)):
                spoilt = put(scene, {("ground", point): (x + dx, y + dy)})
                yield fault(f"a ground point: {axis}", by, Kind.place, point, spoilt)
        for name in clean.some(guides, f"guide {by}"):
            slide = scene.bodies[name].slide
            assert slide is not None
            along = complex(*slide.along)
            beside = complex(*slide.through) + 1j * along * by * size
            spoilt = put(scene, {("bodies", name, "slide", "through"): (beside.real, beside.imag)})
            yield fault("a guide beside its place", by, Kind.guide, name, spoilt)
            turned = along * np.exp(1j * by)
            spoilt = put(scene, {("bodies", name, "slide", "along"): (float(turned.real), float(turned.imag))})
            yield fault("a guide's direction", by, Kind.guide, name, spoilt)
    for by in (0.1, 5 * clean.promise):
        yield fault("the whole linkage's scale", by, Kind.length, "all", rescaled(scene, 1 + by))


def rescaled(scene: Scene, by: float) -> Scene:
    """Return the whole linkage larger or smaller; its forces and speeds stay."""
    larger = {one.at: by * one.value for one in inputs(scene) if one.quantity.dimension == "length"}
    other: Scene = put(scene, larger)
    return other


def drives(clean: Clean) -> Iterator[Fault]:
    """Yield drives that ask for something else, which are late or fast."""
    scene, law = clean.scene, clean.scene.drive.law

    def fault(kind: str, by: float, *changed: Any) -> Fault:
        return Fault("time", kind, by, Kind.drive, "drive", scene=scene.with_law(put(law, {changed[:-1]: changed[-1]})))

    for by in (0.01, 1e-4, 1e-7):
        if isinstance(law, ConstantSpeed):
            yield fault("another speed of the drive", by, "speed", (1 + by) * law.speed)
            if scene.drive.slide is None:
                other = scene.with_law(replace(law, start=law.start + by))  # at one speed the same as a lag
                yield Fault("time", "another start of the drive", by, Kind.lag, "all", scene=other)
        else:
            entries = [number for number in walk(law) if number.quantity.dimension == "position"]
            middle = entries[len(entries) // 2]
            yield fault("another entry of the law", by, *middle.at, middle.value + by)


def loads(clean: Clean) -> Iterator[Fault]:
    """Yield other loads and springs."""
    scene = clean.scene

    def fault(kind: str, magnitude: float, place: str, number: int, *instead: Any) -> Fault:
        spoilt = replace(scene, loads=(*scene.loads[:number], *instead, *scene.loads[number + 1 :]))
        return Fault("load", kind, magnitude, Kind.load, place, scene=spoilt)

    for number, load in enumerate(scene.loads):
        kinds = {Force: "a force", TurningForce: "a force", PressForce: "a press force", ForceTable: "a table"}
        if (kind := kinds.get(type(load))) is None:
            continue
        yield fault(f"{kind} missing", 1, load.at, number)
        for by in (-2.0, 1.0, *SIZES):
            yield fault(f"{kind} {'opposite' if by < -1 else 'by a factor'}", by, load.at, number, _times(load, 1 + by))
        for point in [p for p in scene.bodies[load.body].points if p != load.at][:1]:
            yield fault(f"{kind} at another point", 1, load.at, number, replace(load, at=point))
        if isinstance(load, Force):
            x, y = load.force
            for angle in (pi / 2, 0.1, 0.005):
                turned = complex(x, y) * np.exp(1j * angle)
                other = replace(load, force=(float(turned.real), float(turned.imag)))
                yield fault("a force turned", angle, load.at, number, other)
        if isinstance(load, PressForce):
            for factor in (2.0, 1.2, 0.5):
                later = replace(load, last=factor * load.last)
                yield fault("a press force's last part", factor, load.at, number, later)
            yield fault("a press force all the time", 1, load.at, number, Force(load.body, load.at, load.force))
            back = replace(load, closing=-load.closing)
            yield fault("a press force on the way back", 1, load.at, number, back)
            yield fault("a press force both ways", 1, load.at, number, load, back)
        if isinstance(load, GuideForce) and (table := load.table) is not None:
            range_ = table.arguments[-1] - table.arguments[0]
            for by in (0.1, 0.01, 0.001):
                moved = replace(table, displacements=tuple(x + by * range_ for x in table.arguments))
                yield fault("a table shifted", by, load.at, number, replace(load, table=moved))
            backwards = replace(table, forces=table.forces[::-1])
            yield fault("a table backwards", 1, load.at, number, replace(load, table=backwards))
    yield from _springs(clean)


def _times(load: Any, factor: float) -> Any:
    if load.table is not None:
        return replace(load, table=replace(load.table, forces=tuple(factor * force for force in load.table.forces)))
    return replace(load, force=(factor * load.force[0], factor * load.force[1]))


def _springs(clean: Clean) -> Iterator[Fault]:
    scene = clean.scene
    for number, spring in enumerate(scene.springs):
        place = f"{spring.first[1]}-{spring.second[1]}"
        without = (*scene.springs[:number], *scene.springs[number + 1 :])
        yield Fault("load", "a spring missing", 1, Kind.spring, place, scene=replace(scene, springs=without))
        for by in (-2.0, *SIZES) if spring.stiffness else ():
            for what in ("stiffness", "length"):
                spoilt = put(scene, {("springs", number, what): (1 + by) * getattr(spring, what)})
                yield Fault("load", f"a spring's {what}", by, Kind.spring, place, scene=spoilt)

"""Which numbers of a scene may be off together, and what that is called."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes import Scene
from scenes.elements.element import Element
from scenes.elements.loads import Force, TableForce, TurningForce
from scenes.elements.springs import Damper, Spring, TorsionSpring
from scenes.model.motion import Samples
from scenes.scene import DrawnBody

from ...mechanics.bodies import first_point, weights
from ...mechanics.contacts import CONTACTS
from ...mechanics.reference import Reference
from .cause import Cause, Kind

NO_MASS = -1.005  # of a mass or a moment of inertia, by so much of itself too small: none at all, but for rounding
STANDARD_GRAVITY = (0.0, -9.81)  # m/s^2
OF_LINKAGE = {"ground", "bodies", "springs"}  # which have the lengths of a linkage
LENGTH = "{place}'s length {one} is {length} too {long}"
# of tables, by what they are over
SHIFTS = {"displacement": "{signed_length}", "drive": "{displacement}", "time": "{number} s"}

Direction: TypeAlias = Mapping[str, float]  # by path in the file what is added to a number, SI


class Numbers(NamedTuple):
    """Numbers of a scene that are off together, along k directions, and the cause that they are then."""

    cause: Cause  # without its amounts
    directions: tuple[Direction, ...]
    amounts: Callable[[Samples], Any] = np.asarray  # of the cause, by those of the directions, shape (k,)
    linear: bool = False  # as forces are in masses, and in a press's force: one of the other sign would act elsewhere
    alone: bool = False  # in the scene whose centres of mass and moments of inertia stand by themselves

    def measured(self, x: Samples) -> Cause:
        """Return the cause that numbers are, off by so much of each direction; not finite where they cannot be."""
        none = self.cause.kind in (Kind.mass, Kind.inertia) and x[0] < NO_MASS
        return replace(self.cause, amounts=(np.nan,) if none else tuple(np.ravel(self.amounts(x)).tolist()))


_linear = partial(Numbers, linear=True)


def standing_alone(scene: Scene) -> Scene:
    """Return a scene whose bodies have centres of mass and moments of inertia of their own, and gravity, be it none."""
    bodies = dict(scene.bodies)
    for name, body in scene.bodies.items():
        if body.mass is not None:
            weight = weights(scene, body)
            com = weight.com + first_point(body)
            bodies[name] = replace(body.weighed, com=(com.real, com.imag), inertia=weight.inertia)
    return replace(scene, bodies=bodies, gravity=scene.gravity or (0.0, 0.0))


def numbers_of_causes(reference: Reference) -> Iterator[Numbers]:
    """Yield the groups of numbers that one cause changes."""
    if reference.scene.has_masses:
        yield from _of_weights(reference.scene)
        yield from _of_forces(reference.scene)
        yield from _of_friction(reference.scene)
    yield from _of_places(reference.scene)


def _of_weights(scene: Scene) -> Iterator[Numbers]:
    """Yield masses, moments of inertia and centres of mass, of each body and of all, and gravity."""
    alone, a_mass = partial(Numbers, linear=True, alone=True), "{place}'s mass is {percent}"
    weight_of = {name: weights(scene, body) for name, body in scene.bodies.items() if body.mass}
    turning = [name for name in scene.turning if name in weight_of and weight_of[name].inertia]
    masses = {f"bodies.{name}.mass": w.mass for name, w in weight_of.items()}
    inertias = {f"bodies.{name}.inertia": weight_of[name].inertia for name in turning}
    for name in weight_of:
        inertia, mass = scene.bodies[name].inertia, {f"bodies.{name}.mass": weight_of[name].mass}
        if inertia is None:  # which goes with the mass
            yield Numbers(Cause(Kind.mass, name, a_mass), (mass,), linear=True)
        elif isinstance(scene.bodies[name], DrawnBody):
            yield alone(Cause(Kind.mass, name, a_mass), (mass | {f"bodies.{name}.inertia": inertia},))
        if inertia is not None or name in turning:
            yield alone(Cause(Kind.mass, name, a_mass), (mass,))
        if name in turning:
            of_own = {f"bodies.{name}.inertia": weight_of[name].inertia}
            yield alone(Cause(Kind.inertia, name, "{place}'s moment of inertia is {inertia}"), (of_own,))
        if name in scene.turning:
            com = Cause(Kind.com, name, "{place}'s centre of mass is {com}")
            yield Numbers(com, _turned(f"bodies.{name}.com"), alone=True)
    if len(weight_of) > 1:
        yield alone(Cause(Kind.mass, "all", "each body's mass is {percent}"), (masses | inertias,))
        yield alone(Cause(Kind.inertia, "all", "each body's moment of inertia is {percent}"), (inertias,))
    if scene.gravity is not None:  # without it this is the same as each body's mass
        less = {f"gravity.{axis}": -g for axis, g in enumerate(scene.gravity)}
        yield alone(Cause(Kind.mass, "all", "inertia's share of all forces is {percent}"), (masses | inertias | less,))
    bars = [name for name in turning if scene.bodies[name].inertia is None and len(scene.bodies[name].corners) == 2]
    # The inertia of a bar of width w is m (l^2 + w^2) / 12: linear in w^2, whose root is the width.
    if bars:  # as wide as w they have m w²/12 more
        wide = {f"bodies.{name}.inertia": weight_of[name].mass / 12 for name in bars}
        cause = Cause(Kind.inertia, "all", "each uniform bar's moment of inertia is that of one {length} wide")
        yield alone(cause, (wide,), lambda x: np.sqrt(np.where(x > 0, x, np.nan)))
    down = complex(*(scene.gravity or STANDARD_GRAVITY))
    ways = _turned("gravity", down)
    if scene.gravity:
        yield alone(Cause(Kind.gravity, "all", "gravity is {percent}"), ways[:1])
    else:
        yield alone(Cause(Kind.gravity, "all", "gravity is {number} m/s^2"), ways[:1], lambda x: x * abs(down))
    cause = Cause(Kind.gravity, "all", "gravity is ({numbers}) m/s^2")
    yield alone(cause, ways, partial(_turned_vector, complex(*(scene.gravity or ())), down))


def _of_forces(scene: Scene) -> Iterator[Numbers]:
    """Yield what is wrong of loads and springs: the forces and moments of each, its table, and what its type has."""
    for place, element in scene.elements:
        label = element.named
        entries = (entry for entry in scene.numbers.values() if entry.path.startswith(f"{place}."))
        size = {entry.path: entry.value for entry in entries if entry.quantity.dimension in ("force", "moment")}
        if size:
            yield _linear(_cause(element, f"{label} is {{percent}}"), (size,))
        if element.table is not None:
            shifted = f"the table of {label} is shifted by {SHIFTS[element.table.over]}"
            rows = {f"{place}.table.{row}.0": 1.0 for row in range(len(element.table.values))}
            yield Numbers(_cause(element, shifted), (rows,))
        if more := TYPES.get(type(element)):
            yield from more(place, element)


def _cause(element: Element, text: str) -> Cause:
    return Cause(kind_of(element), element.spot, text)


def _of_force(place: str, load: Force) -> Iterator[Numbers]:
    force = complex(*load.force)
    vector = _cause(load, f"{load.named} is {{force}} at {{way}}")
    yield _linear(vector, _turned(f"{place}.force", force), partial(_turned_vector, force, force))


def _of_table_force(place: str, load: TableForce) -> Iterator[Numbers]:
    turned = _turned(f"{place}.along", complex(*load.along))[1:]
    yield Numbers(_cause(load, f"{load.named} is turned by {{angle}}"), turned)


def _of_spring(place: str, spring: Spring) -> Iterator[Numbers]:
    unloaded = "length", spring.length, f"{spring.named}'s length is {{percent}}"
    yield from _of_stiffness(place, spring, unloaded)


def _of_torsion_spring(place: str, spring: TorsionSpring) -> Iterator[Numbers]:
    """Yield its numbers: its moments are linear in its angle too."""
    yield from _of_stiffness(place, spring, ("angle", 1.0, f"{spring.named}'s angle is {{angle}} off"))


def _of_stiffness(place: str, spring: Spring | TorsionSpring, unloaded: tuple[str, float, str]) -> Iterator[Numbers]:
    stiffness = "stiffness", spring.stiffness, f"{spring.named}{{stiffness}}"
    damping = "damping", spring.damping, f"the damping of {spring.named} is {{percent}}"
    for key, value, text in (stiffness, unloaded, damping):
        if value is not None:
            yield _linear(_cause(spring, text), ({f"{place}.{key}": value},))


TYPES: Mapping[type[Element], Callable[[str, Any], Iterator[Numbers]]] = {
    Force: _of_force,
    TurningForce: _of_force,
    TableForce: _of_table_force,
    Spring: _of_spring,
    Damper: _of_spring,
    TorsionSpring: _of_torsion_spring,
}


def kind_of(element: Element) -> Kind:
    """The kind of a cause in an element: a spring has two ends."""
    return Kind.spring if len(element.ends) > 1 else Kind.load


def _of_friction(scene: Scene) -> Iterator[Numbers]:
    """Yield friction of each joint and of all, what it has by the load and what by the rate, and the contacts."""
    every: dict[str, float] = {}
    for number, friction in enumerate(scene.friction):
        path, place = f"friction.{number}", friction.joint(scene)
        contact = CONTACTS[type(friction)]
        coulomb = {f"{path}.{contact.linear}": getattr(friction, contact.linear)}
        viscous = {f"{path}.viscous": friction.viscous} if friction.viscous else {}
        ways = {"friction": coulomb | viscous}
        if viscous:
            ways |= {"Coulomb friction": coulomb, "viscous friction": viscous}
        ways |= {label: {f"{path}.{key}": getattr(friction, key)} for label, key in contact.others.items()}
        for label, way in ways.items():
            yield Numbers(Cause(Kind.friction, place, f"the {label} of {{place}} is {{percent}}"), (way,))
        every |= ways["friction"]
    if len(scene.friction) > 1:
        yield Numbers(Cause(Kind.friction, "all", "all friction is {percent}"), (every,))


def _of_places(scene: Scene) -> Iterator[Numbers]:
    for point in scene.ground:
        yield Numbers(Cause(Kind.place, point, "{place} is {length} off"), _turned(f"ground.points.{point}"))
    for name, body in scene.bodies.items():
        for point in body.local or ():
            cause = Cause(Kind.length, name, "{place}'s point {one} is {length} off", names=(point,))
            yield Numbers(cause, _turned(f"bodies.{name}.points.{point}"))
        for ends in body.lengths or ():
            ordered = "-".join(point for point in body.points if point in ends)
            length = {f"bodies.{name}.lengths.{'-'.join(sorted(ends))}": 1.0}
            yield Numbers(Cause(Kind.length, name, LENGTH, names=(ordered,)), (length,))
        if body.slide is not None:
            for key, how in (("through", "{length} beside its place"), ("along", "turned by {angle}")):
                directions = _turned(f"bodies.{name}.slides.{key}", complex(*body.slide.along))[1:]
                yield Numbers(Cause(Kind.guide, name, f"{{place}}'s guide is {how}"), directions)
    of_linkage = (entry for entry in scene.numbers.values() if entry.at[0] in OF_LINKAGE)
    lengths = {entry.path: entry.value for entry in of_linkage if entry.quantity.dimension == "length"}
    yield Numbers(Cause(Kind.length, "all", "each length is {times}"), (lengths,), lambda x: 1 + x)


def _turned(path: str, vector: complex = 1 + 0j) -> tuple[Direction, Direction]:
    """Return the directions of a vector along another one or x, and along that turned by a right angle."""
    x, y = vector.real, vector.imag
    return {f"{path}.0": x, f"{path}.1": y}, {f"{path}.0": -y, f"{path}.1": x}


def _turned_vector(now: complex, vector: complex, x: Samples) -> tuple[float, float]:
    """Return the components of what a vector is with so much of another one along and beside it added."""
    other = now + complex(*x) * vector
    return other.real, other.imag

"""Which numbers of a scene may be off together, and what that is called."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes import Scene
from scenes.elements.friction import GuideFriction
from scenes.elements.loads import Force, Load, Moment, TableForce
from scenes.elements.springs import Spring, TorsionSpring
from scenes.model.motion import Samples
from scenes.scene import DrawnBody

from ...mechanics.bodies import first_point, weights
from ...mechanics.reference import Reference
from .cause import Cause, Kind, stem

NONE = -1.005  # of a mass or a moment of inertia, by so much of itself too small: none at all, but for rounding
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
        none = self.cause.kind in (Kind.mass, Kind.inertia) and x[0] < NONE
        return replace(self.cause, amounts=(np.nan,) if none else tuple(np.ravel(self.amounts(x)).tolist()))


def standing_alone(scene: Scene) -> Scene:
    """Return a scene whose bodies have centres of mass and moments of inertia of their own, and gravity, be it none."""
    bodies = dict(scene.bodies)
    for name, body in scene.bodies.items():
        if body.mass is not None:
            own = weights(scene, body)
            com = own.com + first_point(body)
            bodies[name] = replace(body.weighed, com=(com.real, com.imag), inertia=own.inertia)
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
    own = {name: weights(scene, body) for name, body in scene.bodies.items() if body.mass}
    turning = [name for name in scene.turning if name in own and own[name].inertia]
    masses = {f"bodies.{name}.mass": w.mass for name, w in own.items()}
    inertias = {f"bodies.{name}.inertia": own[name].inertia for name in turning}
    for name in own:
        inertia, mass = scene.bodies[name].inertia, {f"bodies.{name}.mass": own[name].mass}
        if inertia is None:  # which goes with the mass
            yield Numbers(Cause(Kind.mass, name, a_mass), (mass,), linear=True)
        elif isinstance(scene.bodies[name], DrawnBody):
            yield alone(Cause(Kind.mass, name, a_mass), (mass | {f"bodies.{name}.inertia": inertia},))
        if inertia is not None or name in turning:
            yield alone(Cause(Kind.mass, name, a_mass), (mass,))
        if name in turning:
            of_own = {f"bodies.{name}.inertia": own[name].inertia}
            yield alone(Cause(Kind.inertia, name, "{place}'s moment of inertia is {inertia}"), (of_own,))
        if name in scene.turning:
            com = Cause(Kind.com, name, "{place}'s centre of mass is {com}")
            yield Numbers(com, _turned(f"bodies.{name}.com"), alone=True)
    if len(own) > 1:
        yield alone(Cause(Kind.mass, "all", "each body's mass is {percent}"), (masses | inertias,))
        yield alone(Cause(Kind.inertia, "all", "each body's moment of inertia is {percent}"), (inertias,))
    if scene.gravity is not None:  # without it this is the same as each body's mass
        less = {f"gravity.{axis}": -g for axis, g in enumerate(scene.gravity)}
        yield alone(Cause(Kind.mass, "all", "inertia's share of all forces is {percent}"), (masses | inertias | less,))
    bars = [name for name in turning if scene.bodies[name].inertia is None and len(scene.bodies[name].corners) == 2]
    if bars:  # as wide as w they have m w²/12 more
        wide = {f"bodies.{name}.inertia": own[name].mass / 12 for name in bars}
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
    """Yield loads and springs; the moments of one that twists are linear in its angle too."""
    linear = partial(Numbers, linear=True)
    for number, load in enumerate(scene.loads):
        at, place, what = f"loads.{number}", load_place(load), load_name(load)
        own = [one for one in scene.numbers.values() if one.at[:2] == ("loads", number)]
        size = {one.path: one.value for one in own if one.quantity.dimension in ("force", "moment")}
        yield linear(Cause(Kind.load, place, f"{what} is {{percent}}"), (size,))
        if load.table is not None:
            shifted = Cause(Kind.load, place, f"the table of {what} is shifted by {SHIFTS[load.table.over]}")
            yield Numbers(shifted, ({f"{at}.table.{row}.0": 1.0 for row in range(len(load.table.values))},))
        if isinstance(load, TableForce):
            turned = _turned(f"{at}.along", complex(*load.along))[1:]
            yield Numbers(Cause(Kind.load, place, f"{what} is turned by {{angle}}"), turned)
        if isinstance(load, Force):
            force = complex(*load.force)
            vector = Cause(Kind.load, place, f"{what} is {{force}} at {{way}}")
            yield linear(vector, _turned(f"{at}.force", force), partial(_turned_vector, force, force))
    for at, spring in scene.elements:
        if isinstance(spring, TorsionSpring):
            place, what = spring.at, "the torsion spring {place}"
            unloaded = "angle", 1.0, f"{what}'s angle is {{angle}} off"
        elif isinstance(spring, Spring):
            place, what = f"{spring.first[1]}-{spring.second[1]}", "the spring {place}"
            unloaded = "length", spring.length, f"{what}'s length is {{percent}}"
        else:
            continue
        damping = "damping", spring.damping, f"the damping of {what} is {{percent}}"
        for of, value, text in (("stiffness", spring.stiffness, f"{what}{{stiffness}}"), unloaded, damping):
            if value is not None:
                yield linear(Cause(Kind.spring, place, text), ({f"{at}.{of}": value},))


def _of_friction(scene: Scene) -> Iterator[Numbers]:
    """Yield friction of each joint and of all, what it has by the load and what by the rate, and the contacts."""
    every: dict[str, float] = {}
    for number, one in enumerate(scene.friction):
        at, place = f"friction.{number}", stem(one.channel(scene))
        # A pin's is linear in the radius, and the coefficient cannot be told from that.
        linear = "coefficient" if isinstance(one, GuideFriction) else "radius"
        coulomb = {f"{at}.{linear}": getattr(one, linear)}
        viscous = {f"{at}.viscous": one.viscous} if one.viscous else {}
        ways = {"friction": coulomb | viscous}
        if viscous:
            ways |= {"Coulomb friction": coulomb, "viscous friction": viscous}
        if isinstance(one, GuideFriction):
            ways["length of contact"] = {f"{at}.length": one.length}
        for what, way in ways.items():
            yield Numbers(Cause(Kind.friction, place, f"the {what} of {{place}} is {{percent}}"), (way,))
        every |= ways["friction"]
    if len(scene.friction) > 1:
        yield Numbers(Cause(Kind.friction, "all", "all friction is {percent}"), (every,))


def load_place(load: Load | TorsionSpring) -> str:
    """Return what a cause calls the place of a load: its point, or of a moment its body."""
    return load.body if isinstance(load, Moment) else load.at


def load_name(load: Load) -> str:
    """Return what a cause calls a load at its place."""
    return "the moment on {place}" if isinstance(load, Moment) else "the load at {place}"


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
            for of, how in (("through", "{length} beside its place"), ("along", "turned by {angle}")):
                beside = _turned(f"bodies.{name}.slides.{of}", complex(*body.slide.along))[1:]
                yield Numbers(Cause(Kind.guide, name, f"{{place}}'s guide is {how}"), beside)
    of_linkage = (one for one in scene.numbers.values() if one.at[0] in OF_LINKAGE)
    lengths = {one.path: one.value for one in of_linkage if one.quantity.dimension == "length"}
    yield Numbers(Cause(Kind.length, "all", "each length is {times}"), (lengths,), lambda x: 1 + x)


def _turned(path: str, vector: complex = 1 + 0j) -> tuple[Direction, Direction]:
    """Return the directions of a vector along another one or x, and along that turned by a right angle."""
    x, y = vector.real, vector.imag
    return {f"{path}.0": x, f"{path}.1": y}, {f"{path}.0": -y, f"{path}.1": x}


def _turned_vector(now: complex, vector: complex, x: Samples) -> tuple[float, float]:
    """Return the components of what a vector is with so much of another one along and beside it added."""
    other = now + complex(*x) * vector
    return other.real, other.imag

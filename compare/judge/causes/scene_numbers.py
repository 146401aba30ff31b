"""Which numbers of a scene may be off together, and what that is called."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple, TypeAlias

import numpy as np

from scenes import Scene
from scenes.model.motion import Samples
from scenes.scene import Force, ForceTable

from ...mechanics.bodies import first_point, weights
from ...mechanics.reference import Reference
from .cause import Cause, Kind, Way

HAIR = 1e-6  # of the linkage's size, rad, or a share: what a number is varied by, for a slope
NONE = -1.005  # of a mass or a moment of inertia, by so much of itself too small: none at all, but for rounding
STANDARD_GRAVITY = (0.0, -9.81)  # m/s^2
OF_LINKAGE = {"ground", "bodies", "springs"}  # which have the lengths of a linkage

Direction: TypeAlias = Mapping[str, float]  # by path in the file what is added to a number, SI


def _as_it_is(x: Samples) -> Samples:
    return x


class Numbers(NamedTuple):
    """Numbers of a scene that are off together, along k directions, and the cause that they are then."""

    kind: Kind
    place: str
    way: Way
    directions: tuple[Direction, ...]
    names: tuple[str, ...] = ()
    amounts: Callable[[Samples], Samples] = _as_it_is  # of the cause, by those of the directions, shape (k,)
    step: float = HAIR
    linear: bool = False  # as forces are in masses
    alone: bool = False  # in the scene whose centres of mass and moments of inertia stand by themselves

    def cause(self, x: Samples) -> Cause | None:
        """Return the cause that numbers are, off by so much of each direction; None where they cannot be."""
        amounts = self.amounts(x)
        none = self.kind in (Kind.mass, Kind.inertia) and x[0] < NONE
        if none or not np.isfinite(amounts).all():
            return None
        return Cause(self.kind, self.place, self.way, tuple(amounts.tolist()), self.names)


def standing_alone(scene: Scene) -> Scene:
    """Return a scene whose bodies have centres of mass and moments of inertia of their own, and gravity, be it none."""
    bodies = dict(scene.bodies)
    for name, body in scene.bodies.items():
        if body.mass is not None:
            own = weights(scene, body)
            com = own.com + first_point(body)
            bodies[name] = replace(body, com=(com.real, com.imag), inertia=own.inertia)
    return replace(scene, bodies=bodies, gravity=scene.gravity or (0.0, 0.0))


def numbers_of_causes(reference: Reference) -> Iterator[Numbers]:
    """Yield the groups of numbers that one cause changes."""
    if reference.scene.has_masses:
        for group in (*_of_weights(reference), *_of_gravity(reference.scene)):
            yield group._replace(linear=group.kind is not Kind.com)
        yield from _of_forces(reference.scene)
    yield from _of_places(reference)


def _of_weights(reference: Reference) -> Iterator[Numbers]:
    """Yield masses, moments of inertia and centres of mass, of each body and of all."""
    scene = reference.scene
    own = {name: weights(scene, body) for name, body in scene.bodies.items() if body.mass}
    turning = [name for name in scene.turning if name in own and own[name].inertia]
    masses = {f"bodies.{name}.mass": w.mass for name, w in own.items()}
    inertias = {f"bodies.{name}.inertia": own[name].inertia for name in turning}
    for name in own:
        body, mass = scene.bodies[name], {f"bodies.{name}.mass": own[name].mass}
        if body.inertia is None:  # which goes with the mass
            yield Numbers(Kind.mass, name, Way.mass, (mass,))
        if body.inertia is not None or name in turning:
            yield Numbers(Kind.mass, name, Way.mass, (mass,), alone=True)
        if name in turning:
            inertia = {f"bodies.{name}.inertia": own[name].inertia}
            yield Numbers(Kind.inertia, name, Way.inertia, (inertia,), alone=True)
        if name in scene.turning:
            com = _both(f"bodies.{name}.com")
            yield Numbers(Kind.com, name, Way.com, com, step=HAIR * reference.mechanics.size, alone=True)
    if len(own) > 1:
        yield Numbers(Kind.mass, "all", Way.masses, (masses | inertias,), alone=True)
        yield Numbers(Kind.inertia, "all", Way.inertias, (inertias,), alone=True)
    if scene.gravity is not None:  # without it this is the same as each body's mass
        less = {f"gravity.{axis}": -g for axis, g in enumerate(scene.gravity)}
        yield Numbers(Kind.mass, "all", Way.inertia_share, (masses | inertias | less,), alone=True)
    bars = [name for name in turning if scene.bodies[name].inertia is None and len(scene.bodies[name].corners) == 2]
    if bars:  # as wide as w they have m w²/12 more
        wide = {f"bodies.{name}.inertia": own[name].mass / 12 for name in bars}
        width = lambda x: np.sqrt(np.where(x > 0, x, np.nan))  # noqa: E731
        yield Numbers(Kind.inertia, "all", Way.width, (wide,), amounts=width, alone=True)


def _of_gravity(scene: Scene) -> Iterator[Numbers]:
    """Yield gravity by a factor, and as another vector; where there is none, some."""
    down = scene.gravity or STANDARD_GRAVITY
    ways = _turned("gravity", complex(*down))
    size = (lambda x: x) if scene.gravity else (lambda x: x * float(np.hypot(*down)))
    way = Way.gravity if scene.gravity else Way.gravity_size
    yield Numbers(Kind.gravity, "all", way, ways[:1], amounts=size, alone=True)
    other = lambda x: np.add(scene.gravity or (0.0, 0.0), _components(complex(*x) * complex(*down)))  # noqa: E731
    yield Numbers(Kind.gravity, "all", Way.gravity_vector, ways, amounts=other, alone=True)


def _of_forces(scene: Scene) -> Iterator[Numbers]:
    """Yield loads and springs."""
    for number, load in enumerate(scene.loads):
        at = f"loads.{number}"
        if isinstance(load, ForceTable):
            forces = {f"{at}.table.{row}.1": force for row, force in enumerate(load.forces)}
            yield Numbers(Kind.load, load.at, Way.load, (forces,), linear=True)
            rows = dict.fromkeys((f"{at}.table.{row}.0" for row in range(len(load.forces))), 1.0)
            hair = HAIR * float(np.ptp(load.displacements))
            yield Numbers(Kind.load, load.at, Way.table_shifted, (rows,), step=hair)
            continue
        own = complex(*load.force)
        ways = _turned(f"{at}.force", own)
        yield Numbers(Kind.load, load.at, Way.load, ways[:1], linear=True)
        if isinstance(load, Force):
            other = lambda x, own=own: _components((1 + complex(*x)) * own)  # noqa: E731
            yield Numbers(Kind.load, load.at, Way.load_vector, ways, amounts=other, linear=True)
    for number, spring in enumerate(scene.springs):
        place = f"{spring.first[1]}-{spring.second[1]}"
        stiffness, length = (
            {f"springs.{number}.stiffness": spring.stiffness},
            {f"springs.{number}.length": spring.length},
        )
        yield Numbers(Kind.spring, place, Way.stiffness, (stiffness,), linear=True)
        yield Numbers(Kind.spring, place, Way.spring_length, (length,), linear=True)


def _of_places(reference: Reference) -> Iterator[Numbers]:
    """Yield lengths, points, guides, and the scale of the whole linkage."""
    scene, hair = reference.scene, HAIR * reference.mechanics.size
    for point in scene.ground:
        yield Numbers(Kind.place, point, Way.ground, _both(f"ground.points.{point}"), step=hair)
    for name, body in scene.bodies.items():
        for point in body.local or ():
            yield Numbers(Kind.length, name, Way.point, _both(f"bodies.{name}.points.{point}"), (point,), step=hair)
        for ends in body.lengths or ():
            ordered = "-".join(point for point in body.points if point in ends)
            length = {f"bodies.{name}.lengths.{'-'.join(sorted(ends))}": 1.0}
            yield Numbers(Kind.length, name, Way.length, (length,), (ordered,), step=hair)
        if body.slide is not None:
            guide, along = f"bodies.{name}.slides", complex(*body.slide.along)
            yield Numbers(Kind.guide, name, Way.beside, _turned(f"{guide}.through", along)[1:], step=hair)
            yield Numbers(Kind.guide, name, Way.tilted, _turned(f"{guide}.along", along)[1:])
    of_linkage = (one for one in scene.numbers.values() if one.at[0] in OF_LINKAGE)
    lengths = {one.path: one.value for one in of_linkage if one.quantity.dimension == "length"}
    yield Numbers(Kind.length, "all", Way.scale, (lengths,), amounts=lambda x: 1 + x)


def _both(path: str) -> tuple[Direction, Direction]:
    """Return the directions of the two components of a vector."""
    return {f"{path}.0": 1.0}, {f"{path}.1": 1.0}


def _turned(path: str, vector: complex) -> tuple[Direction, Direction]:
    """Return the directions of a vector along another one, and along that turned by a right angle."""
    x, y = vector.real, vector.imag
    return {f"{path}.0": x, f"{path}.1": y}, {f"{path}.0": -y, f"{path}.1": x}


def _components(vector: complex) -> Samples:
    return np.array([vector.real, vector.imag])

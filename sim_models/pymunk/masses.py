"""The masses of pymunk's bodies: those that leave the motion or the forces unchanged and need few sweeps.

The drive prescribes the motion, so masses can be chosen freely where only the motion is wanted:

- `own_masses`: each body's own, all bodies moved by forces: the plain model.
- `ballasted_masses`: where a body is pinned to the ground or to the driven body, a heavy point mass is added to it.
  The drive prescribes that point's motion, whatever the forces: only the force of that pin changes, by the ballast
  times the point's acceleration less gravity (d'Alembert). For its other joints, the body only turns.
- `fictitious_masses`: all replaced. The motion is the same; the engine's forces have no meaning.

Gauss-Seidel sweeps converge fast where the impulse of one joint hardly moves the others. Hence the fictitious masses
fall from Assur group to Assur group, each of which is determined by those before it: the bodies on another body are too
light to disturb it. A body pinned to one of an earlier group is heavy at that pin and turns easily about it, so its
other pins only turn it. Over the shipped scenes, at their worst poses, a sweep leaves
0.73 to 0.999 of an error with the bodies' own masses, 0.12 to 0.993 with ballast, 0.003 to 0.69 with fictitious ones.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from math import fsum, inf, isfinite, isinf
from typing import TypeAlias

from scenes import Failure, Request, Scene, Status
from scenes.drive import Drive
from scenes.model.constraints import groups
from scenes.scene import GROUND, Pin

from .bodies import PymunkBody
from .settings import PymunkSettings

BALLAST = 10.0  # times the mass of all bodies; more makes no scene of the library converge visibly faster
RATIO = 1e-2  # of masses that hardly disturb each other; smaller ones leave the sweeps' convergence as it is
AMONG_ITS_OWN = 0.3  # the same for moments in a group that a drive closes, where all bodies move each other


@dataclass(frozen=True)
class Inertia:
    """What pymunk gets: the body's origin, which is its centre of mass, in the scene's frame of it, m."""

    origin: complex
    mass: float  # kg; infinite for a body whose motion is prescribed
    moment: float  # kg m^2, about the origin; infinite where the body cannot turn

    @property
    def prescribed(self) -> bool:
        """Whether the drive prescribes the body's motion."""
        return isinf(self.mass)


Inertias: TypeAlias = Mapping[str, Inertia]
Masses: TypeAlias = Callable[[Scene, Mapping[str, PymunkBody]], Inertias]


def loaded(scene: Scene, settings: PymunkSettings, request: Request) -> bool:
    """Tell whether forces act on the bodies; where none are requested, the drive alone moves fictitious masses."""
    # So does a drive between moving bodies, which may have no mass of their own.
    return request.wants_forces(scene) and not settings.fictitious and not between_bodies(scene)


def between_bodies(scene: Scene) -> bool:
    """Tell whether a drive stands on a moving body."""
    return any(drive.on != GROUND for drive in scene.drives)


def masses_of(scene: Scene, settings: PymunkSettings, request: Request) -> Masses:
    """Choose the masses that these settings give the linkage."""
    if settings.extra == "motor":
        return own_masses
    return ballasted_masses if loaded(scene, settings, request) else fictitious_masses


def own_masses(scene: Scene, rigids: Mapping[str, PymunkBody]) -> Inertias:
    """Take the bodies' own inertias, the driven one's too; Failure where pymunk cannot move or turn such a body."""
    return _movable(scene, {name: Inertia(b.com, b.mass, b.inertia) for name, b in rigids.items()}, rigids)


def ballasted_masses(scene: Scene, rigids: Mapping[str, PymunkBody]) -> Inertias:
    """The inertias with ballast at pins to the ground and the driven body, which is moved; Failure as of the own."""
    moved = {name: Inertia(b.com, b.mass, b.inertia) for name, b in rigids.items() if name not in scene.driven}
    extra = BALLAST * sum(body.mass for body in rigids.values())
    for name, pin in held(scene).items():
        body, point = rigids[name], pin.point
        mass = body.mass + extra
        # Parallel axes: centre of mass and moment of body and ballast together, about their common centre.
        arm = body.com - body.points[point]
        moment = body.inertia + body.mass * extra / mass * abs(arm) ** 2 if mass else 0.0
        moved[name] = Inertia(body.points[point] + (body.mass / mass * arm if mass else 0), mass, moment)
    return {**_movable(scene, moved, rigids), **{drive.body: _driven(scene, drive, rigids) for drive in scene.drives}}


def held(scene: Scene) -> dict[str, Pin]:
    """Return, by body, its pin on the ground or on the driven body."""
    moved = {GROUND, *scene.driven}
    return {
        name: pin
        for pin in scene.pins
        for name, other in ((pin.first, pin.second), (pin.second, pin.first))
        if other in moved and name not in moved
    }


def fictitious_masses(scene: Scene, rigids: Mapping[str, PymunkBody]) -> Inertias:
    """Choose masses with which sweeps converge fast; the largest is 1 kg divided by RATIO."""
    chosen = {drive.body: _driven(scene, drive, rigids) for drive in scene.drives if drive.on == GROUND}
    scale = 1.0
    for group in assur_groups(scene):
        driven = not scene.driven.keys().isdisjoint(group)
        earlier, light = {GROUND, *chosen}, AMONG_ITS_OWN if driven else RATIO
        for name in group:
            body, mass = rigids[name], scale
            size = body.size or _size(rigids)
            moment = scale * size**2
            origin = body.com
            for pin in scene.pins:
                if name in (pin.first, pin.second) and {pin.first, pin.second} & earlier:
                    origin, mass, moment = body.points[pin.point], scale / RATIO, scale * light * size**2
            # A gear keeps slider and carrier parallel and shares their moments: the carrier's has to be much the
            # larger, so that the slider's joints do not turn it.
            carrier = name
            while carrier in scene.slides and scene.slides[carrier].on != GROUND:
                carrier, moment = scene.slides[carrier].on, light * moment  # so that the gear hardly turns the carrier
            chosen[name] = Inertia(origin, mass, inf if GROUND in scene.aligned[name] else moment)
        # The next group is lighter by three ratios: its heaviest bodies, 1/RATIO of its scale, are still two ratios
        # lighter than the bodies that carry them.
        scale *= RATIO**3
    return chosen


def assur_groups(scene: Scene) -> Iterator[list[str]]:
    """Yield the bodies that are determined together, in the order of the file, each group by those before it.

    Each joint takes two freedoms of its bodies, the drive one; each body has three.
    """
    columns = {name: range(3 * i, 3 * i + 3) for i, name in enumerate(scene.bodies)} | {GROUND: range(0)}
    joints = [(pin.first, pin.second) for pin in scene.pins]
    joints += [(name, slide.on) for name, slide in scene.slides.items()]
    pattern = [[*columns[first], *columns[second]] for first, second in joints for _ in range(2)]
    pattern += [[*columns[drive.on], *columns[drive.body]] for drive in scene.drives]
    bodies, prescribed = [*scene.bodies], {drive.body for drive in scene.drives if drive.on == GROUND}
    for block in groups(pattern):
        together = {column // 3 for column in block.columns}
        if named := [bodies[i] for i in sorted(together) if bodies[i] not in prescribed]:
            yield named


def _driven(scene: Scene, drive: Drive, rigids: Mapping[str, PymunkBody]) -> Inertia:
    """Prescribe the driven body's motion: a crank's about its pivot on the ground, about which pymunk turns it."""
    body = rigids[drive.body]
    pivots = [place for point, place in body.points.items() if point in scene.ground]
    return Inertia(pivots[0] if drive.slide is None else body.com, inf, inf)


def _movable(scene: Scene, inertias: Inertias, rigids: Mapping[str, PymunkBody]) -> Inertias:
    """Choose moments by which each body can be turned on its own; Failure where pymunk cannot move or turn one.

    Bodies that slides keep parallel to the ground cannot turn. Others that slides keep parallel turn as one, so only
    the sum of their moments counts for the motion and the forces; each gets the same part, since pymunk cannot turn a
    point mass. Where the drive turns them, any moment will do.
    """
    movable = {}
    for name, inertia in inertias.items():
        group = scene.aligned[name]
        if GROUND in group:
            moment = inf
        elif not scene.driven.keys().isdisjoint(group):
            moment = inertia.moment or inertia.mass * _size(rigids) ** 2
        else:
            moment = fsum(inertias[other].moment for other in group) / len(group)
        # Else pymunk's C core would end the whole process.
        if not (inertia.mass > 0 and isfinite(inertia.mass)):
            raise Failure(Status.unsupported, f"pymunk cannot move a body of mass {inertia.mass:g} kg: '{name}'")
        if not moment > 0:
            sentence = f"pymunk cannot turn a body with a moment of inertia of {moment:g} kg m^2: '{name}'"
            raise Failure(Status.unsupported, sentence)
        movable[name] = replace(inertia, moment=moment)
    return movable


def _size(rigids: Mapping[str, PymunkBody]) -> float:
    return max(body.size for body in rigids.values()) or 1.0

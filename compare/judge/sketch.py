"""Whether the sketch shows one way of assembling the bodies where it has the drive: judged before any engine runs.

Every model closes the linkage from the sketch by its own means. Where the sketch is rough all end in the assembly that
is meant; where it is of another position of the drive, or has points on the wrong side, each may end in another one,
and none of them is to blame. A sketch is at fault

    where the bodies cannot be put together at its position of the drive,
    where a body but the driven one is drawn turned by more than `MAX_TURNED` from where it is put together,
    where it is nearer to another assembly than to the one on whose side its points are, or
    where its points are as far apart as in another unit of length.

The bounds lie between two kinds of spoilt sketches, of another angle or unit, with points swapped, mirrored or moved at
random: those from which an engine takes another assembly or none are all at fault, and of the others some. How far
points are off does not tell: a crank that is drawn at another angle is harmless, and noted.
"""

from cmath import phase
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import chain
from math import degrees, isnan, radians
from statistics import median

import numpy as np

from scenes import Failure, Scene, Status
from scenes.model.enclosures import Assembly, SketchFit
from scenes.model.inputs import passing

from ..engines import registry
from ..mechanics.bodies import distances
from ..mechanics.mechanics import Mechanics
from ..mechanics.reference import Reference

NEAR_TOL = 0.03  # of the largest length: a sketch whose points are all so near is nearest to the assembly that it picks
SKETCH_TOL = 0.1  # of that length: shipped sketches are within 0.06 of it, a leg upside down is 0.28 and more off
MIN_SHOWN = 1e-6  # of that length
MAX_TURNED = radians(75)  # of those spoilt sketches, all that mislead an engine have a body turned by 81 deg and more
MAX_BODIES = 13  # that are six dyads, or 64 assemblies
MAX_SCALE = 5.0  # times as far apart as on their bodies, or a fifth: no drawing is so rough
FAR_OFF = "the sketch is far from where the lengths put its points"

Places = Mapping[str, complex]  # by point, m


class UnclearSketchError(Failure):
    """A failure that is the sketch's fault, whoever notices it."""

    def __init__(self, reason: str) -> None:
        super().__init__(Status.cannot_assemble, reason)


def check_sketch(reference: Reference) -> None:
    """Raise UnclearSketchError where the sketch is at fault."""
    scene, size = reference.scene, reference.mechanics.size
    if why := _fault(scene, size, _posed(reference)):
        raise UnclearSketchError(f"{why}{_what_fits(scene, size, registry.sketch_fit(scene))}")


def with_notes(reference: Reference) -> Reference:
    """The reference with what is known of its sketch; UnclearSketchError where that is at fault."""
    check_sketch(reference)
    other = other_assembly(reference) if rough(reference) else ""
    return replace(reference, rough_sketch=other, notes=[*warnings(reference)])


def other_assembly(reference: Reference) -> str:
    """What an engine takes from a rough sketch that it reads otherwise than the core, with how far points are off."""
    scene, size = reference.scene, reference.mechanics.size
    listed = _listed(scene, _off(scene, _posed(reference)), size)
    fits = _what_fits(scene, size, registry.sketch_fit(scene))
    return f"another assembly from the sketch than the core, {_given(scene)}: {listed}{fits}"


def with_sketch(mechanics: Mechanics, failure: Failure) -> Failure:
    """A failure of the core on the drive's way or at the sketch, with the fault of the sketch that may be behind it."""
    if failure.status is not Status.cannot_assemble:
        return failure
    scene, size, fit = mechanics.scene, mechanics.size, registry.sketch_fit(mechanics.scene)
    places = fit.here if fit else _nearest(scene)
    if fit is None:  # its sides pick what never closes
        wrong = bool(_scaled(scene) or places)
    elif any(isnan(abs(place)) for place in places.values()):
        wrong = max(_off(scene, fit.there).values()) <= SKETCH_TOL * size
    else:
        wrong = max(_off(scene, places).values()) > SKETCH_TOL * size
    if not wrong:
        return failure
    listed = f": {points}" if (points := _listed(scene, _off(scene, places), size)) else ""
    fault = f"; {FAR_OFF}, {_given(scene)}{listed}{_what_fits(scene, size, fit)}"
    return Failure(failure.status, f"{failure.reason}{fault}", at=failure.at)


def off_sketch(reference: Reference) -> dict[str, float]:
    """How far each sketched point is from where the reference has it, m; none where it has no pose."""
    return _off(reference.scene, _posed(reference))


def rough(reference: Reference) -> bool:
    """Whether an engine that takes another assembly may have read the sketch as well as the core has.

    It is not where the sketch is near to an assembly, be it the core's or not.
    """
    scene, most = reference.scene, NEAR_TOL * reference.mechanics.size
    if max(off_sketch(reference).values(), default=np.inf) <= most:
        return False
    return not max(_off(scene, _nearest(scene)).values(), default=np.inf) <= most


def warnings(reference: Reference) -> Iterator[str]:
    """Yield a sentence on points that are far from their sketch: of the driven body, on the others, or of all.

    It is of all where the sketch is near at another position of the drive.
    """
    scene, size, distances = reference.scene, reference.mechanics.size, off_sketch(reference)
    far = {point: distance for point, distance in distances.items() if not distance <= SKETCH_TOL * size}
    driver = " and the ".join(scene.driven)
    driven, fits = {point for point in far if not scene.driven.keys().isdisjoint(scene.owners[point])}, ""
    if driven:
        fit = registry.sketch_fit(scene)
        fits = _what_fits(scene, size, fit)
        driven = {*far} if fit and max(_off(scene, fit.there).values()) <= SKETCH_TOL * size else driven
    for points, what_follows in (
        (driven, f"check that sketch.{_key(scene)} is where the {driver} is drawn{fits}"),
        (far.keys() - driven, "it picks the assembly branch: check that they are drawn on the side meant"),
    ):
        if points:
            yield f"{FAR_OFF}: {_listed(scene, {point: far[point] for point in points}, size)}; {what_follows}"


def _posed(reference: Reference) -> Places:
    """Where the reference has the sketched points where the sketch has the drive; nothing where it has no pose."""
    sketch = reference.scene.sketch
    try:
        motion = reference.at(passing(reference.scene, [sketch.drive], [0.0]))
    except Failure:
        return {}
    return {point: complex(motion[f"{point}.x"][0], motion[f"{point}.y"][0]) for point in sketch.points}


def _off(scene: Scene, places: Places) -> dict[str, float]:
    """How far sketched points are from places, m."""
    return {point: abs(place - scene.drawn[point]) for point, place in places.items()}


def _fault(scene: Scene, size: float, places: Places) -> str:
    """Why the sketch is at fault, with what is off, by where the core has its points; or nothing."""
    if not places:
        fit = registry.sketch_fit(scene)
        listed = _listed(scene, _off(scene, fit.here), size) if fit else ""
        why = f"the bodies cannot be put together where the sketch has the drive, {_given(scene)}"
        return f"{why}: {listed}" if listed else why
    given, distances = _given(scene), _off(scene, places)
    listed = _listed(scene, distances, size)
    if _scaled(scene):
        return f"{FAR_OFF}, {given}: {listed}"
    turned, body = max(_turned(scene, places), default=(0.0, ""))
    near = max(distances.values(), default=0.0) <= NEAR_TOL * size
    if near and turned <= MAX_TURNED:
        return ""
    # The decision takes all assemblies, and is made last: rough sketches that are near their own assembly need none of
    # them.
    every = _assemblies(scene)
    if every and max(_off(scene, _of(scene, every[0])).values()) <= NEAR_TOL * size and not near:
        return ""  # a clear one, of which the core has taken another assembly: no fault of the sketch
    meant = next((assembly for assembly in every if assembly.meant), None)
    if turned <= MAX_TURNED and (meant is None or meant is every[0]):
        return ""
    apart = f"it has {body} turned by {degrees(turned):.0f} deg"
    if meant and (other := next((assembly for assembly in every if assembly is not meant), None)):
        nearest, another = (scene.length(assembly.off_sketch) for assembly in (meant, other))
        apart = f"it is {nearest} from the one on whose side its points are, {another} from another"
    return f"the sketch decides between no two ways of assembling the bodies, {given}: {apart}; {listed}"


def _turned(scene: Scene, places: Places) -> Iterator[tuple[float, str]]:
    """Yield by how much each body but the driven one is drawn turned, rad, where points of it show that."""
    for name, body in scene.bodies.items():
        known = [point for point in body.points if point in scene.drawn]
        if name in scene.turning and name not in scene.driven and len(known) > 1:
            drawn = np.array([scene.drawn[point] for point in known])
            posed = np.array([places.get(point, scene.drawn[point]) for point in known])
            # Best-fitting rotation of the posed points onto the drawn ones: the angle of the sum of conj(p) z about
            # their means.
            yield abs(phase(np.vdot(posed - posed.mean(), drawn - drawn.mean()))), name


def _assemblies(scene: Scene) -> list[Assembly]:
    """All assemblies where the sketch has the drive, the nearest first; none where that is too much to look at."""
    try:
        return [*registry.assemblies(scene, circuits=False).found] if len(scene.bodies) <= MAX_BODIES else []
    except Failure:
        return []


def _of(scene: Scene, assembly: Assembly) -> Places:
    return {p: complex(assembly.motion[f"{p}.x"][0], assembly.motion[f"{p}.y"][0]) for p in scene.sketch.points}


def _nearest(scene: Scene) -> Places:
    """Where the nearest assembly has the sketched points; nothing where none is known."""
    every = _assemblies(scene)
    return _of(scene, every[0]) if every else {}


def _key(scene: Scene) -> str:
    return "displacement" if any(drive.slide for drive in scene.drives) else "angle"


def _given(scene: Scene) -> str:
    """Where the sketch has the drive."""
    absent = " (taken where it is absent)" if _key(scene) == "angle" and scene.sketch.drive == 0 else ""
    return f"sketch.{_key(scene)} = {scene.position(scene.sketch.drive)}{absent}"


def _listed(scene: Scene, distances: Mapping[str, float], size: float) -> str:
    """Which points are off, the worst first; none of those that nothing places."""
    known = sorted((point for point in distances if not isnan(distances[point])), key=lambda point: -distances[point])
    worst = [point for point in known if distances[point] > NEAR_TOL * size] or known[:1]
    return ", ".join(f"{point} by {scene.length(distances[point])}" for point in worst)


def _what_fits(scene: Scene, size: float, fit: SketchFit | None) -> str:
    """Where the drive would be if the sketch were right, or that its points may be in another unit."""
    if scale := _scaled(scene):
        return f"; it is drawn {scale:.3g} times as large as the bodies, and read in {scene.units['length'][0]}"
    if fit is None:
        return "; with its points on that side the bodies close at no position of the drive"
    there, distances = scene.position(fit.position), _off(scene, fit.there)
    worst = max(distances, key=lambda point: distances[point])
    left = scene.length(distances[worst])
    if distances[worst] > SKETCH_TOL * size:
        return f"; it fits nowhere: best at {there}, with {worst} off by {left}"
    bound = f", with no point off by more than {left}" if distances[worst] > MIN_SHOWN * size else ""
    return f"; it fits at {there}{bound}"


def _scaled(scene: Scene) -> float:
    """How many times as far apart as on their bodies points are drawn, by the median, where it is not about once."""
    drawn = scene.drawn
    # The median over pairs of points on one body: a wrong unit scales them all, a wrong point only some.
    pairs = [
        abs(drawn[p] - drawn[q]) / length
        for (p, q), length in chain(*(distances(body).items() for body in scene.bodies.values()))
        if p in drawn and q in drawn and not {p, q} <= {*scene.ground} and length > 0
    ]
    scale = median(pairs or [1.0])  # not that of numpy, which imports its masked arrays for it
    return scale if scale > MAX_SCALE or scale < 1 / MAX_SCALE else 0.0

"""Whether a scene's parts fit together: names, joints, mobility. Counts and names only; no pose is computed.

Each function yields what is wrong, and may take for granted what those before it ask for: the first thing is refused.
"""

from collections.abc import Collection, Iterator
from graphlib import CycleError, TopologicalSorter
from itertools import pairwise
from math import pi, remainder

from ..errors import InputError, nearest, path_in_file
from ..joints import DriveJoint, Guide, Pin
from ..limits import POINTS, TURNS, WAVES
from ..scene import GROUND, Body, HarmonicLaw, MotionLaw, Scene, SegmentedLaw, Vector
from . import freedoms
from .demands import unmet_by_numbers, unmet_together


def check(scene: Scene, *, output_slides: bool) -> None:
    """Raise InputError, `<path in the file>: <what was expected>`, for the first thing that does not fit together."""
    for problem in _problems(scene, output_slides):
        raise InputError(problem)


def _problems(scene: Scene, output_slides: bool) -> Iterator[str]:
    count = len(scene.ground) + sum(len(body.points) for body in scene.bodies.values())
    if count > POINTS:
        yield f"bodies: expected {POINTS} points at most, of all bodies and the ground, found {count}"
    yield from _of_slides(scene)
    yield from (demand.refusal() for demand in unmet_by_numbers(scene))
    yield from _of_bodies(scene)
    yield from _of_drive(scene)
    yield from (demand.refusal() for demand in unmet_together(scene))
    yield from _of_joints(scene)
    for place, element in scene.listed:
        yield from element.problems(scene, place)
    yield from _of_sketch_and_output(scene, output_slides)


def _of_slides(scene: Scene) -> Iterator[str]:
    on = {name: slide.on for name, slide in scene.slides.items()}
    for name, carrier in on.items():
        if carrier != GROUND and carrier not in scene.bodies:
            known = [other for other in (GROUND, *scene.bodies) if other != name]
            yield f"bodies.{name}.slides.on: no body '{carrier}'{nearest(carrier, known)}"
    try:
        # A slide is measured in the frame of what it slides on, so the frames have to form a forest that is rooted in
        # the ground or in bodies that do not slide. A cycle of slides has no frame to begin with.
        TopologicalSorter({name: [carrier] for name, carrier in on.items()}).prepare()
    except CycleError as error:
        ring = error.args[1][::-1]  # from each to what it slides on
        expected = "expected slides to lead to the ground, or to a body that does not slide"
        yield f"bodies.{ring[0]}.slides.on: {expected}, found {' on '.join(ring)}"
    driven, base = scene.drive.body, scene.drive.on
    others = [name for name in (GROUND, *scene.bodies) if name != driven]
    if base not in others:
        yield f"drive.on: no other body '{base}'{nearest(base, others)}"
    pivots = {*scene.bodies[driven].points} & {*(scene.ground if base == GROUND else scene.bodies[base].points)}
    if driven not in on and len(pivots) != 1:
        where = "the ground" if base == GROUND else f"'{base}'"
        slips = freedoms.slips(scene, scene.bodies[driven].points) if not pivots else ""
        has = slips or f"{where} has {', '.join(scene.ground if base == GROUND else scene.bodies[base].points)}"
        yield f"drive.body: '{driven}' has {len(pivots)} points on {where}; expected one, to turn about; {has}"


def _of_bodies(scene: Scene) -> Iterator[str]:
    for name, body in scene.bodies.items():
        if name in (GROUND, "drive"):
            yield f"bodies.{name}: the name '{name}' is taken; choose another"
        if body.lengths is not None:
            yield from _of_lengths(body, body.lengths)
        at: dict[Vector, str] = {}
        for point, xy in (body.local or {}).items():
            if at.setdefault(xy, point) != point:
                yield f"bodies.{name}.points: {at[xy]} and {point} are the same point"
        if body.mass is not None and body.com is None and len(body.corners) > 3:
            more = "more than three points that are not on one line"
            yield f"bodies.{name}: expected 'com' and 'inertia', since it has a mass and {more}"
    missing = [body.name for body in scene.bodies.values() if body.mass is None]
    if missing and (len(missing) < len(scene.bodies) or scene.listed):
        why = "other bodies have one" if len(missing) < len(scene.bodies) else "there are loads"
        yield f"bodies.{missing[0]}.mass: missing, and {why}; give every body a mass (0 is allowed) or none"


def _of_lengths(body: Body, lengths: Collection[frozenset[str]]) -> Iterator[str]:
    place = f"bodies.{body.name}.lengths"
    if any(len(pair) == 1 for pair in lengths):
        yield f"{place}: a length joins two different points"
    for point in body.points[2:]:  # the first two are those of the first length
        bases = body.bases[point]
        if len(bases) != 2:
            given = ", ".join(f"'{base}-{point}'" for base in bases) or "none"
            instead = "; give the points as 'points' in the body's own frame instead" if len(bases) > 2 else ""
            yield f"{place}: {point}: expected its lengths to two of the points before it, found {given}{instead}"


def _of_drive(scene: Scene) -> Iterator[str]:
    law, slides, instead = scene.drive.law, scene.drive.slide is not None, ""
    keys: dict[type, str] = {MotionLaw: "law", SegmentedLaw: "segments", HarmonicLaw: "harmonics"}
    key = keys.get(type(law), "end")
    if isinstance(law, MotionLaw):
        yield from _of_times(law)
    if isinstance(law, MotionLaw | SegmentedLaw):
        yield from _of_positions(scene, law, key)
    elif isinstance(law, HarmonicLaw):
        yield from _of_harmonics(law)
    else:
        instead = "; without 'end' a crank turns for ever"
        if law.end is None and slides:
            yield "drive.end: missing; a slider that is driven has to stop somewhere"
        if law.end == law.start:
            yield f"drive.end: expected another position than 'start', {scene.position(law.start)}"
    turns = (law.extent[1] - law.extent[0]) / (2 * pi)
    if not slides and not turns <= TURNS:
        yield f"drive.{key}: expected {TURNS} turns at most from end to end, found {turns:g}{instead}"


def _of_harmonics(law: HarmonicLaw) -> Iterator[str]:
    most = max(law.multiples)
    if not most <= WAVES:
        place, own = f"drive.harmonics.{law.multiples.index(most)}.1", f"with {WAVES} of its own at most"
        yield f"{place}: expected a common period of all, in the digits as written, {own}, found {most:.3g}"
    if not law.extent[1] - law.extent[0] > 1e-9 * sum(map(abs, law.amplitudes)):
        yield "drive.harmonics: expected a motion, found sines that cancel"


def _of_times(law: MotionLaw) -> Iterator[str]:
    if law.times[0] != 0:
        yield f"drive.law.0.0: expected the first time to be 0, found {law.times[0]:g} s"
    for number, (before, after) in enumerate(pairwise(law.times), start=1):
        if not before < after:
            yield f"drive.law.{number}.0: expected increasing times, found {after:g} s after {before:g} s"


def _of_positions(scene: Scene, law: MotionLaw | SegmentedLaw, key: str) -> Iterator[str]:
    """Whether the positions where a law's parts meet are a motion, and can be repeated where it is periodic."""
    if len(set(law.positions)) == 1:
        yield f"drive.{key}: expected a motion, found the same position at all times"
    gain = law.positions[-1] - law.positions[0]
    slides = scene.drive.slide is not None
    # Positions in degrees or in inches become SI by a factor that is rounded, so a law that closes as written is off by
    # a few units in the last place here; 1e-9 of the travel is far above that and far below what anybody would write.
    off = gain if slides else remainder(gain, 2 * pi)
    largest = max(abs(position - law.positions[0]) for position in law.positions)
    if law.periodic and not abs(off) <= 1e-9 * largest:  # what a unit's conversion leaves
        first = f"the last position to be the first{'' if slides else ', or whole turns from it'}"
        yield f"drive.{key}: periodic: expected {first}; it is off by {scene.amount('position', off, 3)}"
    if isinstance(law, MotionLaw) and not law.beyond <= 1:
        leaves = f"it drives from {scene.between(law.extent)}, the table from {scene.between(law.table)}"
        instead = "expected more rows where the motion changes, or 'segments' or 'harmonics' in place of the table"
        yield f"drive.law: the spline leaves the table by more than its range: {leaves}; {instead}"


def _of_joints(scene: Scene) -> Iterator[str]:
    """Whether all hangs together, and Gruebler's count: a pin and a slide take two freedoms each, the drive has one."""
    slides = [(name, slide.on) for name, slide in scene.slides.items()]
    joined: dict[str, set[str]] = {name: set() for name in (GROUND, *scene.bodies)}
    others = [joint for joint in scene.joints if not isinstance(joint, Pin | Guide | DriveJoint)]
    for one, other in (*((pin.first, pin.second) for pin in scene.pins), *slides):
        joined[one].add(other)
        joined[other].add(one)
    # Breadth-first search of the graph of bodies and joints from the ground: what is left in `joined` was never
    # reached. It comes before the count of freedoms, which a loose part with too many joints could balance.
    ahead = [GROUND]
    for name in ahead:
        ahead += joined.pop(name, ())
    for body in scene.bodies.values():
        if body.name in joined:
            chain = f"no chain of pins or slides leads from {', '.join(body.points)} to the ground"
            slips = freedoms.slips(scene, body.points)
            yield f"bodies.{body.name}: hangs on nothing: {chain}{slips and f'; {slips}'}"
    b, p, s = len(scene.bodies), len(scene.pins), len(slides)
    # Gruebler's (Chebyshev's) criterion for plane linkages. It counts and looks at no length: a linkage that moves
    # because of special lengths, such as a parallelogram with a third crank, is refused here as over-constrained.
    more = sum(joint.equations for joint in others)
    mobility = 3 * b - 2 * p - 2 * s - more
    if mobility != 1:
        kind = "under-constrained" if mobility > 1 else "over-constrained"
        besides, less = (f", and {len(others)} more joints", f" - {more}") if others else ("", "")
        left = f"leave 3*{b} - 2*{p} - 2*{s}{less} = {mobility} degrees of freedom"
        count = f"{b} bodies, {p} pins and {s} slides{besides} {left}"
        cause = freedoms.cause(scene, mobility)
        yield f"bodies: {kind}: {cause}{'' if cause.endswith('?') else ';'} {count}; expected 1, for the drive"


def _shown(scene: Scene, bodies: Collection[str], known: Collection[str]) -> bool:
    """Whether known points show how bodies are turned: two of one, or one of a slider and one of what it slides on."""
    count = {name: len({*known} & {*scene.bodies[name].points}) for name in bodies}
    slides = ((name, slide.on) for name, slide in scene.slides.items() if name in count)
    return max(count.values()) > 1 or any(count[name] and count[on] for name, on in slides)


def _of_sketch_and_output(scene: Scene, output_slides: bool) -> Iterator[str]:
    moving = dict.fromkeys(scene.moving_points)
    for point in scene.sketch.points:
        if point not in moving:
            yield f"sketch.{path_in_file([point])}: no such moving point{nearest(point, moving)}"
    needed = {pin.point for pin in scene.pins}
    needed |= {point for body in scene.bodies.values() if body.lengths is not None for point in body.points}
    for point in moving:
        if point in needed and point not in scene.sketch.points:
            yield f"sketch.{point}: missing; its rough position picks the assembly branch"
    known = {*scene.sketch.points, *scene.ground}
    turned_by_drive = () if scene.drive.slide is not None else (scene.drive.on, scene.drive.body)
    for group in dict.fromkeys(scene.aligned[name] for name in scene.turning):
        known_turns = group.union(*(scene.aligned[name] for name in turned_by_drive if group & {*turned_by_drive}))
        if GROUND not in known_turns and not _shown(scene, known_turns, known):
            turned = f"nothing shows how {' and '.join(sorted(group))} are turned"
            yield f"sketch: {turned}; expected the positions of two points of one of them"
    key = "slider" if output_slides else "point"
    if scene.output not in moving:
        yield f"output.{key}: no moving point '{scene.output}'{nearest(scene.output, moving)}"
    if output_slides and scene.guided(scene.output) is None:
        yield f"output.slider: '{scene.output}' is on no body that slides on the ground; expected 'point' instead"

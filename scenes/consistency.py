"""Whether a scene's parts fit together: names, joints, mobility. Counts and names only; no pose is computed."""

from itertools import combinations, pairwise
from math import pi, remainder

from .errors import InputError, nearest, path_in_file
from .limits import POINTS, TURNS
from .scene import GROUND, Body, ForceTable, MotionLaw, Scene, Vector
from .sizes import check_sizes


def check(scene: Scene, *, output_slides: bool) -> None:
    """Check that a scene's tables fit together.

    Raises:
        InputError: `<path in the file>: <what was expected>`, for the first thing that does not fit.
    """
    _check_count(scene)
    _check_slides(scene)
    _check_driven_body(scene)
    check_sizes(scene)
    for body in scene.bodies.values():
        _check_body(scene, body)
    _check_masses(scene)
    _check_drive(scene)
    _check_connected(scene)
    _check_mobility(scene)
    _check_loads(scene)
    _check_springs(scene)
    _check_sketch(scene)
    _check_output(scene, output_slides)


def _check_count(scene: Scene) -> None:
    count = len(scene.ground) + sum(len(body.points) for body in scene.bodies.values())
    if count > POINTS:
        raise InputError(f"bodies: expected {POINTS} points at most, of all bodies and the ground, found {count}")


def _check_body(scene: Scene, body: Body) -> None:
    place = f"bodies.{body.name}"
    if body.name in (GROUND, "drive"):
        raise InputError(f"{place}: the name '{body.name}' is taken; choose another")
    if body.lengths is not None:
        _check_lengths(scene, body)
    at: dict[Vector, str] = {}
    for point, xy in (body.local or {}).items():
        if at.setdefault(xy, point) != point:
            raise InputError(f"{place}.points: {at[xy]} and {point} are the same point")
    if body.mass is not None and body.com is None and len(body.corners) > 3:
        more = "more than three points that are not on one line"
        raise InputError(f"{place}: expected 'com' and 'inertia', since it has a mass and {more}")


def _check_masses(scene: Scene) -> None:
    missing = [other.name for other in scene.bodies.values() if other.mass is None]
    if missing and (len(missing) < len(scene.bodies) or scene.loads or scene.springs):
        why = "other bodies have one" if len(missing) < len(scene.bodies) else "there are loads"
        raise InputError(f"bodies.{missing[0]}.mass: missing, and {why}; give every body a mass (0 is allowed) or none")


def _check_lengths(scene: Scene, body: Body) -> None:
    assert body.lengths is not None
    place = f"bodies.{body.name}.lengths"
    if any(len(pair) == 1 for pair in body.lengths):
        raise InputError(f"{place}: a length joins two different points")
    first, second, *others = body.points
    if frozenset((first, second)) not in body.lengths:
        raise InputError(f"{place}: missing the length '{first}-{second}'")
    for point in others:
        bases = body.bases(point)
        if len(bases) != 2:
            found = ", ".join(f"'{base}-{point}'" for base in bases)
            raise InputError(
                f"{place}: {point}: expected its lengths to two of the points before it, found {found or 'none'}"
                + ("; give the points as 'points' in the body's own frame instead" if len(bases) > 2 else "")
            )
        if frozenset(bases) in body.lengths:
            _check_triangle(scene, place, [body.lengths[frozenset(pair)] for pair in combinations((*bases, point), 2)])


def _check_triangle(scene: Scene, place: str, sides: list[float]) -> None:
    longest, *others = sorted(sides, reverse=True)
    if not longest < sum(others):
        raise InputError(
            f"{place}: the triangle cannot close, expected its longest side to be shorter than the other two"
            f" together, found {scene.length(longest, 6)} against {scene.length(sum(others), 6)}"
        )


def _check_slides(scene: Scene) -> None:
    on = {body.name: body.slide.on for body in scene.bodies.values() if body.slide is not None}
    for name, carrier in on.items():
        if carrier != GROUND and carrier not in scene.bodies:
            known = [other for other in (GROUND, *scene.bodies) if other != name]
            raise InputError(f"bodies.{name}.slides.on: no body '{carrier}'{nearest(carrier, known)}")
    leads = {GROUND, *scene.bodies} - on.keys()  # to where slides may lead
    for name in on:
        path = {name: None}  # in order
        last = name
        while last not in leads:
            last = on[last]
            if last in path:
                raise InputError(
                    f"bodies.{name}.slides.on: expected slides to lead to the ground, or to a body that does not slide,"
                    f" found {' on '.join((*path, last))}"
                )
            path[last] = None
        leads |= path.keys()


def _check_driven_body(scene: Scene) -> None:
    name, bodies = scene.drive.body, scene.bodies
    slide = bodies[name].slide
    pivots = [point for point in bodies[name].points if point in scene.ground]
    if slide is None and len(pivots) != 1:
        raise InputError(f"drive.body: '{name}' has {len(pivots)} points on the ground; expected one, to turn about")
    if slide is not None and slide.on != GROUND:
        raise InputError(f"drive.body: '{name}' slides on '{slide.on}'; expected a body that slides on the ground")


def _check_drive(scene: Scene) -> None:
    drive = scene.drive
    if isinstance(drive, MotionLaw):
        _check_law(scene, drive)
    elif drive.speed == 0:
        raise InputError("drive.speed: expected a speed other than zero")
    elif drive.end is None:
        if scene.driven_slide is not None:
            raise InputError("drive.end: missing; a slider that is driven has to stop somewhere")
    elif drive.end == drive.start:
        raise InputError(f"drive.end: expected another position than 'start', {scene.position(drive.start)}")
    elif not drive.cycle > 0:
        way, sign = ("above", "negative") if drive.speed > 0 else ("below", "positive")
        kind = "angle" if scene.driven_slide is None else "length"
        start, end = (scene.amount(kind, position, 12) for position in (drive.start, drive.end))
        raise InputError(f"drive.end: expected a position {way} 'start', {start}, found {end}; or make speed {sign}")
    least, most = drive.extent
    turns = (most - least) / (2 * pi)
    if scene.driven_slide is None and not turns <= TURNS:
        key, instead = (
            ("law", "") if isinstance(drive, MotionLaw) else ("end", "; without 'end' a crank turns for ever")
        )
        raise InputError(f"drive.{key}: expected {TURNS} turns at most from end to end, found {turns:g}{instead}")


def _check_law(scene: Scene, law: MotionLaw) -> None:
    if law.times[0] != 0:
        raise InputError(f"drive.law.0.0: expected the first time to be 0, found {law.times[0]:g} s")
    for number, (before, after) in enumerate(pairwise(law.times), start=1):
        if not before < after:
            raise InputError(f"drive.law.{number}.0: expected increasing times, found {after:g} s after {before:g} s")
    if len(set(law.positions)) == 1:
        raise InputError("drive.law: expected a motion, found the same position at all times")
    gain = law.positions[-1] - law.positions[0]
    slides = scene.driven_slide is not None
    off = gain if slides else remainder(gain, 2 * pi)
    largest = max(abs(position - law.positions[0]) for position in law.positions)
    if law.periodic and not abs(off) <= 1e-9 * largest:  # what a unit's conversion leaves
        whole, kind = ("", "length") if slides else (", or whole turns from it", "angle")
        raise InputError(
            f"drive.law: periodic: expected the last position to be the first{whole}; it is off by"
            f" {scene.amount(kind, off, 3)}"
        )
    if not law.beyond <= 1:
        leaves = f"it drives from {scene.between(law.extent)}, the table from {scene.between(law.table)}"
        raise InputError(
            f"drive.law: the spline leaves the table by more than its range: {leaves}; expected more rows where the"
            " motion changes"
        )


def _check_connected(scene: Scene) -> None:
    joints = [(pin.first, pin.second) for pin in scene.pins]
    joints += [(body.name, body.slide.on) for body in scene.bodies.values() if body.slide is not None]
    joined: dict[str, list[str]] = {name: [] for name in (GROUND, *scene.bodies)}
    for one, other in joints:
        joined[one].append(other)
        joined[other].append(one)
    reached, ahead = {GROUND}, [GROUND]
    while ahead:
        new = set(joined[ahead.pop()]) - reached
        reached |= new
        ahead += new
    for body in scene.bodies.values():
        if body.name not in reached:
            points = ", ".join(body.points)
            raise InputError(
                f"bodies.{body.name}: hangs on nothing: no chain of pins or slides leads from {points} to the ground"
            )


def _check_mobility(scene: Scene) -> None:
    """Gruebler's count: a pin takes two freedoms, a slide two, and one is left for the drive."""
    bodies, pins = len(scene.bodies), len(scene.pins)
    slides = sum(body.slide is not None for body in scene.bodies.values())
    mobility = 3 * bodies - 2 * pins - 2 * slides
    if mobility != 1:
        kind = "under-constrained" if mobility > 1 else "over-constrained"
        raise InputError(
            f"bodies: {kind}: {bodies} bodies, {pins} pins and {slides} slides leave 3*{bodies} - 2*{pins} - 2*{slides}"
            f" = {mobility} degrees of freedom; expected 1, for the drive"
        )


def _check_loads(scene: Scene) -> None:
    for number, load in enumerate(scene.loads):
        _check_attack(scene, f"loads.{number}", load.body, load.at)
        if isinstance(load, ForceTable):
            for before, after in pairwise(load.displacements):
                if not before < after:
                    raise InputError(
                        f"loads.{number}.table: expected increasing displacements, found {scene.length(after)}"
                    )


def _check_springs(scene: Scene) -> None:
    for number, spring in enumerate(scene.springs):
        for body, point in (spring.first, spring.second):
            _check_attack(scene, f"springs.{number}.between", body, point)
        if spring.first[0] == spring.second[0]:
            raise InputError(
                f"springs.{number}.between: expected points of two bodies, found both on {spring.first[0]}"
            )
        if spring.first[1] == spring.second[1]:
            raise InputError(f"springs.{number}.between: {spring.first[1]} is the same point of both bodies")


def _check_attack(scene: Scene, place: str, body: str, point: str) -> None:
    """Check that there is such a point on the body, which may be the ground for a spring."""
    springs = place.startswith("springs")
    if body not in scene.bodies and not (springs and body == GROUND):
        bodies = (GROUND, *scene.bodies) if springs else scene.bodies
        raise InputError(f"{place}{'' if springs else '.body'}: no body '{body}'{nearest(body, bodies)}")
    points = scene.ground if body == GROUND else scene.bodies[body].points
    if point not in points:
        raise InputError(f"{place}{'' if springs else '.at'}: '{body}' has no point '{point}'{nearest(point, points)}")


def _check_sketch(scene: Scene) -> None:
    moving = dict.fromkeys(scene.moving_points)
    for point in scene.sketch.points:
        if point not in moving:
            raise InputError(f"sketch.{path_in_file([point])}: no such moving point{nearest(point, moving)}")
    needed = {pin.point for pin in scene.pins}
    needed |= {point for body in scene.bodies.values() if body.lengths is not None for point in body.points}
    for point in moving:
        if point in needed and point not in scene.sketch.points:
            raise InputError(f"sketch.{point}: missing; its rough position picks the assembly branch")
    known = {*scene.sketch.points, *scene.ground}
    for group in dict.fromkeys(scene.aligned[name] for name in scene.turning):
        if scene.drive.body not in group and not any(
            len(known & set(scene.bodies[other].points)) > 1 for other in group
        ):
            raise InputError(
                f"sketch: nothing shows how {' and '.join(sorted(group))} are turned; expected the positions of two"
                " points of one of them"
            )


def _check_output(scene: Scene, output_slides: bool) -> None:
    key = "slider" if output_slides else "point"
    if scene.output not in scene.moving_points:
        raise InputError(f"output.{key}: no moving point '{scene.output}'{nearest(scene.output, scene.moving_points)}")
    if output_slides and scene.guided(scene.output) is None:
        raise InputError(
            f"output.slider: '{scene.output}' is on no body that slides on the ground; expected 'point' instead"
        )

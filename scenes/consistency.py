"""Whether a scene's parts fit together: names, joints, mobility. Counts and names only; no pose is computed."""

from collections.abc import Iterable, Iterator
from itertools import combinations

from .errors import InputError, nearest
from .scene import GROUND, Body, Scene


def check(scene: Scene, *, output_slides: bool) -> None:
    """Check everything that a scene's tables say about each other.

    Raises:
        InputError: `<path in the file>: <what was expected>`, for the first thing that does not fit.
    """
    _check_sizes(scene)
    for body in scene.bodies.values():
        _check_body(scene, body)
    _check_drive(scene)
    _check_connected(scene)
    _check_mobility(scene)
    _check_loads(scene)
    _check_sketch(scene)
    _check_output(scene, output_slides)


def _check_sizes(scene: Scene) -> None:
    """Refuse numbers whose products leave what a double can hold, long before they do."""
    for place, value, smallest, largest in _sizes(scene):
        if value != 0 and not smallest <= abs(value) <= largest:
            raise InputError(
                f"{place}: expected a size from {smallest:.0e} to {largest:.0e} in SI units, found {value:g}"
            )


def _sizes(scene: Scene) -> Iterator[tuple[str, float, float, float]]:
    """Yield place in the file, value, smallest and largest size; zero is for others to judge."""
    for body in scene.bodies.values():
        for pair, length in (body.lengths or {}).items():
            yield f"bodies.{body.name}.lengths.{'-'.join(sorted(pair))}", length, 1e-15, 1e15
        yield f"bodies.{body.name}.mass", body.mass or 0.0, 1e-15, 1e15
        yield f"bodies.{body.name}.inertia", body.inertia or 0.0, 1e-45, 1e45
    yield "drive.speed", scene.drive.speed, 1e-15, 1e15
    for place, values in _coordinates(scene):
        yield from ((place, value, 0.0, 1e15) for value in values)


def _coordinates(scene: Scene) -> Iterator[tuple[str, Iterable[float]]]:
    """Yield the numbers that may be as near to zero as they like."""
    for point, xy in scene.ground.items():
        yield f"ground.points.{point}", xy
    for body in scene.bodies.values():
        for point, xy in (body.local or {}).items():
            yield f"bodies.{body.name}.points.{point}", xy
        yield f"bodies.{body.name}.com", body.com or ()
        yield f"bodies.{body.name}.slides.through", body.slide.through if body.slide is not None else ()
    yield "drive.start", (scene.drive.start,)
    for number, load in enumerate(scene.loads):
        yield f"loads.{number}.force", load.force
    yield "gravity", scene.gravity or ()
    yield "sketch.angle", (scene.sketch.angle,)
    for point, xy in scene.sketch.points.items():
        yield f"sketch.{point}", xy


def _check_body(scene: Scene, body: Body) -> None:
    place = f"bodies.{body.name}"
    if body.name in (GROUND, "drive"):
        raise InputError(f"{place}: the name '{body.name}' is taken; choose another")
    if body.lengths is not None:
        _check_lengths(body)
    if body.local is not None:
        for a, b in combinations(body.points, 2):
            if body.local[a] == body.local[b]:
                raise InputError(f"{place}.points: {a} and {b} are the same point")
    if (body.com is None) and len(body.points) > 3:
        raise InputError(f"{place}: expected 'com' and 'inertia', since it has more than three points")
    missing = [other.name for other in scene.bodies.values() if other.mass is None]
    if missing and (len(missing) < len(scene.bodies) or scene.loads):
        why = "other bodies have one" if len(missing) < len(scene.bodies) else "there are loads"
        raise InputError(f"bodies.{missing[0]}.mass: missing, and {why}; give every body a mass (0 is allowed) or none")


def _check_lengths(body: Body) -> None:
    assert body.lengths is not None
    place = f"bodies.{body.name}.lengths"
    if any(len(pair) == 1 for pair in body.lengths):
        raise InputError(f"{place}: a length joins two different points")
    if len(body.points) > 3:
        raise InputError(f"{place}: expected two or three points; give more as 'points' in the body's own frame")
    for a, b in combinations(body.points, 2):
        if frozenset((a, b)) not in body.lengths:
            raise InputError(f"{place}: missing the length '{a}-{b}'")
    if len(body.points) == 3:
        longest, *others = sorted(body.lengths.values(), reverse=True)
        if not longest < sum(others):
            raise InputError(
                f"{place}: the triangle cannot close, expected its longest side to be shorter than the other two"
                f" together, found {longest:g} m against {sum(others):g} m"
            )


def _check_drive(scene: Scene) -> None:
    drive = scene.drive
    if drive.body not in scene.bodies:
        raise InputError(f"drive.body: no body '{drive.body}'{nearest(drive.body, scene.bodies)}")
    if scene.bodies[drive.body].slide is not None:
        raise InputError(f"drive.body: '{drive.body}' slides; expected a body that turns about a point of the ground")
    pivots = [point for point in scene.bodies[drive.body].points if point in scene.ground]
    if len(pivots) != 1:
        raise InputError(
            f"drive.body: '{drive.body}' has {len(pivots)} points on the ground; expected one, to turn about"
        )
    if drive.speed == 0:
        raise InputError("drive.speed: expected a speed other than zero")


def _check_connected(scene: Scene) -> None:
    reached = {GROUND} | {body.name for body in scene.bodies.values() if body.slide is not None}
    for _ in scene.bodies:
        for pin in scene.pins:
            if {pin.first, pin.second} & reached:
                reached |= {pin.first, pin.second}
    for body in scene.bodies.values():
        if body.name not in reached:
            points = ", ".join(body.points)
            raise InputError(
                f"bodies.{body.name}: hangs on nothing: no chain of pins leads from {points} to the ground"
            )


def _check_mobility(scene: Scene) -> None:
    """Gruebler's count: a pin takes two freedoms, a slide on the ground two, and one is left for the drive."""
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
        if load.body not in scene.bodies:
            raise InputError(f"loads.{number}.body: no body '{load.body}'{nearest(load.body, scene.bodies)}")
        points = scene.bodies[load.body].points
        if load.at not in points:
            raise InputError(f"loads.{number}.at: '{load.body}' has no point '{load.at}'{nearest(load.at, points)}")


def _check_sketch(scene: Scene) -> None:
    for point in scene.sketch.points:
        if point not in scene.moving_points:
            raise InputError(f"sketch.{point}: no moving point '{point}'{nearest(point, scene.moving_points)}")
    pinned = {pin.point for pin in scene.pins}
    by_lengths = {point for body in scene.bodies.values() if body.lengths is not None for point in body.points}
    for point in scene.moving_points:
        if point in pinned | by_lengths and point not in scene.sketch.points:
            raise InputError(f"sketch.{point}: missing; its rough position picks the assembly branch")


def _check_output(scene: Scene, output_slides: bool) -> None:
    key = "slider" if output_slides else "point"
    if scene.output not in scene.moving_points:
        raise InputError(f"output.{key}: no moving point '{scene.output}'{nearest(scene.output, scene.moving_points)}")
    sliding = {point for body in scene.bodies.values() if body.slide is not None for point in body.points}
    if output_slides and scene.output not in sliding:
        raise InputError(f"output.slider: '{scene.output}' is not on a body that slides; say 'point' instead")

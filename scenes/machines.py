"""Many machines of one topology: a scene with arrays of shape (m, 1) in place of the numbers that differ."""

from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import replace
from functools import partial
from itertools import combinations, pairwise
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from .arguments import check_changes, doubles, scene_of
from .corners import LINE, heights
from .drive import MotionLaw
from .errors import InputError, nearest
from .loads import ForceTable, Load, PressForce, Spring
from .scene import Body, Scene, Slide
from .sizes import sized

# path, value in SI, and from the file's unit to SI -> another value in SI
Change: TypeAlias = Callable[[str, Any, Callable[[Any], Any]], Any]

MORE_THAN_ZERO = {"lengths", "last", "stiffness"}
NOT_NEGATIVE = {"mass", "inertia", "length"}
KEPT = "numbers"  # in a scene, as of a cached property of it: they are asked for with every set of machines


def machines(scene: Scene, changes: Mapping[str, ArrayLike]) -> Scene:
    """Return a scene with many machines' numbers, of which nothing is checked but their paths and shapes.

    Args:
        scene: the mechanism.
        changes: by path in its file (`bodies.rod.mass`), in the file's units, the numbers of m machines, shape (m,).

    Raises:
        InputError: no number is at a path, or one that cannot differ: of a motion law or of the sketch; or two paths
            lead to the same one.
        InputError: the numbers are not as many for each path.
    """
    check_changes(changes)
    known = numbers_of(scene_of(scene))
    arrays = {at_path(scene, path, known): doubles(path, values) for path, values in changes.items()}
    if len(arrays) < len(changes):
        raise InputError(f"{scene.file}: expected each number once, and two of the paths lead to the same one")
    if len({values.shape for values in arrays.values()}) > 1 or any(values.ndim != 1 for values in arrays.values()):
        raise InputError("changes: expected one number a machine for each path, shape (m,)")

    def change(path: str, value: Any, to_si: Callable[[Any], Any]) -> Any:
        return to_si(arrays[path][:, None]) if path in arrays else value

    return with_numbers(scene, change, arrays)


def numbers_of(scene: Scene) -> Mapping[str, tuple[Any, float]]:
    """Return all numbers that machines of one topology may differ by, in the order of the file.

    Args:
        scene: the mechanism.

    Returns:
        By path: the number in SI, and what the file's unit of it is in SI.
    """
    if KEPT not in vars(scene):
        found: dict[str, tuple[Any, float]] = {}

        def note(path: str, value: Any, to_si: Callable[[Any], Any]) -> Any:
            found[path] = value, to_si(1.0)
            return value

        with_numbers(scene, note)
        vars(scene)[KEPT] = found
    kept: Mapping[str, tuple[Any, float]] = vars(scene)[KEPT]
    return kept


def at_path(scene: Scene, path: str, known: Collection[str]) -> str:
    """Return the one form of a path, in which a length has no direction.

    Raises:
        InputError: there is no number that machines may differ by.
    """
    before, key, pair = path.partition(".lengths.")
    found = before + key + "-".join(sorted(pair.split("-")))
    if found not in known:
        near = nearest(found, known)
        raise InputError(f"{scene.file}: {path}: expected the path of a number of the machine{near}")
    return found


def with_numbers(scene: Scene, change: Change, paths: Collection[str] | None = None) -> Scene:
    """Return a scene with other numbers, at these paths or at any."""
    changed = None if paths is None else {".".join(path.split(".")[:2]) for path in paths}
    units = {name: size for name, (_, size) in scene.units.items()}
    length, speed, force = (partial(_times, units[name]) for name in ("length", "speed", "force"))
    drive = scene.drive
    if not isinstance(drive, MotionLaw):
        along = length if scene.driven_slide is not None else partial(_times, units["angle"])
        drive = replace(
            drive,
            speed=change("drive.speed", drive.speed, speed),
            start=change("drive.start", drive.start, along),
            end=None if drive.end is None else change("drive.end", drive.end, along),
        )
    bodies = MappingProxyType(
        {
            name: _body(body, change, units) if changed is None or f"bodies.{name}" in changed else body
            for name, body in scene.bodies.items()
        }
    )
    return replace(
        scene,
        gravity=None if scene.gravity is None else _pair("gravity", scene.gravity, change, _as_it_is),
        ground=MappingProxyType(
            {point: _pair(f"ground.points.{point}", xy, change, length) for point, xy in scene.ground.items()}
        ),
        bodies=bodies,
        drive=drive,
        loads=tuple(_load(f"loads.{n}", load, bodies, change, length, force) for n, load in enumerate(scene.loads)),
        springs=tuple(_spring(f"springs.{n}", spring, change, units) for n, spring in enumerate(scene.springs)),
    )


def refused(scene: Scene) -> dict[int, str]:
    """Return which of many machines have a number that no file may have, and why: the first thing that does not fit."""
    why: dict[int, str] = {}
    for place, fits, found in _demands(scene):
        if not fits.all():
            numbers = np.broadcast_to(found, fits.shape)
            for machine in np.flatnonzero(~np.ravel(fits)).tolist():
                why.setdefault(machine, f"{place}, found {numbers[machine, 0]:g}")
    return why


# --- parts of the scene ----------------------------------------------------------------------------------------------


def _times(size: float, value: Any) -> Any:
    return value * size


def _as_it_is(value: Any) -> Any:
    return value


def _pair(path: str, xy: tuple[Any, Any], change: Change, to_si: Callable[[Any], Any]) -> tuple[Any, Any]:
    return change(f"{path}.0", xy[0], to_si), change(f"{path}.1", xy[1], to_si)


def _body(body: Body, change: Change, units: Mapping[str, float]) -> Body:
    place, m, kg = f"bodies.{body.name}", units["length"], units["mass"]
    length = partial(_times, m)

    def inertia(value: Any) -> Any:
        return value * kg * m**2

    local, lengths = body.local, body.lengths
    if local is not None:
        local = MappingProxyType({p: _pair(f"{place}.points.{p}", xy, change, length) for p, xy in local.items()})
    if lengths is not None:
        named = {pair: f"{place}.lengths.{'-'.join(sorted(pair))}" for pair in lengths}
        lengths = MappingProxyType({pair: change(named[pair], value, length) for pair, value in lengths.items()})
    return replace(
        body,
        local=local,
        lengths=lengths,
        mass=None if body.mass is None else change(f"{place}.mass", body.mass, partial(_times, kg)),
        com=None if body.com is None else _pair(f"{place}.com", body.com, change, length),
        inertia=None if body.inertia is None else change(f"{place}.inertia", body.inertia, inertia),
        slide=None if body.slide is None else _slide(f"{place}.slides", body.slide, change, length),
    )


def _slide(place: str, slide: Slide, change: Change, length: Callable[[Any], Any]) -> Slide:
    drawn = slide.along[0] * slide.drawn, slide.along[1] * slide.drawn
    along = _pair(f"{place}.along", drawn, change, _as_it_is)
    if along[0] is not drawn[0] or along[1] is not drawn[1]:
        norm = np.hypot(*along)
        slide = replace(slide, along=(along[0] * (1 / norm), along[1] * (1 / norm)), drawn=norm)
    return replace(slide, through=_pair(f"{place}.through", slide.through, change, length))


def _load(
    place: str,
    load: Load,
    bodies: Mapping[str, Body],
    change: Change,
    length: Callable[[Any], Any],
    force: Callable[[Any], Any],
) -> Load:
    if isinstance(load, ForceTable):
        rows = list(zip(load.displacements, load.forces, strict=True))
        return replace(
            load,
            displacements=tuple(change(f"{place}.table.{n}.0", x, length) for n, (x, _) in enumerate(rows)),
            forces=tuple(change(f"{place}.table.{n}.1", f, force) for n, (_, f) in enumerate(rows)),
        )
    load = replace(load, force=_pair(f"{place}.force", load.force, change, force))
    if not isinstance(load, PressForce):
        return load
    push = _along(load, bodies)
    closing: Any = load.closing if np.ndim(push) == 0 else np.where(push > 0, -1, 1)
    return replace(load, last=change(f"{place}.last", load.last, length), closing=closing)


def _along(load: PressForce, bodies: Mapping[str, Body]) -> Any:
    """Return the part of a press force along its slider's guide, N."""
    slide = bodies[load.body].slide
    assert slide is not None
    return load.force[0] * slide.along[0] + load.force[1] * slide.along[1]


def _spring(place: str, spring: Spring, change: Change, units: Mapping[str, float]) -> Spring:
    def stiffness(value: Any) -> Any:
        return value * units["force"] / units["length"]

    return replace(
        spring,
        stiffness=change(f"{place}.stiffness", spring.stiffness, stiffness),
        length=change(f"{place}.length", spring.length, partial(_times, units["length"])),
    )


# --- what a file would be refused for --------------------------------------------------------------------------------


def _demands(scene: Scene) -> Iterator[tuple[str, Any, Any]]:
    """Yield what is demanded of numbers that differ, where it is so, and the numbers in the file's units."""
    for one in sized(scene, np.ndarray):
        place, value, found = one.place, one.value, one.value / one.size
        keys, size = {*place.split(".")[-2:]}, abs(value)
        if place == "drive.speed":
            yield f"{place}: expected a speed other than zero", value != 0, found
        elif keys & MORE_THAN_ZERO:
            yield f"{place}: expected more than zero", value > 0, found
        elif keys & NOT_NEGATIVE:
            yield f"{place}: expected zero or more", value >= 0, found
        fits = (value == 0) | ((one.smallest <= size) & (size <= one.largest))
        yield f"{place}: {one.expected}", fits, found
    for body in scene.bodies.values():
        if body.slide is not None and np.ndim(drawn := body.slide.drawn):
            place = f"bodies.{body.name}.slides.along: expected a direction of a size from 1e-15 to 1e15"
            yield place, (drawn >= 1e-15) & (drawn <= 1e15), drawn
    _, unit = scene.length_unit
    for number, load in enumerate(scene.loads):
        if isinstance(load, PressForce) and np.ndim(push := _along(load, scene.bodies)):
            yield f"loads.{number}.force: expected a part along the guide", push != 0, push
        for before, after in pairwise(load.displacements if isinstance(load, ForceTable) else ()):
            if np.ndim(after - before):
                step = (after - before) / unit
                yield f"loads.{number}.table: expected increasing displacements", step > 0, step
    for body in scene.bodies.values():
        for sides in _triangles(body):
            longest, most = np.maximum.reduce(np.broadcast_arrays(*sides)), sum(sides)
            if np.ndim(longest):
                place = (
                    f"bodies.{body.name}.lengths: the triangle cannot close, expected its longest side to be shorter"
                )
                yield f"{place} than the other two together", longest < most - longest, longest / unit
        for height in _heights(body):
            on_line = len(body.corners) == 2
            if np.ndim(height):
                where = f"points that are {'' if on_line else 'not '}on one line, as drawn, or 'com' and 'inertia'"
                yield f"bodies.{body.name}: expected {where}", (height <= LINE) == on_line, height
    drive = scene.drive
    if not isinstance(drive, MotionLaw) and drive.end is not None and np.ndim(drive.cycle):
        _, unit = scene.units["angle" if scene.driven_slide is None else "length"]
        yield "drive.end: expected a position that the speed leads to", drive.cycle > 0, drive.end / unit


def _heights(body: Body) -> Iterator[Any]:
    """Yield what tells whether the points of a uniform body are on one line."""
    if body.mass is not None and body.com is None and len(body.points) > 2:
        yield from heights(body.corners, body.points, body.local, body.lengths)


def _triangles(body: Body) -> Iterator[list[Any]]:
    """Yield the sides of each triangle that a body's lengths give."""
    for point in body.points[2:] if body.lengths is not None else ():
        pairs = [frozenset(pair) for pair in combinations((*body.bases(point), point), 2)]
        if body.lengths is not None and all(pair in body.lengths for pair in pairs):
            yield [body.lengths[pair] for pair in pairs]

"""Whether the numbers of a scene are of a size that all models can take."""

from collections.abc import Iterable, Iterator
from typing import Any

from .errors import InputError
from .scene import ForceTable, MotionLaw, PressForce, Scene


def check_sizes(scene: Scene) -> None:
    """Refuse numbers whose products leave what a double can hold, long before they do.

    Raises:
        InputError: `<path in the file>: <what was expected>`, for the first such number.
    """
    for place, value, size, smallest, largest, limits in sized(scene):
        if value != 0 and not smallest <= abs(value) <= largest:
            raise InputError(f"{place}: expected a size {limits}, found {value / size:g}")


def sized(scene: Scene) -> Iterator[tuple[str, Any, float, float, float, str]]:
    """Yield place in the file, value, its unit, smallest and largest size, and both in words; zero is for others."""
    (length, m), (mass, kg), (force, N) = (scene.units[name] for name in ("length", "mass", "force"))
    units = {**scene.units, "inertia": (f"{mass}*{length}^2", kg * m**2), "stiffness": (f"{force}/{length}", N / m)}
    units |= {"time": ("s", 1.0), "gravity": ("m/s^2", 1.0)}
    for place, quantity, value, smallest, largest in _sizes(scene):
        unit, size = units[quantity]
        yield place, value, size, smallest, largest, f"from {smallest / size:.2g} to {largest / size:.2g} {unit}"


def _sizes(scene: Scene) -> Iterator[tuple[str, str, Any, float, float]]:
    for body in scene.bodies.values():
        for pair, length in (body.lengths or {}).items():
            yield f"bodies.{body.name}.lengths.{'-'.join(sorted(pair))}", "length", length, 1e-15, 1e15
        yield f"bodies.{body.name}.mass", "mass", 0.0 if body.mass is None else body.mass, 1e-15, 1e15
        yield f"bodies.{body.name}.inertia", "inertia", 0.0 if body.inertia is None else body.inertia, 1e-45, 1e45
    if isinstance(scene.drive, MotionLaw):
        for number, time in enumerate(scene.drive.times):
            yield f"drive.law.{number}.0", "time", time, 1e-15, 1e15
    else:
        yield "drive.speed", "speed", scene.drive.speed, 1e-15, 1e15
    for number, load in enumerate(scene.loads):
        if isinstance(load, PressForce):
            yield f"loads.{number}.last", "length", load.last, 1e-15, 1e15
    for number, spring in enumerate(scene.springs):
        yield f"springs.{number}.stiffness", "stiffness", spring.stiffness, 1e-15, 1e15
        yield f"springs.{number}.length", "length", spring.length, 1e-15, 1e15
    for place, quantity, values in _coordinates(scene):
        yield from ((place, quantity, value, 0.0, 1e15) for value in values)


def _coordinates(scene: Scene) -> Iterator[tuple[str, str, Iterable[float]]]:
    """Yield the numbers that may be as near to zero as they like."""
    drive, at = ("angle", "angle") if scene.driven_slide is None else ("length", "displacement")
    for point, xy in scene.ground.items():
        yield f"ground.points.{point}", "length", xy
    for body in scene.bodies.values():
        for point, xy in (body.local or {}).items():
            yield f"bodies.{body.name}.points.{point}", "length", xy
        yield f"bodies.{body.name}.com", "length", body.com or ()
        yield f"bodies.{body.name}.slides.through", "length", body.slide.through if body.slide is not None else ()
    if isinstance(scene.drive, MotionLaw):
        yield "drive.law", drive, scene.drive.positions
    else:
        yield "drive.start", drive, (scene.drive.start,)
        yield "drive.end", drive, () if scene.drive.end is None else (scene.drive.end,)
    for number, load in enumerate(scene.loads):
        if isinstance(load, ForceTable):
            yield f"loads.{number}.table", "length", load.displacements
            yield f"loads.{number}.table", "force", load.forces
        else:
            yield f"loads.{number}.force", "force", load.force
    yield "gravity", "gravity", scene.gravity or ()
    yield f"sketch.{at}", drive, (scene.sketch.drive,)
    for point, xy in scene.sketch.points.items():
        yield f"sketch.{point}", "length", xy

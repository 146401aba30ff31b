"""Whether the numbers of a scene are of a size that all models can take."""

from collections.abc import Iterable, Iterator

from .errors import InputError
from .scene import ForceTable, MotionLaw, PressForce, Scene


def check_sizes(scene: Scene) -> None:
    """Refuse numbers whose products leave what a double can hold, long before they do.

    Raises:
        InputError: `<path in the file>: <what was expected>`, for the first such number.
    """
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
    if isinstance(scene.drive, MotionLaw):
        for number, time in enumerate(scene.drive.times):
            yield f"drive.law.{number}.0", time, 1e-15, 1e15
    else:
        yield "drive.speed", scene.drive.speed, 1e-15, 1e15
    for number, load in enumerate(scene.loads):
        if isinstance(load, PressForce):
            yield f"loads.{number}.last", load.last, 1e-15, 1e15
    for number, spring in enumerate(scene.springs):
        yield f"springs.{number}.stiffness", spring.stiffness, 1e-15, 1e15
        yield f"springs.{number}.length", spring.length, 1e-15, 1e15
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
    if isinstance(scene.drive, MotionLaw):
        yield "drive.law", scene.drive.positions
    else:
        yield "drive.start", (scene.drive.start,)
        yield "drive.end", (scene.drive.end or 0.0,)
    for number, load in enumerate(scene.loads):
        if isinstance(load, ForceTable):
            yield f"loads.{number}.table", (*load.displacements, *load.forces)
        else:
            yield f"loads.{number}.force", load.force
    yield "gravity", scene.gravity or ()
    yield "sketch.angle" if scene.driven_slide is None else "sketch.displacement", (scene.sketch.drive,)
    for point, xy in scene.sketch.points.items():
        yield f"sketch.{point}", xy

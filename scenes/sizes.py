"""Whether the numbers of a scene are of a size that all models can take."""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

from .errors import InputError
from .scene import ForceTable, MotionLaw, PressForce, Scene


class Sized(NamedTuple):
    """A number of the scene, and of what size it may be; zero is for others."""

    place: str  # in the file
    value: Any  # SI
    unit: str
    size: float  # of the unit, SI
    smallest: float  # SI
    largest: float

    @property
    def expected(self) -> str:
        """Return what a message expects."""
        return f"expected a size from {self.smallest / self.size:.2g} to {self.largest / self.size:.2g} {self.unit}"


def check_sizes(scene: Scene) -> None:
    """Refuse numbers whose products leave what a double can hold, long before they do.

    Raises:
        InputError: `<path in the file>: <what was expected>`, for the first such number.
    """
    for number in sized(scene):
        if number.value != 0 and not number.smallest <= abs(number.value) <= number.largest:
            raise InputError(f"{number.place}: {number.expected}, found {number.value / number.size:g}")


def sized(scene: Scene, kind: type = object) -> Iterator[Sized]:
    """Yield the numbers of a scene that are of a kind."""
    (length, m), (mass, kg), (force, N) = (scene.units[name] for name in ("length", "mass", "force"))
    units = {**scene.units, "inertia": (f"{mass}*{length}^2", kg * m**2), "stiffness": (f"{force}/{length}", N / m)}
    units |= {"time": ("s", 1.0), "gravity": ("m/s^2", 1.0)}
    for place, quantity, value, smallest, largest in _sizes(scene):
        if isinstance(value, kind):
            yield Sized(place, value, *units[quantity], smallest, largest)


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

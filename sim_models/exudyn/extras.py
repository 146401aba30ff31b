"""Features of Exudyn that no scene needs: sensors, text files, a Python function in every step."""

from collections.abc import Iterator
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any
from weakref import finalize

from scenes.scene import GROUND

from .settings import Extra, TextbookTimeStepping, TimeStepping
from .system import ExudynSystem, engine


def add_extras(system: ExudynSystem, options: TimeStepping, step: float, *, forces: bool) -> None:
    """Add sensors, text files or a callback to a system with steps of that size, s; files are deleted with it."""
    extra, solution = options.extra, system.settings.solution
    folder = None
    if extra is Extra.TEXT or isinstance(options, TextbookTimeStepping):
        folder = Path(mkdtemp(prefix="exudyn_"))
        finalize(system, rmtree, folder)
        solution.file.write = True  # as it is preset, but not into the working folder
        solution.file.name = str(folder / "coordinates.txt")
    if extra in (Extra.SENSORS, Extra.TEXT):
        solution.sensors.writePeriod = step
        for number, sensor in enumerate(_sensors(system, forces=forces)):
            file = str(folder / f"sensor{number}.txt") if folder and extra is Extra.TEXT else ""
            system.mbs.AddSensor(sensor(fileName=file, storeInternal=not file))
        system.mbs.Assemble()
    if extra is Extra.CALLBACK:
        system.mbs.SetPreStepUserFunction(lambda _mbs, _time: True)


def _sensors(system: ExudynSystem, *, forces: bool) -> Iterator[Any]:
    """Yield a sensor for every two channels or one, as a function of where it writes."""
    scene, items, kinds = system.scene, engine().itemInterface, engine().OutputVariableType

    def of_body(body: str, kind: Any, place: complex) -> Any:
        number, local = system.objects[body], [place.real, place.imag, 0]
        return lambda **to: items.SensorBody(bodyNumber=number, localPosition=local, outputVariableType=kind, **to)

    def of_constraint(constraint: Any, kind: Any = kinds.Force) -> Any:
        return lambda **to: items.SensorObject(objectNumber=constraint, outputVariableType=kind, **to)

    for point in scene.moving_points:
        body = scene.owners[point][0]
        for kind in (kinds.Position, kinds.Velocity, kinds.Acceleration):
            yield of_body(body, kind, system.bodies[body].points[point])
    for name in scene.turning:
        for kind in (kinds.Rotation, kinds.AngularVelocity, kinds.AngularAcceleration):
            yield of_body(name, kind, 0j)
    if forces:
        for constraint in (*system.pins.values(), system.drive):
            yield of_constraint(constraint)
        for name, constraint in system.slides.items():
            yield of_constraint(constraint, kinds.Force if system.slide(name).on == GROUND else kinds.ForceLocal)

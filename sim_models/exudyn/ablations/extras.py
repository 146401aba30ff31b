"""Features of Exudyn that no scene needs: sensors, text files, a Python function in every step."""

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any
from weakref import finalize

from scenes.scene import GROUND

from ..settings import ExudynExtra, TextbookTimeStepping, TimeStepping
from ..system import ExudynSystem, exudyn, items


def add_extras(system: ExudynSystem, options: TimeStepping, step: float, *, forces: bool) -> None:
    """Add sensors, text files or a callback to a system with steps of that size, s; files are deleted with it."""
    extra, solution = options.extra, system.settings.solution
    folder = None
    if extra is ExudynExtra.TEXT or isinstance(options, TextbookTimeStepping):
        folder = Path(mkdtemp(prefix="exudyn_"))
        finalize(system, rmtree, folder)
        solution.file.write = True  # as it is preset, but not into the working folder
        solution.file.name = str(folder / "coordinates.txt")
    if extra in (ExudynExtra.SENSORS, ExudynExtra.TEXT):
        solution.sensors.writePeriod = step
        for number, sensor in enumerate(_sensors(system, forces=forces)):
            file = str(folder / f"sensor{number}.txt") if folder and extra is ExudynExtra.TEXT else ""
            system.mbs.AddSensor(sensor(fileName=file, storeInternal=not file))
        system.mbs.Assemble()
    if extra is ExudynExtra.CALLBACK:
        system.mbs.SetPreStepUserFunction(lambda _mbs, _time: True)


def _sensors(system: ExudynSystem, *, forces: bool) -> Iterator[Callable[..., Any]]:
    """Yield a sensor for every two channels or one, as a function of where it writes."""
    scene, kinds = system.scene, exudyn.OutputVariableType
    motions = (kinds.Position, kinds.Velocity, kinds.Acceleration)
    turns = (kinds.Rotation, kinds.AngularVelocity, kinds.AngularAcceleration)
    places = [(scene.owners[point][0], point, motions) for point in scene.moving_points]
    for body, point, measured in [*places, *((name, "", turns) for name in scene.turning)]:
        place = system.bodies[body].points.get(point, 0j)
        at = {"bodyNumber": system.objects[body], "localPosition": [place.real, place.imag, 0]}
        yield from (partial(items.SensorBody, outputVariableType=kind, **at) for kind in measured)
    if forces:
        slots = [joint for name, joint in system.slides.items() if system.slide(name).on != GROUND]
        for joint in (*system.pins.values(), system.drive, *system.slides.values()):
            kind = kinds.ForceLocal if joint in slots else kinds.Force
            yield partial(items.SensorObject, objectNumber=joint, outputVariableType=kind)

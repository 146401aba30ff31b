"""TOML -> Scene. Units and user errors end here: what leaves is SI, complete and consistent."""

from collections.abc import Mapping, Sequence
from functools import cache
from importlib.resources import files
from math import hypot
from os import PathLike
from os.path import isfile
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pydantic import ValidationError

from .arguments import check_changes, refuse
from .changes import Value, change, label, numbers
from .consistency import check
from .corners import corners, on_one_line
from .drive import ConstantSpeed, Drive, MotionLaw
from .errors import InputError, nearest, one_line
from .format import BodyTable, DriveTable, LoadTable, SceneFile, SpringTable, TolerancesTable, explain
from .limits import SOURCE, TITLE
from .loads import Force, ForceTable, Load, PressForce, Spring, Vector
from .scene import GROUND, Body, Scene, Sketch, Slide
from .toml_file import read_toml
from .units import si_units
from .variations import Variation, check_variations

LIBRARY = Path(str(files("scenes"))) / "library"


@cache
def shipped() -> Mapping[str, Path]:
    """Return the scenes that come with the project, name -> file."""
    return {path.stem: path for path in sorted(LIBRARY.glob("*.toml"))}


def load(name_or_path: str | Path, changes: Mapping[str, Value] = MappingProxyType({})) -> Scene:
    """Read a scene.

    Args:
        name_or_path: the name of a shipped scene, or a .toml file, with its ending or without.
        changes: other values for some of its numbers and texts, by path (`bodies.rod.mass`), in the units of the file.

    Returns:
        The scene in SI: complete, and consistent as far as counts and names show.

    Raises:
        InputError: the file cannot be read or asks for something impossible; the text is one line that names the file,
            the changes, the path in it, what was expected, and the nearest valid name.
    """
    check_changes(changes)
    found = file_of(name_or_path)
    tables = tables_of(found)
    file = label(found, changes)
    try:
        change(tables, changes)
        scene = _scene(SceneFile.model_validate(tables), file)
        check_variations(tables, scene.variations)
    except ValidationError as error:
        raise InputError(f"{one_line(file)}: {explain(error, SceneFile)}") from None
    except InputError as error:
        raise InputError(f"{one_line(file)}: {error}") from None
    return scene


def numbers_in(name_or_path: str | Path, paths: Sequence[str]) -> list[float]:
    """Return numbers of a scene file, in its own units.

    Args:
        name_or_path: as of `load`.
        paths: where the numbers are, as `bodies.rod.lengths.P4-P5`.

    Raises:
        InputError: the file cannot be read, or there is no number at one of the paths, or one is named twice.
    """
    try:
        return numbers(tables_of(name_or_path), paths)
    except InputError as error:
        raise InputError(f"{one_line(str(name_or_path))}: {error}") from None


def file_of(name_or_path: str | Path) -> str | Path:
    """Return the name of a shipped scene, or else the file; `mine` is `mine.toml` where no file has that name."""
    if not isinstance(name_or_path, str | PathLike):
        refuse("scene", "the name of a shipped one, or the path of a file", name_or_path)
    name, ending = str(name_or_path), f"{name_or_path}.toml"
    alone = name not in shipped() and isfile(ending) and not isfile(name)  # noqa: PTH113 - Path raises for odd names
    return ending if alone else name_or_path


def tables_of(name_or_path: str | Path) -> dict[str, Any]:
    """Return the tables of a scene file, unchecked.

    Raises:
        InputError: the file cannot be read.
    """
    return read_toml(file_of(name_or_path), shipped(), "scene")


# --- numbers into SI -------------------------------------------------------------------------------------------------


def _scene(table: SceneFile, file: str) -> Scene:
    if table.drive.body not in table.bodies:
        raise InputError(f"drive.body: no body '{table.drive.body}'{nearest(table.drive.body, table.bodies)}")
    guide = table.bodies[table.drive.body].slides
    slider_driven = guide is not None and guide.on == GROUND
    units = si_units(table.units, table.drive.body, slides=slider_driven)
    length, mass, force, angle, speed = (units[name][1] for name in ("length", "mass", "force", "angle", "speed"))
    drive_unit = length if slider_driven else angle
    bodies = {name: _body(name, body, length, mass) for name, body in table.bodies.items()}
    scene = Scene(
        name=table.name,
        title=one_line(table.title or table.name, TITLE),
        source=one_line(table.source, SOURCE),
        file=file,
        ground=MappingProxyType({name: _times(length, point) for name, point in table.ground.points.items()}),
        bodies=MappingProxyType(bodies),
        drive=_drive(table.drive, drive_unit, speed),
        loads=tuple(_load(f"loads.{i}", load, bodies, length, force) for i, load in enumerate(table.loads)),
        springs=tuple(_spring(spring, length, force) for spring in table.springs),
        gravity=table.gravity,
        sketch=Sketch(
            _sketched_drive(table, slider_driven=slider_driven) * drive_unit,
            MappingProxyType({name: _times(length, point) for name, point in (table.sketch.model_extra or {}).items()}),
        ),
        output=table.output.slider or table.output.point or "",
        tolerances=MappingProxyType(
            {
                engine: MappingProxyType(_tolerances(f"tolerances.{engine}", groups, slider_driven=slider_driven))
                for engine, groups in table.tolerances.items()
            }
        ),
        units=MappingProxyType(units),
        variations=tuple(Variation(v.path, v.plus_minus, v.distribution) for v in table.variations),
    )
    check(scene, output_slides=table.output.slider is not None)
    return scene


def _times(factor: float, pair: Vector) -> Vector:
    return pair[0] * factor, pair[1] * factor


def _drive(table: DriveTable, unit: float, speed_unit: float) -> Drive:
    if (table.law is None) == (table.speed is None):
        raise InputError("drive: expected either 'speed' or 'law'")
    if table.law is not None:
        for key in ("start", "end"):
            if getattr(table, key) is not None:
                raise InputError(f"drive.{key}: expected none with a 'law'")
        times, positions = zip(*table.law, strict=True)
        return MotionLaw(table.body, times, tuple(p * unit for p in positions), periodic=bool(table.periodic))
    if table.periodic is not None:
        raise InputError("drive.periodic: expected a 'law' with it")
    assert table.speed is not None
    end = None if table.end is None else table.end * unit
    return ConstantSpeed(table.body, table.speed * speed_unit, (table.start or 0.0) * unit, end)


def _load(place: str, table: LoadTable, bodies: Mapping[str, Body], length: float, force: float) -> Load:
    if (table.force is None) == (table.table is None):
        raise InputError(f"{place}: expected either 'force' or 'table'")
    if table.force is not None and table.last is None:
        return Force(table.body, table.at, _times(force, table.force))
    slide = bodies[table.body].slide if table.body in bodies else None
    if table.body in bodies and (slide is None or slide.on != GROUND):
        key = "table" if table.last is None else "last"
        raise InputError(f"{place}.{key}: expected a body that slides on the ground, found '{table.body}'")
    if table.force is None:
        assert table.table is not None
        if table.last is not None:
            raise InputError(f"{place}.last: expected a 'force' with it, not a 'table'")
        displacements, forces = zip(*table.table, strict=True)
        return ForceTable(
            table.body, table.at, tuple(x * length for x in displacements), tuple(f * force for f in forces)
        )
    assert table.last is not None
    along = slide.along if slide is not None else (0.0, 0.0)
    push = table.force[0] * along[0] + table.force[1] * along[1]
    if slide is not None and push == 0:
        raise InputError(f"{place}.force: expected a part along the guide, which the slider closes against")
    closing = -1 if push > 0 else 1
    return PressForce(table.body, table.at, _times(force, table.force), table.last * length, closing)


def _spring(table: SpringTable, length: float, force: float) -> Spring:
    first, second = ((body, point) for body, _, point in (text.partition(".") for text in table.between))
    return Spring(first, second, table.stiffness * force / length, table.length * length)


def _sketched_drive(table: SceneFile, *, slider_driven: bool) -> float:
    right, wrong = ("displacement", "angle") if slider_driven else ("angle", "displacement")
    driven = f"drive.body, '{table.drive.body}', {'slides' if slider_driven else 'does not slide'} on the ground"
    if getattr(table.sketch, wrong) is not None:
        raise InputError(f"sketch.{wrong}: expected '{right}', since {driven}; or another body there")
    if slider_driven and table.sketch.displacement is None:
        raise InputError(f"sketch.displacement: missing; the sketch is at one place of what is driven: {driven}")
    return getattr(table.sketch, right) or 0.0


def _tolerances(place: str, table: TolerancesTable, *, slider_driven: bool) -> dict[str, float]:
    groups: dict[str, float] = table.model_dump(exclude_none=True)
    if slider_driven and "torque" in groups:
        groups.setdefault("force", groups.pop("torque"))  # by which the first files name it
    elif not slider_driven and "force" in groups:
        raise InputError(f"{place}.force: expected 'torque', since the drive moves a crank")
    return groups


def _body(name: str, table: BodyTable, length: float, mass: float) -> Body:
    if (table.points is None) == (table.lengths is None):
        raise InputError(f"bodies.{name}: expected either 'points' or 'lengths'")
    if (table.com is None) != (table.inertia is None):
        raise InputError(f"bodies.{name}: expected both 'com' and 'inertia', or neither")
    local = lengths = slide = None
    if table.points is not None:
        names = tuple(table.points)
        local = MappingProxyType({p: _times(length, pair) for p, pair in table.points.items()})
    else:
        assert table.lengths is not None
        names = tuple(dict.fromkeys(p for pair in table.lengths for p in pair.split("-")))
        lengths = MappingProxyType({frozenset(pair.split("-")): v * length for pair, v in table.lengths.items()})
        if len(lengths) != len(table.lengths):
            raise InputError(f"bodies.{name}.lengths: a distance is given twice")
        if on_line := on_one_line(names, lengths):  # which no triangles give: it is a matter of the last places
            local, lengths = MappingProxyType(on_line), None
    if table.slides is not None:
        norm = hypot(*table.slides.along)
        if not 1e-15 <= norm <= 1e15:
            raise InputError(
                f"bodies.{name}.slides.along: expected a direction of a size from 1e-15 to 1e15, found {norm:g}"
            )
        slide = Slide(table.slides.on, _times(length, table.slides.through), _times(1 / norm, table.slides.along), norm)
    return Body(
        name=name,
        points=names,
        local=local,
        lengths=lengths,
        corners=corners(names, local, lengths),
        mass=None if table.mass is None else table.mass * mass,
        com=None if table.com is None else _times(length, table.com),
        inertia=None if table.inertia is None else table.inertia * mass * length**2,
        slide=slide,
    )

"""Tables -> Scene, whether a file had them or not. Units and user errors end here: scenes are SI and consistent.

And a first file to change, with the schema by which editors complete and check it.
"""

import json
import re
import tomllib
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from functools import cache, partial
from os import PathLike
from os.path import isfile
from pathlib import Path
from types import MappingProxyType
from typing import Any

from ..arguments import refuse, scene_of, single_values
from ..bodies import SlideTable
from ..channels import TRANSMISSION, Role
from ..elements import LISTS
from ..errors import InputError, at_place, nearest, one_line
from ..fields import NAME, put, walk
from ..limits import NAME as LONGEST_NAME
from ..limits import SOURCE, TITLE
from ..scene import GROUND, LimitTable, Scene, Sketch
from .changes import Value, change, check_variations, label, numbers
from .consistency import check
from .explained import validated
from .format import SceneFile, TolerancesTable
from .toml import copied, read_toml
from .units import si_units, unit_named

SCENES = Path(__file__).parents[1]
LIBRARY = SCENES / "library"
SCHEMA = "scene.schema.json"


@cache
def shipped() -> Mapping[str, Path]:
    """The scenes that come with the project, name -> file."""
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
    changes = single_values(changes)
    place = file_of(name_or_path)
    return _made(tables_of(place), place, changes)


def from_tables(tables: Mapping[str, Any], file: str = "tables") -> Scene:
    """Make a scene of tables, as TOML gives them: of a program that has no file, or reads those of another one.

    Args:
        tables: what a scene file has, by key; they are copied.
        file: what messages call them.

    Returns:
        The scene as of `load`.

    Raises:
        InputError: as of `load`, and for what no TOML file has.
    """
    with at_place(one_line(file)):
        kept = copied(tables)
    return _made(kept, file, {})


def with_changes(scene: Scene, changes: Mapping[str, Value]) -> Scene:
    """Make a scene of the tables of another one, with other values for some numbers and texts, as of `load`."""
    scene = scene_of(scene)
    return _made(copied(_tables_in(scene)), scene.file, single_values(changes))


def numbers_in(scene: Scene | str | Path, paths: Sequence[str]) -> list[float]:
    """Numbers of a scene, or of a file by its name or path, in the units of the file, by their paths.

    A path is as `bodies.rod.lengths.P4-P5`.

    Raises:
        InputError: the file cannot be read, or there is no number at one of the paths, or one is named twice.
    """
    tables, file = (_tables_in(scene), scene.file) if isinstance(scene, Scene) else (tables_of(scene), str(scene))
    with at_place(one_line(file)):
        return numbers(tables, paths)


def title_of(name: str) -> str:
    """The title of a shipped scene: it is above the first [table] of its file, of which the rest is not read."""
    above, *_ = shipped()[name].read_text(encoding="utf-8").partition("\n[")
    return one_line(str(tomllib.loads(above).get("title", name)), TITLE)


def file_of(name_or_path: str | Path) -> str | Path:
    """The name of a shipped scene, or else the file; `mine` is `mine.toml` where no file has that name."""
    if not isinstance(name_or_path, str | PathLike):
        refuse("scene", "the name of a shipped one, or the path of a file", name_or_path)
    name, ending = str(name_or_path), f"{name_or_path}.toml"
    alone = name not in shipped() and isfile(ending) and not isfile(name)  # noqa: PTH113 - Path raises for odd names
    return ending if alone else name_or_path


def tables_of(name_or_path: str | Path) -> dict[str, Any]:
    """The tables of a scene file, unchecked; InputError where it cannot be read."""
    return read_toml(file_of(name_or_path), shipped(), "scene")


def _tables_in(scene: Scene) -> Mapping[str, Any]:
    if not scene.tables:
        raise InputError(f"{scene.file}: expected a scene as its tables have it, and this one has other numbers")
    return scene.tables


def _made(tables: dict[str, Any], file: str | Path, changes: Mapping[str, Value]) -> Scene:
    """The scene of tables that nobody else has, with changes."""
    file = label(file, changes)
    with at_place(one_line(file)):
        change(tables, changes)
        scene = _scene(validated(SceneFile, tables, partial(unit_named, tables)), file)
        check_variations(tables, scene)
    return replace(scene, tables=tables)


def _scene(table: SceneFile, file: str) -> Scene:
    if table.drive.body not in table.bodies:
        raise InputError(f"drive.body: no body '{table.drive.body}'{nearest(table.drive.body, table.bodies)}")
    guide = table.bodies[table.drive.body].slides
    slides = guide is not None
    units = si_units(table.units, table.drive.body, slides=slides)
    bodies = {name: body.body(name) for name, body in table.bodies.items()}
    held = {engine: _tolerances(f"tolerances.{engine}", of, slides=slides) for engine, of in table.tolerances.items()}
    lists: dict[str, Any] = {
        key: tuple(entry.element(f"{key}.{number}", bodies) for number, entry in enumerate(getattr(table, key)))
        for key in LISTS
    }
    as_written = Scene(
        name=table.name,
        title=one_line(table.title or table.name, TITLE),
        source=one_line(table.source, SOURCE),
        file=file,
        ground=MappingProxyType(table.ground.points),
        bodies=MappingProxyType(bodies),
        drives=(replace(table.drive.drive(), on=_driven_on(table, guide)),),
        gravity=table.gravity,
        sketch=Sketch(_position_in_sketch(table, slides=slides), MappingProxyType(table.sketch.model_extra or {})),
        output=table.output.slider or table.output.point or "",
        tolerances=MappingProxyType(held),
        units=MappingProxyType(units),
        variations=tuple(table.variations),
        **lists,
    )
    # All units end here, once: each number that the types of the fields declare is multiplied by the size of its
    # quantity's unit. Limits follow below, since their units are those of channels.
    sizes = {dimension: size for dimension, (_, size) in as_written.all_units.items()}
    in_si = {number.at: number.value * sizes[number.quantity.dimension] for number in walk(as_written)}
    scene: Scene = put(as_written, in_si)
    check(scene, output_slides=table.output.slider is not None)
    return replace(scene, limits=_limits(table, scene))


def _limits(table: SceneFile, scene: Scene) -> Mapping[str, LimitTable]:
    held: dict[str, LimitTable] = {}
    known = [*scene.channels.names(Role.kinematic, Role.force, Role.friction, Role.magnitude), TRANSMISSION]
    for name, limit in table.limits.items():
        place = f"limits.{name}"
        if name not in known:
            raise InputError(f"{place}: no such channel or magnitude{nearest(name, known)}")
        if limit.least is None and limit.most is None:
            raise InputError(f"{place}: expected 'least', 'most' or both")
        if limit.least is not None and limit.most is not None and limit.least > limit.most:
            raise InputError(f"{place}.least: expected {limit.most:g}, the most, or less, found {limit.least:g}")
        _, size = scene.unit_of(name)
        held[name] = LimitTable(**{end: value * size for end, value in limit.model_dump(exclude_none=True).items()})
    return MappingProxyType(held)


def _driven_on(table: SceneFile, guide: SlideTable | None) -> str:
    on = table.drive.on
    if guide is not None and on not in (None, guide.on):
        raise InputError(f"drive.on: expected '{guide.on}', on which '{table.drive.body}' slides, found '{on}'")
    return guide.on if guide is not None else on or GROUND


def _position_in_sketch(table: SceneFile, *, slides: bool) -> float:
    right, wrong = ("displacement", "angle") if slides else ("angle", "displacement")
    driven = f"drive.body, '{table.drive.body}', {'slides' if slides else 'does not slide'}"
    if getattr(table.sketch, wrong) is not None:
        raise InputError(f"sketch.{wrong}: expected '{right}', since {driven}; or another body there")
    if slides and table.sketch.displacement is None:
        raise InputError(f"sketch.displacement: missing; the sketch is at one place of what is driven: {driven}")
    return getattr(table.sketch, right) or 0.0


def _tolerances(place: str, table: TolerancesTable, *, slides: bool) -> Mapping[str, float]:
    groups: dict[str, float] = table.model_dump(exclude_none=True)
    if slides and "torque" in groups:
        groups.setdefault("force", groups.pop("torque"))  # by which the first files name it
    elif not slides and "force" in groups:
        raise InputError(f"{place}.force: expected 'torque', since the drive moves a crank")
    return MappingProxyType(groups)


def write_starter(path: Path) -> list[Path]:
    """Write a commented scene, its file named by the path and .toml, and its schema beside it; return both files.

    Raises:
        InputError: the name cannot be a scene's, the file is there already, another schema is in its place, or the
            folder cannot be written. Then nothing is left of either file.
    """
    place, name = f"new {one_line(str(path))}", path.name.removesuffix(".toml")
    if not (re.fullmatch(NAME, name) and len(name) <= LONGEST_NAME):
        raise InputError(
            f"{place}: '{one_line(name, 40)}' is not a name: expected letters, digits and '_', a letter first,"
            f" {LONGEST_NAME} at most"
        )
    if name in shipped():
        raise InputError(f"{place}: '{name}' is a scene that ships, which its name stands for; expected another name")
    scene, schema = (path.with_name(file) for file in (f"{name}.toml", SCHEMA))
    starter = (SCENES / "starter.toml").read_text(encoding="utf-8").replace('"NAME"', f'"{name}"')
    contents = {scene: starter.encode(), schema: json.dumps(SceneFile.model_json_schema(), indent=1).encode() + b"\n"}
    try:
        # Both files or none. "xb" creates a file only where there is none, in one step, so that no other process's file
        # is overwritten between a test and the write. Where the second one fails, the stack deletes what was created
        # before.
        with ExitStack() as undo:
            for file, content in contents.items():
                if file == schema and file.is_file() and file.read_bytes() == content:
                    continue
                with file.open("xb") as stream:
                    undo.callback(file.unlink)
                    stream.write(content)
            undo.pop_all()
    except FileExistsError as error:
        if error.filename == str(scene):
            raise InputError(f"{place}: the file exists; expected a new name") from None
        raise InputError(f"{place}: another {SCHEMA} is beside it; expected none, or the one of this version") from None
    except (OSError, ValueError) as error:  # the latter of a zero in the path
        raise InputError(f"{place}: cannot be written ({getattr(error, 'strerror', error)})") from None
    return [scene, schema]

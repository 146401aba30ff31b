"""TOML -> Scene. Units and user errors end here: what leaves is SI, complete and consistent."""

import tomllib
from collections.abc import Iterator
from functools import cache
from importlib.resources import files
from math import hypot
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, get_args

from pydantic import BaseModel, ValidationError

from .consistency import check
from .errors import InputError, nearest
from .format import BodyTable, SceneFile, Units
from .scene import Body, Drive, Load, Scene, Sketch, Slide, Vector

if TYPE_CHECKING:
    from pint import UnitRegistry

LIBRARY = Path(str(files("scenes"))) / "library"


def shipped() -> dict[str, Path]:
    """Return the scenes that come with the project, name -> file."""
    return {path.stem: path for path in sorted(LIBRARY.glob("*.toml"))}


def load(name_or_path: str | Path) -> Scene:
    """Read a scene, by the name of a shipped one or from a .toml file.

    Raises:
        InputError: the file cannot be read or says something impossible; the text is one line that names the file, the
            path in it, what was expected, and the nearest valid name.
    """
    path = shipped().get(str(name_or_path), Path(name_or_path))
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError(f"{name_or_path}: no such scene or file{nearest(path.stem, shipped())}") from None
    except (OSError, UnicodeDecodeError, ValueError) as error:
        raise InputError(f"{name_or_path}: cannot be read as a text file ({_first_line(error)})") from None
    try:
        return _scene(SceneFile.model_validate(tomllib.loads(text)), str(name_or_path))
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{name_or_path}: not valid TOML: {_first_line(error)}") from None
    except ValidationError as error:
        raise InputError(f"{name_or_path}: {_explain(error)}") from None
    except InputError as error:
        raise InputError(f"{name_or_path}: {error}") from None


def _first_line(error: Exception) -> str:
    return (str(error) or type(error).__name__).splitlines()[0]


# --- numbers into SI -------------------------------------------------------------------------------------------------

_UNIT_EXAMPLES = {
    "length": ("meter", ("m", "mm", "cm", "um", "km", "in", "ft")),
    "mass": ("kilogram", ("kg", "g", "t", "lb")),
    "force": ("newton", ("N", "kN", "MN", "lbf")),
    "angle": ("radian", ("rad", "deg")),
    "speed": ("radian / second", ("rad/s", "deg/s", "rpm")),
}


@cache
def _unit_registry() -> "UnitRegistry[float]":
    from pint import UnitRegistry  # late, and once: by far the slowest import here

    return UnitRegistry()


def _si_factors(units: Units) -> dict[str, float]:
    """Return what to multiply each quantity's number by to have it in SI."""
    registry = _unit_registry()
    factors = {}
    for name, (si, examples) in _UNIT_EXAMPLES.items():
        unit = getattr(units, name)
        try:
            factors[name] = float(registry.Quantity(1.0, registry.parse_units(unit)).to(si).magnitude)
        except Exception:  # pint raises its own, ValueError, AttributeError or a tokenizer's error, by kind of nonsense
            hint = nearest(unit, examples)
            raise InputError(f"units.{name}: '{unit}' is not a unit of {name} that is known{hint}") from None
    return factors


def _scene(table: SceneFile, file: str) -> Scene:
    factor = _si_factors(table.units)
    length, mass, force, angle = (factor[name] for name in ("length", "mass", "force", "angle"))

    def point(pair: Vector) -> Vector:
        return pair[0] * length, pair[1] * length

    scene = Scene(
        name=table.name,
        title=table.title or table.name,
        source=table.source,
        file=file,
        ground=MappingProxyType({name: point(pair) for name, pair in table.ground.points.items()}),
        bodies=MappingProxyType({name: _body(name, body, length, mass) for name, body in table.bodies.items()}),
        drive=Drive(table.drive.body, table.drive.speed * factor["speed"], table.drive.start * angle),
        loads=tuple(Load(load.body, load.at, (load.force[0] * force, load.force[1] * force)) for load in table.loads),
        gravity=table.gravity,
        sketch=Sketch(
            table.sketch.angle * angle,
            MappingProxyType({name: point(pair) for name, pair in (table.sketch.model_extra or {}).items()}),
        ),
        output=table.output.slider or table.output.point or "",
        tolerances=MappingProxyType(
            {
                engine: MappingProxyType(groups.model_dump(exclude_none=True))
                for engine, groups in table.tolerances.items()
            }
        ),
    )
    check(scene, output_slides=table.output.slider is not None)
    return scene


def _body(name: str, table: BodyTable, length: float, mass: float) -> Body:
    def point(pair: Vector) -> Vector:
        return pair[0] * length, pair[1] * length

    if (table.points is None) == (table.lengths is None):
        raise InputError(f"bodies.{name}: expected either 'points' or 'lengths'")
    if (table.com is None) != (table.inertia is None):
        raise InputError(f"bodies.{name}: expected both 'com' and 'inertia', or neither")
    local = lengths = slide = None
    if table.points is not None:
        names = tuple(table.points)
        local = MappingProxyType({p: point(pair) for p, pair in table.points.items()})
    else:
        assert table.lengths is not None
        names = tuple(dict.fromkeys(p for pair in table.lengths for p in pair.split("-")))
        lengths = MappingProxyType({frozenset(pair.split("-")): v * length for pair, v in table.lengths.items()})
        if len(lengths) != len(table.lengths):
            raise InputError(f"bodies.{name}.lengths: a distance is given twice")
    if table.slides is not None:
        norm = hypot(*table.slides.along)
        if not norm > 0:
            raise InputError(f"bodies.{name}.slides.along: expected a direction, not zero")
        slide = Slide(point(table.slides.through), (table.slides.along[0] / norm, table.slides.along[1] / norm))
    return Body(
        name=name,
        points=names,
        local=local,
        lengths=lengths,
        mass=None if table.mass is None else table.mass * mass,
        com=None if table.com is None else point(table.com),
        inertia=None if table.inertia is None else table.inertia * mass * length**2,
        slide=slide,
    )


# --- one line for the first thing that is wrong ----------------------------------------------------------------------


def _explain(error: ValidationError) -> str:
    """Say the first of the errors; the rest is only counted, since one slip often causes several."""
    first, *rest = sorted(error.errors(), key=lambda e: e["type"] != "extra_forbidden")
    location = [part for part in first["loc"] if part != "[key]"]
    place = ".".join(str(part) for part in location)
    match first["type"]:
        case "extra_forbidden":
            text = f"unknown key{nearest(str(location[-1]), _keys_at(location[:-1]))}"
        case "missing" if isinstance(location[-1], int):
            text = "expected two numbers, [x, y]"
        case "missing":
            text = "missing; the scene needs it"
        case "string_pattern_mismatch":
            pair = "lengths" in location
            wanted = "two point names joined by '-'" if pair else "letters, digits and '_', starting with a letter"
            text = f"not a name: expected {wanted}"
        case "model_type" | "dict_type":
            text = "expected a table"
        case "greater_than" | "greater_than_equal" | "literal_error":
            text = f"{first['msg'].replace('Input should be', 'expected')}, found {first['input']!r}"
        case _:
            text = f"{first['msg'].replace('Input should be', 'expected')}, found {str(first['input'])[:40]!r}"
    return f"{place}: {text}" + (f" (and {len(rest)} more)" if rest else "")


def _keys_at(location: list[int | str]) -> Iterator[str]:
    """Yield the keys that the table at this place of a scene file may have."""
    model: type[BaseModel] = SceneFile
    for part in location:
        if isinstance(part, str) and part in model.model_fields:
            model = next(_tables_in(model.model_fields[part].annotation), model)
    yield from model.model_fields


def _tables_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for argument in get_args(annotation):
        yield from _tables_in(argument)

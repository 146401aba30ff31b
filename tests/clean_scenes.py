"""Scenes as a user would write them, drawn at random, the same ones every time: files in many units, clear of lock.

The linkages of `linkage_scenes`, as many of every kind of dyad, and class III with its numbers a little off. One
drawing read in inches and pounds is another size, and another weight against its loads, than in millimetres and tonnes.
"""

from dataclasses import replace
from itertools import combinations
from math import degrees, pi
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st

import scenes
from scenes import Scene
from scenes.fields import put, walk
from scenes.file.reader import numbers_in, tables_of
from scenes.scene import GROUND, Body, ConstantSpeed, DriveLaw, Load, Moment, MotionLaw, Spring, TorsionSpring

from . import remainder_scenes as remainders
from . import scene_files
from .element_scenes import element_scenes
from .linkage_scenes import linkages
from .moving_drives import DRIVES
from .remainder_scenes import PREFIX, with_a_rough_sketch, with_a_small_stroke

KINDS = ("RRR", "RRP", "RPR", "PRP", "RPP")  # of the first dyad
CLASS_III = ("class_iii", "class_iii_among_dyads", "slotted_class_iii")
EVERY = 16  # so many scenes, one of class III
FOURTH = 4  # so many scenes, one of small remainders; of these every third of a small stroke
OFF = 0.02  # of every length of class III: it stays far from lock


class Sizes(NamedTuple):
    """What 1 m, 1 kg, 1 N and 1 rad of a drawing become: a unit and how many of it."""

    length: tuple[str, float]
    mass: tuple[str, float]
    force: tuple[str, float]
    angle: tuple[str, float]


METRES = {"m": 1.0, "mm": 1e-3, "cm": 0.01, "in": 0.0254, "ft": 0.3048, "um": 1e-6}
LENGTHS = (("m", 1.0), ("mm", 60.0), ("cm", 25.0), ("in", 4.0), ("ft", 3.0), ("um", 800.0))
MASSES = (("kg", 1.0), ("g", 150.0), ("lb", 0.5), ("t", 0.1))
FORCES = (("N", 1.0), ("kN", 0.2), ("lbf", 3.0))
ANGLES = (("rad", 1.0), ("deg", degrees(1.0)))
SIZES = st.builds(Sizes, *map(st.sampled_from, (LENGTHS, MASSES, FORCES, ANGLES)))


def clean_scenes(folder: Path, count: int, *, elements: bool = False, rough: bool = False) -> list[Scene]:
    """Scenes that were written to a folder and read from there; with elements and drives of every kind, or plain.

    Rough ones have no exact sketch; and of plain ones every fourth is a small remainder, see `remainder_scenes`.
    """
    clean = []
    for number in range(count):
        if number % EVERY == EVERY - 1 and not elements:
            clean.append(_class_iii(number // EVERY))
            continue
        if number % FOURTH == 1 and rough and not elements:
            clean.append(_remainder(folder, number // FOURTH))
            continue
        kind = KINDS[number % len(KINDS)]
        scene, sizes = _drawn(
            number, element_scenes(kind, DRIVES[number % len(DRIVES)]) if elements else linkages(kind)
        )
        if rough:
            scene = with_a_rough_sketch(scene, np.random.default_rng(number))
        file = folder / f"clean_{number:03d}.toml"
        file.write_text(scene_files.toml(tables(replace(scene, name=file.stem), sizes)), encoding="utf-8")
        clean.append(scenes.load(file))
    return clean


def _remainder(folder: Path, number: int) -> Scene:
    """A scene of small remainders, see `remainder_scenes`."""
    if number % 3 == 1:
        scene, _ = _drawn(number, linkages(KINDS[number % len(KINDS)]))
        small = with_a_small_stroke(scene, np.random.default_rng(number))
        return replace(small, name=f"{PREFIX}_stroke_{number:03d}")
    written = remainders.tables_of(number)
    file = folder / f"{written['name']}.toml"
    file.write_text(scene_files.toml(written), encoding="utf-8")
    return scenes.load(file)


def _drawn(number: int, strategy: st.SearchStrategy[Scene]) -> tuple[Scene, Sizes]:
    """One drawing, the same one every time."""
    drawings: list[tuple[Scene, Sizes]] = []

    @seed(number)
    @settings(max_examples=2, phases=[Phase.generate], database=None, suppress_health_check=list(HealthCheck))
    @given(strategy, SIZES)
    def draw(scene: Scene, sizes: Sizes) -> None:
        drawings.append((scene, sizes))

    draw()
    return drawings[-1]  # the first one is the plainest, whatever the seed


def tables(scene: Scene, sizes: Sizes) -> dict[str, Any]:
    """The tables of the file of a drawn scene, in other units and as many of them."""
    (length, L), (mass, M), (force, F), (angle, A) = sizes
    slides = scene.drive.slide is not None
    speed, per_second = (f"{length}/s", L) if slides else (("rpm", 30 / pi) if angle == "deg" else ("rad/s", 1.0))
    many = {"length": L, "mass": M, "force": F, "inertia": M * L**2, "stiffness": F / L, "speed": per_second}
    many |= {"angle": A, "position": L if slides else A} | dict.fromkeys(("time", "gravity", "direction"), 1.0)
    moment = F * L * METRES[length]  # in the file's force times metre
    many |= {"moment": moment, "damping": F / L, "torsion_stiffness": moment / A, "torsion_damping": moment / A}
    many |= {"coefficient": 1.0, "turning_rate": 1.0, "turning_damping": moment, "sliding_rate": L}
    scene = put(scene, {number.at: many[number.quantity.dimension] * number.value for number in walk(scene)})
    written = {
        "format": 1,
        "name": scene.name,
        "units": {"length": length, "mass": mass, "force": force, "angle": angle, "speed": speed},
        "gravity": scene.gravity,
        "ground": {"points": dict(scene.ground) or {"G": (0, 0)}},  # a file has one at least
        "bodies": {name: _body(body) for name, body in scene.bodies.items()},
        "drive": _drive(scene.drive.body, scene.drive.law)
        | ({} if slides or scene.drive.on == GROUND else {"on": scene.drive.on}),
        "loads": [_load(load) for load in scene.loads],
        "springs": [
            {"between": [".".join(of.first), ".".join(of.second)], **_pull(of), "length": of.length}
            for of in scene.springs
        ],
        "torsion_springs": [
            {"at": of.at, "between": [of.first, of.second], **_pull(of), "angle": of.angle}
            for of in scene.torsion_springs
        ]
        or None,
        "friction": [_without_none(vars(of)) for of in scene.friction] or None,
        "sketch": {"displacement" if slides else "angle": scene.sketch.drive, **scene.sketch.points},
        "output": {"point": scene.output},
    }
    return _without_none(written)


def _without_none(table: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in table.items() if value is not None}


def _body(body: Body) -> dict[str, Any]:
    pairs = [pair for pair in combinations(body.points, 2) if body.lengths and frozenset(pair) in body.lengths]
    table: dict[str, Any] = {"points": body.local, "mass": body.mass, "com": body.com, "inertia": body.inertia}
    if body.lengths is not None:
        table["lengths"] = {"-".join(pair): body.lengths[frozenset(pair)] for pair in pairs}
    if body.slide is not None:
        table["slides"] = {"on": body.slide.on, "through": body.slide.through, "along": body.slide.along}
    return _without_none(table)


def _drive(body: str, law: DriveLaw) -> dict[str, Any]:
    if isinstance(law, ConstantSpeed):
        return {"body": body} | _without_none(vars(law))
    assert isinstance(law, MotionLaw)
    return {"body": body, "law": [*zip(law.times, law.positions, strict=True)], "periodic": law.periodic}


def _pull(spring: Spring | TorsionSpring) -> dict[str, Any]:
    return _without_none({"stiffness": spring.stiffness or None, "damping": spring.damping})


def _load(load: Load) -> dict[str, Any]:
    given, table = dict[str, Any](vars(load)), load.table
    keys: dict[str, Any] = {
        key: given[key] for key in ("body", "at", "force", "moment", "last", "along") if key in given
    }
    if load.frame == "body":
        keys["frame"] = load.frame
    if table is not None:
        keys |= {} if load.kind == "force tables" else {"over": table.over, "periodic": table.periodic}
        keys["table"] = [*zip(table.arguments, table.values, strict=True)]
        if isinstance(load, Moment):
            del keys["at"]
    return _without_none(keys)


def _class_iii(number: int) -> Scene:
    """A scene of class III whose lengths are each a little off those of its file."""
    file, chance = scene_files.path(CLASS_III[number % len(CLASS_III)]), np.random.default_rng(number)
    bodies = tables_of(file)["bodies"]
    paths = [f"bodies.{body}.lengths.{pair}" for body, of in bodies.items() for pair in of.get("lengths", ())]
    off = chance.uniform(1 - OFF, 1 + OFF, len(paths)) * numbers_in(file, paths)
    return scenes.load(file, dict(zip(paths, off.tolist(), strict=True)))

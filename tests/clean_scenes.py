"""Scenes as a user would write them, drawn at random, the same ones every time: files in many units, clear of lock.

The linkages of `linkage_scenes`, as many of every kind of dyad, and class III with its numbers a little off. One
drawing read in inches and pounds is another size, and another weight against its loads, than in millimetres and tonnes.
"""

from collections.abc import Iterator, Mapping
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
from scenes.reader import numbers_in, tables_of
from scenes.scene import Body, ConstantSpeed, Force, ForceTable, PressForce, Vector

from . import scene_files
from .linkage_scenes import linkages

KINDS = ("RRR", "RRP", "RPR", "PRP", "RPP")  # of the first dyad
CLASS_III = ("class_iii", "class_iii_among_dyads", "slotted_class_iii")
EVERY = 16  # so many scenes, one of class III
OFF = 0.02  # of every length of class III: it stays far from lock


class Sizes(NamedTuple):
    """What 1 m, 1 kg, 1 N and 1 rad of a drawing become: a unit and how many of it."""

    length: tuple[str, float]
    mass: tuple[str, float]
    force: tuple[str, float]
    angle: tuple[str, float]


LENGTHS = (("m", 1.0), ("mm", 60.0), ("cm", 25.0), ("in", 4.0), ("ft", 3.0), ("um", 800.0))
MASSES = (("kg", 1.0), ("g", 150.0), ("lb", 0.5), ("t", 0.1))
FORCES = (("N", 1.0), ("kN", 0.2), ("lbf", 3.0))
ANGLES = (("rad", 1.0), ("deg", degrees(1.0)))
SIZES = st.builds(Sizes, *map(st.sampled_from, (LENGTHS, MASSES, FORCES, ANGLES)))


def clean_scenes(folder: Path, count: int) -> list[Scene]:
    """Return scenes that were written to a folder and read from there."""
    found = []
    for number in range(count):
        if number % EVERY == EVERY - 1:
            found.append(_class_iii(number // EVERY))
            continue
        scene, sizes = _drawn(number)
        file = folder / f"clean_{number:03d}.toml"
        file.write_text(scene_files.toml(tables(replace(scene, name=file.stem), sizes)), encoding="utf-8")
        found.append(scenes.load(file))
    return found


def _drawn(number: int) -> tuple[Scene, Sizes]:
    """Return one drawing, the same one every time."""
    found: list[tuple[Scene, Sizes]] = []

    @seed(number)
    @settings(max_examples=2, phases=[Phase.generate], database=None, suppress_health_check=list(HealthCheck))
    @given(linkages(KINDS[number % len(KINDS)]), SIZES)
    def draw(scene: Scene, sizes: Sizes) -> None:
        found.append((scene, sizes))

    draw()
    return found[-1]  # the first one is the plainest, whatever the seed


def tables(scene: Scene, sizes: Sizes) -> dict[str, Any]:
    """Return the tables of the file of a drawn scene, in other units and as many of them."""
    (length, L), (mass, M), (force, F), (angle, A) = sizes
    slides = scene.driven_slide is not None
    speed, per_second = (f"{length}/s", L) if slides else (("rpm", 30 / pi) if angle == "deg" else ("rad/s", 1.0))

    def points(of: Mapping[str, Vector]) -> dict[str, Vector]:
        return {point: _times(L, xy) for point, xy in of.items()}

    def body(of: Body) -> Iterator[tuple[str, Any]]:
        if of.local is not None:
            yield "points", points(of.local)
        pairs = ((p, q) for p, q in combinations(of.points, 2) if of.lengths and frozenset((p, q)) in of.lengths)
        if of.lengths is not None:
            yield "lengths", {f"{p}-{q}": L * of.lengths[frozenset((p, q))] for p, q in pairs}
        if of.mass is not None:
            yield "mass", M * of.mass
        if of.com is not None and of.inertia is not None:
            yield from (("com", _times(L, of.com)), ("inertia", M * L**2 * of.inertia))
        if of.slide is not None:
            yield "slides", {"on": of.slide.on, "through": _times(L, of.slide.through), "along": of.slide.along}

    def drive() -> Iterator[tuple[str, Any]]:
        unit, of = L if slides else A, scene.drive
        yield "body", of.body
        if isinstance(of, ConstantSpeed):
            yield from (("speed", per_second * of.speed), ("start", unit * of.start))
            if of.end is not None:
                yield "end", unit * of.end
        else:
            yield "law", [(t, unit * x) for t, x in zip(of.times, of.positions, strict=True)]
            yield "periodic", of.periodic

    def load(of: Force | PressForce | ForceTable) -> dict[str, Any]:
        at = {"body": of.body, "at": of.at}
        if isinstance(of, ForceTable):
            return at | {"table": [(L * x, F * f) for x, f in zip(of.displacements, of.forces, strict=True)]}
        return at | {"force": _times(F, of.force)} | ({"last": L * of.last} if isinstance(of, PressForce) else {})

    return {
        "format": 1,
        "name": scene.name,
        "units": {"length": length, "mass": mass, "force": force, "angle": angle, "speed": speed},
        **({} if scene.gravity is None else {"gravity": scene.gravity}),
        "ground": {"points": points(scene.ground) or {"G": (0, 0)}},  # a file has one at least
        "bodies": {name: dict(body(of)) for name, of in scene.bodies.items()},
        "drive": dict(drive()),
        "loads": [load(of) for of in scene.loads],
        "springs": [
            {
                "between": [".".join(of.first), ".".join(of.second)],
                "stiffness": F / L * of.stiffness,
                "length": L * of.length,
            }
            for of in scene.springs
        ],
        "sketch": {"displacement" if slides else "angle": (L if slides else A) * scene.sketch.drive}
        | points(scene.sketch.points),
        "output": {"point": scene.output},
    }


def _times(factor: float, xy: Vector) -> Vector:
    return factor * xy[0], factor * xy[1]


def _class_iii(number: int) -> Scene:
    """Return a scene of class III whose lengths are each a little off those of its file."""
    file, chance = scene_files.path(CLASS_III[number % len(CLASS_III)]), np.random.default_rng(number)
    bodies = tables_of(file)["bodies"]
    paths = [f"bodies.{body}.lengths.{pair}" for body, of in bodies.items() for pair in of.get("lengths", ())]
    off = chance.uniform(1 - OFF, 1 + OFF, len(paths)) * numbers_in(file, paths)
    return scenes.load(file, dict(zip(paths, off.tolist(), strict=True)))

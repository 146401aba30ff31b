"""A scene's numbers, each with how to put another in its place; and how far the motion moves when all are a little off.

No model that computes in doubles can be held to less: each rounds the lengths its own way before the first equation.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from scenes import Failure, Motion, Scene
from scenes.loads import ForceTable, Vector
from scenes.motion import Samples
from scenes.scene import ConstantSpeed

from ..engines import registry

ULPS = 4  # of every number, up or down at random
DRAWS = 4  # scenes; their worst is within a factor of three of the worst of many more, see the tests
SEED = 20261121


Path: TypeAlias = tuple[str | int | frozenset[str], ...]  # names of fields, keys of tables, numbers of rows


class Input(NamedTuple):
    """One number or vector of a scene, SI, and where it is; a table of forces is one input, by a factor."""

    path: Path
    value: float | Vector
    geometry: bool = False  # whether it is a length or a place
    direction: bool = False  # whether it is a unit vector


def inputs(scene: Scene) -> Iterator[Input]:
    """Yield the inputs of a scene in the order of its tables; of a motion law none."""
    for name, place in scene.ground.items():
        yield Input(("ground", name), place, geometry=True)
    for body in scene.bodies.values():
        own = ("bodies", body.name)
        yield from (Input((*own, "local", p), place, geometry=True) for p, place in (body.local or {}).items())
        yield from (Input((*own, "lengths", p), length, geometry=True) for p, length in (body.lengths or {}).items())
        if body.com is not None:
            yield Input((*own, "com"), body.com, geometry=True)
        if body.slide is not None:
            yield Input((*own, "slide", "through"), body.slide.through, geometry=True)
            yield Input((*own, "slide", "along"), body.slide.along, direction=True)
        yield Input((*own, "mass"), body.mass or 0.0)
        yield Input((*own, "inertia"), body.inertia or 0.0)
    for number, load in enumerate(scene.loads):
        if isinstance(load, ForceTable):
            yield Input(("loads", number, "forces"), 1.0)
        else:
            yield Input(("loads", number, "force"), load.force)
    for number, spring in enumerate(scene.springs):
        yield Input(("springs", number, "length"), spring.length, geometry=True)
        yield Input(("springs", number, "stiffness"), spring.stiffness)
    if scene.gravity is not None:
        yield Input(("gravity",), scene.gravity)
    if isinstance(scene.drive, ConstantSpeed):
        yield Input(("drive", "speed"), scene.drive.speed)


def put(whole: Any, path: Path, value: float | Vector) -> Any:
    """Return a scene, or a part of one, with another value of an input."""
    if not path:
        by_factor = isinstance(whole, tuple) and not isinstance(value, tuple)
        return tuple(value * force for force in whole) if by_factor else value
    key, rest = path[0], path[1:]
    if isinstance(whole, Mapping):
        return {**whole, key: put(whole[key], rest, value)}
    if isinstance(key, int):
        return (*whole[:key], put(whole[key], rest, value), *whole[key + 1 :])
    return replace(whole, **{str(key): put(getattr(whole, str(key)), rest, value)})


def neighbours(scene: Scene) -> tuple[registry.Solve, ...]:
    """Return solvers of the scene with its lengths and places off by a few last places; none if one cannot be solved.

    Args:
        scene: the linkage.
    """
    draw = np.random.default_rng(SEED)
    off = ULPS * np.finfo(float).eps
    try:
        return tuple(
            registry.reference(_jittered(scene, lambda value: value * (1 + off * float(draw.choice((-1.0, 1.0))))))
            for _ in range(DRAWS)
        )
    except Failure:
        return ()


def sensitivity(
    scene: Scene,
    others: Sequence[registry.Solve],
    true: Motion,
    errors: Callable[[Motion], Mapping[str, Samples]],
) -> dict[str, Samples]:
    """Return by how much each channel moves when lengths, places and drive are off by a few last places, shape (n,).

    Infinite where one of the scenes cannot be assembled: then doubles know nothing of the motion.

    Args:
        scene: the linkage.
        others: its neighbours.
        true: its motion, whose drive the others follow, off by as little.
        errors: relative errors of a motion by channel, each of shape (n,).
    """
    position = true[scene.drive_channel]
    least = 1e-3 * np.ptp(scene.drive.extent)  # an angle that passes through zero is no better known there
    off = ULPS * np.finfo(float).eps * np.maximum(np.abs(position), least)
    unknown = {channel: np.full(true["time"].shape, np.inf) for channel in true.samples}
    moved: dict[str, Samples] = {} if others else unknown
    for number, solve in enumerate(others):
        try:
            with np.errstate(invalid="ignore"):
                found = errors(solve(position + (-1) ** number * off, true["time"]))
        except Failure:
            return unknown
        for channel, error in found.items():
            known = np.where(np.isnan(error), np.inf, error)  # where both scenes stand in a singular pose
            moved[channel] = np.maximum(moved.get(channel, 0.0), known)
    return moved


def _jittered(scene: Scene, jitter: Callable[[float], float]) -> Scene:
    """Return the scene with every length and place a little off."""
    for path, value, geometry, _ in inputs(scene):
        if geometry:
            scene = put(
                scene, path, (jitter(value[0]), jitter(value[1])) if isinstance(value, tuple) else jitter(value)
            )
    return scene

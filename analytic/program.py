"""The core's formulas for one topology as a straight line of real expressions, recorded from the core itself."""

from collections.abc import Iterable, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenes import Failure, Sampling, Scene, Status
from scenes.drive import Driven
from scenes.machines import with_numbers
from scenes.scene import PressForce

from .channels import scalar_channels, vector_channels
from .decomposition import decompose
from .expressions import Expression, Recorder, Traced
from .group_equations import Group
from .kinematics import Linkage, kinematics
from .kinetostatics import Reactions, kinetostatics

SAMPLED = ("position", "rate", "acceleration")  # of the drive


@dataclass(frozen=True)
class Program:
    """Channels as expressions of numbers of the scene, SI, by path, and of what the drive asks for."""

    make: Recorder
    numbers: Mapping[str, Expression]
    channels: Mapping[str, Expression]
    reach: Expression  # negative where a group does not reach


def recorded(scene: Scene, paths: AbstractSet[str], channels: AbstractSet[str] | None = None) -> Program:
    """Record the core's own formulas.

    Args:
        scene: the mechanism; its groups are dyads.
        paths: of the numbers that stay open; the others are those of the scene.
        channels: the names of those wanted; None for all, but for the time and the drive's position.

    Raises:
        Failure: `unsupported` when the linkage has a larger group.
    """
    make = Recorder()
    numbers: dict[str, Expression] = {}

    def change(path: str, value: Any, _: Any) -> Any:
        if path not in paths:
            return value
        number = make.input(path, sampled=False)
        numbers[path] = number.x
        return number

    opened = with_numbers(scene, change)
    whole = decompose(opened)
    if any(isinstance(group, Group) for group in whole.groups):
        raise Failure(Status.unsupported, "a group that is solved by Newton's method has no formula to record")
    linkage = Linkage(whole.driver, whole.groups, whole.bodies, whole.carries, whole.arm, tracks={})
    driven: Any = Driven(*(make.input(name, sampled=True) for name in SAMPLED))  # type: ignore[arg-type]
    rate = getattr(opened.drive, "speed", None)
    if isinstance(rate, Traced):
        driven = driven._replace(rate=rate, acceleration=make.traced(0.0))
    k = kinematics(opened, linkage, driven)
    request = Sampling(channels=None if channels is None else frozenset(channels))
    on = Reactions()
    if request.wants_forces(scene):
        presses = (number for number, load in enumerate(scene.loads) if isinstance(load, PressForce))
        ends: Any = {number: make.input(stroke_end(number), sampled=False) for number in presses}
        on = kinetostatics(opened, linkage, ends, k, request.channels)
    found: dict[str, Expression] = {}
    for (x, y), take in vector_channels(scene):
        if request.channels is None or {x, y} & request.channels:
            vector: Any = take(k, on)
            found |= {x: make.traced(vector).x, y: make.traced(vector).y}
    for (name,), take in scalar_channels(scene, linkage):
        if request.channels is None or name in request.channels:
            found[name] = make.traced(take(k, on)).x
    least: Any = make.traced(np.inf)
    for reach in k.reach.values():
        least = np.minimum(least, reach)
    return Program(make, numbers, found, least.x)


def stroke_end(number: int) -> str:
    """Return the name of the input that is where a press force's stroke ends, m, by the number of the load."""
    return f"stroke_end.{number}"


def needed(expressions: Iterable[Expression]) -> list[Expression]:
    """Return expressions and all that they are made of, in an order in which they can be evaluated."""
    found: dict[int, Expression] = {}
    ahead = list(expressions)
    while ahead:
        expression = ahead.pop()
        if expression.order not in found:
            found[expression.order] = expression
            ahead += [one for one in expression.of if isinstance(one, Expression)]
    return [found[order] for order in sorted(found)]

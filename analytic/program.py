"""The core's formulas for one topology as a straight line of real expressions, recorded from the core itself."""

from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from typing import Any

import numpy as np

from scenes import Sampling, Scene
from scenes.drive import Driven
from scenes.machines import with_numbers
from scenes.motion import Samples
from scenes.scene import PressForce

from .channels import scalar_channels, vector_channels
from .decomposition import decompose
from .expressions import Expression, Recorder
from .group_equations import Group
from .kinematics import Linkage
from .kinetostatics import Reactions
from .numbers import chosen
from .placing import Kinematics
from .recorded_group import RecordedBalance, RecordedPass
from .traced import Traced, given, traced

SAMPLED = ("position", "rate", "acceleration")  # of the drive


@dataclass(frozen=True)
class Program:
    """Channels as expressions of numbers of the scene, SI, by path, and of what the drive asks for."""

    make: Recorder
    numbers: Mapping[str, Expression]
    channels: Mapping[str, Expression]
    reach: Expression  # negative where a group does not reach, or its branch is open


def recorded(scene: Scene, paths: AbstractSet[str], channels: AbstractSet[str] | None = None) -> Program:
    """Record the core's own formulas.

    Args:
        scene: the mechanism.
        paths: of the numbers that stay open; the others are those of the scene.
        channels: the names of those wanted; None for all, but for the time, the drive's position and a larger group's
            distance from a singular configuration, which is a singular value.

    Raises:
        Failure: as of `decompose`.
    """
    make = Recorder()
    numbers: dict[str, Expression] = {}

    def change(path: str, value: Any, _: Any) -> Any:
        if path not in paths:
            return value
        number = given(make, path, sampled=False)
        numbers[path] = number.x
        return number

    opened = with_numbers(scene, change)
    whole = decompose(opened)
    linkage = Linkage(whole.driver, whole.groups, whole.bodies, whole.carries, whole.arm, tracks={})
    driven: Any = Driven(*(given(make, name, sampled=True) for name in SAMPLED))  # type: ignore[arg-type]
    rate = getattr(opened.drive, "speed", None)
    if isinstance(rate, Traced):
        driven = driven._replace(rate=rate, acceleration=traced(make, 0.0))
    k = RecordedPass(make, opened, linkage, driven).solve().k
    request = Sampling(channels=None if channels is None else frozenset(channels))
    on = Reactions()
    if request.wants_forces(scene):
        presses = (number for number, load in enumerate(scene.loads) if isinstance(load, PressForce))
        ends: Any = {number: given(make, stroke_end(number), sampled=False) for number in presses}
        on = RecordedBalance(opened, linkage, ends, k).solve(request.channels)
    found: dict[str, Expression] = {}
    for (x, y), take in vector_channels(scene):
        if request.channels is None or {x, y} & request.channels:
            vector: Any = take(k, on)
            both = (x, traced(make, vector).x), (y, traced(make, vector).y)
            found |= {name: one for name, one in both if request.channels is None or name in request.channels}
    singular_values = {f"{group.P}.to_lock" for group in linkage.groups if isinstance(group, Group)}
    for (name,), take in scalar_channels(scene, linkage.groups):
        if (request.channels is None or name in request.channels) and name not in singular_values:
            found[name] = traced(make, take(k, on)).x
    least: Any = traced(make, np.inf)
    for reach in k.reach.values():
        least = np.minimum(least, reach)
    for branch in (group.branch for group in linkage.groups if not isinstance(group, Group)):
        if isinstance(branch, Traced):  # where the sketch leaves it open it is not a number
            least = np.minimum(least, chosen(branch * branch > 0, 1.0, -1.0))
    return Program(make, numbers, found, least.x)


def coordinates(scene: Scene, k: Kinematics, linkage: Linkage) -> dict[str, Samples]:
    """Return the inputs that are the poses of larger groups."""
    found: dict[str, Samples] = {}
    for body in (body for group in linkage.groups if isinstance(group, Group) for body in group.bodies):
        z = k.z[scene.bodies[body].points[0]]
        found |= {f"{body}.x": z.real, f"{body}.y": z.imag, f"{body}.angle": np.angle(k.u[body])}
    return found


def stroke_end(number: int) -> str:
    """Return the name of the input that is where a press force's stroke ends, m, by the number of the load."""
    return f"stroke_end.{number}"

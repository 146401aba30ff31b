"""Exact derivatives of every channel by numbers of the scene: forward differentiation of the recorded formulas.

The formulas are recorded with these numbers open, differentiated once by each, and run as one line at all positions.
Positions of the drive stay as they are; instants that follow from them change with the drive's start and speed. Where
a position is not reached the core's `Failure` says so; where friction takes more than a line, derivatives are NaN.
"""

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.arguments import finite_numbers, names
from scenes.file.changes import at_path
from scenes.model.inputs import passing
from scenes.model.motion import Samples

from ..solve import solver
from .arithmetics.in_numpy import StraightLine
from .expressions import Expression, forward
from .program import inputs_at, recorded
from .traced import traced


def derivatives(
    scene: Scene,
    numbers: Sequence[str],
    position: ArrayLike,
    time: ArrayLike | None = None,
    channels: AbstractSet[str] | None = None,
) -> Mapping[str, Samples]:
    """Return the derivatives of channels by numbers of the scene, at positions of the drive that stay as they are.

    Args:
        scene: the mechanism.
        numbers: p paths in its file (`bodies.rocker.lengths.O-P3`).
        position: as of `solve`, shape (n,).
        time: as of `solve`.
        channels: as of `solve`.

    Returns:
        By channel, shape (p, n): its unit (`scenes.channels`) over the file's unit of each number.

    Raises:
        Failure: as of `solve`.
        InputError: there is no number at a path, or one that cannot differ.
        InputError: as of `solve`.
    """
    return derivative_solver(scene, numbers, channels)(position, time)


@np.errstate(all="ignore")  # of constants
def derivative_solver(
    scene: Scene, numbers: Sequence[str], channels: AbstractSet[str] | None = None
) -> Callable[..., Mapping[str, Samples]]:
    """Return `derivatives` by position and time for many calls: the formulas are differentiated only once."""
    solve = solver(scene, channels)
    keys = [at_path(scene, path) for path in names("numbers", numbers)]
    program = recorded(scene, {*keys}, channels)
    make, wanted, rows = program.make, [*program.channels.values()], list[Expression]()
    zero, instant = make.constant(0.0), make.input("time", sampled=True)
    follows = make.input("time follows", sampled=False)  # 1 where it is not given
    rate = make("negative", make("divide", follows, traced(make, getattr(program.linkage.drive.law, "speed", 1.0)).x))
    # Positions stay, and instants follow from them: t = (x - start) / speed has the derivatives -1 / speed and -t /
    # speed, but where instants are given.
    by_drive = {"drive.start": rate, "drive.speed": make("multiply", instant, rate)}  # of (position - start) / speed
    for key in keys:
        given = {make.input(key, sampled=False): make.constant(1.0), instant: by_drive.get(key, zero)}
        rows += forward(make, wanted, given)
    line = StraightLine([*rows, program.reach])
    values = {key: scene.numbers[key].value for key in keys}
    units = np.array([scene.size(scene.numbers[key]) for key in keys])[:, np.newaxis]

    def at(position: ArrayLike, time: ArrayLike | None = None) -> Mapping[str, Samples]:
        position = finite_numbers("position", position)
        inputs = passing(scene, position, time)
        instants, driven = inputs.time, inputs.driven()
        solve.check_hull(position)
        given = {**solve.given_at(driven.position, instants), **inputs_at(driven, [solve.linkage.tracks])}
        found = line({**values, **given, "time follows": float(time is None)})[:, 0]
        if not (found[-1] >= 0).all():
            solve(position, time)  # which tells where it does not reach
            found[:, ~(found[-1] >= 0)] = np.nan  # where friction takes more than the line
        by_number = found[:-1].reshape(len(keys), len(program.channels), len(position))
        return {name: by_number[:, c] * units for c, name in enumerate(program.channels)}

    return at

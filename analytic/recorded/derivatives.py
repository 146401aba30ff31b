"""Exact derivatives of every channel by numbers of the scene: forward differentiation of the recorded formulas."""

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.arguments import finite_numbers, names
from scenes.file.changes import at_path
from scenes.model.motion import Samples

from ..solve import driven_at, solver
from .arithmetics.in_numpy import StraightLine
from .expressions import Expression, needed
from .forward import forward
from .program import Program, recorded
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
        By channel, shape (p, n): its unit (`scenes.model.motion.UNITS`) over the file's unit of each number.

    Raises:
        Failure: as of `solve`.
        InputError: there is no number at a path, or one that cannot differ.
        InputError: as of `solve`.
    """
    return derivative_solver(scene, numbers, channels)(position, time)


def derivative_solver(
    scene: Scene, numbers: Sequence[str], channels: AbstractSet[str] | None = None
) -> Callable[..., Mapping[str, Samples]]:
    """Return `derivatives` by position and time for many calls: the formulas are differentiated only once."""
    solve = solver(scene, channels)
    keys = [at_path(scene, path) for path in names("numbers", numbers)]
    program = recorded(scene, {*keys}, channels)
    zero, order, rows = program.make.constant(0.0), needed(program.channels.values()), []
    by_drive = _of_instants(program)
    for key in keys:
        d = forward(program.make, order, {program.numbers[key]: program.make.constant(1.0), **by_drive.get(key, {})})
        rows += [d.get(made.order, zero) for made in program.channels.values()]
    line = StraightLine([*rows, program.reach])
    values = {key: scene.numbers[key].value for key in keys}
    units = np.array([scene.size(scene.numbers[key]) for key in keys])[:, np.newaxis]

    def at(position: ArrayLike, time: ArrayLike | None = None) -> Mapping[str, Samples]:
        position = finite_numbers("position", position)
        instants, driven = driven_at(scene, position, time)
        found = line({**values, **solve.inputs_at(driven, instants), "time follows": float(time is None)})[:, 0]
        if not (found[-1] >= 0).all():
            solve(position, time)  # which tells where it does not reach
        by_number = found[:-1].reshape(len(keys), len(program.channels), len(position))
        return {name: by_number[:, c] * units for c, name in enumerate(program.channels)}

    return at


def _of_instants(program: Program) -> dict[str, dict[Expression, Expression]]:
    """How the instants change by numbers of the drive, where they are (position - start) / speed."""
    make = program.make
    time, follows = make.input("time", sampled=True), make.input("time follows", sampled=False)
    speed = traced(make, getattr(program.scene.drive, "speed", 1.0)).x
    rate = make("negative", make("divide", follows, speed))
    return {"drive.start": {time: rate}, "drive.speed": {time: make("multiply", time, rate)}}

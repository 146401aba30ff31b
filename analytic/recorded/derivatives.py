"""Exact derivatives of every channel by numbers of the scene: forward differentiation of the recorded formulas."""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.arguments import finite_numbers, names
from scenes.file.machines import at_path
from scenes.model.motion import Samples

from ..solve import Solver, driven_at, solver
from .arithmetics.in_numpy import StraightLine
from .expressions import Expression, needed
from .forward import forward
from .program import Program, inputs_at, recorded


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
) -> "DerivativeSolver":
    """Return `derivatives` for many calls, with what it raises: the formulas are recorded and differentiated only once.

    Args:
        scene: as of `derivatives`.
        numbers: likewise.
        channels: likewise.
    """
    solve = solver(scene, channels)
    keys = [at_path(scene, path) for path in names("numbers", numbers)]
    program = recorded(scene, {*keys}, channels)
    rows = [d[channel] for d in differentiated(program, keys) for channel in program.channels]
    units = np.array([scene.size(scene.numbers[key]) for key in keys])
    return DerivativeSolver(
        solve,
        {key: scene.numbers[key].value for key in keys},
        tuple(program.channels),
        units,
        StraightLine([*rows, program.reach]),
    )


@dataclass(frozen=True)
class DerivativeSolver:
    """The derivatives of one scene, prepared for many calls."""

    solve: Solver
    numbers: Mapping[str, float]  # p, SI, by path
    channels: tuple[str, ...]
    units: Samples  # of the file, SI, shape (p,)
    line: StraightLine  # of all channels by the first number, then by the next, and of the reach

    def __call__(self, position: ArrayLike, time: ArrayLike | None = None) -> Mapping[str, Samples]:
        """The derivatives, as `derivatives` has them, with what it raises."""
        position = finite_numbers("position", position)
        _, driven = driven_at(self.solve.scene, position, time)
        machine, samples = inputs_at(driven, [self.solve.linkage.tracks])
        rows = self.line({**self.numbers, **self.solve.ends, **machine}, samples)[:, 0]
        if not (rows[-1] >= 0).all():
            self.solve(position, time)  # which tells where it does not reach
        by_number = rows[:-1].reshape(len(self.numbers), len(self.channels), len(position))
        return {name: by_number[:, c] * self.units[:, np.newaxis] for c, name in enumerate(self.channels)}


def differentiated(program: Program, keys: Sequence[str]) -> list[dict[str, Expression]]:
    """Return for each number the derivatives of all channels."""
    zero, order = program.make.constant(0.0), needed(program.channels.values())
    by_number = []
    for key in keys:
        d = forward(program.make, order, {program.numbers[key]: program.make.constant(1.0)})
        by_number.append({channel: d.get(made.order, zero) for channel, made in program.channels.items()})
    return by_number

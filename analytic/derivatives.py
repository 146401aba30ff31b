"""Exact derivatives of every channel by numbers of the scene: forward differentiation of the recorded formulas."""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.arguments import finite_numbers, names
from scenes.machines import at_path, numbers_of
from scenes.motion import Samples

from .expressions import Expression, needed
from .forward import forward
from .kinematics import kinematics
from .program import Program, coordinates, recorded, stroke_end
from .solve import check_reach, driven_at, solver
from .straight_line import StraightLine


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
        By channel, shape (p, n): its unit (`scenes.motion.UNITS`) over the file's unit of each number.

    Raises:
        Failure: as of `solve`.
        InputError: there is no number at a path, or one that cannot differ.
        InputError: as of `solve`.
    """
    solve = solver(scene, channels)
    known = numbers_of(scene)
    keys = [at_path(scene, path, known) for path in names("numbers", numbers)]
    program = recorded(scene, {*keys}, channels)
    position = finite_numbers("position", position)
    _, driven = driven_at(scene, position, time)
    with np.errstate(invalid="ignore", divide="ignore"):  # where a group does not reach, which is refused
        k = kinematics(scene, solve.linkage, driven, rates=False)
    check_reach(scene, solve.linkage, k, position)
    values = {key: known[key][0] for key in keys}
    values |= {stroke_end(number): end for number, end in solve.stroke_ends.items()}
    found = differentiated(program, keys)
    pairs = [(channel, key) for channel in program.channels for key in range(len(keys))]
    line = StraightLine([found[key][channel] for channel, key in pairs])
    rows = line(values, {**driven._asdict(), **coordinates(scene, k, solve.linkage)})[:, 0]
    units = np.array([known[key][1] for key in keys])[:, None]
    return {
        channel: rows[number * len(keys) : (number + 1) * len(keys)] * units
        for number, channel in enumerate(program.channels)
    }


def differentiated(program: Program, keys: Sequence[str]) -> list[dict[str, Expression]]:
    """Return for each number the derivatives of all channels."""
    zero, order = program.make.constant(0.0), needed(program.channels.values())
    found = []
    for key in keys:
        d = forward(program.make, order, {program.numbers[key]: program.make.constant(1.0)})
        found.append({channel: d.get(made.order, zero) for channel, made in program.channels.items()})
    return found

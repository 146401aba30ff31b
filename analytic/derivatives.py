"""Exact derivatives of every channel by numbers of the scene: forward differentiation of the recorded formulas."""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.machines import at_path, numbers_of
from scenes.motion import Samples

from .expressions import Expression, Recorder
from .program import Program, needed, recorded, stroke_end
from .solve import driven_at, solver
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
        ValueError: as of `solve`.
    """
    solve = solver(scene, channels)
    solve(position, time)  # which refuses what does not assemble
    known = numbers_of(scene)
    keys = [at_path(scene, path, known) for path in numbers]
    program = recorded(scene, {*keys}, channels)
    position = np.asarray(position, np.float64)
    _, driven = driven_at(scene, position, time)
    values = {key: known[key][0] for key in keys}
    values |= {stroke_end(number): end for number, end in solve.stroke_ends.items()}
    found = differentiated(program, keys)
    names = [(channel, key) for channel in program.channels for key in range(len(keys))]
    rows = StraightLine([found[key][channel] for channel, key in names])(values, driven)
    units = np.array([known[key][1] for key in keys])[:, None]
    return {
        channel: rows[number * len(keys) : (number + 1) * len(keys)] * units
        for number, channel in enumerate(program.channels)
    }


def differentiated(program: Program, keys: Sequence[str]) -> list[dict[str, Expression]]:
    """Return for each number the derivatives of all channels."""
    order = needed(program.channels.values())
    return [_by(program, order, program.numbers[key]) for key in keys]


def _by(program: Program, order: Sequence[Expression], number: Expression) -> dict[str, Expression]:
    make = program.make
    zero = make.constant(0.0)
    d: dict[int, Expression] = {number.order: make.constant(1.0)}
    for expression in order:
        if any(isinstance(one, Expression) and one.order in d for one in expression.of):
            change = _rule(make, expression, [d.get(one.order, zero) for one in expression.of])
            if change is not zero:
                d[expression.order] = change
    return {channel: d.get(expression.order, zero) for channel, expression in program.channels.items()}


def _rule(make: Recorder, y: Expression, d: Sequence[Expression]) -> Expression:
    """Return the derivative of an operation, given those of what it is of."""
    of = y.of
    match y.operation:
        case "add" | "subtract" | "negative":
            return make(y.operation, *d)
        case "multiply":
            return make("add", make("multiply", d[0], of[1]), make("multiply", of[0], d[1]))
        case "divide":
            over = make("divide", make.constant(1.0), of[1])
            return make("multiply", make("subtract", d[0], make("multiply", y, d[1])), over)
        case "sqrt":
            return make("multiply", d[0], make("divide", make.constant(0.5), y))
        case "sin":
            return make("multiply", make("cos", of[0]), d[0])
        case "cos":
            return make("negative", make("multiply", make("sin", of[0]), d[0]))
        case "arctan2":
            square = make("add", make("multiply", of[0], of[0]), make("multiply", of[1], of[1]))
            turn = make("subtract", make("multiply", of[1], d[0]), make("multiply", of[0], d[1]))
            return make("multiply", turn, make("divide", make.constant(1.0), square))
        case "absolute":
            return make("where", make("less", of[0], make.constant(0.0)), make("negative", d[0]), d[0])
        case "minimum":
            return make("where", make("less_equal", *of), *d)
        case "maximum":
            return make("where", make("less_equal", *of), d[1], d[0])
        case "where":
            return make("where", of[0], d[1], d[2])
    return make.constant(0.0)  # of a comparison

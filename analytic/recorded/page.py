"""The core's recorded line for a page: the same formulas as JavaScript, with the inputs that a script cannot find."""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.arguments import finite_numbers
from scenes.model.inputs import passing

from ..core.groups.group_equations import Group
from ..solve import solver
from .arithmetics.loops import Language, Loop
from .balances import BALANCE
from .expressions import SIGNS, Expression
from .program import recorded
from .traced import traced

FIXED = ("drive.start",)  # positions are counted from there
OPERATIONS = {**SIGNS, "absolute": "Math.abs({})", "where": "({} ? {} : {})"}
OPERATIONS |= {"arctan2": "Math.atan2({}, {})", "minimum": "Math.min({}, {})", "maximum": "Math.max({}, {})"}
JAVASCRIPT = Language(OPERATIONS, "Math.{name}({})", "number[{}]", "given[{}][i]", "const {} = {};")
FUNCTION = """(number, given, row, count) => {{
const inf = Infinity, nan = NaN;
{of_number}
for (let i = 0; i < count; i++) {{
{of_position}
}}
}}"""


def page_program(
    scene: Scene, position: ArrayLike, time: ArrayLike | None = None, channels: AbstractSet[str] | None = None
) -> Mapping[str, Any] | None:
    """Return what a page needs to solve a scene by itself; None of one with a larger group, which takes iterations.

    Args:
        scene: the mechanism.
        position: of the drive, rad or m, shape (n,).
        time: the instants, s, shape (n,), as of `solve`.
        channels: as of `solve`.

    Returns:
        `numbers`, the paths of the numbers that stay open, and their `values`, SI; `channels`, by name; `line`, the
        text of a function of numbers, of arrays for each position, of arrays to fill, one a channel and the reach, and
        of how many positions there are; `given`, the values of its arrays at these positions, by name; `strokes`, by
        the input that each finds, the `text` of a function of the same kind, of its `numbers` and what is `given`, for
        a slider's displacement, m, its rate and the sign in which it closes; `gaps`, a `text` of the same kind that is
        negative where one of `joints` does not close, the first of them being why the others do not; where that is
        `balance`, a few steps do not find what may be there; `loads`, a `text` of the same kind that fills the force
        along x and along y, N, of each load at its `places` in the file.

    Raises:
        Failure: as of `solver`.
        InputError: as of `solver`.
    """
    core = solver(scene, channels)
    inputs = passing(scene, finite_numbers("position", position), time)
    instants, driven = inputs.time, inputs.driven()
    if any(isinstance(group, Group) for group in core.linkage.groups):
        return None
    program = recorded(scene, scene.numbers.keys() - FIXED, core.request.channels)
    line = script(program.rows)
    given = {**core.given_at(driven.position, instants), **driven._asdict()}
    sense = {place: traced(program.make, load.closing).x for place, load in program.scene.presses.items()}
    values = {**{path: number.value for path, number in scene.numbers.items()}, **core.stroke_ends}
    return {
        "numbers": line["numbers"],
        "values": [float(values[name]) for name in line["numbers"]],
        "channels": [*program.channels],
        "line": line["text"],
        "given": {name: np.broadcast_to(given[name], instants.shape) for name in line["given"]},
        "strokes": {place: script([*moved, sense[place]]) for place, moved in program.strokes.items()},
        "loads": {
            "places": [*program.loads],
            **script([part for load in program.loads.values() for part in (load.x, load.y)]),
        },
        "gaps": {
            "balance": BALANCE,
            "joints": [name.partition(" (")[0] for name in program.conditions],
            **script([*program.conditions.values()]),
        },
    }


def script(expressions: Sequence[Expression]) -> Mapping[str, Any]:
    """The function that fills as many arrays with the values of expressions, none of them a larger group's.

    Its `text` in JavaScript is of `numbers`, of arrays for each position, by name `given`, each in this order, of the
    arrays to fill and of their length.
    """
    loop = Loop(expressions, JAVASCRIPT)
    rows = (f"row[{row}][i] = {value};" for row, value in enumerate(loop.values))
    text = FUNCTION.format(of_number="\n".join(loop.of_number), of_position="\n".join([*loop.of_position, *rows]))
    return {"text": text, "numbers": loop.numbers, "given": [entry.of[0] for entry in loop.given]}

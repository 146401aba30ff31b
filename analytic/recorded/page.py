"""The core's recorded line for a page: the same formulas as JavaScript, with the inputs that a script cannot find."""

from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from scenes import Scene
from scenes.arguments import finite_numbers

from ..core.groups.group_equations import Group
from ..solve import driven_at, solver
from .arithmetics.in_javascript import script
from .program import recorded
from .traced import traced

FIXED = ("drive.start",)  # positions are counted from there


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
        negative where one of `joints` does not close, the first of them being why the others do not.

    Raises:
        Failure: as of `solver`.
        InputError: as of `solver`.
    """
    core = solver(scene, channels)
    instants, driven = driven_at(scene, finite_numbers("position", position), time)
    if any(isinstance(group, Group) for group in core.linkage.groups):
        return None
    program = recorded(scene, scene.numbers.keys() - FIXED, core.request.channels)
    line = script(program.rows)
    given = {**core.given_at(driven.position, instants), **driven._asdict()}
    sense = {place: traced(program.make, load.closing).x for place, load in program.scene.presses.items()}
    ends = {place: script([*of, sense[place]])._asdict() for place, of in program.strokes.items()}
    values = {**{path: number.value for path, number in scene.numbers.items()}, **core.stroke_ends}
    return {
        "numbers": line.numbers,
        "values": [float(values[name]) for name in line.numbers],
        "channels": [*program.channels],
        "line": line.text,
        "given": {name: np.broadcast_to(given[name], instants.shape) for name in line.given},
        "strokes": ends,
        "gaps": {
            "joints": [name.partition(" (")[0] for name in program.conditions],
            **script([*program.conditions.values()])._asdict(),
        },
    }

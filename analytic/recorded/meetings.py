"""Machines of which two assemblies may meet: of each a closer look is worth its time.

How far a dyad reaches is a parabola around a place where two of its assemblies meet, and zero there. Of samples around
it the least is then at most half of the larger one beside it. Few machines have such samples without such a place.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeAlias

import numpy as np

from scenes import Failure, Scene, Status
from scenes.drive import Driven
from scenes.model.motion import Samples

from ..core.groups.continuation import Track
from ..core.groups.group_equations import Group
from ..solve import Solver
from ..way.singular import way_of
from .program import Program, inputs_at

Ending: TypeAlias = tuple[Status, str]  # of a machine, and why it is not ok

COARSE = 45  # samples of a turn, or of a way
MAX_TOGETHER = 256  # machines
ZERO_TOL = 1e-6  # of the larger sample beside: what a place leaves where it is a sample


def meeting(near: Iterable[int], core: Callable[[int], Solver], position: Samples) -> dict[int, Ending]:
    """How machines end whose assemblies meet between positions, (n,) or (m, n), and the sketch, of some that are near.

    `core` is the solver of one machine.
    """
    found = dict[int, Ending]()
    for machine in near:
        try:
            core(machine).check_hull(position[machine] if position.ndim == 2 else position)
        except Failure as failure:
            found[machine] = failure.status, failure.reason
    return found


@np.errstate(all="ignore")  # of machines that do not reach
def near_meeting(
    scene: Scene, program: Program, numbers: Mapping[str, Samples], tracks: Sequence[Mapping[Group, Track]]
) -> Sequence[int]:
    """The machines, of numbers of shape (m, 1), whose assemblies may meet somewhere."""
    if program.reaches is None:
        return []
    line, (first, last) = program.reaches, way_of(scene, program.linkage)
    if program.linkage.drive.slide is None:  # a turn to either side of the sketch is the same turn
        first = (first + last) / 2
    known = {path: number.value for path, number in scene.numbers.items()}  # the line may be of numbers all alike too
    step, near = (last - first) / COARSE, list[int]()
    driven = Driven(np.linspace(first - step, last + step, COARSE + 3), np.ones(()), np.zeros(()))
    for begin in range(0, len(tracks), MAX_TOGETHER):
        rows = slice(begin, begin + MAX_TOGETHER)
        of_some = known | {path: values[rows] for path, values in numbers.items()}
        reach = np.asarray(line({**of_some, **inputs_at(driven, tracks[rows])}))  # shape (dyads, m, n)
        # The reach is the square of a distance near a meeting, hence a parabola with its zero there: between two
        # samples the lower is at most half of the larger neighbour's. A screen only: what passes is looked at by the
        # core.
        before, here, after = reach[..., :-2], reach[..., 1:-1], reach[..., 2:]
        larger = np.maximum(before, after)
        lowest = (here >= -ZERO_TOL * larger) & (here <= before) & (here <= after) & (2 * here <= larger)
        near += (begin + np.flatnonzero(lowest.any(axis=(0, 2)))).tolist()
    return near

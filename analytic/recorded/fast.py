"""One machine in many calls at few positions: by the line of its formulas, in machine code if possible."""

from collections.abc import Mapping
from collections.abc import Set as AbstractSet

from numpy.typing import ArrayLike

from scenes import Failure, InputError, Scene, Status

from ..solve import Solver, solver
from .arithmetics.in_numpy import StraightLine
from .arithmetics.machine_code import COMPILES, MachineCode, operations
from .many import Machines, ManySolver, many_solver
from .program import recorded

LARGEST = 1000  # operations, of which machine code is made in some 4 s; of twice as many in three times that


def fast_solver(
    scene: Scene, channels: AbstractSet[str] | None = None, *, compiled: bool | None = None
) -> "FastSolver":
    """Return `solver` for many calls at few positions, or for many machines: the core's formulas in a straight line.

    Machine code, for which numba is needed, takes seconds to make, and is kept on disk for the topology.

    Args:
        scene: the mechanism.
        channels: as of `solve`.
        compiled: whether the line is machine code, or else NumPy calls; None for machine code where it is soon made.

    Raises:
        Failure: as of `solver`; `unsupported` for machine code of a group that is solved by Newton's method.
        InputError: as of `solver`, or there is no numba for machine code.
    """
    core = solver(scene, channels)
    if compiled and not COMPILES:
        raise InputError("compiled: expected numba to be installed, as by the extra 'compiled'")
    if compiled or (compiled is None and COMPILES):
        # all numbers are open, so that the code is one for the topology
        program = recorded(scene, scene.numbers.keys(), core.request.channels)
        count = operations(program.rows)
        if compiled and count is None:
            raise Failure(Status.unsupported, "a group that is solved by Newton's method has no machine code")
        if count is not None and (compiled or count <= LARGEST):
            known = {path: number.value for path, number in scene.numbers.items()}
            line = MachineCode(program.rows, {**known, **core.stroke_ends})
            return FastSolver(**vars(core) | {"at_hand": (program, line)})
    program = recorded(scene, frozenset(), core.request.channels)
    return FastSolver(**vars(core) | {"at_hand": (program, StraightLine(program.rows))})


class FastSolver(Solver):
    """One topology, prepared for many calls, of many machines too."""

    def many(self, changes: Mapping[str, ArrayLike], position: ArrayLike, time: ArrayLike | None = None) -> Machines:
        """Solve as `solve_many` does, with what it returns and raises."""
        return self.many_solver(changes)(position, time)

    def many_solver(self, changes: Mapping[str, ArrayLike]) -> ManySolver:
        """Return `many` for many calls, with what it raises."""
        all_open = self.at_hand is not None and isinstance(self.at_hand[1], MachineCode)
        return many_solver(self.scene, changes, self.request.channels, self.at_hand if all_open else None)

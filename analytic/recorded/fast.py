"""`solve` for many calls at few positions, and for many machines: by the recorded line, in machine code if possible."""

from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass

from numpy.typing import ArrayLike

from scenes import Failure, InputError, Motion, Scene, Status
from scenes.arguments import finite_numbers

from ..solve import Solver, driven_at, solver
from .arithmetics.in_numpy import StraightLine
from .arithmetics.machine_code import COMPILES, MachineCode, operations
from .arithmetics.walk import Line
from .many import Machines, ManySolver, machines_of, many_by_line, many_solver
from .program import Program, inputs_at, recorded

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
            return FastSolver(core, program, MachineCode(program.rows, known | core.ends))
    program = recorded(scene, frozenset(), core.request.channels)
    return FastSolver(core, program, StraightLine(program.rows))


@dataclass(frozen=True)
class FastSolver:
    """One topology, prepared for many calls."""

    core: Solver
    program: Program
    line: Line

    def __call__(self, position: ArrayLike, time: ArrayLike | None = None) -> Motion:
        """Solve as `solve` does, with what it returns and raises."""
        core, position = self.core, finite_numbers("position", position)
        instants, driven = driven_at(core.scene, position, time)
        machine, samples = inputs_at(driven, [core.linkage.tracks])
        rows = self.line({**core.ends, **machine}, samples)[:, 0]
        if self.program.own or not (rows[-1] >= 0).all():
            return core(position, time)  # which names the place, or finds it to be none
        channels = dict(zip(self.program.channels, rows, strict=False))
        channels |= {"time": instants, core.scene.drive_channel: position}
        return Motion({name: channels[name] for name in self.program.names})

    def many(self, changes: Mapping[str, ArrayLike], position: ArrayLike, time: ArrayLike | None = None) -> Machines:
        """Solve as `solve_many` does, with what it returns and raises."""
        return self.many_solver(changes)(position, time)

    def many_solver(self, changes: Mapping[str, ArrayLike]) -> ManySolver:
        """Return `many` for many calls, with what it raises."""
        scene = self.core.scene
        if isinstance(self.line, MachineCode):
            return many_by_line(scene, *machines_of(scene, changes), self.program, self.line)
        return many_solver(scene, changes, self.core.request.channels)

"""One machine in many calls at few positions: by the line of its formulas, in machine code if possible.

The line is a sequence of NumPy calls, or a loop that numba compiles. Machine code has all numbers of the scene open, so
that it is one for the topology, and is kept on disk. It is made of few operations alone, since compiling takes longer
than in proportion to them, and of none where Newton's method closes a group.
"""

import sys
from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from dataclasses import replace
from functools import cached_property, lru_cache
from math import nan

import numpy as np
from numpy.typing import ArrayLike

from scenes import Failure, InputError, Motion, Scene, Status
from scenes.channels import Role
from scenes.model.inputs import Inputs
from scenes.model.lookup import Rows
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed

from ..solve import Solver, solver
from .arithmetics.in_numpy import StraightLine
from .arithmetics.machine_code import CHUNK, COMPILES, MachineCode, operations
from .expressions import Line
from .many import Machines, ManySolver, many_solver
from .program import Program, recorded

MAX_OPERATIONS = 1000  # of which machine code is made in some 4 s; of twice as many in three times that
MIN_SAMPLES = 1_000_000  # of which machine code saves more than it takes to record the formulas anew
MIN_SAMPLES_TO_IMPORT = 30_000_000  # numba: it saves the second or two that this takes
MIN_SAMPLES_TO_COMPILE = 100_000_000  # it saves the seconds that machine code takes to make


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
        program = _opened(scene, core.request.channels)
        count = operations(program.rows)
        if compiled and count is None:
            raise Failure(Status.unsupported, "a group that is solved by Newton's method has no machine code")
        if count is not None and (compiled or count <= MAX_OPERATIONS):
            known = {path: number.value for path, number in scene.numbers.items()}
            line = MachineCode(program.rows, {**known, **core.stroke_ends})
            return FastSolver(**vars(core) | {"at_hand": (program, line)})
    program = recorded(scene, frozenset(), core.request.channels)
    return FastSolver(**vars(core) | {"at_hand": (program, StraightLine(program.rows))})


def _opened(scene: Scene, channels: frozenset[str] | None) -> Program:
    """The formulas with all numbers open, so that the code is one for the topology; arcs last, for one call."""
    program = recorded(scene, scene.numbers.keys(), channels)
    last = sorted(program.channels.items(), key=lambda channel: channel[1].operation == "arctan2")
    return replace(program, channels=dict(last))


@lru_cache(maxsize=4)
def machine_line(scene: Scene, channels: frozenset[str] | None, samples: int) -> tuple[Program, Line] | None:
    """The formulas of many machines in machine code, where it is at hand, or so many samples are worth making it."""
    if not COMPILES or samples < (MIN_SAMPLES if "numba" in sys.modules else MIN_SAMPLES_TO_IMPORT):
        return None
    program = _opened(scene, channels)
    count = operations(program.rows)
    if count is None or count > MAX_OPERATIONS:
        return None
    known = {path: number.value for path, number in scene.numbers.items()}
    line = MachineCode(program.rows, known | dict.fromkeys(program.strokes, nan))  # whose ends each machine has
    return (program, line) if line.at_hand or samples >= MIN_SAMPLES_TO_COMPILE else None


class FastSolver(Solver):
    """One topology, prepared for many calls, of many machines too."""

    def __call__(self, position: ArrayLike | Inputs, time: ArrayLike | None = None) -> Motion:
        """Solve as `Solver` does; few positions at a constant speed by machine code without a detour."""
        if time is None and type(position) is np.ndarray and 0 < position.size <= CHUNK:
            return self._at_once(position) or super().__call__(position)
        return super().__call__(position, time)

    def _at_once(self, position: Samples) -> Motion | None:
        """The same, shape (n,); None where it has to be looked at closer, or there is no machine code for it."""
        code, law = self._code, self.linkage.drive.law
        plain = position.dtype == np.float64 and position.ndim == 1
        if code is None or not plain or not np.isfinite(position).all() or not isinstance(law, ConstantSpeed):
            return None
        if self._way is not None and not (self._way[0] <= position.min() and position.max() <= self._way[1]):
            return None
        # One array for all: the line's rows with the reach last, then instants and positions, which are also inputs;
        # channels are views of it.
        rows = np.empty((len(code) + 2, 1, len(position)))
        reach, instants, positions = rows[-3:, 0]
        positions[:] = position
        np.divide(positions - law.start, law.speed, out=instants)
        code.of_known({"position": positions, "time": instants}, rows[:-2])
        return Motion(Rows(self._places, rows[:, 0])) if reach.min() >= 0 else None

    @cached_property
    def _code(self) -> MachineCode | None:
        """The line, if it is machine code of the time and the position alone, and no assemblies meet on the way."""
        if self.meetings.nearest:
            return None
        line = self.at_hand[1] if self.at_hand else None
        return line if isinstance(line, MachineCode) and line.driven <= {"position", "time"} else None

    @cached_property
    def _way(self) -> tuple[float, float] | None:
        """From where to where, m, a driven slider is known to have no place where assemblies meet; none of a crank."""
        return None if self.linkage.drive.slide is None else (self.meetings.first, self.meetings.last)

    @cached_property
    def _places(self) -> Mapping[str, int]:
        """By channel wanted its place among the line's rows, which the time and the position follow."""
        assert self.at_hand is not None
        rows = [*self.at_hand[0].channels, "reach", *self.scene.channels.names(Role.time, Role.input)]
        return {channel: rows.index(channel) for channel in (*self.known, *self.own)}

    def many(self, changes: Mapping[str, ArrayLike], position: ArrayLike, time: ArrayLike | None = None) -> Machines:
        """Solve as `solve_many` does, with what it returns and raises."""
        return self.many_solver(changes)(position, time)

    def many_solver(self, changes: Mapping[str, ArrayLike]) -> ManySolver:
        """Return `many` for many calls, with what it raises."""
        all_open = self.at_hand is not None and isinstance(self.at_hand[1], MachineCode)
        return many_solver(self.scene, changes, self.request.channels, self.at_hand if all_open else None)

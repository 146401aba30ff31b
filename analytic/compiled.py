"""The core's recorded formulas for one topology as machine code: the second, faster route to the same numbers.

The code is kept on disk by its own text, which has a topology's numbers as arguments. Whatever does not reach, or is
not finite, is left to the core, which names it.
"""

import sys
from collections.abc import Callable, Iterator, Mapping
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, field
from functools import cache, cached_property
from hashlib import sha256
from importlib.util import find_spec, module_from_spec, spec_from_file_location
from os import environ, getpid
from pathlib import Path
from typing import Any, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from scenes import Failure, Motion, Scene, Status
from scenes.drive import Driven
from scenes.machines import at_path, numbers_of
from scenes.motion import Samples

from .decomposition import decompose
from .expressions import Expression, needed
from .group_equations import Group
from .many import Machines, many_solver, solve_many
from .program import SAMPLED, Program, recorded, stroke_end
from .solve import Solver, driven_at, solver
from .straight_line import PLAIN, StraightLine

CHUNK = 64  # positions: their results stay in the first cache, and a loop of fixed length becomes vector instructions
COMPILES = find_spec("numba") is not None

Kernel: TypeAlias = Callable[..., None]
Route: TypeAlias = tuple[list[str], Kernel, Program]


def fast_solver(scene: Scene, channels: AbstractSet[str] | None = None) -> "FastSolver":
    """Return `solver` for many calls at few positions, or for many machines: the core's formulas in a straight line.

    With numba they are machine code, which takes seconds to make and is kept on disk for the topology; without it they
    are NumPy calls, and many machines are left to `solve_many`.

    Args:
        scene: the mechanism; its groups are dyads.
        channels: as of `solve`.

    Raises:
        Failure: as of `solver`; `unsupported` for a group that is solved by Newton's method.
    """
    if any(isinstance(group, Group) for group in decompose(scene).groups):
        raise Failure(Status.unsupported, "a group that is solved by Newton's method is no straight line")
    return FastSolver(scene, None if channels is None else frozenset(channels), solver(scene, channels))


@dataclass(frozen=True)
class FastSolver:
    """One topology, prepared for many calls."""

    scene: Scene
    channels: frozenset[str] | None
    core: Solver
    routes: dict[AbstractSet[str], Route] = field(default_factory=dict)  # by the numbers that differ

    def __call__(self, position: ArrayLike, time: ArrayLike | None = None) -> Motion:
        """Solve as `solve` does, with what it returns and raises."""
        position = np.array(position, np.float64)
        instants, driven = driven_at(self.scene, position, time)
        names, rows_at = self._single
        rows = rows_at(driven)
        if not (rows[-1] >= 0).all():
            return self.core(position, time)  # which names the place, or finds it to be none
        return Motion({"time": instants, self.scene.drive_channel: position, **dict(zip(names, rows, strict=False))})

    def many(self, changes: Mapping[str, ArrayLike], position: ArrayLike, time: ArrayLike | None = None) -> Machines:
        """Solve as `solve_many` does, with what it returns and raises."""
        if not COMPILES:
            return solve_many(self.scene, changes, position, time, self.channels)
        scene, position = self.scene, np.asarray(position, np.float64)
        prepared = many_solver(scene, changes, self.channels)
        instants, driven = driven_at(prepared.scene, position, time)
        names, kernel, program = self._route(frozenset(at_path(scene, path, self._numbers) for path in changes))
        given = {path: value for path, (value, _) in numbers_of(prepared.scene).items()}
        given |= {stroke_end(number): end for number, end in prepared.stroke_ends.items()}
        numbers = np.empty((prepared.count, len(names)))
        for column, name in enumerate(names):
            numbers[:, column] = np.ravel(given[name])
        n = position.shape[-1]
        rows = self._filled(kernel, program, numbers, driven, n)
        shape = (prepared.count, n)
        samples = {"time": np.broadcast_to(instants, shape), scene.drive_channel: np.broadcast_to(position, shape)}
        samples |= dict(zip(program.channels, rows, strict=False))
        status, reason = [Status.ok] * prepared.count, [""] * prepared.count
        fine = (rows[-1] >= 0).all(axis=1) & np.isfinite(rows[:-1].sum(axis=(0, 2)))
        fine[list(prepared.failed)] = False
        self._left_to_the_core(np.flatnonzero(~fine), changes, position, time, samples, status, reason)
        return Machines(samples, tuple(status), tuple(reason))

    def _left_to_the_core(
        self,
        which: NDArray[np.intp],
        changes: Mapping[str, ArrayLike],
        position: Samples,
        time: ArrayLike | None,
        samples: Mapping[str, Samples],
        status: list[Status],
        reason: list[str],
    ) -> None:
        """Put in what the core finds of some machines."""
        if not len(which):
            return
        own = position[which] if position.ndim == 2 else position
        when = None if time is None else np.asarray(time)[which] if np.ndim(time) == 2 else time
        some = {path: np.asarray(values)[which] for path, values in changes.items()}
        core = solve_many(self.scene, some, own, when, self.channels)
        for channel, values in samples.items():
            if values.flags.writeable:
                values[which] = core[channel]
        for place, machine in enumerate(which.tolist()):
            status[machine], reason[machine] = core.status[place], core.reason[place]

    @staticmethod
    def _filled(kernel: Kernel, program: Program, numbers: Samples, driven: Any, n: int) -> Samples:
        """Return the values of the channels, and of the reach, shape (channels + 1, m, n)."""
        rows = np.empty((len(program.channels) + 1, len(numbers), n))
        each = max((np.shape(samples)[0] for samples in driven if np.ndim(samples) == 2), default=1)
        given = (np.ascontiguousarray(np.broadcast_to(samples, (each, n))) for samples in driven)
        kernel(numbers, *given, rows)
        return rows

    @cached_property
    def _numbers(self) -> Mapping[str, float]:
        return {path: value for path, (value, _) in numbers_of(self.scene).items()}

    @cached_property
    def _single(self) -> tuple[tuple[str, ...], Callable[[Driven], Samples]]:
        """Return the channels, and the function of the drive that finds them for the one machine."""
        ends = {stroke_end(number): end for number, end in self.core.stroke_ends.items()}
        if not COMPILES:
            program = recorded(self.scene, frozenset(), self.channels)
            line = StraightLine([*program.channels.values(), program.reach])
            return tuple(program.channels), lambda driven: line(ends, driven._asdict())
        names, kernel, program = self._route(frozenset())
        numbers = np.array([[{**self._numbers, **ends}[name] for name in names]])
        return tuple(program.channels), lambda driven: self._filled(
            kernel, program, numbers, driven, len(driven.position)
        )[:, 0]

    def _route(self, open_too: AbstractSet[str]) -> Route:
        """Return the names of the kernel's numbers, the kernel, and what it computes.

        Of numbers that are 0, 1 or -1 and do not differ, which many a frame has, there is nothing to compute.
        """
        opened = {path for path, value in self._numbers.items() if value not in (0.0, 1.0, -1.0)} | open_too
        if open_too in self.routes:
            return self.routes[open_too]
        program = recorded(self.scene, opened, self.channels)
        order = needed([*program.channels.values(), program.reach])
        names = [made.of[0] for made in order if made.operation == "input" and not made.sampled]
        kernel = kernel_of("\n".join(code([*program.channels.values(), program.reach], names)))
        return self.routes.setdefault(open_too, (names, kernel, program))


@cache
def kernel_of(source: str) -> Kernel:
    """Return the function of a text as machine code, from the disk where it was made before."""
    folder = Path(environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "linkage-crosscheck"
    file = folder / f"kernel_{sha256(source.encode()).hexdigest()[:24]}.py"
    try:
        if not file.is_file() or file.read_text(encoding="utf-8") != source:
            folder.mkdir(parents=True, exist_ok=True)
            aside = file.with_suffix(f".{getpid()}")
            aside.write_text(source, encoding="utf-8")
            aside.replace(file)
    except (OSError, UnicodeDecodeError):  # a home that cannot be written: made anew by each process
        run: dict[str, Any] = {}
        exec(source.replace("cache=True, ", ""), run)
        return cast("Kernel", run["kernel"])
    spec = spec_from_file_location(file.stem, file)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[file.stem] = module_from_spec(spec)  # where numba looks for what it kept
    spec.loader.exec_module(module)
    return cast("Kernel", module.kernel)


def code(expressions: list[Expression], names: list[str]) -> Iterator[str]:
    """Yield the lines of a module whose kernel writes expressions for every machine and position.

    Angles come before, and arcs after, the loop of all that vector instructions can do.
    """
    order = needed(expressions)
    rows = {made.order: row for row, made in enumerate(expressions)}
    used = {one.order for made in order for one in made.of if isinstance(one, Expression)}
    name: dict[int, str] = {}
    numbers: list[str] = []
    angles: list[tuple[str, str]] = []
    line: list[str] = []
    arcs: list[tuple[int, str, str]] = []
    for made in order:
        of = [name[one.order] for one in made.of if isinstance(one, Expression)]
        form = PLAIN.get(made.operation, made.operation + "({})")
        name[made.order] = f"e{made.order}"
        if made.operation == "constant":
            name[made.order] = repr(made.of[0])
        elif made.operation == "input":
            place = f"{made.of[0]}[own, first + i]" if made.sampled else f"number[m, {names.index(made.of[0])}]"
            name[made.order] = place
        elif not made.sampled:
            numbers.append(f"e{made.order} = {form.format(*of)}")
        elif made.operation in ("sin", "cos") and SAMPLED[0] in of[0]:
            name[made.order] = f"e{made.order}[i]"
            angles.append((f"e{made.order}", form.format(*of)))
        elif made.operation == "arctan2" and made.order in rows and made.order not in used:
            arcs.append((rows[made.order], of[0], of[1]))
        else:
            line.append(f"e{made.order} = {form.format(*of)}")
    same = {place: rows[made.order] for place, made in enumerate(expressions) if rows[made.order] != place}
    late = {row for row, _, _ in arcs} | same.keys()
    outputs = [(row, name[made.order]) for row, made in enumerate(expressions) if row not in late]
    yield from (
        "from math import atan2, cos, inf, nan, sin, sqrt",
        "",
        "import numpy as np",
        "from numba import njit",
        "",
        "",
    )
    yield '@njit(cache=True, error_model="numpy")'
    yield f"def kernel(number, {', '.join(SAMPLED)}, row):"
    yield f"    buffer = np.empty(({len(expressions) + len(arcs)}, {CHUNK}))"
    yield from (f"    {angle} = np.zeros({CHUNK})" for angle, _ in angles)
    yield "    for m in range(number.shape[0]):"
    yield "        own = m if position.shape[0] > 1 else 0"
    yield from (f"        {text}" for text in numbers)
    yield f"        for first in range(0, position.shape[1], {CHUNK}):"
    yield f"            count = min({CHUNK}, position.shape[1] - first)"
    yield "            for i in range(count):"
    yield from (f"                {angle}[i] = {text}" for angle, text in angles or [("row[0, m, first + i]", "0.0")])
    yield f"            for i in range({CHUNK if angles else 'count'}):"
    yield from (f"                {text}" for text in line)
    yield from (f"                buffer[{row}, i] = {text}" for row, text in outputs)
    besides = range(len(expressions), len(expressions) + len(arcs))  # rows for what the arcs are of
    for beside, (row, y, x) in zip(besides, arcs, strict=True):
        yield f"                buffer[{row}, i] = {y}"
        yield f"                buffer[{beside}, i] = {x}"
    yield "            for i in range(count):"
    for beside, (row, _, _) in zip(besides, arcs, strict=True):
        yield f"                buffer[{row}, i] = atan2(buffer[{row}, i], buffer[{beside}, i])"
    yield from (f"                buffer[{place}, i] = buffer[{row}, i]" for place, row in same.items())
    yield "                pass"
    yield f"            for r in range({len(expressions)}):"
    yield "                for i in range(count):"
    yield "                    row[r, m, first + i] = buffer[r, i]"
    yield ""

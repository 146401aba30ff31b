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
from scenes.arguments import finite_numbers
from scenes.drive import Driven
from scenes.machines import at_path, machines, numbers_of, refused
from scenes.motion import Samples

from .decomposition import decompose
from .expressions import Expression, needed
from .group_equations import Group
from .many import Machines, many_solver, solve_many
from .program import recorded, stroke_end
from .solve import Solver, driven_at, solver
from .straight_line import SIGNS, StraightLine

CHUNK = 64  # positions: their results stay in the first cache
LANES = 8  # positions in a vector instruction, or a multiple of theirs
COMPILES = find_spec("numba") is not None

FORMS = {
    **SIGNS,
    "minimum": "min({}, {})",
    "maximum": "max({}, {})",
    "where": "({1} if {0} else {2})",
    "arctan2": "atan2({}, {})",
}

Kernel: TypeAlias = Callable[..., None]
# Numbers that differ, by path, SI, shape (m,), and the drive's samples -> channels and reach, (channels + 1, m, n)
Rows: TypeAlias = Callable[[Mapping[str, Samples], Driven], Samples]
Route: TypeAlias = tuple[tuple[str, ...], Rows]  # with the names of the channels


def fast_solver(scene: Scene, channels: AbstractSet[str] | None = None) -> "FastSolver":
    """Return `solver` for many calls at few positions, or for many machines: the core's formulas in a straight line.

    With numba they are machine code, which takes seconds to make and is kept on disk for the topology; without it they
    are NumPy calls.

    Args:
        scene: the mechanism; its groups are dyads.
        channels: as of `solve`.

    Raises:
        Failure: as of `solver`; `unsupported` for a group that is solved by Newton's method.
    """
    if any(isinstance(group, Group) for group in decompose(scene).groups):
        raise Failure(Status.unsupported, "a group that is solved by Newton's method is no straight line")
    core = solver(scene, channels)
    return FastSolver(scene, core.request.channels, core)


@dataclass(frozen=True)
class FastSolver:
    """One topology, prepared for many calls."""

    scene: Scene
    channels: frozenset[str] | None
    core: Solver
    routes: dict[AbstractSet[str], Route] = field(default_factory=dict)  # by the numbers that differ

    def __call__(self, position: ArrayLike, time: ArrayLike | None = None) -> Motion:
        """Solve as `solve` does, with what it returns and raises."""
        position = finite_numbers("position", position)
        instants, driven = driven_at(self.scene, position, time)
        names, rows_at = self._single
        rows = rows_at({}, driven)[:, 0]
        if not (rows[-1] >= 0).all():
            return self.core(position, time)  # which names the place, or finds it to be none
        return Motion({"time": instants, self.scene.drive_channel: position, **dict(zip(names, rows, strict=False))})

    def many(self, changes: Mapping[str, ArrayLike], position: ArrayLike, time: ArrayLike | None = None) -> Machines:
        """Solve as `solve_many` does, with what it returns and raises."""
        scene, position = self.scene, finite_numbers("position", position)
        many, known = machines(scene, changes), numbers_of(scene)
        given = {at_path(scene, path, known): np.asarray(values, np.float64) for path, values in changes.items()}
        numbers = {path: values * known[path][1] for path, values in given.items()}
        if self.core.stroke_ends:
            ends = many_solver(scene, changes, self.channels).stroke_ends
            numbers |= {stroke_end(number): np.ravel(end) for number, end in ends.items()}
        instants, driven = driven_at(many, position, time)
        count = max(map(len, numbers.values()), default=1)
        shape = count, position.shape[-1]
        samples = {"time": np.broadcast_to(instants, shape), scene.drive_channel: np.broadcast_to(position, shape)}
        names, rows_at = self._route(frozenset(numbers))
        rows = rows_at(numbers, driven)
        samples |= dict(zip(names, rows, strict=False))
        status, reason = [Status.ok] * count, [""] * count
        with np.errstate(all="ignore"):  # machines that no file could describe are named
            fine = (rows[-1] >= 0).all(axis=1) & np.isfinite(rows[:-1].sum(axis=(0, 2)))
            fine[list(refused(many))] = False
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

    @cached_property
    def _single(self) -> Route:
        """Return the route of the one machine."""
        return self._route(frozenset())

    def _route(self, differing: AbstractSet[str]) -> Route:
        """Return the channels, and the function that finds them for machines that differ in some numbers.

        Machine code takes all others as arguments too, but for those that are 0, 1 or -1, which many a frame has.
        """
        if differing not in self.routes:
            known = {path: value for path, (value, _) in numbers_of(self.scene).items()}
            ends = {stroke_end(number): end for number, end in self.core.stroke_ends.items()}
            more = {path for path, value in known.items() if COMPILES and value not in (0.0, 1.0, -1.0)}
            program = recorded(self.scene, more | differing, self.channels)
            made = [*program.channels.values(), program.reach]
            rows = _compiled(made, known | ends) if COMPILES else _in_numpy(made, ends)
            self.routes[differing] = tuple(program.channels), rows
        return self.routes[differing]


def _in_numpy(made: list[Expression], ends: Mapping[str, float]) -> Rows:
    """Return the function of numbers and samples as NumPy calls."""
    line = StraightLine(made)

    def rows(numbers: Mapping[str, Samples], driven: Driven) -> Samples:
        return line({**ends, **{path: values[:, None] for path, values in numbers.items()}}, driven._asdict())

    return rows


def _compiled(made: list[Expression], known: Mapping[str, float]) -> Rows:
    """Return the function of numbers and samples as machine code."""
    inputs = [one for one in needed(made) if one.operation == "input"]
    names = [one.of[0] for one in inputs if not one.sampled]
    sampled = [one.of[0] for one in inputs if one.sampled]
    kernel = kernel_of("\n".join(code(made, names, sampled)))
    nominal = np.array([[known[name] for name in names]])

    def rows(numbers: Mapping[str, Samples], driven: Driven) -> Samples:
        machines = nominal
        if numbers:
            machines = np.repeat(nominal, len(next(iter(numbers.values()))), axis=0)
            for path, values in numbers.items():
                if path in names:
                    machines[:, names.index(path)] = values
        n = driven.position.shape[-1]
        drive = [getattr(driven, name) for name in sampled]
        own = max((len(samples) for samples in drive if samples.ndim == 2), default=1)
        padded = np.zeros((own, len(sampled), -(-n // LANES) * LANES))
        for q, samples in enumerate(drive):
            padded[:, q, :n] = samples
        filled = np.empty((len(made), len(machines), n))
        kernel(machines, padded, filled)
        return filled

    return rows


@cache
def kernel_of(source: str) -> Kernel:
    """Return the function of a text as machine code, from the disk where it was made before."""
    try:
        folder = Path(environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "linkage-crosscheck"
        file = folder / f"kernel_{sha256(source.encode()).hexdigest()[:24]}.py"
        if not file.is_file() or file.read_text(encoding="utf-8") != source:
            folder.mkdir(parents=True, exist_ok=True)
            aside = file.with_suffix(f".{getpid()}")
            aside.write_text(source, encoding="utf-8")
            aside.replace(file)
        spec = spec_from_file_location(file.stem, file)
        assert spec is not None
        assert spec.loader is not None
        module = sys.modules[file.stem] = module_from_spec(spec)  # where numba looks for what it kept
        spec.loader.exec_module(module)
    except (OSError, RuntimeError, UnicodeDecodeError):  # no home, or none that can be written: made by each process
        run: dict[str, Any] = {}
        exec(source.replace("cache=True, ", ""), run)
        return cast("Kernel", run["kernel"])
    return cast("Kernel", module.kernel)


def code(expressions: list[Expression], names: list[str], sampled: list[str]) -> Iterator[str]:
    """Yield the lines of a module whose kernel writes expressions for every machine and position.

    Angles come before, and arcs after, the loop of all that vector instructions can do. Positions are filled up to
    whole vectors.
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
        form = FORMS.get(made.operation, made.operation + "({})")
        name[made.order] = f"e{made.order}"
        if made.operation == "constant":
            name[made.order] = repr(made.of[0])
        elif made.operation == "input":
            (input_,) = made.of
            drive = f"drive[own, {sampled.index(input_)}, first + i]" if made.sampled else ""
            name[made.order] = drive or f"number[m, {names.index(input_)}]"
        elif not made.sampled:
            numbers.append(f"e{made.order} = {form.format(*of)}")
        elif made.operation in ("sin", "cos") and of[0].startswith("drive["):
            name[made.order] = f"e{made.order}[own, first + i]"
            angles.append((f"e{made.order}", form.format(of[0].replace("first + i", "i"))))
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
    yield "def kernel(number, drive, row):"
    yield f"    buffer = np.empty(({len(expressions) + len(arcs)}, {CHUNK}))"
    yield from (f"    {angle} = np.empty((drive.shape[0], drive.shape[2]))" for angle, _ in angles)
    yield "    for own in range(drive.shape[0]):"
    yield "        for i in range(drive.shape[2]):"
    yield from (f"            {angle}[own, i] = {text}" for angle, text in angles)
    yield "            pass"
    yield "    for m in range(number.shape[0]):"
    yield "        own = m if drive.shape[0] > 1 else 0"
    yield from (f"        {text}" for text in numbers)
    yield f"        for first in range(0, row.shape[2], {CHUNK}):"
    yield f"            count = min({CHUNK}, row.shape[2] - first)"
    yield f"            whole = (count + {LANES - 1}) // {LANES} * {LANES}"
    yield "            for i in range(whole):"
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

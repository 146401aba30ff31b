"""A mapping proposed for a table: its columns held against the reference's channels; printed, and never used unasked.

Each column c is fitted by a line to each channel v, c = p v + q, at instants that a rising column gives, late by an
unknown time, in frames that may be turned, mirrored and shifted. What is left of c shows how sure a pair is; p is its
unit and sign, q its zero.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import product
from math import pi, remainder

import numpy as np
from numpy.typing import NDArray

from scenes import Failure, InputError, Scene
from scenes.channels import Channel, Channels, Role
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed

from ..engines.registry import Solve, reference
from .frame import KNOWN, OF_ANGLES, Frame, seen, unit_near, vectors
from .joined import read_tables
from .moving_axes import by_links, left_by, moving
from .proposal_text import MIN_RATIO_OF_READINGS, NO_ROWS, NOISE_TOL, SURE_TOL, Axis, Pair, as_toml
from .result import name_and_files
from .table import Table

MAPPED = (Role.kinematic, Role.force, Role.friction)  # roles of channels that a column may be
MIN_ROWS, MAX_ROWS = 8, 100  # of rows, evenly spread: fewer are near to anything
LAGS = 24  # parts of a cycle in which the table may begin
PARTS, CLOSER = 6, 2  # of a step between lags, and how many of these are tried: the best one need not be the nearest
MAX_HALVINGS = 11  # of a cycle: by a third of a degree of a crank, instants may be told apart
MIN_CYCLES, MAX_CYCLES = 0.05, 1000.0  # cycles of the drive that a table is of: of next to none every channel is a line
FIT_TOL = 1e-2  # of a column: what a channel leaves of it at most
SAME_TOL = 1e-6  # of a column's square: what a vector leaves whose frame is looked for
PRICE_OF_FRAME = 0.5  # turned or mirrored, as of a sign: columns may just as well be in another order
SAME_UNIT_TOL = 2e-3  # relative: of a unit, a frame's angle


def proposed(scene: Scene, text: str) -> str:
    """Return a mapping for a table, NAME=FILE.csv, as TOML with a remark on how sure each line is; or InputError."""
    _, files = name_and_files(text)
    table = read_tables(files, None, None)
    try:
        names, columns = _numbers(table)
        solve = reference(scene)
        axis, alone = _nearest(scene, solve, names, columns)
    except InputError as error:
        raise InputError(f"{', '.join(map(str, files))}: {error}") from None
    except Failure as failure:
        raise InputError(f"{scene.file}: {failure.reason}") from None
    rest = [k for k, name in enumerate(names) if name != axis.column]
    time = axis.time + axis.lag
    true = solve(inputs_of(scene, time)).samples
    turn = _turn(scene.channels, true, columns[rest])
    # Eight frames are tried: four right angles from the one that vectors show (`_turn`), each plain and mirrored. A
    # frame is charged PRICE_OF_FRAME, and the scene's own is taken wherever it fits as well as the best.
    unwrapped = {
        c: np.unwrap(true[c]) if scene.channels[c].modulo_turn else true[c] for c in scene.channels.names(*MAPPED)
    }
    ways = []
    for mirrored, angle in product((False, True), turn + pi / 2 * np.arange(4)):
        theirs = seen(scene.channels, Frame(float(angle if mirrored else -angle), mirrored=mirrored), unwrapped)
        ways.append((*_paired(scene.channels, moving(scene.channels, theirs), columns[rest]), (float(angle), mirrored)))
    best = min(ways, key=lambda way: way[1] + PRICE_OF_FRAME * any(way[2]))
    pairs, _, frame = next((way for way in ways if not any(way[2]) and _as_well(way[0], best[0])), best)
    left = {pair.column: pair.left for pair in pairs}
    known = [min(SURE_TOL, max(left.get(k, 1.0), NOISE_TOL) / MIN_RATIO_OF_READINGS) for k in range(len(rest))]
    by_link = by_links(scene.channels, unwrapped, columns[rest], known)
    pairs = [pair for pair in pairs if pair.column not in {each.column for each in by_link}]
    return "\n".join(as_toml(scene, axis, [names[k] for k in rest], pairs, frame, by_link, alone=alone)) + "\n"


def _as_well(pairs: Sequence[Pair], best: Sequence[Pair]) -> bool:
    """Return whether pairs fit all columns that the best ones do, as far as readings can be told apart."""
    by_column = {pair.column: pair for pair in pairs}
    return all(
        (pair := by_column.get(other.column)) is not None
        and pair.left <= MIN_RATIO_OF_READINGS * max(other.left, NOISE_TOL)
        and bool(pair.unit) >= bool(other.unit)
        for other in best
    )


def _numbers(table: Table) -> tuple[list[str], NDArray[np.float64]]:
    """Return the names and numbers of the columns that have nothing else, at some rows."""
    numeric: dict[str, Samples] = {}
    for name in table.columns:
        with suppress(InputError):
            table.complete([name])[0].numbers(name)
            numeric[name] = NO_ROWS
    table, _ = table.complete(numeric)
    for name in [*numeric]:
        with suppress(InputError):
            numeric[name] = table.numbers(name)[0]
    numeric = {name: values for name, values in numeric.items() if values.size}
    if not numeric:
        raise InputError("expected columns of numbers, found none")
    count = len(table.rows)
    if count < MIN_ROWS:
        raise InputError(f"expected {MIN_ROWS} rows at least to propose a mapping from, found {count}")
    rows = np.unique(np.linspace(0, count - 1, min(count, MAX_ROWS)).astype(int))
    return [*numeric], np.array([_counted_on(values[rows]) for values in numeric.values()])


def _counted_on(values: Samples) -> Samples:
    """Return a column counted on from turn to turn where it jumps by one, as an angle between -180 and 180 degrees."""
    # A jump is a change of turn if it is nearly a whole turn, and the steps are less than a quarter of one when it is
    # taken back; a quantity that really leaps, or spans more than a turn, is left alone.
    for turn in (2 * pi / size for size in OF_ANGLES.values()):
        continued = np.unwrap(values, period=turn)
        jump, step = np.abs(np.diff(values)).max(), np.abs(np.diff(continued)).max()
        if 4 * step < turn < jump + 2 * step and np.ptp(values) <= (1 + SAME_UNIT_TOL) * turn:
            return continued
    return values


def _axes(scene: Scene, names: Sequence[str], columns: NDArray[np.float64]) -> Iterator[Axis]:
    law = scene.drive.law
    for name, values in zip(names, columns, strict=True):
        if (np.diff(values) > 0).all():
            for unit, size in KNOWN["s"].items():
                yield Axis("time", name, unit, size * values)
        if isinstance(law, ConstantSpeed) and scene.drive.slide is None:
            for unit, size in OF_ANGLES.items():
                time = (np.unwrap(size * values) - law.start) / law.speed
                if (np.diff(time) > 0).all():
                    yield Axis("crank_angle", name, unit, time)


def _nearest(scene: Scene, solve: Solve, names: Sequence[str], columns: NDArray[np.float64]) -> tuple[Axis, bool]:
    """Return the axis, late as it is, at which the channels leave least of all columns, and whether no others do."""
    from scipy.optimize import minimize_scalar

    cycle, repeats = scene.cycle, scene.periodic

    def left(axis: Axis, lag: float) -> Samples:
        """Return the shares of the squares of columns that the channels leave."""
        try:
            true = solve(inputs_of(scene, axis.time + lag)).samples
        except Failure:
            return np.ones(len(names))
        leaves, known = [np.ones(len(names))], {c: true[c] for c in scene.channels.names(*MAPPED)}
        moves = moving(scene.channels, known)
        rows = [scene.channels[name] for name in moves]
        for vector, turns in dict.fromkeys((row.components or (row.name,), row.modulo_turn) for row in rows):
            base = np.array([true[name] for name in vector])
            leaves.append(left_by(np.unwrap(base) if turns else base, columns))
        return np.asarray(np.min(leaves, axis=0) + NOISE_TOL**2)

    def mean(candidate: Axis) -> float:
        return float(np.log10(np.delete(candidate.left, names.index(candidate.column))).mean())

    def as_good(candidate: Axis, best: Axis) -> bool:
        """Return whether no column is left over that the best ones explain."""
        return bool((candidate.left <= MIN_RATIO_OF_READINGS**2 * best.left).all())

    def at(axis: Axis, lags: Iterable[float]) -> list[Axis]:
        """Return instants at lags; where the drive runs once, at those that are within the run."""
        first = -float(axis.time[0])
        last = max(first, cycle - float(axis.time[-1]))
        return [axis._replace(lag=lag, left=left(axis, lag)) for lag in lags if repeats or first <= lag <= last]

    def apart(candidate: Axis, other: Axis) -> bool:
        """Return whether their instants differ, where the drive repeats modulo a cycle."""
        lag = (candidate.time + candidate.lag - other.time - other.lag) / cycle
        return bool(np.abs(lag - np.round(lag) * repeats).max() > SAME_UNIT_TOL / (2 * pi))

    most = MAX_CYCLES if repeats else 1 + SAME_TOL
    axes = [axis for axis in _axes(scene, names, columns) if MIN_CYCLES <= np.ptp(axis.time) / cycle <= most]
    if not axes or len(names) < 2:
        raise InputError("expected a column that rises as the time does, or turns as the crank does, and another")
    # A global search for the lag, which has many local optima: a grid over the cycle, a finer grid about the best two,
    # and a bounded minimisation between its neighbours. What counts is the mean of the logarithm of what is left of
    # each column, so that several columns that fit exactly outweigh one that fits badly in any case.
    steps, finer = cycle / LAGS * np.arange(LAGS), cycle / (LAGS * PARTS)
    tried = [candidate for axis in axes for candidate in at(axis, (0.0, *(steps if repeats else steps - axis.time[0])))]
    closer = finer * np.arange(-PARTS, PARTS + 1)
    firsts = sorted(tried, key=mean)[:CLOSER]
    near = min(
        (min(at(candidate, candidate.lag + closer), key=mean, default=candidate) for candidate in firsts), key=mean
    )
    bounds, options = (near.lag - finer, near.lag + finer), {"xatol": 1e-9 * cycle}
    refined = minimize_scalar(
        lambda shift: min(map(mean, at(near, [shift])), default=0.0), bounds=bounds, method="bounded", options=options
    )
    plain = at(near, (0.0, near.lag, float(refined.x)))
    best = min(plain, key=mean)
    best = next(candidate for candidate in plain if as_good(candidate, best))
    # Whether another lag fits as well: symmetric motions repeat after parts of a cycle, so that halves, quarters and so
    # on are tried about the best one.
    moves = [way * cycle / 2**k for k in range(1, MAX_HALVINGS) for way in (1, -1)]
    tried += at(best, [best.lag + move for move in (*moves, *steps)])
    lag = best.lag - cycle if repeats and best.lag > cycle / 2 else best.lag
    # a point on the crank alone does not show a lag: it may as well be the turn of a frame
    return best._replace(lag=lag), not any(as_good(candidate, best) and apart(candidate, best) for candidate in tried)


def _turn(channels: Channels, true: Mapping[str, Samples], columns: NDArray[np.float64]) -> float:
    """Return the angle of the frame but for right angles: the one that most columns have to a vector they fit."""
    angles = []
    for x, y in vectors(channels, true):
        base = np.array([true[x], true[y]])
        # A column of a frame turned by b is a x + b y up to scale. Right angles and mirroring only exchange and negate
        # components: the angle is taken modulo a quarter turn, as four times itself, and the angle that most columns
        # share within a tolerance wins.
        base = base - base.mean(axis=1, keepdims=True)
        if np.linalg.cond(base) < 1e3:
            for column in columns[left_by(base, columns) < SAME_TOL]:
                a, b = np.linalg.lstsq(base.T, column - column.mean(), rcond=None)[0]
                angles.append(4 * np.arctan2(b, a))
    apart = np.abs(np.angle(np.exp(1j * np.subtract.outer(angles, angles))))
    turn = (
        float(np.angle(np.exp(1j * angles[int((apart <= SAME_UNIT_TOL).sum(axis=1).argmax())]))) / 4 if angles else 0.0
    )
    return turn if abs(turn) > SAME_UNIT_TOL else 0.0


def _paired(channels: Channels, seen: Mapping[str, Samples], columns: NDArray[np.float64]) -> tuple[list[Pair], float]:
    """Return the pairs that cost least together, those that fit, and the cost of all."""
    from scipy.optimize import linear_sum_assignment

    # Assignment problem (Hungarian method): each column has at most one channel and the sum of costs is least. Greedy
    # pairing would give a column's best channel away to another one that fits others as well.
    fits = _pairs(channels, seen, columns)
    costs = np.array([[_cost(channels[pair.channel], pair) for pair in row] for row in fits])
    rows, chosen = linear_sum_assignment(costs)
    pairs = []
    for k, c in zip(rows, chosen, strict=True):
        second = min((p.left for n, p in enumerate(fits[k]) if n != c and p.unit), default=1.0)
        pairs.append(fits[k][c]._replace(second=second))
    return [pair for pair in pairs if pair.left <= FIT_TOL], float(costs[rows, chosen].sum())


def _pairs(channels: Channels, seen: Mapping[str, Samples], columns: NDArray[np.float64]) -> list[list[Pair]]:
    values = np.array([*seen.values()])
    # All least-squares lines c = p v + q at once: slopes from centred products, what is left from the correlation. A
    # channel that stands still gets no slope.
    v, c = (each - each.mean(axis=1, keepdims=True) for each in (values, columns))
    squares = (v**2).sum(axis=1)
    moves = squares > 1e-18 * (values**2).sum(axis=1)
    p = c @ v.T / np.where(moves, squares, np.inf)
    zeros = columns.mean(axis=1)[:, np.newaxis] - p * values.mean(axis=1)
    whole = (c**2).sum(axis=1)[:, np.newaxis]
    left = np.sqrt(np.clip(1 - p**2 * squares / np.where(whole > 0, whole, np.inf), 0.0, 1.0))
    hair = np.maximum(MIN_RATIO_OF_READINGS * left, NOISE_TOL) * np.abs(columns).max(axis=1, keepdims=True)
    fits = np.stack([p, left, zeros, hair], axis=2).tolist()
    return [[_pair(channels[c], k, *fit) for c, fit in zip(seen, row, strict=True)] for k, row in enumerate(fits)]


def _pair(channel: Channel, column: int, p: float, left: float, zero: float, hair: float) -> Pair:
    """Return how a column fits a channel; without a unit where it fits in none that is known."""
    unit = unit_near(p, channel.unit, max(SAME_UNIT_TOL, left))
    zero = remainder(zero, 2 * pi * abs(p)) if channel.modulo_turn and p else zero
    zero = zero if abs(zero) > hair else 0.0
    return Pair(channel.name, column, left, unit, 1 if p > 0 else -1, zero)


def _cost(channel: Channel, pair: Pair) -> float:
    """Return the price of a pair: what it leaves, in powers of ten, an unknown unit, an opposite sign, a zero."""
    odd_zero = bool(pair.zero) and channel.order != 0
    return float(np.log10(pair.left + NOISE_TOL)) + 4 * (not pair.unit) + 0.5 * (pair.sign < 0) + 0.5 * odd_zero

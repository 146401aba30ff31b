"""The rows of a speed table, and their results: cheapest settings for errors, orders of convergence, costs of a step.

Settings with a note, such as an engine's own defaults or fictitious masses, compete apart: they have their own rows in
every comparison and are never the cheapest, since nobody should take them, or since they are no independent check.

A setting is the cheapest only where no other is as fast but for what another program on the same core may change. Else
they are level, and what is named of them is found without a clock: the smallest error, then the fewest steps.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import isnan, nan
from operator import attrgetter

import numpy as np

from scenes import Settings, Status
from scenes.model.motion import Samples

from ...engines.registry import REFERENCE, WORK_PRECISION, settings_of, tiers
from ...mechanics.mechanics import SHOWN_GROUPS

LEVELS: Mapping[str, float] = {"10 %": 1e-1, "1 %": 1e-2, "0.1 %": 1e-3, "1e-4": 1e-4, "1e-6": 1e-6, "1e-8": 1e-8}
# Of the fastest time. While another program runs on the same core, Exudyn's solves of the toggle press take 1.75 times
# the processor time, pymunk's 1.35 times: a ratio of up to 1.3 between two settings may be the neighbour's.
TIE_TOL = 0.5
# What is named may change from run to run where a ratio is near the limit of a tie; up to this one it is called level
# all the same: two runs whose times are up to a sixth apart differ in what they name only where both call it level.
CHOICE_TOL = 0.75
ABOVE_FLOOR = 10.0  # times the floor: there the floor is a tenth of the error at most
MIN_POINTS = 3  # of a fit, so that it has a residual
STRAIGHT_TOL = 0.02  # decades: where theory holds errors lie on a line as well as this
LAST, SETTLED = 2, 0.25  # local orders, as far apart: two whole orders, one apart, are four times as far


@dataclass(frozen=True)
class SpeedRow:
    """One setting of one engine: what it is, how its runs ended, their times, s, and errors."""

    engine: str
    setting: str
    role: str
    tier: str  # the names of the accuracies that it is offered for
    family: str
    expected_order: float | None
    note: str
    steps: float  # a cycle, of the coarsest run, rounded up as engines do; NaN of settings that take none
    samples_a_turn: int  # that the times are of
    status: str
    reason: str
    build_s: float
    solve_min_s: float
    solve_median_s: float
    solve_spread_s: float
    solve_wall_s: float
    read_s: float
    timed_runs: int
    errors: Mapping[str, float]  # `reaction_max`, `reaction_rms` and so on: the largest of a channel group
    steps_made: float
    counters: Mapping[str, int]

    def error(self, name: str) -> float:
        """An error, NaN where it is not known."""
        return self.errors.get(name, nan)

    @property
    def cells(self) -> dict[str, object]:
        """The row as a table has it, by column."""
        cells = dict[str, object]()
        for name, value in vars(self).items():
            cells |= self.errors if name == "errors" else {name: value}
        return cells | {"counters": " ".join(f"{name}={count}" for name, count in self.counters.items())}


@dataclass(frozen=True)
class Choice:
    """The cheapest setting of an engine, of those with this note, for a level of the largest error."""

    group: str
    level: str
    engine: str
    note: str
    setting: str = ""  # nothing where none reaches the level, as are the others then
    level_with: str | None = None  # the engine's settings that are level with it
    solve_s: float = nan
    error: float = nan
    ratio: float = nan  # of its time to that of the fastest setting without a note, of any engine
    standing: str | None = None  # among the engines besides the reference: cheapest, level, or dearer


@dataclass(frozen=True)
class Order:
    """A family's order of convergence in a channel group."""

    engine: str
    family: str
    expected_order: float | None
    group: str
    order: float  # NaN where it has not settled, or few errors count
    residual: float  # root mean square, decades
    local_orders: Sequence[float]
    points: int


@dataclass(frozen=True)
class StepCost:
    """The cost of a step in a family of settings, and the fixed cost of a run, s."""

    engine: str
    family: str
    fixed_s: float
    step_s: float
    residual: float  # root mean square, relative
    points: int


def groups(speed: Sequence[SpeedRow]) -> list[str]:
    """The channel groups that errors were measured in."""
    known = set[str]().union(*(row.errors for row in speed))
    return [group for group in SHOWN_GROUPS if f"{group}_max" in known]


def solved(speed: Sequence[SpeedRow]) -> list[SpeedRow]:
    """The work-precision settings that solved the scene."""
    return [row for row in speed if row.status == Status.ok.name and row.role == WORK_PRECISION]


def contenders(points: Iterable[SpeedRow]) -> list[tuple[str, str, list[SpeedRow]]]:
    """Engine, note and settings of all that compete with each other."""
    sets: dict[tuple[str, str], list[SpeedRow]] = {}
    for row in points:
        sets.setdefault((row.engine, row.note), []).append(row)
    return [(*named, rows) for named, rows in sets.items()]


# --- the cheapest setting for an error -------------------------------------------------------------------------------


def as_fast(points: Iterable[SpeedRow], error: str, limit: float, tie: float = TIE_TOL) -> list[SpeedRow]:
    """The settings that are level with the fastest of those whose error is at most `limit`, the best first.

    The best has the smallest error of those that tie with the fastest; of equal ones, the fewest steps; of these, the
    first of the table.
    """
    good = [row for row in points if row.error(error) <= limit]
    fastest = min((row.solve_min_s for row in good), default=nan)

    def rank(row: SpeedRow) -> tuple[bool, float, float]:
        steps = 0.0 if isnan(row.steps_made) else row.steps_made
        return row.solve_min_s > (1 + tie) * fastest, row.error(error), steps

    return sorted((row for row in good if row.solve_min_s <= (1 + CHOICE_TOL) * fastest), key=rank)


def front(points: Iterable[SpeedRow], error: str, tie: float = TIE_TOL) -> list[SpeedRow]:
    """Every setting without a note that is the cheapest for some error, fastest first; the Pareto front."""
    plain = [row for row in points if not row.note]
    # The front changes only at the errors of settings, so each of these is tried as the limit.
    best = {id(row) for limit in plain for row in as_fast(plain, error, limit.error(error), tie)[:1]}
    return sorted((row for row in plain if id(row) in best), key=attrgetter("solve_min_s"))


def choices(speed: Sequence[SpeedRow]) -> Iterator[Choice]:
    """Yield the cheapest setting by channel group, engine and note, and level of the largest error."""
    points = solved(speed)
    for group in groups(speed):
        error = f"{group}_max"
        fastest = {name: _fastest(points, error, limit) for name, limit in LEVELS.items()}
        standings = {name: standing(points, error, limit) for name, limit in LEVELS.items()}
        for (engine, note, rows), (name, limit) in product(contenders(points), LEVELS.items()):
            if not (level := as_fast(rows, error, limit)):
                yield Choice(group, name, engine, note)
                continue
            best, *others = level
            alike, ratio = "; ".join(sorted(row.setting for row in others)), best.solve_min_s / fastest[name]
            stands = "" if note else standings[name].get(engine, "")
            figures = best.solve_min_s, best.error(error), ratio, stands
            yield Choice(group, name, engine, note, best.setting, alike, *figures)


def _fastest(points: Iterable[SpeedRow], error: str, limit: float) -> float:
    return min((row.solve_min_s for row in points if not row.note and row.error(error) <= limit), default=nan)


def standing(points: Iterable[SpeedRow], error: str, limit: float) -> dict[str, str]:
    """By engine how its fastest setting without a note stands, among the engines besides the reference."""
    times = {engine: _fastest(rows, error, limit) for engine, note, rows in contenders(points) if not note}
    fastest = {engine: time for engine, time in times.items() if engine != REFERENCE and not isnan(time)}
    near = {engine: time <= (1 + TIE_TOL) * min(fastest.values()) for engine, time in fastest.items()}
    first = "cheapest" if sum(near.values()) == 1 else "level"
    return {engine: first if is_near else "dearer" for engine, is_near in near.items()}


def within(engine: str, accuracy: float, speed: Sequence[SpeedRow]) -> list[Settings]:
    """An engine's settings without a note that meet an accuracy in every group: the cheapest first.

    Each that follows is the cheapest of those more accurate than the ones before. No clock decides, so that equal calls
    choose the same: the cost is the largest of the engine's counters, that of its innermost loop. Left out are settings
    that promise less of the drive than those that the engine offers by name.
    """
    promise = max(settings.drive_promise for settings in tiers(engine).values())
    able = {each.label: each for each in settings_of(engine, full=True) if each.drive_promise <= promise}
    names, points = [f"{group}_max" for group in groups(speed)], list[SpeedRow]()
    for row in solved(speed):
        worst = float(np.max([*map(row.error, names)] or [nan]))
        if row.engine == engine and not row.note and row.setting in able and worst <= accuracy:
            cost = float(max(row.counters.values(), default=0))
            points.append(replace(row, solve_min_s=cost, errors={"worst": worst}))
    return [able[row.setting] for row in front(points, "worst")]


# --- fits within a family --------------------------------------------------------------------------------------------


def families(points: Sequence[SpeedRow], steps: str) -> Iterator[list[SpeedRow]]:
    """The settings of every family, those that solved the scene, from the fewest to the most of `steps`."""
    by_family: dict[tuple[str, str], dict[float, SpeedRow]] = {}
    for row in solved(points):
        if row.family and not isnan(count := getattr(row, steps)):
            by_family.setdefault((row.engine, row.family), {}).setdefault(count, row)
    for rows in by_family.values():
        yield [row for _, row in sorted(rows.items())]


def orders(speed: Sequence[SpeedRow], floors: Mapping[str, float]) -> Iterator[Order]:
    """Yield every family's order of convergence by channel group, NaN where it has not settled or few errors count.

    The order is the slope of log(largest error) against log(steps per cycle) by least squares, `residual` the root mean
    square of what that leaves, in decades. The longest straight run of settings counts: theory is not about the
    coarsest, and the finest may feel a floor. `local_orders` are the slopes from each of its settings to the next; the
    order has settled where the last ones agree with each other and with it. `floors` are the reference's.
    """
    for points, group in product(families(speed, "steps"), groups(speed)):
        errors = np.array([row.error(f"{group}_max") for row in points])
        steps = np.array([row.steps for row in points])
        above = above_floor(steps, errors, floors.get(group, 0.0))
        order, residual, local = _order(np.log10(steps[:above]), np.log10(errors[:above]))
        named = points[0].engine, points[0].family, points[0].expected_order, group
        order = order if local and np.ptp([order, *local[-LAST:]]) <= SETTLED else nan
        yield Order(*named, order, residual, local, len(local) + 1 if local else 0)


def above_floor(steps: Samples, errors: Samples, floor: float) -> int:
    """How many settings, from the coarsest on, have errors well above the reference's floor and their own.

    A family has met a floor of its own when its last refinement gains less than half of what its best one gains, at
    the same ratio of steps: that floor is its smallest error.
    """
    if len(steps) > 1 and (errors > 0).all():
        gains = -np.diff(np.log(errors)) / np.diff(np.log(steps))
        if gains[-1] < gains.max() / 2:
            floor = max(floor, errors.min())
    above = errors > ABOVE_FLOOR * floor
    return len(above) if above.all() else int(above.argmin())


def _order(x: Samples, y: Samples) -> tuple[float, float, list[float]]:
    """Return order, residual and local orders of the longest straight run of settings, or else of all."""
    if len(x) < MIN_POINTS:
        return nan, nan, []
    # All stretches of neighbouring settings are tried, a few dozen for the sizes that families have. Of equally long
    # straight ones the coarsest counts, which is the farthest above any floor.
    runs = (slice(i, j) for i in range(len(x)) for j in range(i + MIN_POINTS, len(x) + 1))
    straight = [run for run in runs if _line(x[run], y[run])[1] <= STRAIGHT_TOL]
    best = max(straight or [slice(0, len(x))], key=lambda run: run.stop - run.start)
    return *_line(x[best], y[best]), [float(slope) for slope in -np.diff(y[best]) / np.diff(x[best])]


def _line(x: Samples, y: Samples) -> tuple[float, float]:
    line = np.polynomial.Polynomial.fit(x, y, 1)
    return -float(line.deriv()(0.0)), float(np.sqrt(np.mean((y - line(x)) ** 2)))


def step_costs(speed: Sequence[SpeedRow]) -> Iterator[StepCost]:
    """Yield the cost of a step in every family, and the fixed cost of a run, s, by time = fixed + steps * step.

    Least squares of the relative errors, whose root mean square is `residual`; steps are all that were made, those
    before the first sample and those of every Richardson level.
    """
    for points in (points for points in families(speed, "steps_made") if len(points) >= MIN_POINTS):
        time, steps = np.array([(row.solve_min_s, row.steps_made) for row in points]).T
        # Divided by its time, every setting has the equation fixed / time + step steps / time = 1. Without that the
        # slowest runs, whose errors are the largest in seconds, would decide alone, and the fixed cost would be noise.
        relative = np.column_stack([1 / time, steps / time])
        (fixed, step), *_ = np.linalg.lstsq(relative, np.ones(len(time)))
        residual = float(np.sqrt(np.mean((relative @ (fixed, step) - 1) ** 2)))
        yield StepCost(points[0].engine, points[0].family, float(fixed), float(step), residual, len(points))

"""Results of a speed table: the cheapest setting for every error, orders of convergence, the cost of a step.

Settings with a note, such as an engine's own defaults or fictitious masses, compete apart: they have their own rows in
every comparison and are never the cheapest, since nobody should take them, or since they are no independent check.

A setting is the cheapest only where no other is as fast but for what another program on the same core may change. Else
they are level, and what is named of them is found without a clock: the smallest error, then the fewest steps.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import isnan, nan

import numpy as np
from numpy.typing import NDArray

from scenes import Settings
from scenes.model.motion import Samples

from ...engines.registry import REFERENCE
from ...engines.settings import settings_of, tiers
from ...mechanics.mechanics import SHOWN_GROUPS
from .row import SpeedRow

LEVELS: Mapping[str, float] = {"10 %": 1e-1, "1 %": 1e-2, "0.1 %": 1e-3, "1e-4": 1e-4, "1e-6": 1e-6, "1e-8": 1e-8}
# Of the fastest time. While another program runs on the same core, Exudyn's solves of the toggle press take 1.75 times
# the processor time, pymunk's 1.35 times: a ratio of up to 1.3 between two settings may be the neighbour's.
TIE = 0.5
# What is named may change from run to run where a ratio is near the limit of a tie; up to this one it is called level
# all the same: two runs whose times are up to a sixth apart differ in what they name only where both call it level.
ALIKE = 0.75
DOUBT = 1.75  # ratio of the limit of a tie to a time, below which a busy machine might have moved it across
ABOVE_FLOOR = 10.0  # times the floor: there the floor is a tenth of the error at most
LEAST_POINTS = 3  # of a fit, so that it has a residual
STRAIGHT = 0.02  # decades: where theory holds errors lie on a line as well as this
LAST, SETTLED = 2, 0.25  # local orders, as far apart: two whole orders, one apart, are four times as far


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
    return [row for row in speed if row.solved]


def contenders(points: Sequence[SpeedRow]) -> Iterator[tuple[str, str, list[SpeedRow]]]:
    """Yield engine, note and settings of all that compete with each other; without a note first."""
    for (engine, note), places in _contending(points).items():
        yield engine, note, [points[place] for place in places]


def _contending(points: Sequence[SpeedRow]) -> dict[tuple[str, str], list[int]]:
    """By engine and note the places of the settings that compete with each other."""
    places: dict[tuple[str, str], list[int]] = {}
    for place, row in enumerate(points):
        places.setdefault((row.engine, row.note), []).append(place)
    return places


# --- the cheapest setting for an error -------------------------------------------------------------------------------


def as_fast(points: Sequence[SpeedRow], error: str, limit: float, tie: float = TIE) -> list[SpeedRow]:
    """The settings that are level with the fastest of those whose error is at most `limit`, the best first.

    The best has the smallest error of those that tie with the fastest; of equal ones, the fewest steps; of these, the
    first of the table.
    """
    return [points[place] for place in _as_fast(*_numbers(points, error), limit, tie)]


def _numbers(points: Sequence[SpeedRow], error: str) -> tuple[Samples, Samples, Samples]:
    """The times, errors and steps of settings, shape (n,)."""
    numbers = np.array([(row.solve_min_s, row.error(error), row.steps_made) for row in points]).reshape(-1, 3)
    return numbers[:, 0], numbers[:, 1], np.nan_to_num(numbers[:, 2])


def _as_fast(times: Samples, errors: Samples, steps: Samples, limit: float, tie: float) -> NDArray[np.intp]:
    """The rows of what `as_fast` returns."""
    good = errors <= limit
    fastest = times[good].min(initial=np.inf)
    level = np.flatnonzero(good & (times <= (1 + ALIKE) * fastest))
    return level[np.lexsort((steps[level], errors[level], times[level] > (1 + tie) * fastest))]


def front(points: Sequence[SpeedRow], error: str, tie: float = TIE) -> list[SpeedRow]:
    """Every setting without a note that is the cheapest for some error, fastest first; the Pareto front."""
    plain = [row for row in points if not row.note]
    times, errors, steps = _numbers(plain, error)
    best = {int(_as_fast(times, errors, steps, limit, tie)[0]) for limit in errors[~np.isnan(errors)]}
    return [plain[place] for place in sorted(best, key=lambda place: (times[place], place))]


def choices(speed: Sequence[SpeedRow]) -> list[Choice]:
    """The cheapest setting by channel group, engine and note, and level of the largest error."""
    points, chosen = solved(speed), list[Choice]()
    sets = [(engine, note, np.array(places)) for (engine, note), places in _contending(points).items()]
    for group in groups(speed) if points else ():
        times, errors, steps = _numbers(points, f"{group}_max")
        standings = {name: standing(points, f"{group}_max", limit) for name, limit in LEVELS.items()}
        plain = np.where([not row.note for row in points], errors, np.inf)
        for (engine, note, places), (name, limit) in product(sets, LEVELS.items()):
            level = places[_as_fast(times[places], errors[places], steps[places], limit, TIE)]
            if not level.size:
                chosen.append(Choice(group, name, engine, note))
                continue
            best, *others = (points[place].setting for place in level)
            fastest, time = times[plain <= limit], float(times[level[0]])
            ratio = time / float(fastest.min()) if fastest.size else nan
            stands = standings[name].get(engine, "") if not note else ""
            figures = time, float(errors[level[0]]), ratio, stands
            chosen.append(Choice(group, name, engine, note, best, "; ".join(sorted(others)), *figures))
    return chosen


def standing(points: Sequence[SpeedRow], error: str, limit: float) -> dict[str, str]:
    """By engine how its fastest setting without a note stands, among the engines besides the reference."""
    fastest: dict[str, float] = {}
    for row in points:
        if not row.note and row.engine != REFERENCE and row.error(error) <= limit:
            fastest[row.engine] = min(row.solve_min_s, fastest.get(row.engine, np.inf))
    near = {engine: time <= (1 + TIE) * min(fastest.values()) for engine, time in fastest.items()}
    first = "cheapest" if sum(near.values()) == 1 else "level"
    return {engine: first if is_near else "dearer" for engine, is_near in near.items()}


def contests(speed: Sequence[SpeedRow]) -> list[NDArray[np.intp]]:
    """The sets of settings, by their places in the table, of which the fastest is asked for.

    One for every group, level and contender, and one for all engines besides the reference.
    """
    able = [place for place, row in enumerate(speed) if row.solved]
    sets = [[able[place] for place in places] for places in _contending(solved(speed)).values()]
    sets.append([place for place in able if not speed[place].note and speed[place].engine != REFERENCE])
    rivals = (
        tuple(place for place in places if speed[place].error(f"{group}_max") <= limit)
        for group, limit, places in product(groups(speed), LEVELS.values(), sets)
    )
    return [np.array(places) for places in dict.fromkeys(rivals) if len(places) > 1]


def in_doubt(contests: Sequence[NDArray[np.intp]], times: Sequence[float]) -> list[int]:
    """The settings whose times, s, more rounds should make sure of, by their places.

    Those are near the limit up to which settings of a contest are level, and the fastest of that contest.
    """
    doubtful: set[int] = set()
    for places in contests:
        ratio = np.array(times)[places] / min(times[place] for place in places)
        near = (np.abs(np.log(ratio / (1 + TIE))) < np.log(DOUBT)) & (ratio > 1)
        if near.any():
            doubtful |= {int(place) for place in places[near | (ratio == 1)]}
    return sorted(doubtful)


def within(engine: str, accuracy: float, speed: Sequence[SpeedRow]) -> list[Settings]:
    """An engine's settings without a note that meet an accuracy in every group: the cheapest first.

    Each that follows is the cheapest of those more accurate than the ones before. No clock decides, so that equal calls
    choose the same: the cost is the largest of the engine's counters, that of its innermost loop. Left out are settings
    that promise less of the drive than those that the engine offers by name.
    """
    drive_promise = max(settings.drive_promise for settings in tiers(engine).values())
    by_label = {
        settings.label: settings
        for settings in settings_of(engine, full=True)
        if settings.drive_promise <= drive_promise
    }
    names = [f"{group}_max" for group in groups(speed)]
    points = [row for row in solved(speed) if row.engine == engine and not row.note and row.setting in by_label]
    worst = [
        replace(
            row,
            solve_min_s=float(max(row.counters.values(), default=0)),
            errors={"worst": float(np.max([*map(row.error, names)] or [nan]))},
        )
        for row in points
    ]
    return [by_label[row.setting] for row in front([row for row in worst if row.error("worst") <= accuracy], "worst")]


# --- fits within a family --------------------------------------------------------------------------------------------


def families(points: Sequence[SpeedRow], steps: str) -> Iterator[list[SpeedRow]]:
    """The settings of every family, those that solved the scene, from the fewest to the most of `steps`."""
    by_family: dict[tuple[str, str], dict[float, SpeedRow]] = {}
    for row in solved(points):
        if row.family and not isnan(count := getattr(row, steps)):
            by_family.setdefault((row.engine, row.family), {}).setdefault(count, row)
    for rows in by_family.values():
        yield [row for _, row in sorted(rows.items())]


def orders(speed: Sequence[SpeedRow], floors: Mapping[str, float]) -> list[Order]:
    """Every family's order of convergence by channel group, NaN where it has not settled or few errors count.

    The order is the slope of log(largest error) against log(steps per cycle) by least squares, `residual` the root mean
    square of what that leaves, in decades. The longest straight run of settings counts: theory is not about the
    coarsest, and the finest may feel a floor. `local_orders` are the slopes from each of its settings to the next; the
    order has settled where the last ones agree with each other and with it. `floors` are the reference's.
    """
    fitted = []
    for points, group in product(families(speed, "steps"), groups(speed)):
        errors = np.array([row.error(f"{group}_max") for row in points])
        steps = np.array([row.steps for row in points])
        above = above_floor(steps, errors, floors.get(group, 0.0))
        order, residual, local = _order(np.log10(steps[:above]), np.log10(errors[:above]))
        settled = local and np.ptp([order, *local[-LAST:]]) <= SETTLED
        named = points[0].engine, points[0].family, points[0].expected_order, group
        fitted.append(Order(*named, order if settled else nan, residual, local, len(local) + 1 if local else 0))
    return fitted


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
    runs = [slice(i, j) for i in range(len(x)) for j in range(i + LEAST_POINTS, len(x) + 1)]
    if not runs:
        return nan, nan, []
    residuals = [_line(x[run], y[run])[1] for run in runs]
    straight = [run for run, residual in zip(runs, residuals, strict=True) if residual <= STRAIGHT]
    best = max(straight or [slice(0, len(x))], key=lambda run: run.stop - run.start)
    return *_line(x[best], y[best]), [float(slope) for slope in -np.diff(y[best]) / np.diff(x[best])]


def _line(x: Samples, y: Samples) -> tuple[float, float]:
    line = np.polynomial.Polynomial.fit(x, y, 1)
    return -float(line.deriv()(0.0)), float(np.sqrt(np.mean((y - line(x)) ** 2)))


def step_costs(speed: Sequence[SpeedRow]) -> list[StepCost]:
    """The cost of a step in every family, and the fixed cost of a run, s, by time = fixed + steps * step.

    Least squares of the relative errors, whose root mean square is `residual`; steps are all that were made, those
    before the first sample and those of every Richardson level.
    """
    costs = []
    for points in families(speed, "steps_made"):
        if len(points) >= LEAST_POINTS:
            time, steps = np.array([(row.solve_min_s, row.steps_made) for row in points]).T
            relative = np.column_stack([1 / time, steps / time])
            (fixed, step), *_ = np.linalg.lstsq(relative, np.ones(len(time)))
            residual = float(np.sqrt(np.mean((relative @ (fixed, step) - 1) ** 2)))
            named = points[0].engine, points[0].family
            costs.append(StepCost(*named, float(fixed), float(step), residual, len(points)))
    return costs

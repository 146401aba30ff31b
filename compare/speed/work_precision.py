"""Results of a speed table: the cheapest setting for every error, orders of convergence, the cost of a step.

Settings with a note, such as an engine's own defaults or fictitious masses, compete apart: they have their own rows in
every comparison and are never the cheapest, since nobody should take them, or since they are no independent check.

A setting is the cheapest only where no other is as fast but for what another program on the same core may change. Else
they are level, and what is named of them is found without a clock: the smallest error, then the fewest steps.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import product

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from scenes import Settings, Status
from scenes.motion import Samples

from ..engines.registry import REFERENCE
from ..engines.settings import WORK_PRECISION, settings_of
from ..judge.errors import SHOWN_GROUPS

LEVELS: Mapping[str, float] = {"10 %": 1e-1, "1 %": 1e-2, "0.1 %": 1e-3, "1e-4": 1e-4, "1e-6": 1e-6, "1e-8": 1e-8}
# Of the fastest time. While another program runs on the same core, Exudyn's solves of the toggle press take 1.75 times
# the processor time, pymunk's 1.35 times: a ratio of up to 1.3 between two settings may be the neighbour's.
TIE = 0.5
# What is named may change from run to run where a ratio is near the limit of a tie; up to this one it is called level
# all the same: two runs whose times are up to a sixth apart differ in what they name only where both call it level.
NEAR = 0.75
DOUBT = 1.75  # ratio of the limit of a tie to a time, below which a busy machine might have moved it across
ABOVE_FLOOR = 10.0  # times the floor: there the floor is a tenth of the error at most
LEAST_POINTS = 3  # of a fit, so that it has a residual
STRAIGHT = 0.02  # decades: where theory holds errors lie on a line as well as this
LAST, SETTLED = 2, 0.25  # local orders, as far apart: two whole orders, one apart, are four times as far


def groups(speed: pd.DataFrame) -> list[str]:
    """Return the channel groups that errors were measured in."""
    return [group for group in SHOWN_GROUPS if f"{group}_max" in speed]


def solved(speed: pd.DataFrame) -> pd.DataFrame:
    """Return the work-precision settings that solved the scene."""
    return speed[(speed["status"] == Status.ok.name) & (speed["role"] == WORK_PRECISION)] if len(speed) else speed


def contenders(points: pd.DataFrame) -> Iterator[tuple[str, str, pd.DataFrame]]:
    """Yield engine, note and settings of all that compete with each other; without a note first."""
    for (engine, note), rows in points.groupby(["engine", "note"], sort=False) if len(points) else ():
        yield str(engine), str(note), rows


# --- the cheapest setting for an error -------------------------------------------------------------------------------


def as_fast(points: pd.DataFrame, error: str, limit: float, tie: float = TIE) -> pd.DataFrame:
    """Return the settings that are level with the fastest of those whose error is at most `limit`, the best first.

    The best has the smallest error of those that tie with the fastest; of equal ones, the fewest steps; of these, the
    first of the table.
    """
    times, errors, steps = _numbers(points, error)
    return points.take(_as_fast(times, errors, steps, limit, tie))


def _numbers(points: pd.DataFrame, error: str) -> tuple[Samples, Samples, Samples]:
    """Return the times, errors and steps of settings, shape (n,)."""
    steps = points["steps_made"].fillna(0)
    return points["solve_min_s"].to_numpy(float), points[error].to_numpy(float), steps.to_numpy(float)


def _as_fast(times: Samples, errors: Samples, steps: Samples, limit: float, tie: float) -> NDArray[np.intp]:
    """Return the rows of what `as_fast` returns."""
    good = errors <= limit
    fastest = times[good].min(initial=np.inf)
    level = np.flatnonzero(good & (times <= (1 + NEAR) * fastest))
    return level[np.lexsort((steps[level], errors[level], times[level] > (1 + tie) * fastest))]


def front(points: pd.DataFrame, error: str, tie: float = TIE) -> pd.DataFrame:
    """Return every setting without a note that is the cheapest for some error, fastest first; the Pareto front."""
    return points.take(front_places(points, error, tie))


def front_places(points: pd.DataFrame, error: str, tie: float = TIE) -> list[int]:
    """Return the rows of what `front` returns."""
    plain = np.flatnonzero(points["note"].to_numpy() == "")
    times, errors, steps = (values[plain] for values in _numbers(points, error))
    best = {int(_as_fast(times, errors, steps, limit, tie)[0]) for limit in errors[~np.isnan(errors)]}
    return [int(plain[row]) for row in sorted(best, key=lambda row: (times[row], row))]


def choices(speed: pd.DataFrame) -> pd.DataFrame:
    """Return the cheapest setting by channel group, engine and note, and level of the largest error.

    `level_with` are the engine's settings that are level with it, `ratio` is its time over that of the fastest setting
    without a note, of any engine. `standing` is among the engines besides the reference, of settings without a note:
    cheapest, level, or dearer.
    """
    points = solved(speed).reset_index(drop=True)
    sets = [(engine, note, rows.index.to_numpy()) for engine, note, rows in contenders(points)]
    found, names = [], points["setting"].tolist() if len(points) else []
    for group in groups(speed) if len(points) else ():
        times, errors, steps = _numbers(points, f"{group}_max")
        standings = {name: standing(points, f"{group}_max", limit) for name, limit in LEVELS.items()}
        plain = np.where(points["note"] == "", errors, np.inf)
        for (engine, note, places), (name, limit) in product(sets, LEVELS.items()):
            level = places[_as_fast(times[places], errors[places], steps[places], limit, TIE)]
            settings = [names[place] for place in level]
            row: dict[str, object] = {"group": group, "level": name, "engine": engine, "note": note}
            found.append(row | {"setting": settings[0] if settings else ""})
            if settings:
                fastest, time = times[plain <= limit], times[level[0]]
                found[-1] |= {
                    "level_with": "; ".join(sorted(settings[1:])),
                    "solve_s": time,
                    "error": errors[level[0]],
                    "ratio": time / fastest.min() if fastest.size else np.nan,
                    "standing": standings[name].get(engine, "") if not note else "",
                }
    return pd.DataFrame(found)


def standing(points: pd.DataFrame, error: str, limit: float) -> dict[str, str]:
    """Return by engine how its fastest setting without a note stands, among the engines besides the reference."""
    fastest: dict[str, float] = {}
    columns = "engine", "note", "solve_min_s", error
    for engine, note, time, off in zip(*(points[name].tolist() for name in columns), strict=True):
        if not note and engine != REFERENCE and off <= limit:
            fastest[engine] = min(time, fastest.get(engine, np.inf))
    near = {engine: time <= (1 + TIE) * min(fastest.values()) for engine, time in fastest.items()}
    first = "cheapest" if sum(near.values()) == 1 else "level"
    return {engine: first if is_near else "dearer" for engine, is_near in near.items()}


def contests(speed: pd.DataFrame) -> list[NDArray[np.intp]]:
    """Return the sets of settings, by their places in the table, of which the fastest is asked for.

    One for every group, level and contender, and one for all engines besides the reference.
    """
    points = solved(speed.reset_index(drop=True))
    if points.empty:
        return []
    plain = points[(points["note"] == "") & (points["engine"] != REFERENCE)]
    sets = [*(rows for _, _, rows in contenders(points)), plain]
    errors = [[(rows.index.to_numpy(), rows[f"{group}_max"].to_numpy()) for rows in sets] for group in groups(speed)]
    found = (tuple(places[error <= limit]) for of, limit in product(errors, LEVELS.values()) for places, error in of)
    return [np.array(places) for places in dict.fromkeys(found) if len(places) > 1]


def in_doubt(contests: Sequence[NDArray[np.intp]], times: Sequence[float]) -> list[int]:
    """Return the settings whose times, s, more rounds should make sure of, by their places.

    Those are near the limit up to which settings of a contest are level, and the fastest of that contest.
    """
    doubtful: set[int] = set()
    for places in contests:
        ratio = np.array(times)[places] / min(times[place] for place in places)
        near = (np.abs(np.log(ratio / (1 + TIE))) < np.log(DOUBT)) & (ratio > 1)
        if near.any():
            doubtful |= {int(place) for place in places[near | (ratio == 1)]}
    return sorted(doubtful)


def within(engine: str, accuracy: float, speed: pd.DataFrame) -> list[Settings]:
    """Return an engine's settings without a note that meet an accuracy in every group: the cheapest first.

    Each that follows is the cheapest of those more accurate than the ones before.
    """
    points = solved(speed)
    points = points[(points["engine"] == engine) & (points["note"] == "")]
    points = points.assign(worst=points[[f"{group}_max" for group in groups(speed)]].max(axis=1, skipna=False))
    by_label = {settings.label: settings for settings in settings_of(engine, full=True)}
    good = front(points[points["worst"] <= accuracy], "worst")
    return [by_label[label] for label in good["setting"]]


# --- fits within a family --------------------------------------------------------------------------------------------


def families(speed: pd.DataFrame, steps: str) -> Iterator[tuple[dict[str, object], pd.DataFrame]]:
    """Yield engine, family and expected order, and the family's settings from the fewest to the most of `steps`."""
    points = solved(speed)
    if len(points):
        for (engine, family), rows in points[points["family"] != ""].groupby(["engine", "family"], sort=False):
            named = {"engine": engine, "family": family, "expected_order": rows["expected_order"].iloc[0]}
            counts, first = np.unique(rows[steps].to_numpy(float), return_index=True)
            yield named, rows.take(first[~np.isnan(counts)])


def orders(speed: pd.DataFrame, floors: Mapping[str, float]) -> pd.DataFrame:
    """Return every family's order of convergence by channel group, NaN where it has not settled or few errors count.

    The order is the slope of log(largest error) against log(steps per cycle) by least squares, `residual` the root mean
    square of what that leaves, in decades. The longest straight run of settings counts: theory is not about the
    coarsest, and the finest may feel a floor. `local_orders` are the slopes from each of its settings to the next; the
    order has settled where the last ones agree with each other and with it. `floors` are the reference's.
    """
    rows = []
    for named, points in families(speed, "steps"):
        for group in groups(speed):
            steps, errors = points["steps"].to_numpy(float), points[f"{group}_max"].to_numpy(float)
            above = above_floor(steps, errors, floors.get(group, 0.0))
            order, residual, local = _order(np.log10(steps[:above]), np.log10(errors[:above]))
            settled = local and np.ptp([order, *local[-LAST:]]) <= SETTLED
            rows.append(named | {"group": group, "order": order if settled else np.nan, "residual": residual})
            rows[-1] |= {"local_orders": local, "points": len(local) + 1 if local else 0}
    return pd.DataFrame(rows)


def above_floor(steps: Samples, errors: Samples, floor: float) -> int:
    """Return how many settings, from the coarsest on, have errors well above the reference's floor and their own.

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
        return np.nan, np.nan, []
    residuals = [_line(x[run], y[run])[1] for run in runs]
    straight = [run for run, residual in zip(runs, residuals, strict=True) if residual <= STRAIGHT]
    best = max(straight or [slice(0, len(x))], key=lambda run: run.stop - run.start)
    return *_line(x[best], y[best]), [float(slope) for slope in -np.diff(y[best]) / np.diff(x[best])]


def _line(x: Samples, y: Samples) -> tuple[float, float]:
    line = np.polynomial.Polynomial.fit(x, y, 1)
    return -float(line.convert().coef[1]), float(np.sqrt(np.mean((y - line(x)) ** 2)))


def step_costs(speed: pd.DataFrame) -> pd.DataFrame:
    """Return the cost of a step in every family, and the fixed cost of a run, s, by time = fixed + steps * step.

    Least squares of the relative errors, whose root mean square is `residual`; steps are all that were made, those
    before the first sample and those of every Richardson level.
    """
    rows = []
    for named, points in families(speed, "steps_made"):
        if len(points) >= LEAST_POINTS:
            time, steps = points["solve_min_s"].to_numpy(float), points["steps_made"].to_numpy(float)
            relative = np.column_stack([1 / time, steps / time])
            (fixed, step), *_ = np.linalg.lstsq(relative, np.ones(len(time)))
            residual = np.sqrt(np.mean((relative @ (fixed, step) - 1) ** 2))
            rows.append(named | {"fixed_s": fixed, "step_s": step, "residual": residual, "points": len(time)})
    return pd.DataFrame(rows).drop(columns="expected_order", errors="ignore")

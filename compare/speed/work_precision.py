"""Results of a speed table: the cheapest setting for every error, orders of convergence, the cost of a step.

Settings with a note, such as an engine's own defaults or fictitious masses, compete apart: they have their own rows in
every comparison and are never the cheapest, since nobody should take them, or since they are no independent check.
"""

from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from scenes import Settings, Status
from scenes.motion import Samples

from ..engines.settings import WORK_PRECISION, settings_of
from ..judge.errors import SHOWN_GROUPS

LEVELS: Mapping[str, float] = {"10 %": 1e-1, "1 %": 1e-2, "0.1 %": 1e-3, "1e-4": 1e-4, "1e-6": 1e-6, "1e-8": 1e-8}
TIE = 0.1  # of the time: what two runs of one setting may differ by on a busy machine
ABOVE_FLOOR = 10.0  # times the floor: there the floor is a tenth of the error at most
LEAST_POINTS = 3  # of a fit, so that it has a residual
STRAIGHT = 0.02  # decades: where theory holds errors lie on a line as well as this


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


def cheapest(points: pd.DataFrame, error: str, level: float) -> "pd.Series[Any] | None":
    """Return the fastest of the settings whose error is at most `level`; of those as fast, the most accurate."""
    times, errors = points["solve_min_s"].to_numpy(float), points[error].to_numpy(float)
    good = errors <= level
    if not good.any():
        return None
    as_fast = good & (times <= (1 + TIE) * times[good].min())
    return points.iloc[int(np.where(as_fast, errors, np.inf).argmin())]


def front(points: pd.DataFrame, error: str) -> pd.DataFrame:
    """Return the Pareto front, fastest first: every setting without a note that is the cheapest for some error."""
    plain = points[points["note"] == ""]
    best = [found.name for level in plain[error] if (found := cheapest(plain, error, level)) is not None]
    return plain.loc[list(dict.fromkeys(best))].sort_values("solve_min_s", kind="stable")


def choices(speed: pd.DataFrame) -> pd.DataFrame:
    """Return the cheapest setting by channel group, engine and note, and level of the largest error.

    `ratio` is its time over that of the cheapest setting without a note, of any engine.
    """
    points = solved(speed)
    plain = points[points["note"] == ""] if len(points) else points
    rows = []
    for group, (engine, note, settings), level in product(groups(speed), list(contenders(points)), LEVELS):
        row: dict[str, object] = {"group": group, "level": level, "engine": engine, "note": note, "setting": ""}
        best, least = (cheapest(compared, f"{group}_max", LEVELS[level]) for compared in (settings, plain))
        if best is not None:
            time, shortest = best["solve_min_s"], np.nan if least is None else least["solve_min_s"]
            row |= {
                "setting": best["setting"],
                "solve_s": time,
                "error": best[f"{group}_max"],
                "ratio": time / shortest,
            }
        rows.append(row)
    return pd.DataFrame(rows)


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
            yield named, rows[rows[steps].notna()].drop_duplicates(steps).sort_values(steps)


def orders(speed: pd.DataFrame, floors: Mapping[str, float]) -> pd.DataFrame:
    """Return every family's order of convergence by channel group, NaN where too few of its errors are above a floor.

    The order is the slope of log(largest error) against log(steps per cycle) by least squares, `residual` the root mean
    square of what that leaves, in decades. The longest straight run of settings counts: theory is not about the
    coarsest, and the finest may feel a floor. `floors` are the reference's.
    """
    rows = []
    for named, points in families(speed, "steps"):
        for group in groups(speed):
            steps, errors = points["steps"].to_numpy(float), points[f"{group}_max"].to_numpy(float)
            above = above_floor(steps, errors, floors.get(group, 0.0))
            order, residual, used = _order(np.log10(steps[:above]), np.log10(errors[:above]))
            rows.append(named | {"group": group, "order": order, "residual": residual, "points": used})
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


def _order(x: Samples, y: Samples) -> tuple[float, float, int]:
    """Return order, residual and length of the longest run of settings that is straight, or else of the straightest."""
    runs = [slice(i, j) for i in range(len(x)) for j in range(i + LEAST_POINTS, len(x) + 1)]
    fits = [(*_line(x[run], y[run]), run.stop - run.start) for run in runs]
    best = (np.nan, np.nan, 0)
    return min(fits, key=lambda fit: (-fit[2] if fit[1] <= STRAIGHT else 0, fit[1]), default=best)


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

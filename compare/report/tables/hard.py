"""Results of the hard cases: counts, a sentence, and every ladder rung by rung."""

from collections.abc import Hashable, Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd

from scenes import hard

from ...engines.registry import tiers
from ...measure.hard.case import Outcome
from ...mechanics.mechanics import SHOWN_GROUPS
from . import TableRows

FINDERS = ("engine", "checks", "isolation", "reader")
WRONG = (Outcome.silent, Outcome.false_alarm, Outcome.uncertified)


def counts(cases: pd.DataFrame) -> TableRows:
    """One row an engine: how many attempts came out how, and by what the failures were noticed."""
    return [
        {"engine": engine, "attempts": len(rows)}
        | {str(outcome): int((rows["outcome"] == outcome).sum()) for outcome in (Outcome.right, Outcome.refused)}
        | {
            f"by {finder}": int(((rows["outcome"] == Outcome.refused) & (rows["found_by"] == finder)).sum())
            for finder in FINDERS
        }
        | {str(outcome): int((rows["outcome"] == outcome).sum()) for outcome in WRONG}
        for engine, rows in cases.groupby("engine", sort=False)
    ]


def promises(cases: pd.DataFrame) -> str:
    """What the engines promise at their default settings."""
    return ", ".join(f"{name} {tiers(name)['balanced'].promise:.0e}" for name in dict.fromkeys(cases["engine"]))


def verdict(cases: pd.DataFrame) -> str:
    """The result of the catalogue, in a sentence."""
    if cases.empty:
        return "No hard case was run."
    series, linkages = cases["ladder"].nunique(), len(cases[["ladder", "rung"]].drop_duplicates())
    silent, alarms = (int((cases["outcome"] == outcome).sum()) for outcome in (Outcome.silent, Outcome.false_alarm))
    tried = f"{len(cases)} runs of {linkages} linkages, in {series} series from easy to impossible"
    return f"{tried}: {silent} wrong results passed for right ones, {alarms} right results were refused."


def digits(cases: pd.DataFrame) -> TableRows:
    """The digits that the reference loses, and those that the condition allows, on the rungs that count them."""
    groups = [group for group in SHOWN_GROUPS if f"{group}_lost" in cases]
    counted = cases[cases[f"{groups[0]}_lost"].notna()] if groups else cases.iloc[:0]
    return [
        {"series": row["ladder"], "linkage": row["rung"], "κ": row["condition"]}
        | {group: _of_allowed(row[f"{group}_lost"], row[f"{group}_allowed"]) for group in groups}
        for row in counted.to_dict("records")
    ]


def _of_allowed(lost: float, allowed: float) -> str:
    return "–" if np.isnan(lost) and np.isnan(allowed) else f"{lost:.1f} of {allowed:.1f}"


def ladders(cases: pd.DataFrame) -> Iterator[tuple[hard.Ladder, TableRows]]:
    """Yield every ladder with a row a rung: status and error of each engine, attempt after attempt."""
    for name, on_ladder in cases.groupby("ladder", sort=False):
        ladder = hard.ladder(str(name))
        rows: list[dict[str, object]] = []
        for rung, on_rung in on_ladder.groupby("rung", sort=False):
            rows.append({ladder.file.parameter: rung, "condition": on_rung["condition"].max()})
            for engine, attempts in on_rung.groupby("engine", sort=False):
                rows[-1][str(engine)] = "; then ".join(map(_result, attempts.to_dict("records")))
        yield ladder, rows


def _result(attempt: Mapping[Hashable, Any]) -> str:
    """An attempt in a few words: status, largest error that round-off does not explain, and by what it was noticed."""
    words = [str(attempt["status"])]
    errors = np.array([attempt.get(f"{group}_unexplained", np.nan) for group in SHOWN_GROUPS], dtype=float)
    if not np.isnan(worst := np.fmax.reduce(errors)):
        words.append(f"{worst:.0e}" if worst > 0 else "as doubles can")
    if attempt["outcome"] == Outcome.refused and attempt["found_by"] != "engine":
        words.append(f"({attempt['found_by']})")
    if attempt["outcome"] in WRONG:
        words.append(f"({attempt['outcome']})")
    return " ".join(words)

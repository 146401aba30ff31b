"""Results of the hard cases: counts, a sentence, and every ladder rung by rung."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from scenes import hard

from ...hard.case import Outcome
from ...judge.errors import SHOWN_GROUPS

FINDERS = ("engine", "checks", "isolation", "reader")


def counts(cases: pd.DataFrame) -> pd.DataFrame:
    """Return one row per engine: how many attempts came out how, and who found the failures."""
    rows = []
    for engine, attempts in cases.groupby("engine", sort=False):
        outcomes, refused = attempts["outcome"], attempts[attempts["outcome"] == Outcome.refused]
        found = {f"by {finder}": int((refused["found_by"] == finder).sum()) for finder in FINDERS}
        rows.append(
            {"engine": engine, "attempts": len(attempts), "right": int((outcomes == Outcome.right).sum())}
            | {"refused": len(refused)}
            | found
            | {str(o): int((outcomes == o).sum()) for o in (Outcome.silent, Outcome.false_alarm, Outcome.uncertified)}
        )
    return pd.DataFrame(rows)


def verdict(cases: pd.DataFrame) -> str:
    """Return the result of the catalogue, in a sentence."""
    if cases.empty:
        return "No hard case was run."
    series, linkages = cases["ladder"].nunique(), len(cases[["ladder", "rung"]].drop_duplicates())
    outcomes = Outcome.silent, Outcome.false_alarm
    silent, alarms = (int((cases["outcome"] == outcome).sum()) for outcome in outcomes)
    tried = f"{len(cases)} runs of {linkages} linkages, in {series} series from easy to impossible"
    return f"{tried}: {silent} wrong results passed for right ones, {alarms} right results were refused."


def digits(cases: pd.DataFrame) -> pd.DataFrame:
    """Return the digits that the reference loses, and those that the condition allows, on the rungs that count them."""
    groups = [group for group in SHOWN_GROUPS if f"{group}_lost" in cases]
    counted = cases[cases[f"{groups[0]}_lost"].notna()] if groups else cases.iloc[:0]
    rows = (
        {"series": row["ladder"], "linkage": row["rung"], "κ": row["condition"]}
        | {
            group: f"{row[f'{group}_lost']:.1f} of {row[f'{group}_allowed']:.1f}".replace("nan of nan", "–")
            for group in groups
        }
        for row in counted.to_dict("records")
    )
    return pd.DataFrame(rows)


def ladders(cases: pd.DataFrame) -> Iterator[tuple[hard.Ladder, pd.DataFrame]]:
    """Yield every ladder with a row per rung: status and error of each engine, attempt after attempt."""
    for name, on_ladder in cases.groupby("ladder", sort=False):
        ladder = hard.ladder(str(name))
        rows = []
        for rung, on_rung in on_ladder.groupby("rung", sort=False):
            row: dict[str, object] = {ladder.parameter: rung, "condition": on_rung["condition"].max()}
            for engine, attempts in on_rung.groupby("engine", sort=False):
                row[str(engine)] = "; then ".join(_result(attempt) for _, attempt in attempts.iterrows())
            rows.append(row)
        yield ladder, pd.DataFrame(rows)


def _result(attempt: "pd.Series[Any]") -> str:
    """Return an attempt in a few words: status, largest error that round-off does not explain, and who found it."""
    words = [str(attempt["status"])]
    errors = np.array([attempt.get(f"{group}_unexplained", np.nan) for group in SHOWN_GROUPS], dtype=float)
    if not np.isnan(errors).all():
        worst = np.nanmax(errors)
        words.append(f"{worst:.0e}" if worst > 0 else "as doubles can")
    if attempt["outcome"] == Outcome.refused and attempt["found_by"] != "engine":
        words.append(f"({attempt['found_by']})")
    if attempt["outcome"] in (Outcome.silent, Outcome.false_alarm, Outcome.uncertified):
        words.append(f"({attempt['outcome']})")
    return " ".join(words)

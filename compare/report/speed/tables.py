"""Speed against error as a reader wants it: one sentence, and tables of text."""

import re
from typing import Any

import pandas as pd

from ...engines.axis import cycle_name
from ...engines.registry import REFERENCE
from ...engines.settings import ABLATION
from ...judge.errors import group_floors
from ...speed import work_precision
from ...speed.work_precision import LEVELS, cheapest, contenders, groups, solved
from ...study import Study

SAID = "0.1 %"  # the level of the sentence
NOUNS = {"position": "positions", "velocity": "velocities", "acceleration": "accelerations", "reaction": "reactions"}
SIZES = ("bodies", "coordinates", "constraints", "sensors")  # counters of what was modelled


def said_group(study: Study) -> str | None:
    """Return the channel group that matters most: the reactions, or else the last that was measured."""
    found = groups(study.speed)
    return "reaction" if "reaction" in found else found[-1] if found else None


def contender(engine: str, note: str) -> str:
    """Return the name of an engine's settings with this note: the engine, and the note up to its first comma."""
    return engine if not note else f"{engine}: {re.split('[:,]', note)[0]}"


def verdict(study: Study) -> str:
    """Return which setting is the cheapest for what matters most, in one sentence."""
    group = said_group(study)
    points = solved(study.speed)
    if group is None or points.empty:
        return ""
    points = points[points["note"] == ""]
    best = cheapest(points, f"{group}_max", LEVELS[SAID])
    said = f"Cheapest setting that gives {NOUNS.get(group, group)} to {SAID}: "
    if best is None:
        return f"{said}none that was tried."
    said += _setting(study, best)
    if best["engine"] == REFERENCE:
        best = cheapest(points[points["engine"] != REFERENCE], f"{group}_max", LEVELS[SAID])
        said += f"; besides the reference: {_setting(study, best)}" if best is not None else ""
    return f"{said}."


def _setting(study: Study, row: "pd.Series[Any]") -> str:
    return f"{row['engine']}, {row['setting']}, {1e3 * row['solve_min_s']:.3g} ms a {cycle_name(study.scene)}"


def cheapest_settings(study: Study) -> dict[str, pd.DataFrame]:
    """Return the cheapest setting by channel group: a column a level of the largest error, a row an engine and note."""
    choices = work_precision.choices(study.speed)
    if choices.empty:
        return {}
    choices["engine"] = [contender(row["engine"], row["note"]) for row in choices.to_dict("records")]
    choices["said"] = [
        f"{row['setting']}, {1e3 * row['solve_s']:.3g} ms (×{row['ratio']:.3g})" if row["setting"] else "–"
        for row in choices.to_dict("records")
    ]
    return {
        str(group): _pivot(rows, ["engine"], "level", "said") for group, rows in choices.groupby("group", sort=False)
    }


def notes(study: Study) -> list[str]:
    """Return what a reader has to know about settings, by what the tables call them."""
    pairs = dict.fromkeys((engine, note) for engine, note, _ in contenders(solved(study.speed)) if note)
    return [f"{engine}: {note}" for engine, note in pairs]


def orders(study: Study) -> pd.DataFrame:
    """Return the orders of convergence, a column a channel group, a row a family; none without three good settings."""
    found = work_precision.orders(study.speed, group_floors(study.reference))
    if found.empty:
        return found
    found = found[found.groupby(["engine", "family"])["order"].transform(lambda order: order.notna().any())]
    said = [
        f"{row['order']:.2f} ({row['residual']:.1g}, {row['points']})" if row["order"] == row["order"] else "–"
        for row in found.to_dict("records")
    ]
    expected = ["–" if order != order else f"{order:g}" for order in found["expected_order"]]
    return _pivot(found.assign(said=said, expected=expected), ["engine", "family", "expected"], "group", "said")


def _pivot(table: pd.DataFrame, rows: list[str], columns: str, values: str) -> pd.DataFrame:
    """Return one row for each of `rows`, in the order in which they and the columns come."""
    wide = table.pivot_table(index=rows, columns=columns, values=values, aggfunc="first", sort=False)
    return wide[list(dict.fromkeys(table[columns]))].rename_axis(columns=None).reset_index()


def step_costs(study: Study) -> pd.DataFrame:
    """Return what a step costs in every family of settings, and a run besides."""
    found = work_precision.step_costs(study.speed)
    if found.empty:
        return found
    return pd.DataFrame(
        {
            "engine": found["engine"],
            "family": found["family"],
            "a step [µs]": 1e6 * found["step_s"],
            "besides [ms]": 1e3 * found["fixed_s"],
            "residual [%]": 1e2 * found["residual"],
            "settings": found["points"],
        }
    )


def ablations(study: Study) -> pd.DataFrame:
    """Return what more than the scene needs costs: sizes, steps, and time a step over that of the engine's default."""
    speed = study.speed
    tables = []
    for engine in speed["engine"][speed["role"] == ABLATION].unique() if len(speed) else ():
        own = speed[speed["engine"] == engine]
        own = pd.concat([own[own["tier"].str.contains("balanced")], own[own["role"] == ABLATION]])
        counters = [dict(pair.split("=") for pair in text.split()) for text in own["counters"]]
        a_step = own["solve_min_s"] / own["steps_made"].fillna(1)
        tables.append(
            own[["engine", "setting", "status"]]
            .assign(**{size: [count.get(size, "–") for count in counters] for size in SIZES})
            .assign(
                steps=own["steps_made"].astype("Int64"),
                **{"a step [µs]": 1e6 * a_step, "ratio": a_step / a_step.iloc[0]},
            )
        )
    return pd.concat(tables) if tables else pd.DataFrame()

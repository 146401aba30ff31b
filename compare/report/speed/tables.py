"""Speed against error as a reader wants it: one sentence, and tables of text."""

import re
from collections.abc import Hashable, Mapping
from typing import Any

import pandas as pd

from ...engines.axis import cycle_name
from ...engines.registry import REFERENCE
from ...engines.settings import ABLATION
from ...speed.work_precision import LEVELS, as_fast, contenders, groups, solved, standing
from ...study import Study

LEVEL = "0.1 %"  # of the sentence
NOUNS = {"position": "positions", "velocity": "velocities", "acceleration": "accelerations", "reaction": "reactions"}
SIZES = ("bodies", "coordinates", "constraints", "sensors")  # counters of what was modelled


def contender(engine: str, note: str) -> str:
    """Return the name of an engine's settings with this note: the engine, and the start of the note."""
    return engine if not note else f"{engine}: {re.split('[:,]', note)[0]}"


def main_group(study: Study) -> str | None:
    """Return the channel group that matters most: the reactions, or else the last that was measured."""
    found = groups(study.speed)
    return "reaction" if "reaction" in found else found[-1] if found else None


def verdict(study: Study) -> str:
    """Return which setting is the cheapest for what matters most, in one sentence; several where they are level."""
    group, points = main_group(study), solved(study.speed)
    if group is None or points.empty:
        return ""
    points, error, limit = points[points["note"] == ""], f"{group}_max", LEVELS[LEVEL]
    best = {engine: as_fast(rows, error, limit) for engine, rows in points.groupby("engine", sort=False)}
    reference = REFERENCE in set(as_fast(points, error, limit)["engine"])
    named = [_setting(study, best[REFERENCE])] if reference else []
    others = [engine for engine, stands in standing(points, error, limit).items() if stands != "dearer"]
    if others:
        where = ["besides the reference"] * reference + ["level"] * (len(others) > 1)
        settings = " and ".join(_setting(study, best[engine]) for engine in others)
        named.append(": ".join(filter(None, (", ".join(where), settings))))
    found = "; ".join(named) or "none that was tried"
    return f"Cheapest setting that gives {NOUNS.get(group, group)} to {LEVEL}: {found}."


def _setting(study: Study, level: pd.DataFrame) -> str:
    row, others = level.iloc[0], len(level) - 1
    also = f" (level with {others} more of its settings)" if others else ""
    return f"{row['engine']}, {row['setting']}, {1e3 * row['solve_min_s']:.3g} ms per {cycle_name(study.scene)}{also}"


def notes(study: Study) -> list[str]:
    """Return the notes of settings, by the engine's name in the tables."""
    pairs = dict.fromkeys((engine, note) for engine, note, _ in contenders(solved(study.speed)) if note)
    return [f"{engine}: {note}" for engine, note in pairs]


def cheapest_settings(study: Study) -> dict[str, pd.DataFrame]:
    """Return the cheapest setting by channel group: a column per level of the largest error, a row per contender."""
    tables: dict[str, dict[str, dict[str, str]]] = {}  # by group, name of the engine with its note, level
    for row in study.cheapest.to_dict("records"):
        rows = tables.setdefault(row["group"], {})
        rows.setdefault(contender(row["engine"], row["note"]), {}).setdefault(row["level"], _choice(row))
    return {
        group: pd.DataFrame([{"engine": name} | row for name, row in rows.items()]) for group, rows in tables.items()
    }


def _choice(row: Mapping[Hashable, Any]) -> str:
    """Return a setting with its time, that over the fastest of all, and what is level with it."""
    if not row["setting"]:
        return "–"
    others = len(row["level_with"].split("; ")) if row["level_with"] else 0
    level = [f"×{row['ratio']:.3g}", f"level with {others} more" if others else ""]
    level.append({"cheapest": "cheapest engine", "level": "engines level"}.get(row["standing"], ""))
    return f"{row['setting']}, {1e3 * row['solve_s']:.3g} ms ({', '.join(filter(None, level))})"


def orders(study: Study) -> pd.DataFrame:
    """Return the orders of convergence, a column per channel group, a row per family that has three good settings."""
    rows: dict[tuple[str, str], dict[str, str]] = {}
    for row in study.orders.to_dict("records"):
        family = {"engine": row["engine"], "family": row["family"], "expected": _expected(row["expected_order"])}
        local = ", ".join(f"{order:.2f}" for order in row["local_orders"])
        fit = f"{row['order']:.2f}" if row["order"] == row["order"] else "not settled"
        text = f"{fit} ({local}; {row['residual']:.1g})" if local else "–"
        rows.setdefault((row["engine"], row["family"]), family)[row["group"]] = text
    known = set(groups(study.speed))
    return pd.DataFrame([row for row in rows.values() if any(row[group] != "–" for group in known & row.keys())])


def _expected(order: float) -> str:
    return "–" if order != order else f"{order:g}"


def step_costs(study: Study) -> pd.DataFrame:
    """Return the cost of a step in every family of settings, and the fixed cost of a run."""
    found = study.step_costs
    if found.empty:
        return found
    costs = {"per step [µs]": 1e6 * found["step_s"], "fixed [ms]": 1e3 * found["fixed_s"]}
    quality = {"residual [%]": 1e2 * found["residual"], "settings": found["points"]}
    return found[["engine", "family"]].assign(**costs, **quality)


def ablations(study: Study) -> pd.DataFrame:
    """Return the cost of modelling more than a scene needs: sizes, steps, time per step over that of the default."""
    speed = study.speed
    rows = []
    for engine in speed["engine"][speed["role"] == ABLATION].unique() if len(speed) else ():
        settings = speed[speed["engine"] == engine]
        default = settings[settings["tier"].str.contains("balanced")]
        measured = pd.concat([default, settings[settings["role"] == ABLATION]])
        seconds = measured["solve_min_s"] / measured["steps_made"].fillna(1)
        for row, a_step in zip(measured.to_dict("records"), seconds, strict=True):
            counters = dict(pair.split("=") for pair in row["counters"].split())
            named = {name: row[name] for name in ("engine", "setting", "status")}
            sizes = {size: counters.get(size, "–") for size in SIZES} | {"steps": row["steps_made"]}
            rows.append(named | sizes | {"per step [µs]": 1e6 * a_step, "ratio": a_step / seconds.iloc[0]})
    return pd.DataFrame(rows).astype({"steps": "Int64"} if rows else {})

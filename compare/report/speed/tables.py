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
    """Return which setting is the cheapest for what matters most, in one sentence."""
    group, points = main_group(study), solved(study.speed)
    if group is None or points.empty:
        return ""
    points, error, level = points[points["note"] == ""], f"{group}_max", LEVELS[LEVEL]
    best = cheapest(points, error, level)
    named = [] if best is None else [_setting(study, best)]
    if best is not None and best["engine"] == REFERENCE:
        other = cheapest(points[points["engine"] != REFERENCE], error, level)
        named += [] if other is None else [f"besides the reference: {_setting(study, other)}"]
    settings = "; ".join(named) or "none that was tried"
    return f"Cheapest setting that gives {NOUNS.get(group, group)} to {LEVEL}: {settings}."


def _setting(study: Study, row: "pd.Series[Any]") -> str:
    return f"{row['engine']}, {row['setting']}, {1e3 * row['solve_min_s']:.3g} ms per {cycle_name(study.scene)}"


def notes(study: Study) -> list[str]:
    """Return the notes of settings, by the engine's name in the tables."""
    pairs = dict.fromkeys((engine, note) for engine, note, _ in contenders(solved(study.speed)) if note)
    return [f"{engine}: {note}" for engine, note in pairs]


def cheapest_settings(study: Study) -> dict[str, pd.DataFrame]:
    """Return the cheapest setting by channel group: a column per level of the largest error, a row per contender."""
    tables: dict[str, dict[str, dict[str, str]]] = {}  # by group, name of the engine with its note, level
    for row in work_precision.choices(study.speed).to_dict("records"):
        rows = tables.setdefault(row["group"], {})
        text = f"{row['setting']}, {1e3 * row['solve_s']:.3g} ms (×{row['ratio']:.3g})" if row["setting"] else "–"
        rows.setdefault(contender(row["engine"], row["note"]), {}).setdefault(row["level"], text)
    return {
        group: pd.DataFrame([{"engine": name} | row for name, row in rows.items()]) for group, rows in tables.items()
    }


def orders(study: Study) -> pd.DataFrame:
    """Return the orders of convergence, a column per channel group, a row per family that has three good settings."""
    rows: dict[tuple[str, str], dict[str, str]] = {}
    for row in work_precision.orders(study.speed, group_floors(study.reference)).to_dict("records"):
        family = {"engine": row["engine"], "family": row["family"], "expected": _order(row["expected_order"], "g")}
        text = _order(row["order"], ".2f", f" ({row['residual']:.1g}, {row['points']})")
        rows.setdefault((row["engine"], row["family"]), family)[row["group"]] = text
    known = set(groups(study.speed))
    return pd.DataFrame([row for row in rows.values() if any(row[group] != "–" for group in known & row.keys())])


def _order(order: float, form: str, quality: str = "") -> str:
    return "–" if order != order else f"{order:{form}}{quality}"


def step_costs(study: Study) -> pd.DataFrame:
    """Return the cost of a step in every family of settings, and the fixed cost of a run."""
    found = work_precision.step_costs(study.speed)
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

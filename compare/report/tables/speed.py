"""Speed against error as a reader wants it: one sentence, and tables of text."""

import re
from math import isnan

from ...engines.registry import ABLATION, REFERENCE
from ...measure.speed.share import LEFT_OUT
from ...measure.speed.work_precision import CHOICE_TOL, Choice, contenders, groups, solved
from ...mechanics.axis import cycle_name
from ...study import Study
from . import TableRows

LEVEL = "0.1 %"  # of the sentence
NOUNS = {"position": "positions", "velocity": "velocities", "acceleration": "accelerations", "reaction": "reactions"}
SIZES = ("bodies", "coordinates", "constraints", "sensors", "steps")  # counters of what was modelled


def contender(engine: str, note: str) -> str:
    """The name of an engine's settings with this note: the engine, and the start of the note."""
    return engine if not note else f"{engine}: {re.split('[:,]', note)[0]}"


def main_group(study: Study) -> str | None:
    """The channel group that matters most: the reactions, or else the last that was measured."""
    known = groups(study.speed)
    return "reaction" if "reaction" in known else known[-1] if known else None


def verdict(study: Study) -> str:
    """Which setting is the cheapest for what matters most, in one sentence; several where they are level."""
    group = main_group(study)
    able = [choice for choice in study.cheapest if (choice.group, choice.level) == (group, LEVEL) and not choice.note]
    if group is None or not able:
        return ""
    cycle = cycle_name(study.scene)
    texts = {c: f"{c.engine} with the setting “{c.setting}”, {1e3 * c.solve_s:.3g} ms per {cycle}" for c in able}
    named = [text for choice, text in texts.items() if choice.engine == REFERENCE and choice.ratio <= 1 + CHOICE_TOL]
    others = [text for choice, text in texts.items() if choice.standing in ("cheapest", "level")]
    if others:
        alike = "of the other engines, " * len(named) + "about equally fast, " * (len(others) > 1)
        named.append(alike + " and ".join(others))
    fastest = "; ".join(named) or "no setting that was tried"
    return f"The fastest way to {NOUNS.get(group, group)} within {LEVEL}: {fastest}."


def left_out(study: Study) -> str:
    """The settings that were too much for the table, in one sentence, or nothing."""
    rows: dict[str, list[str]] = {}
    for row in study.speed:
        if row.reason == LEFT_OUT:
            rows.setdefault(row.engine, []).append(row.setting)
    count = sum(map(len, rows.values()))
    named = "; ".join(f"{engine}: {', '.join(settings)}" for engine, settings in rows.items())
    settings = f"{count} of {len(study.speed)} settings"
    return f"Speed against error is of all but {settings}, {LEFT_OUT} ({named})." if rows else ""


def notes(study: Study) -> list[str]:
    """The notes of settings, by the engine's name in the tables."""
    return [f"{engine}: {note}" for engine, note, _ in contenders(solved(study.speed)) if note]


def cheapest_settings(study: Study) -> dict[str, TableRows]:
    """The cheapest setting by channel group: a column per level of the largest error, a row per contender."""
    tables: dict[str, dict[str, dict[str, object]]] = {}  # by group, name of the engine with its note, level
    for choice in study.cheapest:
        name = contender(choice.engine, choice.note)
        row = tables.setdefault(choice.group, {}).setdefault(name, {"engine": name})
        row.setdefault(choice.level, _choice(choice))
    return {group: [*rows.values()] for group, rows in tables.items()}


def _choice(choice: Choice) -> str:
    """A setting with its time, that over the fastest of all, and what is level with it."""
    if not choice.setting:
        return "–"
    more = f"level with {len(choice.level_with.split('; '))} more" if choice.level_with else ""
    stands = {"cheapest": "cheapest engine", "level": "engines level"}.get(choice.standing or "", "")
    level = ", ".join(filter(None, (f"×{choice.ratio:.3g}", more, stands)))
    return f"{choice.setting}, {1e3 * choice.solve_s:.3g} ms ({level})"


def orders(study: Study) -> TableRows:
    """The orders of convergence, a column per channel group, a row per family that has three good settings."""
    rows: dict[tuple[str, str], dict[str, object]] = {}
    for order in study.orders:
        expected = "–" if order.expected_order is None else f"{order.expected_order:g}"
        family: dict[str, object] = {"engine": order.engine, "family": order.family, "expected": expected}
        fit = "not settled" if isnan(order.order) else f"{order.order:.2f}"
        local = ", ".join(f"{order:.2f}" for order in order.local_orders)
        text = f"{fit} ({local}; {order.residual:.1g})" if local else "–"
        rows.setdefault((order.engine, order.family), family)[order.group] = text
    known = set(groups(study.speed))
    return [row for row in rows.values() if any(row[group] != "–" for group in known & row.keys())]


def step_costs(study: Study) -> TableRows:
    """Yield the cost of a step in every family of settings, and the fixed cost of a run."""
    for cost in study.step_costs:
        times = {"per step [µs]": 1e6 * cost.step_s, "fixed [ms]": 1e3 * cost.fixed_s}
        fit = {"residual [%]": 1e2 * cost.residual, "settings": cost.points}
        yield {"engine": cost.engine, "family": cost.family, **times, **fit}


def ablations(study: Study) -> TableRows:
    """Yield the cost of modelling more than a scene needs: sizes, steps, time per step over that of the default."""
    for engine in dict.fromkeys(row.engine for row in study.speed if row.role == ABLATION):
        rows_of_engine = [row for row in study.speed if row.engine == engine]
        measured = [row for row in rows_of_engine if "balanced" in row.tier] + [
            row for row in rows_of_engine if row.role == ABLATION
        ]
        seconds = [row.solve_min_s / (row.counters.get("steps") or 1) for row in measured]
        for row, a_step in zip(measured, seconds, strict=True):
            sizes = {size: row.counters.get(size, "–") for size in SIZES}
            named = {"engine": engine, "setting": row.setting, "status": row.status}
            yield {**named, **sizes, "per step [µs]": 1e6 * a_step, "ratio": a_step / seconds[0]}

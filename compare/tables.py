"""The report's tables, as data frames: what `summary.json`, the page and the terminal all show."""

from dataclasses import asdict
from math import pi

import pandas as pd

from scenes import Status

from . import registry
from .registry import REFERENCE
from .study import Study

SHOWN_GROUPS = ("position", "velocity", "acceleration", "reaction", "torque")


def overview(study: Study) -> pd.DataFrame:
    """Return one row an engine: status, largest error by group, times. Failed engines keep their row."""
    rows = []
    for m in study.measurements:
        worst = {} if m.errors.empty else m.errors.groupby("group")["max"].max(skipna=False).to_dict()
        rows.append(
            {
                "engine": m.run.engine,
                "status": m.run.status.name,
                "setting": m.run.settings.label if m.run.settings else "",
            }
            | {group: worst.get(group, float("nan")) for group in SHOWN_GROUPS}
            | {"build [ms]": 1e3 * m.run.build_s, "solve [ms]": 1e3 * m.run.solve_s, "read [ms]": 1e3 * m.run.read_s}
        )
    return pd.DataFrame(rows)


def by_group(study: Study) -> pd.DataFrame:
    """Return the largest errors of every engine and group: whole run, last turn, toggle windows, commanded angle."""
    columns = ["max", "rms", "last_turn_max", "toggle_max", "commanded_max", "commanded_rms"]
    errors = study.errors
    if errors.empty:
        return errors
    groups = errors.groupby(["engine", "group"], sort=False)
    worst = pd.DataFrame([rows.iloc[int(rows["max"].to_numpy().argmax())] for _, rows in groups])
    table = groups[columns].max(skipna=False).reset_index()  # a NaN counts as the largest, here and above
    return table.assign(worst_channel=worst["channel"].to_numpy(), at_deg=worst["max_at_deg"].to_numpy())


def checks(study: Study) -> pd.DataFrame:
    """Return the worst violation of each reference-free check by engine, and the body it is about."""
    rows = [
        {
            "engine": m.run.engine,
            "check": c.check,
            "of": c.of,
            "worst": c.worst,
            "at_deg": c.at_deg,
            "relative to": c.relative_to,
        }
        for m in study.measurements
        for c in m.checks
    ]
    table = pd.DataFrame(rows)
    if table.empty:
        return table
    return table.loc[table.groupby(["engine", "check"], sort=False)["worst"].idxmax()].reset_index(drop=True)


def residuals(study: Study) -> pd.DataFrame:
    """Return every engine's own convergence checks and counters."""
    rows = [
        {"engine": m.run.engine, "quantity": name, "value": value}
        for m in study.measurements
        for name, value in (*m.run.residuals.items(), *m.run.counters.items())
    ]
    return pd.DataFrame(rows)


def gates(study: Study) -> pd.DataFrame:
    """Return every tolerance of the scene, the error measured, and whether it was met."""
    rows = [
        {
            "engine": g.engine,
            "group": g.group,
            "tolerance": g.tolerance,
            "error": g.error,
            "met": "missed" if g.missed else "met",
            "worst": g.worst,
        }
        for g in study.gates
    ]
    return pd.DataFrame(rows)


def notes(study: Study) -> list[str]:
    """Return what a reader must know: why runs failed, which channels are missing and why, how the floor was found."""
    floor = study.reference.floor
    said = [f"Floor of the reference: {floor.by}."]
    if floor.by_channel:
        said = [f"Floor of the reference: {max(floor.by_channel.values()):.1e} at most, certified by {floor.by}."]
    for m in study.measurements:
        if m.run.status is not Status.ok:
            said.append(f"{m.run.engine}: {m.run.status.name}. {m.run.status.value} Here: {m.run.reason}.")
        if m.run.motion is not None:
            said += [f"{m.run.engine} gives no {c}: {why}." for c, why in m.run.motion.unsupported.items()]
    return said


def setup(study: Study) -> str:
    """Return what was run, in one sentence."""
    scene, sampling = study.scene, study.sampling
    turns = "one turn" if sampling.turns == 1 else f"{sampling.turns} turns"
    rpm = scene.drive.speed * 30 / pi
    stroke = 1e3 * study.reference.stroke
    return (
        f"The {scene.drive.body} at {rpm:g} rpm, {turns}, {sampling.samples} samples a turn; stroke {stroke:.4f} mm."
        f" The reference's way: {registry.route(scene)}."
    )


def verdict(study: Study) -> str:
    """Return how far apart the models are, in one sentence."""
    solved = [m for m in study.measurements if m.run.status is Status.ok]
    said = f"{len(solved)} of {len(study.measurements)} engines solved the scene."
    others = study.errors[study.errors["engine"] != REFERENCE] if not study.errors.empty else study.errors
    for m in solved:
        rows = others[others["engine"] == m.run.engine]
        if not rows.empty:
            worst = rows.groupby("group")["max"].max(skipna=False)
            parts = [f"{worst[group]:.1e} in {group}" for group in SHOWN_GROUPS if group in worst]
            said += f" {m.run.engine} is within {', '.join(parts)} of the analytic core."
    return said


def settings(study: Study) -> pd.DataFrame:
    """Return every engine's version and settings."""
    rows = [
        {"engine": m.run.engine, "version": m.run.version}
        | {"settings": ", ".join(f"{k}={v}" for k, v in asdict(m.run.settings).items()) if m.run.settings else ""}
        for m in study.measurements
    ]
    return pd.DataFrame(rows)

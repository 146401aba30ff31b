"""The report's tables, as data frames: what `summary.json`, the page and the terminal all show."""

from dataclasses import asdict
from math import degrees, pi

import pandas as pd

from scenes import Scene, Status
from scenes.scene import ConstantSpeed

from ..engines import registry
from ..engines.axis import axis, cycle_name
from ..engines.registry import REFERENCE
from ..judge.errors import SHOWN_GROUPS
from ..study import Study


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
    """Return the largest errors of every engine and group: whole run, last turn, toggle windows, commanded position."""
    columns = ["max", "rms", "last_turn_max", "toggle_max", "commanded_max", "commanded_rms", "explained"]
    errors = study.errors
    if errors.empty:
        return errors
    groups = errors.groupby(["engine", "group"], sort=False)
    worst = pd.DataFrame([rows.iloc[int(rows["max"].to_numpy().argmax())] for _, rows in groups])
    table = groups[columns].max(skipna=False).reset_index()  # a NaN counts as the largest, here and above
    at = {f"max_at [{axis(study.scene).unit}]": worst["max_at"].to_numpy()}
    return table.assign(worst_channel=worst["channel"].to_numpy(), **at)


def checks(study: Study) -> pd.DataFrame:
    """Return the worst violation of each reference-free check by engine, and the body it is about."""
    rows = [
        {
            "engine": m.run.engine,
            "check": c.check,
            "of": c.of,
            "worst": c.worst,
            f"max_at [{axis(study.scene).unit}]": c.max_at,
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


def notes(study: Study) -> list[str]:
    """Return what a reader must know: why runs failed, which channels are missing and why, how the floor was found."""
    floor = study.reference.floor
    said = [f"Floor of the reference: {floor.by}."]
    if floor.by_channel:
        said = [f"Floor of the reference: {max(floor.by_channel.values()):.1e} at most, certified by {floor.by}."]
    if study.sampling.channels is not None:
        wanted = ", ".join(study.sampling.wanted(study.scene)[2:])
        said.append(f"Asked for: {wanted}; checks and tolerances of other channels are left out.")
    said += [f"{reason}." for reason in study.reasons]
    for m in study.measurements:
        if m.run.status is not Status.ok:
            said.append(f"{m.run.engine}: {m.run.status.name}. {m.run.status.value} Here: {m.run.reason}.")
        if m.run.motion is not None:
            said += [f"{m.run.engine} gives no {c}: {why}." for c, why in m.run.motion.unsupported.items()]
    return said


def setup(study: Study) -> str:
    """Return what was run, in one sentence."""
    scene, sampling, cycle = study.scene, study.sampling, cycle_name(study.scene)
    cycles = f"one {cycle}" if sampling.turns == 1 else f"{sampling.turns} {cycle}s"
    stroke = 1e3 * study.reference.stroke
    return (
        f"The {scene.drive.body} {_driven(scene)}, {cycles}, {sampling.samples} samples a {cycle};"
        f" stroke {stroke:.4f} mm. The reference's way: {registry.route(scene)}."
    )


def scales(scene: Scene) -> str:
    """Return what the errors' scales are where the drive is more than a crank at constant speed."""
    said = ""
    if scene.driven_slide is not None:
        said = " ω is the drive's peak speed over its travel; the force of the drive stands under torque."
    elif not isinstance(scene.drive, ConstantSpeed):
        said = " ω is the drive's peak rate."
    return said


def _driven(scene: Scene) -> str:
    """Return how the drive moves its body, in a few words."""
    drive = scene.drive
    if not isinstance(drive, ConstantSpeed):
        again = ", again and again" if drive.repeats else ""
        return f"by a motion law of {drive.cycle:g} s{again}"
    if scene.driven_slide is not None:
        return f"at {1e3 * drive.speed:g} mm/s from {1e3 * drive.start:g} to {1e3 * drive.after(1):g} mm"
    rpm = f"at {drive.speed * 30 / pi:g} rpm"
    return rpm if drive.repeats else f"{rpm} from {degrees(drive.start):g} to {degrees(drive.after(1)):g}°"


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

"""A family's tables: one row a member, for the terminal, the page and `family.csv`."""

from collections.abc import Callable
from math import degrees, floor, isnan, log10, nan, prod

import numpy as np
import pandas as pd

from scenes import Status

from ...engines.axis import prefixed
from ...engines.registry import REFERENCE
from ...family.cycle import UNITS
from ...family.family import Family, Member
from ...judge.measure import Measurement

DIGITS = 5  # significant ones, of the largest number in a column
ON_A_LINE = ("stroke", "dwell share", "quick return", "peak torque", "peak force")


def label(family: Family, member: Member) -> str:
    """Return what a member is called: `O-P3 = 300`."""
    return ", ".join(
        f"{name} = {value:.6g}" for name, value in zip(names(family), member.changes.values(), strict=True)
    )


def names(family: Family) -> list[str]:
    """Return what the varied numbers are called: `O-P3` for `bodies.rocker.lengths.O-P3`, as far as that is unique."""
    paths = [variation.path for variation in family.variations]
    short = [path.partition(".lengths.")[2] or path.removeprefix("bodies.") for path in paths]
    return short if len(set(short)) == len(short) else paths


def in_si(family: Family) -> pd.DataFrame:
    """Return one row a member with everything that is known about it, quantities in SI."""
    return pd.DataFrame([_row(member) for member in family.members])


def _row(member: Member) -> dict[str, object]:
    row: dict[str, object] = dict(member.changes) | {"status": member.status, "reason": member.reason}
    if member.cycle is not None:
        quantities, joints = member.cycle.quantities, member.cycle.joints
        for name in (name for name in UNITS if name in quantities):
            row[f"{name} [{UNITS[name]}]" if UNITS[name] else name] = quantities[name]
            if name in joints:
                row[f"{name} at"] = joints[name]
    for m in member.measurements:
        error, channel = _worst(m)
        row |= {f"{m.run.engine} status": m.run.status.name, f"{m.run.engine} error": error}
        row |= {f"{m.run.engine} worst channel": channel}
    return row


def _worst(measurement: Measurement) -> tuple[float, str]:
    """Return the largest relative error and its channel; a NaN counts as the largest."""
    if measurement.errors.empty:
        return nan, ""
    row = measurement.errors.iloc[int(measurement.errors["max"].to_numpy().argmax())]
    return float(row["max"]), str(row["channel"])


def overview(family: Family) -> pd.DataFrame:
    """Return one row a member as a reader wants it: units with prefixes, as many digits as tell the members apart."""
    columns = {}
    for name in UNITS:
        values = [member.cycle.quantities.get(name, nan) if member.cycle else nan for member in family.members]
        joints = [member.cycle.joints.get(name, "") if member.cycle else "" for member in family.members]
        if not all(map(isnan, values)):
            unit, write = _writer(name, _scale(family, name))
            heading = f"{name} [{unit}]" if unit else name
            columns[heading] = [" ".join((write(v), joint)).strip() for v, joint in zip(values, joints, strict=True)]
    varied = pd.DataFrame(
        [list(member.changes.values()) for member in family.members],
        columns=[name.replace("-", "\u2011") for name in names(family)],
    )  # unbroken
    table = varied.map("{:.6g}".format).assign(status=[member.status for member in family.members], **columns)
    for number, engine in enumerate(family.engines):
        table[f"{engine} error"] = [_judged(member, number) for member in family.members]
    return table


def _judged(member: Member, number: int) -> str:
    if not member.measurements:
        return "–"
    m = member.measurements[number]
    error, _ = _worst(m)
    if m.run.status is not Status.ok:
        return m.run.status.name
    return "not certified" if isnan(error) and m.run.engine == REFERENCE else f"{error:.1e}"


def _scale(family: Family, name: str) -> float:
    """Return the largest magnitude of a quantity among the members; the bottom is told as finely as the stroke."""
    of = "stroke" if name == "bottom" else name
    values = (abs(member.cycle.quantities.get(of, nan)) for member in family.members if member.cycle is not None)
    return max((value for value in values if value > 0), default=1.0)


def _writer(name: str, scale: float) -> tuple[str, Callable[[float], str]]:
    """Return the unit that suits the scale of a quantity, and what writes its values in it."""
    factor, unit = _unit(name, scale)
    decimals = min(max(DIGITS - 1 - floor(log10(scale * factor)), 0), 9)
    return unit, lambda value: "–" if isnan(value) else f"{value * factor:.{decimals}f}"


def _unit(name: str, scale: float) -> tuple[float, str]:
    if name == "dwell share":
        return 100.0, "%"
    match UNITS[name]:
        case "":
            return 1.0, ""
        case "rad":
            return degrees(1), "deg"
        case si:
            return prefixed(scale, si.replace("*", " ").replace("^2", "²"))


def on_a_line(family: Family, member: Member) -> str:
    """Return a member in one line for the terminal."""
    said = [label(family, member), member.status]
    if member.cycle is None:
        return "  ".join([*said, member.reason])
    for name in ON_A_LINE:
        value = member.cycle.quantities.get(name, nan)
        if not isnan(value):
            unit, write = _writer(name, abs(value) or 1.0)
            said.append(f"{name} {write(value)} {unit}".strip())
    said += [f"{m.run.engine} {_judged(member, n)}" for n, m in enumerate(member.measurements)]
    return "  ".join(said)


def setup(family: Family) -> str:
    """Return what is varied, in one sentence."""
    said = (f"{v.path} from {v.values[0]:.6g} to {v.values[-1]:.6g}, {len(v.values)} values" for v in family.variations)
    return f"Varied, in the units of the file: {'; '.join(said)}."


def verdict(family: Family) -> str:
    """Return how many members run, and how far each engine is from the reference in the worst of them."""
    able = [member for member in family.members if member.cycle is not None]
    said = f"{len(able)} of {len(family.members)} members run."
    count = prod(len(variation.values) for variation in family.variations)
    if len(family.members) < count:
        said = f"Stopped after {len(family.members)} of {count} members. {said}"
    for number, engine in enumerate(family.engines):
        if engine != REFERENCE:
            solved = [m for m in (member.measurements[number] for member in able) if m.run.status is Status.ok]
            worst = np.max([_worst(m)[0] for m in solved], initial=0.0)  # a NaN counts as the largest
            said += f" {engine} solved {len(solved)} of them" + (
                f", and is within {worst:.1e} of the reference." if solved and not isnan(worst) else "."
            )
    return said


def notes(family: Family) -> list[str]:
    """Return how far the reference may be off, which members cannot run, and which engines fail on which; and why."""
    floors = [member.floor for member in family.members if member.floor is not None]
    said = []
    for by in dict.fromkeys(found.by for found in floors):
        errors = [error for found in floors if found.by == by for error in found.by_channel.values()]
        size = f"{np.max(errors):.1e} at most, certified by " if errors else ""
        said.append(f"Floor of the reference: {size}{by}.")
    said += [f"{label(family, m)}: {m.status}: {m.reason}" for m in family.members if m.cycle is None]
    for member in family.members:
        for m in member.measurements:
            if m.run.status is not Status.ok:
                said.append(f"{label(family, member)}: {m.run.engine}: {m.run.status.name}: {m.run.reason}")
    return said

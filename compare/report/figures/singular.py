"""Figures of the distance to singular configurations: of every Assur group, and the engines' errors over it."""

from typing import Any

import numpy as np

from scenes.model.motion import Samples, quantity

from ...engines.registry import REFERENCE
from ...mechanics.axis import axis
from ...mechanics.mechanics import GROUPS
from ...study import Study
from ..numbers import units
from . import style
from .figure import Figure, draw, side_by_side, stacked
from .style import colour, drive_axes, error_axes, layout

PLOTTED = ("velocity", "acceleration", "reaction")


def assur_groups(study: Study) -> Figure | None:
    """Draw every Assur group's distance to its singular configuration; None where the reference has no such channel."""
    motion, over = study.motion, axis(study.scene).of(study.motion)
    per_metre, metres = units(study.reference)["m"]
    factors = {"transmission": 180 / np.pi, "to_lock": per_metre}
    rows = {
        measured: {c.rpartition(".")[0]: factor * motion[c] for c in motion.samples if quantity(c) == measured}
        for measured, factor in factors.items()
    }  # values by joint
    rows = {measured: curves for measured, curves in rows.items() if curves}
    if not rows or study.sampling.channels is not None:
        return None
    joints = list(dict.fromkeys(joint for curves in rows.values() for joint in curves))
    figure = stacked(*[1.0] * len(rows))
    for row, (measured, curves) in enumerate(rows.items(), start=1):
        for joint, values in curves.items():
            number = joints.index(joint)
            line = {"color": colour(number), "dash": style.DASHES[number // len(style.COLOURS) % len(style.DASHES)]}
            draw(figure, joint, over, values, row, line=line)
        vertical = {"title": "transmission angle [deg]", "range": [0, 92], "dtick": 30}
        if measured == "to_lock":
            vertical = {"title": f"distance [{metres}]"} | _logarithmic(np.array(list(curves.values())))
        figure.update_yaxes(**vertical, panel=row)
    drive_axes(figure, study.scene, study.sampling.turns, len(rows))
    return figure.update_layout(layout((300, 480)[len(rows) - 1]))


def _logarithmic(values: Samples) -> dict[str, Any]:
    """A log axis; where the values span few decades it has marks at 1, 2 and 5, where its own are too few."""
    powers = np.log10(values[(values > 0) & np.isfinite(values)])
    marks = np.outer(10.0 ** np.arange(-12, 12), (1, 2, 5)).ravel()
    near = [m for m in marks if powers.size and powers.min() - 0.4 < np.log10(m) < powers.max() + 0.4]
    if not 1 < len(near) < 8:
        return style.LOG | {"dtick": 1}
    ends = [*np.log10([0.9 * near[0], near[-1]])]
    return style.LOG | {"range": ends, "tickvals": near, "ticktext": [f"{m:g}" for m in near]}


def over_distance(study: Study) -> Figure | None:
    """Draw every engine's errors over the distance to the nearest singular configuration; None if no other ran.

    Where the core knows no distance in metres, it is the relative one to the nearest singular Jacobian, 1/κ.
    """
    runs = {
        (number, m.run.engine): m.comparison.actual
        for number, m in enumerate(study.measurements)
        if m.comparison is not None and m.run.engine != REFERENCE and not m.foreign
    }  # errors by channel
    channels = {group: [c for c in study.explained.sensitivity if GROUPS[quantity(c)] == group] for group in PLOTTED}
    groups = [group for group in PLOTTED if channels[group]]
    if not runs or study.sampling.channels is not None:
        return None
    locks = [values for channel, values in study.motion.samples.items() if quantity(channel) == "to_lock"]
    per_metre, metres = units(study.reference)["m"]
    distance = per_metre * np.min(locks, axis=0) if locks else 1 / study.explained.condition
    order = np.argsort(distance)
    figure = side_by_side(groups)
    for column, group in enumerate(groups, start=1):
        for (number, engine), errors in runs.items():
            known = [errors[channel] for channel in channels[group] if channel in errors]
            largest = np.max([np.zeros_like(distance), *known], axis=0)
            shown, mark = np.where(largest > 0, largest, np.nan), {"color": colour(number), "size": 4}
            draw(figure, engine, distance, shown, column, mode="markers", marker=mark)
        explained = np.max([study.explained.error(channel) for channel in channels[group]], axis=0)
        draw(figure, style.ROUND_OFF, distance[order], explained[order], column, line=style.BOUND)
    error_axes(figure, f"distance to the singular configuration [{metres}]" if locks else "1/κ [-]")
    return figure.update_layout(layout(380, titled=True))

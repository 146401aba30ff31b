"""Curves over the drive's position or the time, errors below them, and over the distance to singular configurations."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from scenes import Motion, Request
from scenes.channels import TO_LOCK, TRANSMISSION
from scenes.model.motion import Samples

from ...engines.registry import REFERENCE
from ...judge.errors import Comparison
from ...mechanics.axis import axis
from ...mechanics.reference import Reference
from ...study import Study
from ..numbers import units
from ..tables.friction import frictionless, losses
from . import style
from .figure import Figure, draw, side_by_side, stacked
from .style import BEFORE, BOUND, DARK_GREY, DASHES, FLOOR, GREY, LOG, colour, drive_axes, layout, marker

MARKERS = 36  # per cycle, shared out between the engines
MAX_PANELS = 24  # of a figure
PLOTTED = ("velocity", "acceleration", "reaction")  # over the distance


@dataclass(frozen=True)
class PlottedCurve:
    """A plotted quantity: the sum of channels, each times a factor, or the magnitude of the vector that they form."""

    name: str
    unit: str
    factors: Mapping[str, float]  # by channel
    magnitude: bool = False

    def of(self, motion: Motion) -> Samples:
        """The values to plot, shape (n,)."""
        parts = [factor * motion[channel] for channel, factor in self.factors.items()]
        return np.asarray(np.linalg.norm(parts, axis=0) if self.magnitude else np.sum(parts, axis=0))


@dataclass(frozen=True)
class Panel:
    """One figure: its curves, and the channels whose largest error is plotted below them; that of x or y is both's."""

    title: str
    axis: str
    curves: Sequence[PlottedCurve]
    judged: Sequence[str]


def panels(reference: Reference, request: Request) -> Iterator[Panel]:
    """Yield the output's motion, every joint's reaction, the drive's torque or force; only channels asked for."""
    asked = set(request.wanted(reference.scene))
    for panel in _all_panels(reference):
        curves = [curve for curve in panel.curves if asked.issuperset(curve.factors)]
        if curves:
            yield replace(panel, curves=curves, judged=tuple(c for c in panel.judged if c in asked))


def chosen(study: Study) -> tuple[list[Panel], list[Panel]]:
    """The panels to draw, and those left out: of many joints those with the largest errors are drawn."""
    every = list(panels(study.reference, study.sampling))
    worst: dict[str, float] = {}
    for row in study.channel_errors:
        worst[row.channel] = max(worst.get(row.channel, 0.0), np.inf if np.isnan(row.max) else row.max)

    def rank(panel: Panel) -> tuple[bool, float]:
        of_a_joint = study.scene.channels[panel.judged[0]].group == "reaction"
        return of_a_joint, -max(worst.get(channel, 0.0) for channel in panel.judged)

    # Panels of the output and of the drive are always drawn; of joints those with the largest errors, NaN as infinite.
    # The panels drawn keep their order.
    first = sorted(every, key=rank)[:MAX_PANELS]
    return [panel for panel in every if panel in first], [panel for panel in every if panel not in first]


def _all_panels(reference: Reference) -> Iterator[Panel]:
    scene, named = reference.scene, units(reference)

    def curve(name: str, *channels: str) -> PlottedCurve:
        factor, unit = named[scene.channels[channels[0]].unit]
        return PlottedCurve(name, unit, dict.fromkeys(channels, factor), len(channels) > 1)

    guided = scene.guided(scene.output)
    titles = ("displacement", "velocity", "acceleration")
    for title, channels in zip(titles, scene.channels.points[scene.output], strict=True):
        factor, unit = named[scene.channels[channels[0]].unit]
        curves = [*map(curve, "xy", channels)]
        if guided is not None:
            along = {c: factor * part for c, part in zip(channels, guided[1].along, strict=True) if part}
            curves = [PlottedCurve("along the guide", unit, along)]
        yield Panel(f"{scene.output}: {title}", f"{title} [{unit}]", curves, channels)
    if not scene.has_masses:
        return
    for pin in scene.pins:
        both = scene.channels.pins[pin.channel]
        curves = [curve("magnitude", *both), *map(curve, "xy", both)]
        title = f"Pin {pin.channel}: force of {pin.first} on {pin.second}"
        yield Panel(title, f"force [{curves[0].unit}]", curves, both)
    for body, guide in scene.channels.guides.items():
        curves = [curve("force", guide.force), curve("moment", guide.moment)]
        judged = [channel for part in curves for channel in part.factors]
        title = ", ".join(f"{part.name} [{part.unit}]" for part in curves)
        yield Panel(f"Guide: force and moment on {body}", title, curves, judged)
    effort = scene.channels.drive.effort
    drive = curve(scene.channels[effort].quantity, effort)
    title = f"Drive: {drive.name} on {', '.join(scene.driven)}"
    yield Panel(title, f"{drive.name} [{drive.unit}]", [drive], [effort])


def error(study: Study, panel: Panel, comparison: Comparison) -> Samples:
    """The error of what an engine has of a panel, shape (n,), no less than the reference's floor; NaN: none."""
    known = [comparison.actual[c] for c in panel.judged if c in comparison.actual]
    worst: Samples = np.max(known or [np.full(len(comparison.axis), np.nan)], axis=0)
    floor = _floor(study, panel)
    return np.maximum(worst, floor) if floor else np.where(worst > 0, worst, np.nan)


def _floor(study: Study, panel: Panel) -> float:
    return max((study.reference.floor.by_channel.get(channel, 0.0) for channel in panel.judged), default=0.0)


def over_angle(study: Study, panel: Panel, before: Motion | None = None) -> Figure:
    """Draw one panel over the drive's position or the time: curves above, dashed an earlier run's; errors below."""
    figure, across = stacked(0.6, 0.4), axis(study.scene)
    along = across.of(study.motion)
    for curve, dash in zip(panel.curves, DASHES, strict=False):
        draw(figure, curve.name, along, curve.of(study.motion), line={"color": DARK_GREY, "dash": dash, "width": 1.5})
    for number, m in enumerate(study.measurements):
        motion = m.run.motion
        if motion is None or m.comparison is None or not any(c in motion for c in panel.judged):
            continue
        engine, there, first, turns = m.run.engine, along, number, len(study.measurements)
        if m.foreign:  # at instants of its own: marked by itself, where the others take turns
            there, first, turns = m.comparison.axis, 0, 1
        # Markers of engines that agree would cover each other: the engines share the places out, each at every n-th in
        # turn.
        stride = max((m.asked.count if m.foreign else study.sampling.samples) // MARKERS, 1)
        rows = slice(first * stride, None, turns * stride)
        for curve in (curve for curve in panel.curves if all(c in motion for c in curve.factors)):
            draw(figure, engine, there[rows], curve.of(motion)[rows], mode="markers", marker=marker(number))
        if engine != REFERENCE:
            line = {"color": colour(number), "width": 1.3}
            draw(figure, f"{engine} error", there, error(study, panel, m.comparison), 2, group=engine, line=line)
    if floor := _floor(study, panel):
        draw(figure, FLOOR, along[[0, -1]], [floor] * 2, 2, line=BOUND)
    for curve in panel.curves:
        if before and {*curve.factors, across.channel} <= before.samples.keys():
            line = {"color": GREY, "dash": "dash", "width": 1.5}
            draw(figure, BEFORE, across.of(before), curve.of(before), line=line)
    figure.update_yaxes(title=panel.axis, panel=1)
    figure.update_yaxes(LOG, title="relative error [-]", nticks=6, panel=2)
    drive_axes(figure, study.scene, study.sampling.turns, 2)
    return figure.update_layout(layout(480))


def assur_groups(study: Study) -> Figure | None:
    """Draw every Assur group's distance to its singular configuration; None where the reference has no such channel."""
    if study.sampling.channels is not None:
        return None
    motion, along = study.motion, axis(study.scene).of(study.motion)
    per_metre, metres = units(study.reference)["m"]
    known = study.scene.channels
    factors = {TRANSMISSION: 180 / np.pi, TO_LOCK: per_metre}
    rows = {
        measured: {known[c].subject: factor * motion[c] for c in motion.samples if known[c].quantity == measured}
        for measured, factor in factors.items()
    }  # values by joint
    rows = {measured: curves for measured, curves in rows.items() if curves}
    if not rows:
        return None
    joints = list(dict.fromkeys(joint for curves in rows.values() for joint in curves))
    figure = stacked(*[1.0] * len(rows))
    for row, (measured, curves) in enumerate(rows.items(), start=1):
        for joint, values in curves.items():
            number = joints.index(joint)
            line = {"color": colour(number), "dash": DASHES[number // len(style.COLOURS) % len(DASHES)]}
            draw(figure, joint, along, values, row, line=line)
        angle = {"title": "transmission angle [deg]", "range": [0, 92], "dtick": 30}
        figure.update_yaxes(angle if measured == "transmission" else LOG | {"title": f"distance [{metres}]"}, panel=row)
    drive_axes(figure, study.scene, study.sampling.turns, len(rows))
    return figure.update_layout(layout((300, 480)[len(rows) - 1]), hovermode="closest")


def over_distance(study: Study) -> Figure | None:
    """Draw every engine's errors over the distance to the nearest singular configuration; None if no other ran."""
    numbered = [
        (number, m) for number, m in enumerate(study.measurements) if m.run.engine != REFERENCE and not m.foreign
    ]
    runs = [(number, m.run.engine, m.comparison.actual) for number, m in numbered if m.comparison is not None]
    rows = study.scene.channels
    channels = {group: [c for c in study.explained.sensitivity if rows[c].group == group] for group in PLOTTED}
    groups = [group for group in PLOTTED if channels[group]]
    if not runs or study.sampling.channels is not None:
        return None
    locks = [values for name, values in study.motion.samples.items() if rows[name].quantity == TO_LOCK]
    per_metre, metres = units(study.reference)["m"]
    distance = per_metre * np.min(locks, axis=0) if locks else 1 / study.explained.condition  # or the relative one
    order = np.argsort(distance)
    figure = side_by_side(groups)
    for column, group in enumerate(groups, start=1):
        for number, engine, errors in runs:
            known = [errors[channel] for channel in channels[group] if channel in errors]
            largest = np.max([np.zeros_like(distance), *known], axis=0)
            shown, mark = np.where(largest > 0, largest, np.nan), {"color": colour(number), "size": 4}
            draw(figure, engine, distance, shown, column, mode="markers", marker=mark)
        explained = np.max([study.explained.error(channel) for channel in channels[group]], axis=0)
        draw(figure, style.ROUND_OFF, distance[order], explained[order], column, line=BOUND)
    style.error_axes(figure, f"distance [{metres}]" if locks else "1/κ [-]")
    return figure.update_layout(layout(380, titled=True))


def friction(study: Study) -> Figure:
    """Draw what each joint's friction takes, stacked, and the drive's effort with and without friction."""
    scene, motion, figure = study.scene, study.motion, stacked(1.0, 1.0)
    along, taken = axis(scene).of(motion), losses(scene, motion)
    named = units(study.reference)
    factor, watts = named["W"]
    for number, (joint, power) in enumerate(taken.items()):
        line = {"color": colour(number), "width": 0.5}
        draw(figure, joint, along, factor * power, 1, line=line, stackgroup="losses")
    effort = scene.channels.drive.effort
    factor, unit = named[scene.channels[effort].unit]
    draw(figure, "with friction", along, factor * motion[effort], 2, line={"color": DARK_GREY})
    free = {"color": DARK_GREY, "dash": "dot"}
    draw(figure, "without friction", along, factor * frictionless(scene, motion), 2, line=free)
    figure.update_yaxes(title=f"losses [{watts}]", panel=1)
    figure.update_yaxes(title=f"{effort} [{unit}]", panel=2)
    drive_axes(figure, scene, study.sampling.turns, 2)
    return figure.update_layout(layout(480), hovermode="closest")

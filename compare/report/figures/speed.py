"""The work-precision picture: time against error, setting by setting, and the Pareto front."""

from collections.abc import Iterator, Sequence
from math import isnan
from typing import Any

import numpy as np

from scenes import Status
from scenes.model.motion import Samples

from ...engines.registry import REFERENCE
from ...judge.errors import group_floors
from ...measure.speed.work_precision import SpeedRow, contenders, families, front, groups, solved
from ...mechanics.axis import cycle_name
from ...study import Study
from ..tables.speed import contender
from .figure import Figure, draw, grid
from .style import BOUND, FLOOR, GREY, colour, error_axes, layout, marker

COLUMNS = 3
NOTED = ("x-thin", "asterisk", "cross-thin", "y-up")  # symbols of settings with a note


def work_precision(study: Study) -> Figure:
    """Draw every setting's time per cycle against its error, log-log, by channel group; buttons switch to the RMS."""
    names = groups(study.speed)
    figure, rms = _panels(study, names)
    error_axes(figure, f"ms per {cycle_name(study.scene)}").update_xaxes(dtick=1).update_yaxes(dtick=2)
    choices = []  # buttons that put a figure's numbers into the traces of the one that is shown
    for label, drawn in (("largest error", figure), ("RMS error", rms)):
        numbers = {axis: [[*trace[axis]] for trace in drawn.traces] for axis in "xy"}
        choices.append({"label": label, "method": "restyle", "args": [numbers]})
    menu = {"type": "buttons", "buttons": choices}
    arranged = layout(150 + 390 * -(-len(names) // COLUMNS), titled=True)
    return figure.update_layout(arranged, {"updatemenus": [menu], "margin": {"t": 110}})


def _panels(study: Study, names: Sequence[str]) -> Iterator[Figure]:
    """Yield the figure of the largest errors, then that of the RMS errors, each drawn from back to front."""
    speed, points, floors = study.speed, solved(study.speed), group_floors(study.reference)
    engines = {m.run.engine: number for number, m in enumerate(study.measurements)}
    lines = {engine: [*families([p for p in points if p.engine == engine], "steps")] for engine in engines}
    settings = [(*each, _hover(study, each[-1])) for each in contenders(points)]
    notes = list(dict.fromkeys(note for _, note, _, _ in settings if note))
    others, times = [p for p in points if p.engine != REFERENCE], _values(speed)
    times = times[~np.isnan(times)]  # none where every setting failed
    fronts = ("Pareto front", points, GREY), ("Pareto front without the reference", others, "#b8860b")
    for kind in ("max", "rms"):
        figure = grid(names, min(COLUMNS, len(names)) or 1)
        for panel, group in enumerate(names, start=1):
            error = f"{group}_{kind}"
            if times.size:
                floor = floors.get(group, np.nan)
                draw(figure, FLOOR, [times.min(), times.max()], [floor] * 2, panel, line=BOUND)
            for name, rows, shade in fronts:
                line = {"color": shade, "width": 7, "shape": "hv"}
                draw(figure, name, *_front(rows, error), panel, line=line, opacity=0.35, hoverinfo="skip")
            for engine, number in engines.items():  # with gaps between the lines
                x, y = (
                    [v for rows in lines[engine] for v in (*_values(rows, column), np.nan)] for column in ("", error)
                )
                draw(figure, "", x, y, panel, line={"color": colour(number), "width": 0.8}, opacity=0.5)
            for engine, note, rows, hover in settings:
                mark = marker(engines[engine], NOTED[notes.index(note) % len(NOTED)] if note else "", 9)
                name, place = contender(engine, note), (_values(rows), _values(rows, error))
                draw(figure, name, *place, panel, mode="markers", marker=mark, **hover)
            failed = [row for row in speed if row.status != Status.ok.name and not isnan(row.error(error))]
            if failed:
                style = _hover(study, failed) | {"marker": {"color": GREY, "symbol": "x", "size": 8}}
                draw(figure, "failed", _values(failed), _values(failed, error), panel, mode="markers", **style)
        yield figure


def _values(rows: Sequence[SpeedRow], error: str = "") -> Samples:
    """An error of every setting, or its time in ms."""
    return np.array([row.error(error) if error else 1e3 * row.solve_min_s for row in rows])


def _front(points: Sequence[SpeedRow], error: str) -> tuple[Samples, Samples]:
    """The front as steps: for every time, ms, the least error that can be had, from the first setting on."""
    best = front(points, error, tie=0)
    if not best:
        return np.zeros(0), np.zeros(0)
    # The front is a staircase. It comes down from the largest error at the fastest time, and goes on to the longest
    # time with the smallest error, so that its first and last settings are corners like all others.
    times, errors = _values(best), _values(best, error)
    longest, largest = np.nanmax(_values(points)), np.nanmax(_values(points, error))
    return np.array([times[0], *times, longest]), np.array([largest, *errors, errors[-1]])


def _hover(study: Study, rows: Sequence[SpeedRow]) -> dict[str, Any]:
    """What each setting shows under the pointer: its name, steps, status and note."""
    texts = []
    for row in rows:
        steps = "" if isnan(row.steps) else f"{row.steps:.0f} steps per cycle"
        texts.append("<br>".join(filter(None, (row.setting, steps, row.status, row.reason, row.note))))
    template = f"%{{text}}<br>%{{x:.3g}} ms per {cycle_name(study.scene)}<br>error %{{y:.2e}}"
    return {"text": texts, "hovertemplate": template}

"""The work-precision picture: time against error, setting by setting, and the Pareto front."""

from collections.abc import Iterator, Sequence
from functools import partial
from math import isnan
from typing import Any

import numpy as np

from scenes import Status
from scenes.motion import Samples

from ...engines.axis import cycle_name
from ...engines.registry import REFERENCE
from ...judge.errors import group_floors
from ...speed.row import SpeedRow
from ...speed.work_precision import contenders, families, front, groups, solved
from ...study import Study
from ..figure import Figure
from ..style import BOUND, FLOOR, GREY, cell, colour, draw, error_axes, grid, layout, marker
from .tables import contender

COLUMNS = 3
NOTED = ("x-thin", "asterisk", "cross-thin", "y-up")  # symbols of settings with a note


def work_precision(study: Study) -> Figure:
    """Draw every setting's time per cycle against its error, log-log, by channel group; buttons switch to the RMS."""
    found = groups(study.speed)
    figure, rms = _panels(study, found)
    error_axes(figure, f"ms per {cycle_name(study.scene)}").update_xaxes(dtick=1).update_yaxes(dtick=2)
    choices = [_button("largest error", figure), _button("RMS error", rms)]
    place = {"x": 1, "xanchor": "right", "y": 1.01, "yanchor": "bottom", "pad": {"b": 25}}
    menu = {"type": "buttons", "direction": "right", "buttons": choices} | place
    arranged = layout(150 + 390 * -(-len(found) // COLUMNS), titled=True)
    return figure.update_layout(arranged, {"updatemenus": [menu], "margin": {"t": 110}})


def _button(label: str, figure: Figure) -> dict[str, object]:
    """Return a button that puts a figure's numbers into the traces of the one that is shown."""
    numbers = {axis: [[*trace[axis]] for trace in figure.traces] for axis in ("x", "y")}
    return {"label": label, "method": "restyle", "args": [numbers]}


def _panels(study: Study, found: Sequence[str]) -> Iterator[Figure]:
    """Draw the floor, the Pareto fronts, the families' lines and the settings of every group, from back to front.

    First with the largest errors, then with the RMS errors.
    """
    speed, points, floors = study.speed, solved(study.speed), group_floors(study.reference)
    engines = {m.run.engine: number for number, m in enumerate(study.measurements)}
    lines = {engine: [*families([p for p in points if p.engine == engine], "steps")] for engine in engines}
    settings = [(*found, _hover(study, found[-1])) for found in contenders(points)]
    notes = list(dict.fromkeys(note for _, note, _, _ in settings if note))
    others, times = [p for p in points if p.engine != REFERENCE], _ms(speed)
    fronts = ("Pareto front", points, GREY), ("Pareto front without the reference", others, "#b8860b")
    for kind in ("max", "rms"):
        figure = grid(found, min(COLUMNS, len(found)) or 1)
        for panel, group in enumerate(found):
            error, where = f"{group}_{kind}", cell(panel, COLUMNS)
            size = partial(_errors, error)
            floor = floors.get(group, np.nan)
            draw(figure, FLOOR, [np.nanmin(times), np.nanmax(times)], [floor] * 2, *where, line=BOUND)
            for name, rows, shade in fronts:
                line = {"color": shade, "width": 7, "shape": "hv"}
                draw(figure, name, *_front(rows, error), *where, line=line, opacity=0.35, hoverinfo="skip")
            for engine, number in engines.items():
                x, y = ([v for rows in lines[engine] for v in (*of(rows), np.nan)] for of in (_ms, size))  # gaps
                draw(figure, "", x, y, *where, line={"color": colour(number), "width": 0.8}, opacity=0.5)
            for engine, note, rows, hover in settings:
                mark = marker(engines[engine], NOTED[notes.index(note) % len(NOTED)] if note else "", 9)
                name, at = contender(engine, note), (_ms(rows), size(rows))
                draw(figure, name, *at, *where, mode="markers", marker=mark, **hover)
            failed = [row for row in speed if row.status != Status.ok.name and not isnan(row.error(error))]
            if failed:
                style = _hover(study, failed) | {"marker": {"color": GREY, "symbol": "x", "size": 8}}
                draw(figure, "failed", _ms(failed), size(failed), *where, mode="markers", **style)
        yield figure


def _ms(rows: Sequence[SpeedRow]) -> Samples:
    return np.array([1e3 * row.solve_min_s for row in rows])


def _errors(error: str, rows: Sequence[SpeedRow]) -> Samples:
    return np.array([row.error(error) for row in rows])


def _front(points: Sequence[SpeedRow], error: str) -> tuple[Samples, Samples]:
    """Return the front as steps: for every time, ms, the least error that can be had, from the first setting on."""
    best = front(points, error, tie=0)
    if not best:
        return np.zeros(0), np.zeros(0)
    times, errors = _ms(best), _errors(error, best)
    return (
        np.concatenate([times[:1], times, [np.nanmax(_ms(points))]]),
        np.concatenate([[np.nanmax(_errors(error, points))], errors, errors[-1:]]),
    )


def _hover(study: Study, rows: Sequence[SpeedRow]) -> dict[str, Any]:
    """Return what each setting shows under the pointer: its name, steps, status and note."""
    texts = []
    for row in rows:
        steps = "" if isnan(row.steps) else f"{row.steps:.0f} steps per cycle"
        texts.append("<br>".join(filter(None, (row.setting, steps, row.status, row.reason, row.note))))
    template = f"%{{text}}<br>%{{x:.3g}} ms per {cycle_name(study.scene)}<br>error %{{y:.2e}}"
    return {"text": texts, "hovertemplate": template}

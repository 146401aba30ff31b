"""The work-precision picture: time against error, setting by setting, and the Pareto front."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from scenes import Status
from scenes.motion import Samples

from ...engines.axis import cycle_name
from ...engines.registry import REFERENCE
from ...judge.errors import group_floors
from ...speed.work_precision import contenders, families, front_places, groups, solved
from ...study import Study
from ..figure import Figure
from ..style import BOUND, FLOOR, GREY, cell, colour, draw, error_axes, grid, layout, marker
from .tables import contender

COLUMNS = 3
SHOWN = ("setting", "steps", "status", "reason", "note")  # under the pointer
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
    speed = study.speed.assign(ms=1e3 * study.speed["solve_min_s"]) if found else study.speed
    points, floors = solved(speed), group_floors(study.reference)
    engines = {m.run.engine: number for number, m in enumerate(study.measurements)}
    own = {engine: points[points["engine"] == engine] for engine in engines} if found else {}
    lines = {engine: [rows for _, rows in families(of, "steps")] for engine, of in own.items()}
    settings = [(*found, _hover(study, found[-1])) for found in contenders(points)]
    notes = list(dict.fromkeys(note for _, note, _, _ in settings if note))
    others = points[points["engine"] != REFERENCE] if found else points
    fronts = ("Pareto front", points, GREY), ("Pareto front without the reference", others, "#b8860b")
    for kind in ("max", "rms"):
        figure = grid(found, min(COLUMNS, len(found)) or 1)
        for panel, group in enumerate(found):
            error, where = f"{group}_{kind}", cell(panel, COLUMNS)
            floor = floors.get(group, np.nan)
            draw(figure, FLOOR, [speed["ms"].min(), speed["ms"].max()], [floor] * 2, *where, line=BOUND)
            for name, rows, shade in fronts:
                line = {"color": shade, "width": 7, "shape": "hv"}
                draw(figure, name, *_front(rows, error), *where, line=line, opacity=0.35, hoverinfo="skip")
            for engine, number in engines.items():
                x, y = ([v for rows in lines[engine] for v in (*rows[axis], np.nan)] for axis in ("ms", error))  # gaps
                draw(figure, "", x, y, *where, line={"color": colour(number), "width": 0.8}, opacity=0.5)
            for engine, note, rows, hover in settings:
                mark = marker(engines[engine], NOTED[notes.index(note) % len(NOTED)] if note else "", 9)
                name, at = contender(engine, note), (rows["ms"], rows[error])
                draw(figure, name, *at, *where, mode="markers", marker=mark, **hover)
            failed = speed[(speed["status"] != Status.ok.name) & speed[error].notna()]
            if len(failed):
                style = _hover(study, failed) | {"marker": {"color": GREY, "symbol": "x", "size": 8}}
                draw(figure, "failed", failed["ms"], failed[error], *where, mode="markers", **style)
        yield figure


def _front(points: pd.DataFrame, error: str) -> tuple[Samples, Samples]:
    """Return the front as steps: for every time, ms, the least error that can be had, from the first setting on."""
    times, errors = points["ms"].to_numpy(), points[error].to_numpy()
    best = front_places(points, error, tie=0)
    if not best:
        return times[:0], errors[:0]
    return (
        np.concatenate([times[best[:1]], times[best], [np.nanmax(times)]]),
        np.concatenate([[np.nanmax(errors)], errors[best], errors[best[-1:]]]),
    )


def _hover(study: Study, rows: pd.DataFrame) -> dict[str, Any]:
    """Return what each setting shows under the pointer: its name, steps, status and note."""
    texts = []
    for setting, count, *more in zip(*(rows[name] for name in SHOWN), strict=True):
        steps = f"{count:.0f} steps per cycle" if count == count else ""
        texts.append("<br>".join(filter(None, (setting, steps, *more))))
    template = f"%{{text}}<br>%{{x:.3g}} ms per {cycle_name(study.scene)}<br>error %{{y:.2e}}"
    return {"text": texts, "hovertemplate": template}

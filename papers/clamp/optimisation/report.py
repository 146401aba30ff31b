"""The study's files: the page with its pictures, one row a point, and everything for a program."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from compare.engines.kept import environment
from compare.report.figures.figure import Figure, draw, stacked
from compare.report.figures.style import BOUND, DASHES, colour, layout, marker
from compare.report.output.placing import placed
from compare.report.pages.html import render
from compare.report.plain import json_text

from ..constraints import ALONE, BOTH, LITERAL, slacks
from ..formulas import DEGREE, PUBLISHED, SCHEME_4, Design, acceleration, at, measure, velocity_ratio
from ..printed import LARGEST_FORCE_RATIO, TABLE_1
from . import tables
from .recheck import Recheck
from .study import AHEAD, ASSUMPTIONS, LENGTHS, LITERALLY, MAIN, Point

FILES = ("design.html", "design.json", "design.csv")
AXES = ("R_S", "M_P", "L_sum")
MARKS = ("circle", "diamond", "star", "star-square")
CLEARANCES = {MAIN: BOTH, "sizes that allow scheme 4": ALONE}


def write(
    points: Sequence[Point], rechecks: Sequence[Recheck], chosen: Mapping[str, Design], seconds: float, folder: Path
) -> Path:
    """Write all into `folder/design/` and return that; InputError where that cannot be, which leaves what was there.

    The designs `chosen` are drawn beside scheme 4; the optimisation took so many seconds.
    """
    rows = tables.rows(points)
    page = render(
        "clamp/optimisation/design.html",
        "papers",
        tables=tables,
        points=points,
        rechecks=rechecks,
        findings=[*tables.findings(points), f"The optimisation took {seconds:.0f} s."],
        coordination=coordination(points, chosen),
        main=MAIN,
        lengths=LENGTHS,
        others=[name for name in ASSUMPTIONS if name != MAIN],
        over_stroke=over_stroke({"scheme 4": SCHEME_4} | dict(chosen)),
        literal=" and ".join(f"{-slacks(d, BOTH)[LITERAL] / DEGREE:.1f} deg ({name})" for name, d in PUBLISHED.items()),
        clearances=CLEARANCES,
    )
    with placed(folder, "design", FILES) as aside:
        pd.DataFrame(rows).to_csv(aside / "design.csv", index=False)
        (aside / "design.json").write_text(json_text(_all(points, rechecks, seconds, rows)), encoding="utf-8")
        (aside / "design.html").write_text(page, encoding="utf-8")
    return folder / "design"


def _all(
    points: Sequence[Point], rechecks: Sequence[Recheck], seconds: float, rows: Sequence[tables.Row]
) -> tables.Row:
    count = len(PUBLISHED)
    return {
        "published": rows[:count],
        "clearances_mm": CLEARANCES,
        "points": [
            row
            | {"slack": {name: float(slack) for name, slack in slacks(p.optimum.design, p.problem.clearance).items()}}
            | {"waived": p.problem.waived, "limits": p.problem.limits, "short": p.short}
            for row, p in zip(rows[count:], points, strict=True)
        ],
        "ahead": [point.at for point in tables.of(points, AHEAD)],
        "rechecks": rechecks,
        "seconds": seconds,
        "environment": environment(),
    }


def coordination(points: Sequence[Point], ahead: Mapping[str, Design]) -> Figure:
    """Draw M_P and L_sum over R_S, with the published designs and those ahead of them."""
    figure = stacked(0.6, 0.4)

    def of(name: str) -> Mapping[str, Sequence[float]]:
        return {axis: [measure(axis, point.optimum.design) for point in tables.of(points, name)] for axis in AXES}

    names = [name for name in ASSUMPTIONS if name != LITERALLY]  # which is far below the others
    for name, dash, shade in zip(names, DASHES, (colour(0), "#777777", "#aaaaaa"), strict=False):
        line = {"dash": dash, "color": shade, "width": 2 if name == MAIN else 1.2}
        mode = "lines+markers" if name == MAIN else "lines"
        _draw(figure, f"largest M_P, {name}", of(name), mode=mode, line=line)
    step = {"mode": "lines+markers", "line": {"color": colour(2), "width": 1.5}, "marker": {"symbol": "square-open"}}
    _draw(figure, "least L_sum within 0.5 % of M_P and R_S", of(LENGTHS), **step)
    computed = {f"{name}, computed": d for name, d in PUBLISHED.items()}
    for mark, (name, d) in zip(MARKS, (computed | dict(ahead)).items(), strict=False):
        values = {axis: [measure(axis, d)] for axis in AXES}
        _draw(figure, name, values, mode="markers", marker=marker(3 if name in ahead else 1, mark, 11))
    for mark, name in zip(MARKS, PUBLISHED, strict=False):
        values = {axis: [float(TABLE_1[axis][name])] for axis in AXES}
        _draw(figure, f"{name}, printed", values, mode="markers", marker=marker(1, f"{mark}-open", 11))
    figure.update_yaxes(title="M_P at α = 2.5° [-]", panel=1)
    figure.update_yaxes(title="L_sum [mm]", panel=2)
    figure.update_xaxes(title="R_S [-]", panel=2)
    drawn = np.concatenate([np.asarray(trace["x"], float) for trace in figure.traces])
    across = [drawn.min(), drawn.max()]
    draw(figure, "largest M_P in print", across, [float(LARGEST_FORCE_RATIO)] * 2, 1, line=BOUND)
    return figure.update_layout(layout(760))


def _draw(figure: Figure, name: str, values: Mapping[str, Sequence[float]], **style: Any) -> None:
    for row, axis in ((1, "M_P"), (2, "L_sum")):
        draw(figure, name, values["R_S"], values[axis], row, **style)


def over_stroke(designs: Mapping[str, Design]) -> Figure:
    """Draw R_V and a_m over the stroke, from open to locked."""
    figure = stacked(1, 1)
    for number, (name, d) in enumerate(designs.items()):
        pose = at(d, np.linspace(d.alpha_max, 0.0, 301))
        for row, values in ((1, velocity_ratio(pose)), (2, 1e3 * acceleration(pose))):
            draw(figure, name, pose.alpha / DEGREE, values, row, line={"color": colour(number), "width": 1.7})
    figure.update_yaxes(title="R_V [-]", panel=1)
    figure.update_yaxes(title="a_m / v_o² [1/m]", panel=2)
    figure.update_xaxes(title="α [deg]", autorange="reversed", panel=2)
    return figure.update_layout(layout(560))

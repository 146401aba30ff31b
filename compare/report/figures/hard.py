"""Figures of hard cases: their errors, and maps of where engines are stable, failures being grey with a letter."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from textwrap import wrap
from typing import Any

import numpy as np
import pandas as pd

from scenes import Status

from ...measure.hard.case import Outcome
from ...mechanics.mechanics import EPS, SHOWN_GROUPS
from .figure import Figure, draw, side_by_side
from .style import BOUND, categories, colour, error_axes, graded, layout

LETTERS = dict(zip([*Status][1:], "UABJSDNIOFTC", strict=True))  # of statuses other than ok, in their order
TITLES: Mapping[str, tuple[str, str]] = {
    "sweeps": ("Stability: steps and sweeps", "sweeps per step"),
    "lock": ("Stability: steps and distance to the singular configuration", "distance"),
    "mass": ("Stability: steps and a factor of the heaviest body's mass", "factor of the mass"),
    "drift": ("Stability: steps and cycles; error of positions in the last cycle", "cycles"),
}
SYMBOLS = dict(zip(Outcome, ("circle", "x-thin-open", "diamond-open", "star", "square-open"), strict=True))
MIN_ERROR, FAILED_COLOUR = 1e-6, "#d0d0d0"  # error with the first colour of the scale; colour of a failure


def stability_maps(table: pd.DataFrame) -> Iterator[tuple[str, Figure]]:
    """Yield title and figure of every map in the table, its engines side by side."""
    for kind, cells in table.groupby("map", sort=False) if len(table) else ():
        title, across = TITLES[str(kind)]
        engines, steps = [*dict.fromkeys(cells["engine"])], sorted(set(cells["steps"]))
        figure = side_by_side(engines)
        for column, engine in enumerate(engines, start=1):
            rows = cells[cells["engine"] == engine]
            figure.add(_cells(rows), column)
            if "needed" in rows and rows["needed"].notna().any():
                line = {"color": colour(1), "width": 3, "dash": "dash"}
                draw(figure, "enough by theory: ρ^sweeps ≤ 1 / (1 + β)", *_boundary(rows), column, line=line)
            figure.update_xaxes(categories(dict.fromkeys(rows["label"])), title=across, panel=column)
        figure.update_xaxes(showgrid=False, zeroline=False)
        figure.update_yaxes(categories(steps), showgrid=False, zeroline=False)
        figure.update_yaxes(title="steps per cycle", panel=figure.left)
        ended = {*cells["status"]}
        key = [f" · {letter}: {status.name}" for status, letter in LETTERS.items() if status.name in ended]
        figure.note(f"Largest relative error{''.join(key)}", x=0, y=0, yshift=-82, xref="paper", yref="paper")
        figure.update_layout(layout(190 + 42 * len(steps), titled=True))
        yield title, figure.update_layout(margin={"b": 100})


def _cells(rows: pd.DataFrame) -> dict[str, Any]:
    """The cells of one engine, with their colours as `meta`."""
    cells, texts, shades = rows.to_dict("records"), [], []
    for error, status in ((cell["error"], Status[str(cell["status"])]) for cell in cells):
        rounded = f"{error:.0e}".replace("e-0", "e-").replace("e+00", "")
        texts.append(LETTERS.get(status, rounded))
        # Colours go with the logarithm of the error, from `MIN_ERROR` to 1; what is beyond has the colour of the end.
        share = 1 - np.log10(min(max(error, MIN_ERROR), 1.0)) / np.log10(MIN_ERROR)
        shades.append(graded(share) if status is Status.ok else FAILED_COLOUR)
    place = {"x": pd.factorize(rows["label"])[0], "y": pd.factorize(rows["steps"], sort=True)[0]}
    texts_of_cells = {
        "text": texts,
        "customdata": [*map(_hover, cells)],
        "meta": shades,
        "hovertemplate": "%{customdata}",
    }
    return {"type": "heatmap", **place, **texts_of_cells}


def _hover(cell: Mapping[Hashable, Any]) -> str:
    errors = {str(name).removesuffix("_max"): error for name, error in cell.items() if str(name).endswith("_max")}
    lines = [f"{cell['label']}, {cell['setting']}", str(cell["status"]), *wrap(str(cell["reason"]), 60)]
    lines += [f"{group}: {error:.1e}" for group, error in errors.items() if error == error]
    return "<br>".join(filter(None, lines))


def _boundary(rows: pd.DataFrame) -> tuple[Sequence[float], Sequence[float]]:
    """The line where theory has the runs begin to hold, between the columns by the logarithm."""
    across = rows.drop_duplicates("label")["x"].to_numpy(float)
    needed = rows.groupby("steps")["needed"].first().to_numpy(float)
    # Columns stand at 0, 1, 2, ... whatever their values, which are roughly a geometric series: between two columns the
    # line is where the logarithm of what is needed lies between theirs.
    x = np.interp(np.log(needed), np.log(across), np.arange(len(across)))
    return [x[0], *x, x[-1]], [-0.5, *range(len(needed)), len(needed) - 0.5]


def over_condition(cases: pd.DataFrame) -> Figure | None:
    """Draw the errors of every attempt over the condition of its Jacobian, by outcome; None where there are none."""
    groups = [group for group in SHOWN_GROUPS if f"{group}_max" in cases and group not in ("torque", "force")]
    if not groups:
        return None
    figure = side_by_side(groups)
    span = np.array([cases["condition"].min(), cases["condition"].max()])
    for column, group in enumerate(groups, start=1):
        for number, (engine, attempts) in enumerate(cases.groupby("engine", sort=False)):
            shown = attempts[attempts[f"{group}_max"] > 0]
            symbols = [SYMBOLS[Outcome(outcome)] for outcome in shown["outcome"]]
            mark = {"color": colour(number), "symbol": symbols, "size": 7, "line": {"width": 1.2}}
            text = [f"{row.ladder}, {row.rung}: {row.setting}, {row.status}" for row in shown.itertuples()]
            hover = "%{text}<br>error %{y:.2e}<extra></extra>"
            places = shown["condition"].to_numpy(), shown[f"{group}_max"].to_numpy(), column
            draw(figure, str(engine), *places, mode="markers", marker=mark, text=text, hovertemplate=hover)
        draw(figure, "κ ε", span, EPS * span, column, line=BOUND)
    error_axes(figure, "condition κ [-]", "largest relative error [-]")
    return figure.update_layout(layout(420, titled=True))

"""Errors of the hard cases against the condition of their Jacobian."""

import numpy as np
import pandas as pd

from ...hard.case import Outcome
from ...judge.errors import SHOWN_GROUPS
from ...judge.round_off import EPS
from ..figure import Figure
from ..style import BOUND, colour, draw, error_axes, layout, side_by_side

SYMBOLS = dict(zip(Outcome, ("circle", "x-thin-open", "diamond-open", "star", "square-open"), strict=True))


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
            at = shown["condition"], shown[f"{group}_max"], 1, column
            draw(figure, str(engine), *at, mode="markers", marker=mark, text=text, hovertemplate=hover)
        draw(figure, "κ ε", span, EPS * span, 1, column, line=BOUND)
    error_axes(figure, "condition κ [-]", "largest relative error [-]")
    return figure.update_layout(layout(420, titled=True))

"""Errors of the hard cases against the condition of their Jacobian."""

import numpy as np
import pandas as pd
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from ...hard.case import Outcome
from ...judge.errors import SHOWN_GROUPS
from ...judge.round_off import EPS
from ..curves import COLOURS, LAYOUT

SYMBOLS = dict(zip(Outcome, ("circle", "x-thin-open", "diamond-open", "star", "square-open"), strict=True))


def over_condition(cases: pd.DataFrame) -> go.Figure | None:
    """Draw the errors of every attempt over the condition of its Jacobian, by outcome; None where there are none."""
    groups = [group for group in SHOWN_GROUPS if f"{group}_max" in cases and group != "torque"]
    if not groups:
        return None
    figure = make_subplots(1, len(groups), subplot_titles=groups, shared_yaxes=True, horizontal_spacing=0.03)
    for column, group in enumerate(groups, start=1):
        for number, (engine, own) in enumerate(cases.groupby("engine", sort=False)):
            shown = own[own[f"{group}_max"] > 0]
            figure.add_scatter(
                x=shown["condition"],
                y=shown[f"{group}_max"],
                name=str(engine),
                legendgroup=str(engine),
                showlegend=column == 1,
                mode="markers",
                marker={
                    "color": COLOURS[number % len(COLOURS)],
                    "symbol": [SYMBOLS[Outcome(outcome)] for outcome in shown["outcome"]],
                    "size": 7,
                    "line": {"width": 1.2},
                },
                text=[f"{row.ladder}, {row.rung}: {row.setting}, {row.status}" for row in shown.itertuples()],
                hovertemplate="%{text}<br>error %{y:.2e}<extra></extra>",
                row=1,
                col=column,
            )
        span = np.array([cases["condition"].min(), cases["condition"].max()])
        figure.add_scatter(
            x=span,
            y=EPS * span,
            name="κ ε",
            legendgroup="rounding",
            showlegend=column == 1,
            mode="lines",
            line={"color": "#999999", "dash": "dot"},
            row=1,
            col=column,
        )
    figure.update_xaxes(title="condition κ [-]", type="log", exponentformat="power", nticks=6)
    figure.update_yaxes(type="log", exponentformat="power", nticks=8)
    figure.update_yaxes(title="largest relative error [-]", col=1)
    return figure.update_layout(LAYOUT, height=420).update_layout(legend_y=1.18, margin_t=80)

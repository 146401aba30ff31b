"""Errors of one run against the distance to the nearest lock, sample by sample."""

from collections.abc import Mapping

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from scenes.motion import Samples, quantity

from ..engines.registry import REFERENCE
from ..judge.errors import GROUPS
from ..judge.round_off import EPS
from ..study import Study
from .curves import COLOURS, LAYOUT

PLOTTED = ("velocity", "acceleration", "reaction")


def over_distance(study: Study) -> go.Figure | None:
    """Draw every engine's errors over the distance to the nearest lock; None where no other engine ran.

    Where the core knows no distance in metres, it is the relative one to the nearest singular Jacobian, 1/κ.
    """
    runs = [m for m in study.measurements if m.comparison is not None and m.run.engine != REFERENCE]
    groups = [group for group in PLOTTED if any(GROUPS[quantity(c)] == group for c in study.explained.sensitivity)]
    if not runs or study.sampling.channels is not None:
        return None
    locks = [values for channel, values in study.motion.samples.items() if quantity(channel) == "to_lock"]
    distance = np.min(locks, axis=0) if locks else 1 / study.explained.condition
    order = np.argsort(distance)
    figure = make_subplots(1, len(groups), subplot_titles=groups, shared_yaxes=True, horizontal_spacing=0.03)
    for column, group in enumerate(groups, start=1):
        for number, m in enumerate(runs, start=1):
            assert m.comparison is not None
            error = _largest(group, m.comparison.actual)
            figure.add_scatter(
                x=distance,
                y=np.where(error > 0, error, np.nan),
                name=m.run.engine,
                legendgroup=m.run.engine,
                showlegend=column == 1,
                mode="markers",
                marker={"color": COLOURS[number % len(COLOURS)], "size": 4},
                row=1,
                col=column,
            )
        explained = np.maximum(_largest(group, study.explained.sensitivity), EPS * study.explained.condition)
        figure.add_scatter(
            x=distance[order],
            y=explained[order],
            name="explained by doubles",
            legendgroup="explained",
            showlegend=column == 1,
            mode="lines",
            line={"color": "#999999", "dash": "dot"},
            row=1,
            col=column,
        )
    title = "nearest distance to lock [m]" if locks else "1/κ [-]"
    figure.update_xaxes(title=title, type="log", exponentformat="power", nticks=6)
    figure.update_yaxes(type="log", exponentformat="power", nticks=8)
    figure.update_yaxes(title="relative error [-]", col=1)
    return figure.update_layout(LAYOUT, height=380).update_layout(legend_y=1.18, margin_t=80)


def _largest(group: str, by_channel: Mapping[str, Samples]) -> Samples:
    of_group = [values for channel, values in by_channel.items() if GROUPS[quantity(channel)] == group]
    largest: Samples = np.max(of_group, axis=0)
    return largest

"""Errors of one run against the distance to the nearest singular configuration, sample by sample."""

from collections.abc import Mapping

import numpy as np
import plotly.graph_objects as go

from scenes.motion import Samples, quantity

from ..engines.registry import REFERENCE
from ..judge.errors import GROUPS
from ..judge.round_off import EPS
from ..study import Study
from .style import BOUND, ROUND_OFF, colour, draw, error_axes, layout, side_by_side

PLOTTED = ("velocity", "acceleration", "reaction")


def over_distance(study: Study) -> go.Figure | None:
    """Draw every engine's errors over the distance to the nearest singular configuration; None if no other ran.

    Where the core knows no distance in metres, it is the relative one to the nearest singular Jacobian, 1/κ.
    """
    runs = [m for m in study.measurements if m.comparison is not None and m.run.engine != REFERENCE]
    groups = [group for group in PLOTTED if any(GROUPS[quantity(c)] == group for c in study.explained.sensitivity)]
    if not runs or study.sampling.channels is not None:
        return None
    locks = [values for channel, values in study.motion.samples.items() if quantity(channel) == "to_lock"]
    distance = np.min(locks, axis=0) if locks else 1 / study.explained.condition
    order = np.argsort(distance)
    figure = side_by_side(groups)
    for column, group in enumerate(groups, start=1):
        for number, m in enumerate(study.measurements):
            if m.comparison is not None and m.run.engine != REFERENCE:
                error = _largest(group, m.comparison.actual)
                shown, mark = np.where(error > 0, error, np.nan), {"color": colour(number), "size": 4}
                draw(figure, m.run.engine, distance, shown, 1, column, mode="markers", marker=mark)
        explained = np.maximum(_largest(group, study.explained.sensitivity), EPS * study.explained.condition)
        draw(figure, ROUND_OFF, distance[order], explained[order], 1, column, line=BOUND)
    error_axes(figure, "distance to lock [m]" if locks else "1/κ [-]")
    return figure.update_layout(layout(380, titled=True))


def _largest(group: str, by_channel: Mapping[str, Samples]) -> Samples:
    of_group = [values for channel, values in by_channel.items() if GROUPS[quantity(channel)] == group]
    largest: Samples = np.max(of_group, axis=0)
    return largest

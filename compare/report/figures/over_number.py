"""What a family is run for: its members' stroke, largest force and drive's peaks over the number that varies."""

import numpy as np

from ...judge.peaks.numbers import STROKE
from ...measure.many.family import Family
from ...mechanics.axis import prefixed
from ..numbers import capital
from ..tables.family import EFFORTS, names
from .figure import Figure, draw, grid
from .style import LEGEND_BESIDE, colour, layout

SHOWN = (STROKE, "largest force", *EFFORTS)  # kinds of numbers


def over_number(family: Family) -> Figure:
    """Draw a panel a number over the first that varies, a line for each value of the others; a gap where none runs."""
    known = [(tuple(m.changes.values()), m.numbers) for m in family.members]
    kinds = [kind for kind in SHOWN if any(kind in numbers for _, numbers in known)]
    first, *others = names(family.variations)
    figure = grid([capital(kind) for kind in kinds], 2)
    for panel, kind in enumerate(kinds, start=1):
        of = [numbers[kind] for _, numbers in known if kind in numbers]
        factor, unit = prefixed(max(abs(peak.value) for peak in of), of[0].unit)
        for number, rest in enumerate(dict.fromkeys(values[1:] for values, _ in known)):
            own = [(values[0], numbers) for values, numbers in known if values[1:] == rest]
            y = [factor * numbers[kind].value if kind in numbers else np.nan for _, numbers in own]
            x, line = np.array([value for value, _ in own]), {"color": colour(number)}
            label = ", ".join(f"{name} = {value:.6g}" for name, value in zip(others, rest, strict=True)) or "members"
            draw(figure, label, x, np.array(y), panel, mode="lines+markers", line=line)
        figure.update_yaxes(title=f"[{unit}]", panel=panel)
    figure.update_xaxes(title=first)
    return figure.update_layout(layout(60 + 300 * -(-len(kinds) // 2), titled=True) | {"legend": LEGEND_BESIDE})

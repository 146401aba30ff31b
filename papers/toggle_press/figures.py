"""Pictures of the toggle press against the crank press, and of what its lengths do."""

from collections.abc import Iterator
from math import degrees

import numpy as np

from compare.report.figures.figure import Figure, draw, stacked
from compare.report.figures.style import DASHES, GREY, LEGEND_BESIDE, colour, layout, marker
from scenes.model.motion import Samples

from .presses import Press, Side, family, press
from .table_1 import HEIGHT, MOST, speed

STRIDE = 10  # of the presses' samples: a degree of the crank


def figures() -> Iterator[tuple[str, str, Figure]]:
    """Yield title, note and figure of every picture."""
    yield (
        "Toggle press against crank press: the slider over a turn",
        f"From where each slider is lowest, as the crank turns; {MOST} strokes a minute. Circles: 6 mm above it.",
        _presses(),
    )
    yield (
        "Toggle press: one length 1 % longer or shorter",
        "Height of the slider above its lowest point. Solid: longer; dashed: shorter; grey: as printed.",
        _family(),
    )


def _presses() -> Figure:
    toggle, crank = press("toggle_press"), press("crank_press")
    sides = {
        "toggle press, clockwise": (toggle.after, toggle.before),
        "toggle press, counter-clockwise": (toggle.before, toggle.after),
        "crank press": (crank.before, crank.after),
    }
    figure = stacked(1, 1)
    for number, (name, (closing, opening)) in enumerate(sides.items()):
        angles, heights, speeds = _over_the_turn(closing, opening)
        angle, rate = closing.at(HEIGHT)
        line, circle = {"color": colour(number), "width": 1.8}, marker(number, "circle-open", 9)
        for row, values, there in ((1, heights, 1e3 * HEIGHT), (2, speeds, -speed(rate))):
            draw(figure, name, angles, values, row, line=line)
            above = f"{name}, 6 mm above"
            draw(figure, above, [-degrees(angle)], [there], row, group=name, mode="markers", marker=circle)
    figure.update_yaxes(title="height [mm]", panel=1)
    figure.update_yaxes(title="speed [mm/s]", panel=2)
    figure.update_xaxes(dtick=60)
    figure.update_xaxes(title="crank angle from the lowest point [deg]", panel=2)
    return figure.update_layout(layout(560))


def _over_the_turn(closing: Side, opening: Side) -> Iterator[Samples]:
    """The crank's angles, deg, and the slider's heights, mm, and speeds, mm/s."""
    yield np.degrees(np.concatenate([-closing.angle[::-STRIDE], opening.angle[::STRIDE]]))
    yield 1e3 * np.concatenate([closing.height[::-STRIDE], opening.height[::STRIDE]])
    yield speed(1.0) * np.concatenate([-closing.rate[::-STRIDE], opening.rate[::STRIDE]])


def _family() -> Figure:
    figure = stacked()

    def add(name: str, of: Press, line: dict[str, object]) -> None:
        angles, heights, _ = _over_the_turn(of.before, of.after)
        draw(figure, name, angles, heights, line={"width": 1.5} | line)

    add("as printed", press("toggle_press"), {"color": GREY, "width": 3})
    for number, (name, member) in enumerate(family()):
        add(name, member, {"color": colour(number // 2), "dash": DASHES[1 - number % 2]})
    figure.update_yaxes(title="height [mm]")
    figure.update_xaxes(title="crank angle from the lowest point, counter-clockwise [deg]", dtick=60)
    return figure.update_layout(layout(560) | {"legend": LEGEND_BESIDE})

"""Pictures of the clamp's two designs over their strokes, as printed and as computed."""

from collections.abc import Iterator

import numpy as np

from compare.report.figures.figure import Figure, draw, stacked
from compare.report.figures.style import colour, layout, marker

from .formulas import PUBLISHED, acceleration, at, platen_stroke, velocity_ratio
from .printed import TABLE_1
from .tables import SPEED


def figures() -> Iterator[tuple[str, str, Figure]]:
    """Yield title, note and figure of every picture."""
    ratios, accelerations = stacked(), stacked()
    for number, (name, d) in enumerate(PUBLISHED.items()):
        pose = at(d, d.alpha_max * np.linspace(1, 0, 361))
        ratio, left = velocity_ratio(pose), platen_stroke(pose)
        way, line = left[0] - left, {"color": colour(number), "width": 1.8}
        draw(ratios, name, way, ratio, line=line)
        printed = [float(TABLE_1[what][name]) for what in ("R_V max", "R_V startup")]
        there, circle = way[[int(ratio.argmax()), 0]], marker(number, "circle-open", 9)
        draw(ratios, f"{name}, printed", there, printed, mode="markers", marker=circle)
        draw(accelerations, name, way, acceleration(pose, SPEED), line=line | {"dash": "solid"})
        misprinted = acceleration(pose, SPEED, printed=True)
        draw(accelerations, f"{name}, as printed", way, misprinted, line=line | {"dash": "dot"})
    for figure in (ratios, accelerations):
        figure.update_xaxes(title="way of the platen from open [mm]")
    yield (
        "Clamp: velocity ratio over the stroke",
        "From open to locked. Circles: the printed peaks and startup values, where the computed ones are.",
        ratios.update_yaxes(title="R_V = v_m / v_o [-]", rangemode="tozero").update_layout(layout(480)),
    )
    yield (
        "Clamp: acceleration of the platen over the stroke",
        f"At an assumed {SPEED:g} mm/s of the crosshead. Solid: the corrected formula; dotted: as printed.",
        accelerations.update_yaxes(title="a_m [mm/s²]").update_layout(layout(480)),
    )

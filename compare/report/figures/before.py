"""An earlier run beside a later one: a ghost of its curves, and its samples at the positions of the later one."""

import numpy as np

from scenes import Motion, Scene

from ...mechanics.axis import axis
from .curves import Panel
from .figure import Figure, draw
from .style import GREY

BEFORE = "before"  # its name in legends and tables


def draw_before(figure: Figure, scene: Scene, panel: Panel, motion: Motion) -> None:
    """Draw the curves of a panel that an earlier motion has, over the same axis, dashed."""
    for curve in panel.curves:
        if {*curve.factors, axis(scene).channel} <= motion.samples.keys():
            line = {"color": GREY, "dash": "dash", "width": 1.5}
            draw(figure, BEFORE, axis(scene).of(motion), curve.of(motion), line=line)


def at_positions(scene: Scene, motion: Motion, later: Motion) -> Motion:
    """An earlier motion where a later one has samples, straight between its own; NaN beyond its ends."""
    over = axis(scene).channel
    order = np.argsort(motion[over])
    at = {
        channel: np.interp(later[over], motion[over][order], values[order], np.nan, np.nan)
        for channel, values in motion.samples.items()
    }
    return Motion(at | {"time": later["time"]})

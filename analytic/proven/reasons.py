"""Why something is not proven, in words."""

import numpy as np

from ..recorded.balances import BALANCE
from .boxes import Boxes
from .levels import Level

GROW = "grow from group to group"
MIN_WIDTHS = 64  # of the smallest boxes: one that is no wider is not divided any more


def why_open(boxes: Boxes, every: Level, begin: float, smallest: float) -> str:
    """Which condition is open in the first doubtful box from a place on, and why, for a message."""
    names = [name.partition(" (")[0] for name in boxes.program.conditions]
    box = int((every.doubtful & (every.low == begin)).argmax())
    low, high = every.low[[box]], every.high[[box]]
    name, middle = names[int(every.condition[box])], (low + high) / 2
    others = [group.P for group in boxes.core.linkage.tracks if name != group.P]  # of which a branch may be lost
    if name == BALANCE:
        return "the joints' forces change by their own friction as much as they are, or more"
    if name.startswith("the branch of"):
        return f"the sketch leaves {name} open"
    name = " or ".join([name, *others])
    if every.fails[box]:
        return f"{name} cannot be reached"
    if high[0] - low[0] <= MIN_WIDTHS * smallest:
        unreached = ", and cannot be reached beside it" * bool(every.fails.any())
        return f"{name} is in a singular configuration there, as nearly as 16 digits can tell{unreached}"
    single, _ = Level.of(boxes, middle, middle, np.full(2 * len(boxes.names), -np.inf))
    if single.doubtful[0]:
        open_too = f"whether {names[int(single.condition[0])]} closes is open at a single position too"
        return f"bounds {GROW}, and 16 digits are too few for so many: {open_too}"
    return f"bounds of {name} are too wide, which {GROW}, and {boxes.most} boxes are too few for them"


def why_unbounded(every: Level, smallest: float) -> str:
    """Why some extremes have no bound, if any has none."""
    unknown = every.box[np.isinf(every.most)]
    if not len(unknown):
        return ""
    if (every.high - every.low)[unknown].min() <= MIN_WIDTHS * smallest:
        return "they are divided by a number that is zero there, or nearly"
    return f"their bounds {GROW}, and more boxes would be needed than there is room for"

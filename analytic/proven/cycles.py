"""Bounds over several cycles of the drive.

The motion of the linkage is the same in every cycle, but for the whole turns of bodies that go round: an angle's bounds
are moved on by what it gains. Forces are the same too, unless something that loads the bodies goes on from cycle to
cycle: a table over the time or the drive's position, or a spring that winds up. Then cycle after cycle is enclosed,
some at a time, and of each extreme the outermost counts.
"""

from collections.abc import Callable, Sequence
from math import tau

from scenes.drive import ConstantSpeed
from scenes.model.enclosures import Enclosure, Enclosures

from ..core.elements import wound
from ..way.windings import Winding, attitude
from .boxes import Boxes

AT_ONCE = 4  # cycles, whose first boxes take hardly longer than those of one
MAX_CYCLES = 200  # that are enclosed, each in some tenths of a second
PERIOD_TOL = 1e-12  # of a cycle: what a unit's conversion leaves of a table's period that fits into it
ROUNDED = 2.0**-50  # of an angle that has gained whole turns


def over_cycles(boxes: Boxes, turns: int, extremes: Callable[[Boxes], Enclosures]) -> Enclosures:
    """Find the extremes over several cycles.

    Args:
        boxes: of the first cycle.
        turns: how many cycles.
        extremes: finds those over the cycles of its boxes.
    """
    lasting, parts = _lasting(boxes), [extremes(boxes)]
    cycles = min(turns, MAX_CYCLES) if lasting else 1
    for first in range(1, cycles, AT_ONCE):
        if parts[-1].open_at is None:
            parts.append(extremes(boxes.over(first, min(first + AT_ONCE, cycles))))
    open_at = parts[-1].open_at
    every = () if open_at else zip(*(part.rows for part in parts), strict=True)
    rows = tuple(_gained(boxes, _outermost(each), turns - cycles) for each in every)
    return Enclosures(
        rows, open_at, cycles if lasting else None, turns, next((part.why for part in parts if part.why), "")
    )


def _lasting(boxes: Boxes) -> bool:
    """Whether a load or a spring goes on from one cycle to the next."""
    scene, law, drive = boxes.scene, boxes.law, boxes.core.linkage.drive
    if not (law.periodic and boxes.core.request.wants_forces(scene)):
        return False
    # A table continues if the cycle is no whole number of its periods. Over the drive's position its period is compared
    # with the turn of a crank; a slider comes back in each cycle, and so does a displacement.
    turn = abs(float(law.after(1) - law.after(0))) if drive.slide is None else 0.0
    cycle = {"time": law.cycle, "drive": turn if turn > tau / 2 else 0.0, "displacement": 0.0}  # none: it comes back
    for table in (load.table for load in scene.loads if load.table is not None and cycle[load.table.over]):
        periods = cycle[table.over] / (table.arguments[-1] - table.arguments[0])
        if not table.periodic or not abs(periods - round(periods)) <= PERIOD_TOL * round(periods):
            return True
    turned = bool(cycle["drive"]) and any(spring.drives(scene) for spring in scene.torsion_springs)
    return turned or any(_gain(boxes, boxes.windings[name]) for name in wound(scene))


def _gain(boxes: Boxes, winding: Winding) -> float:
    """What an angle gains in a cycle, in whole turns."""
    first, last = (float(winding(boxes.law.after(cycle))) for cycle in (0, 1))
    return tau * round((last - first) / tau)


def _gained(boxes: Boxes, row: Enclosure, cycles: int) -> Enclosure:
    """An extreme of so many more cycles: an angle's is in the last of them if it goes that way."""
    channel = boxes.scene.channels[row.channel]
    winding = boxes.windings.get(attitude(channel.subject)) if channel.modulo_turn else None
    gain = cycles * _gain(boxes, winding) if winding and cycles else 0.0
    if not (gain > 0 if row.extreme == "most" else gain < 0):
        return row
    law, error = boxes.law, ROUNDED * (abs(gain) + abs(row.low) + abs(row.high))
    later = float(law.after(cycles) - law.after(0)) if isinstance(law, ConstantSpeed) else cycles * law.cycle
    low, high, *places = (
        value + shift for value, shift in zip(row[2:], (gain - error, gain + error, later, later), strict=True)
    )
    return Enclosure(*row[:2], low, high, *places)


def _outermost(rows: Sequence[Enclosure]) -> Enclosure:
    """The outermost of extremes over several parts of a run, in the first part that is known to have it, or may."""
    largest = rows[0].extreme == "most"
    outer = max if largest else min
    low, high = outer(row.low for row in rows), outer(row.high for row in rows)
    # The extreme's bounds are the outermost of the parts' bounds. Its place is that of the first part whose attained
    # value is as near to it as the bounds are apart, else of the first that may hold it at all.
    may = [row for row in rows if (row.high >= low if largest else row.low <= high)]
    known = [row for row in may if (row.low >= 2 * low - high if largest else row.high <= 2 * high - low)]
    return (known or may or rows)[0]._replace(low=low, high=high)

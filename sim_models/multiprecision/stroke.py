"""Where a press force's stroke ends: as far against the force as a cycle of the drive takes its slider."""

from itertools import pairwise

import numpy as np
from flint import arb_mat

from scenes.loads import PressForce

from .constraints import Linkage
from .march import March

INSTANTS = 180  # a cycle; the slider does not turn round twice between two of them
HALVINGS = 24  # of the time between two of them: 1e-9 of a cycle, to 1e-17 of the stroke where the slider stands still


class _Slider:
    """The slider at some instants of the drive, each near the one before."""

    def __init__(self, linkage: Linkage, march: March, q: arb_mat, load: PressForce) -> None:
        self._linkage, self._march, self._q, self._load = linkage, march, q, load
        self._displacement = linkage.displacement(load.body)

    def move(self, time: float) -> tuple[bool, float]:
        """Go to an instant, s; return whether the slider closes there, and how far it has closed, m."""
        linkage, rows = self._linkage, self._linkage.constraints
        position, rate, _ = map(float, linkage.scene.drive.at(time))
        self._q = self._march.follow(self._q, linkage.drive(position))
        motion = rows.jacobian(self._q).solve(linkage.drive(rate))
        velocity = (self._displacement.jacobian(self._q) * motion)[0, 0]
        closed = self._displacement.value(self._q)[0, 0]
        return bool(velocity * self._load.closing > 0), self._load.closing * float(closed)


def end_of_stroke(linkage: Linkage, march: March, q: arb_mat, load: PressForce) -> float:
    """Return the slider's displacement at the end of its closing stroke, m: at a dead point, or where a run ends.

    Args:
        linkage: the equations
        march: what follows the pose
        q: the pose at the drive's start
        load: the force that the stroke meets

    Raises:
        Failure: the linkage locks within the cycle.
    """
    slider = _Slider(linkage, march, q, load)
    times = np.linspace(0, linkage.scene.drive.cycle, INSTANTS + 1).tolist()
    closes, farthest = slider.move(times[0])
    for early, late in pairwise(times):
        closed_before = closes
        closes, closed = slider.move(late)
        farthest = max(farthest, closed)
        if closed_before and not closes:
            farthest = max(farthest, _dead_point(slider, early, late))
            slider.move(late)
    return load.closing * farthest


def _dead_point(slider: _Slider, early: float, late: float) -> float:
    """Return how far the slider has closed where it turns round between two instants, by bisection, m."""
    closed = -np.inf
    for _ in range(HALVINGS):
        middle = (early + late) / 2
        closes, closed = slider.move(middle)
        early, late = (middle, late) if closes else (early, middle)
    return closed

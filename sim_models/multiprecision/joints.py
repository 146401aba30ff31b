"""Joints and drives as rows of equations, a rule for each type: its multipliers are the force channels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from scenes.joints import Guide, Joint, Pin, SlidingDrive, TurningDrive

if TYPE_CHECKING:  # which kinds there are rules for is asked without python-flint too
    from .constraints import LinkageEquations
    from .rows import EquationRows


def _pin(pin: Pin, linkage: LinkageEquations, rows: EquationRows, row: int) -> None:
    """Add x and y of second - first."""
    linkage.add_way(rows, row, (pin.first, pin.point), (pin.second, pin.point))


def _guide(guide: Guide, linkage: LinkageEquations, rows: EquationRows, row: int) -> None:
    """Add the offset of the slider's first point along the guide's normal, and its angle from the guide."""
    linkage.add_slid(rows, row, guide.slider, across=True)
    linkage.add_angle(rows, row + 1, guide.slider, guide.slide.on)


def _turning_drive(joint: TurningDrive, linkage: LinkageEquations, rows: EquationRows, row: int) -> None:
    """Add the angle between the bodies."""
    linkage.add_angle(rows, row, joint.drive.body, joint.drive.on)


def _sliding_drive(joint: SlidingDrive, linkage: LinkageEquations, rows: EquationRows, row: int) -> None:
    """Add the displacement of the slider's first point."""
    linkage.add_slid(rows, row, joint.drive.body)


RULES: Mapping[type[Joint], Callable[[Any, LinkageEquations, EquationRows, int], None]] = {
    Pin: _pin,
    Guide: _guide,
    TurningDrive: _turning_drive,
    SlidingDrive: _sliding_drive,
}

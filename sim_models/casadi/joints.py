"""Joints and drives as symbols: for each type the rows of C, whose multipliers are its force channels."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from scenes.joints import Guide, Joint, Pin, SlidingDrive, TurningDrive

if TYPE_CHECKING:  # which kinds there are rules for is asked without CasADi too
    from .linkage import SymbolicLinkage


def _pin(joint: Pin, linkage: SymbolicLinkage) -> Any:
    return linkage.point(joint.second, joint.point) - linkage.point(joint.first, joint.point)


def _guide(joint: Guide, linkage: SymbolicLinkage) -> Any:
    from casadi import vertcat

    on, slider = joint.between
    return vertcat(linkage.slid(slider, across=True), linkage.angle(slider) - linkage.angle(on))


def _turning_drive(joint: TurningDrive, linkage: SymbolicLinkage) -> Any:
    on, body = joint.between
    return linkage.angle(body) - linkage.angle(on)


def _sliding_drive(joint: SlidingDrive, linkage: SymbolicLinkage) -> Any:
    return linkage.slid(joint.drive.body)


RULES: Mapping[type[Joint], Callable[[Any, SymbolicLinkage], Any]] = {
    Pin: _pin,
    Guide: _guide,
    TurningDrive: _turning_drive,
    SlidingDrive: _sliding_drive,
}

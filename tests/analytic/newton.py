"""A linkage as the core has it: followed over its way, how far it moves, or some of its dyads as one larger group."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from analytic.core.decomposition import Linkage, _Placed, decompose, larger_group, members
from analytic.core.kinematics import followed
from analytic.way.motion_range import motion_range
from analytic.way.slider import Displaced, displacement
from scenes import Scene
from scenes.model.motion import Samples
from tests.agreement import kind


def assert_close(found: Mapping[str, Samples], expected: Mapping[str, Samples], share: float) -> None:
    """Compare channels to a share of each one's peak, or of its kind's where it is zero but for a symmetry's loss."""
    peaks = {channel: np.nanmax(np.abs(samples)) for channel, samples in expected.items()}
    for channel, samples in expected.items():
        largest = max(peaks[other] for other in peaks if kind(other) == kind(channel))
        allowed = share * max(peaks[channel] if peaks[channel] > 1e-3 * largest else largest, 1e-9)
        np.testing.assert_allclose(found[channel], samples, rtol=0, atol=allowed, err_msg=channel)


class Interval(NamedTuple):
    start: float
    end: float
    start_joint: str
    end_joint: str


def intervals(scene: Scene) -> list[Interval]:
    found = motion_range(scene, followed(scene, decompose(scene)))
    return [Interval(start, end, start_joint, end_joint) for (start, start_joint), (end, end_joint) in found]


def displaced(scene: Scene, point: str) -> Displaced:
    return displacement(scene, followed(scene, decompose(scene)), point)


def as_one_group(scene: Scene, kept: int = 0) -> Linkage:
    """The decomposition with all dyads but the first ones as one group; -1 for the last dyad alone."""
    linkage = decompose(scene)
    dyads = linkage.groups[:kept]
    placed = _Placed(scene, linkage.bodies)
    for body in (scene.drive.body, *(body for dyad in dyads for body in members(dyad))):
        placed.add(body)
    group = larger_group(placed, tuple(body for body in linkage.carries if body not in placed.carries))
    return replace(linkage, groups=(*dyads, group))

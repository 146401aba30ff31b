"""The errors of a motion, estimated without a reference: how far it is from its projection onto the constraints."""

from collections.abc import Mapping, Sequence
from functools import reduce
from typing import NamedTuple

import numpy as np

from scenes import Motion, Scene
from scenes.motion import UNITS, Samples, force_channels, quantity

from ..engines.reference import relative_errors, scales, sizes
from .constraints import largest_length
from .errors import GROUPS
from .projection import projected
from .round_off import EPS, distance

KINDS = {"drive": 0, "position": 0, "velocity": 1, "acceleration": 2, "reaction": 3, "torque": 3, "force": 3}
POWERS = (1, 2, 2, 2)  # of the condition in what rounding changes; rates and forces are solved for in rounded poses


class Estimate(NamedTuple):
    """What is known of a motion without a reference."""

    errors: Mapping[str, Samples]  # by channel, relative as against the reference, each of shape (n,)
    branch: Samples  # the sign of det J, shape (n,): it changes in a singular pose alone
    condition: Samples  # of J, shape (n,)
    closed: Motion  # its projection onto the constraints


@np.errstate(all="ignore")  # what is not finite is so in the result
def estimate(
    scene: Scene, motion: Motion, travel: Mapping[str, float], ends: Sequence[float] | None = None
) -> Estimate:
    """Return what is known of a motion whose kinematic channels are complete.

    `travel` is that of each point, m, see `travels`; `ends` as projected.

    On the switch of a press force all channels count on the side where they fit best.
    """
    projection = projected(scene, motion, ends)
    scale = scales(scene, projection.closed, travel)
    units = scale | _force_units(scene)
    turns, far = _turns(scene, motion), distance(scene, motion)
    eps = [EPS * turns, *[EPS * np.maximum(turns, far)] * (len(POWERS) - 1)]  # places themselves are as large as far
    fitting = Motion({**projection.closed.samples, **projection.forces})
    errors = _unexplained(motion, fitting, scale, units, eps, projection.condition)
    return Estimate(errors, projection.branch, projection.condition, projection.closed)


def _turns(scene: Scene, motion: Motion) -> Samples:
    """Return how often a crank has turned, one at least: its angle is rounded by as much more."""
    if scene.driven_slide is not None:
        return np.ones_like(motion["time"])
    return np.maximum(np.abs(motion[scene.drive_channel]) / (2 * np.pi), 1)


def _force_units(scene: Scene) -> dict[str, float]:
    """Return what makes forces and moments of all joints comparable: one newton, at the linkage's largest length."""
    size = {"N": 1.0, "N*m": largest_length(scene)}
    return {channel: size[UNITS[quantity(channel)]] for channel in force_channels(scene)}


def _unexplained(
    motion: Motion,
    true: Motion,
    scale: Mapping[str, float],
    units: Mapping[str, float],
    eps: Sequence[Samples],
    condition: Samples,
) -> dict[str, Samples]:
    """Return the relative errors, zero where rounding explains them: by the largest value of their kind, in `units`.

    `eps` is how far numbers are rounded, by kind.
    """
    found = relative_errors(motion, true, scale)
    kinds = {channel: KINDS[GROUPS[quantity(channel)]] for channel in found}
    for kind, power in enumerate(POWERS):
        own = [channel for channel in found if kinds[channel] == kind]
        values = (np.abs(true[channel]) / units[channel] for channel in own)
        rounding = eps[kind] * condition**power * reduce(np.maximum, values, np.zeros_like(condition))
        for channel in own:
            explained = rounding * (units[channel] / sizes(true, channel, scale[channel]))
            found[channel] = np.where((found[channel] <= explained) | np.isinf(condition), 0.0, found[channel])
    return found

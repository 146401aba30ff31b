"""The part of an error that arithmetic in doubles explains, sample by sample. Only what is above it is a fault.

Two figures: the condition of the constraint Jacobian times the unit round-off, and how far the motion moves when the
scene's numbers are off by a few units in the last place. Near a lock the second is by far the larger, since velocities
have the condition once in them, accelerations thrice.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from scenes import Rows
from scenes.motion import Samples

from ..engines.reference import Reference
from .constraints import condition
from .perturbation import neighbours, sensitivity

EPS = float(np.finfo(float).eps)
UNKNOWN = 1e-3  # of κ ε: a length that is off by a few last places changes the pose by about that


@dataclass(frozen=True)
class Explained:
    """Relative errors that need no other explanation, at the samples of one run."""

    condition: Samples  # of the constraint Jacobian, shape (n,)
    sensitivity: Mapping[str, Samples]  # by channel, each of shape (n,)
    written: Mapping[str, Samples] = field(default_factory=dict)  # the same of what is written at decimals

    @property
    def decidable(self) -> bool:
        """Whether doubles can tell that the linkage moves at all: not next to a singular pose."""
        return bool(np.isfinite(list(self.sensitivity.values())).all() and (self.condition * EPS < UNKNOWN).all())

    def error(self, channel: str) -> Samples:
        """Return the largest error of a channel that needs no explanation, shape (n,)."""
        return np.maximum(EPS * self.condition, self.sensitivity[channel]) + self.written.get(channel, 0.0)

    def left_over(self, errors: Mapping[str, Samples]) -> dict[str, Samples]:
        """Return errors by channel, zero where they need no explanation; NaN is not explained."""
        return {
            channel: np.where(error <= self.error(channel), 0.0, error - self.written.get(channel, 0.0))
            for channel, error in errors.items()
        }


def explain(reference: Reference, sampling: Rows) -> Explained:
    """Return what is explained at the samples of a run, as commanded.

    Raises:
        Failure: the reference cannot take the scene apart.
    """
    scene = reference.scene
    true = reference.at(sampling.commanded(scene), sampling.times(scene))
    may = reference.acts(true)
    others = reference.neighbours or neighbours(scene)
    moved = sensitivity(scene, others, true, lambda motion: reference.errors(motion, true, may))
    return Explained(condition(scene, true), moved)

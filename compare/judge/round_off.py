"""The part of an error that arithmetic in doubles explains, sample by sample. Only what is above it is a fault.

Three figures: the condition of the constraint Jacobian times the unit round-off, and how far the motion moves when the
scene's numbers are off by a few units in the last place. Near a lock the second is by far the larger, since velocities
have the condition once in them, accelerations thrice. The third is what forces leave that cancel in a joint.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import reduce

import numpy as np

from scenes import Motion, Rows, Scene
from scenes.motion import UNITS, Samples, force_channels, quantity

from ..engines.motion_vectors import MotionVectors
from ..engines.press_switches import press_forces
from ..engines.reference import Reference, sizes
from .constraints import condition, largest_length
from .perturbation import neighbours, sensitivity

EPS = float(np.finfo(float).eps)
FAR = 10.0  # sizes of a linkage off the origin, within which its places are rounded by little more than its lengths
MUCH = 100.0  # times what a joint carries: smaller forces leave less there than the other two figures
UNKNOWN = 1e-3  # of κ ε: a length that is off by a few last places changes the pose by about that


@dataclass(frozen=True)
class Explained:
    """Relative errors that need no other explanation, at the samples of one run."""

    condition: Samples  # of the constraint Jacobian, shape (n,)
    sensitivity: Mapping[str, Samples]  # by channel, each of shape (n,)
    written: Mapping[str, Samples] = field(default_factory=dict)  # the same of what is written at decimals
    cancelled: Mapping[str, Samples] = field(default_factory=dict)  # of forces: what large ones leave that cancel
    largest: str = ""  # of these forces, in words

    @property
    def decidable(self) -> bool:
        """Whether doubles can tell that the linkage moves at all: not next to a singular pose."""
        return bool(np.isfinite(list(self.sensitivity.values())).all() and (self.condition * EPS < UNKNOWN).all())

    def error(self, channel: str) -> Samples:
        """Return the largest error of a channel that needs no explanation, shape (n,)."""
        known = np.maximum(EPS * self.condition, self.sensitivity[channel])
        return np.maximum(known, self.cancelled.get(channel, 0.0)) + self.written.get(channel, 0.0)

    def why(self, channel: str) -> str:
        """Return in words what leaves the largest error of a channel that needs no explanation."""
        if np.max(self.cancelled.get(channel, 0.0)) > np.max(self.sensitivity[channel]):
            return f"{self.largest} cancels in it"
        return "lengths that are off by their last places move it as much"

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
    known, forces = condition(scene, true) * distance(scene, true), _forces(scene, true)
    largest = reduce(np.maximum, forces.values(), np.zeros_like(known))
    strongest = max(forces, key=lambda name: float(forces[name].max()), default="")
    newtons = forces[strongest].max() if forces else 0.0
    arm = {"N": 1.0, "N*m": largest_length(scene)}
    cancelled = {}
    for channel in (channel for channel in force_channels(scene) if channel in true):
        times = largest * arm[UNITS[quantity(channel)]] / sizes(true, channel, reference.scale[channel])
        cancelled[channel] = np.where(times > MUCH, EPS * known * times, 0.0)
    return Explained(known, moved, cancelled=cancelled, largest=f"{strongest}, {newtons:.3g} N,")


def distance(scene: Scene, motion: Motion) -> Samples:
    """Return how far off the origin places are, in sizes of the linkage, one at least: they are rounded by as much."""
    places = [np.hypot(motion[f"{p}.x"], motion[f"{p}.y"]) for p in scene.moving_points]
    off: Samples = np.max(places, axis=0) / largest_length(scene)
    return np.where(off > FAR, off, 1.0)


def _forces(scene: Scene, true: Motion) -> dict[str, Samples]:
    """Return the magnitudes of all forces on the bodies, N, each of shape (n,), with those of joints by channel."""
    state = MotionVectors(scene, true, [np.ones(true["time"].shape, bool) for _ in press_forces(scene)])
    applied = (push for body in scene.bodies.values() for push in state.applied(body) if scene.has_masses)
    joints = {c: np.abs(true[c]) for c in force_channels(scene) if c in true and UNITS[quantity(c)] == "N"}
    return {push.name: np.abs(push.force) for push in applied} | {f"the force {c}": size for c, size in joints.items()}

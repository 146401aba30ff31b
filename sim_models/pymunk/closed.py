"""How far a motion is off, by the engine's own model: what the constraints alone say next to it.

The drive prescribes the motion, so the constraints have one pose near a computed one, and in it one set of rates and of
accelerations. What differs from these by too much of its peak is no result, however well the sweeps have converged:
near a lock a step may be too long for accelerations and forces while the poses still look fine.
"""

from collections.abc import Mapping

import numpy as np

from scenes.drive import Driven
from scenes.motion import Samples, quantity

from .constraints import Linkage, Poses, solved

LEAST_PEAK = 1e-2  # of the largest of its kind: what has a smaller one, as by symmetry, is judged by this

PLACE, VELOCITY, ACCELERATION, FORCE = range(4)
# Of which kind quantities are, and by how many lengths they have to be multiplied for that.
KINDS: Mapping[str, tuple[int, int]] = (
    dict.fromkeys(("x", "y", "displacement"), (PLACE, 0))
    | dict.fromkeys(("vx", "vy"), (VELOCITY, 0))
    | dict.fromkeys(("ax", "ay"), (ACCELERATION, 0))
    | dict.fromkeys(("fx", "fy", "guide_force", "force"), (FORCE, 0))
    | {"angle": (PLACE, 1), "crank_angle": (PLACE, 1), "omega": (VELOCITY, 1), "alpha": (ACCELERATION, 1)}
    | {"guide_moment": (FORCE, -1), "torque": (FORCE, -1)}
)


def closed(linkage: Linkage, q: Poses, driven: Driven) -> tuple[Poses, Poses, Poses]:
    """Return pose, rates and accelerations on the constraints, shape (n, bodies, 3), by one step of Newton's from q.

    `driven` is where the drive is at each sample, shape (n,).
    """
    q = q - solved(linkage.jacobian(q), linkage.gaps(q, driven.position))
    J = linkage.jacobian(q)
    wanted = np.zeros(J.shape[:2])
    wanted[:, -1] = driven.rate
    v = solved(J, wanted)
    wanted = -linkage.bending(q, v)
    wanted[:, -1] += driven.acceleration
    return q, v, solved(J, wanted)


def largest_errors(linkage: Linkage, samples: Mapping[str, Samples], true: Mapping[str, Samples]) -> Samples:
    """Return the largest error of all channels, shape (n,), relative to their own peaks in `true`.

    The two components of a vector are judged as one; places and angles by their distance from the middle of their path.
    """
    vectors = [name.removesuffix("x").removesuffix("y") for name in samples]
    first = [i for i, name in enumerate(vectors) if i == 0 or name != vectors[i - 1]]
    kinds, lengths = np.array([KINDS[quantity(name)] for name in samples]).T
    units = linkage.size ** lengths[:, None].astype(float)

    def magnitudes(components: Samples) -> Samples:
        return np.sqrt(np.add.reduceat(np.square(components), first))

    expected = units * np.array([true[name] for name in samples])
    errors = magnitudes(units * np.array([*samples.values()]) - expected)
    middle = (expected.max(axis=1) + expected.min(axis=1)) / 2
    peaks = magnitudes(expected - np.where(kinds == PLACE, middle, 0.0)[:, None]).max(axis=1)
    largest = np.array([peaks.max(where=kinds[first] == kind, initial=0.0) for kind in range(4)])
    peaks = np.maximum(peaks, LEAST_PEAK * largest[kinds[first]])
    return np.asarray((errors / np.where(peaks > 0, peaks, 1.0)[:, None]).max(axis=0))

"""Accelerations integrated in time, as codes do that close loops by them alone; nothing closes the loops but a pull.

With the constraints C(q) = e s and Baumgarte's terms, J a = e s'' - J' v - 2 k (J v - e s') - k^2 (C - e s).
"""

from collections.abc import Iterator

import numpy as np

from scenes import Failure, Sampling, Status
from scenes.motion import Samples

from ..coordinates.poses import ClosedPose, PathFollower

LOST = 0.1  # gap over the linkage's size, from where nothing pulls the loops together again
PULL = 5.0  # k, over the drive's rate of turning, 2 pi a cycle: stable with Heun's method from 16 steps a cycle on


def stepped(
    poses: PathFollower, start: ClosedPose, sampling: Sampling, steps: int
) -> Iterator[tuple[ClosedPose, Samples, Samples]]:
    """Yield pose and the rates and accelerations of its coordinates at every sample, by Heun's method.

    Raises:
        Failure: `diverged` or `wrong_branch`, a step left the poses near the constraints; `timed_out`.
    """
    drive, system = poses.scene.drive, poses.system
    each = -(-steps // sampling.samples)  # from a sample to the next
    h = drive.cycle / sampling.samples / each
    count = each * sampling.samples * sampling.turns
    driven = np.transpose(drive.at(h * np.arange(count + 1)))
    k = PULL * 2 * np.pi / drive.cycle

    def acceleration(pose: ClosedPose, v: Samples, at: Samples, k: float) -> Samples:
        goal, rate, change = (poses.goal(value) for value in at)
        drift = 2 * k * (pose.J @ v - rate) + k**2 * (system.gaps(pose.x) - goal)
        with np.errstate(over="ignore", invalid="ignore"):  # a run that leaves its branch may run away
            return np.asarray(np.linalg.solve(pose.J, change - system.bend(pose.x, v) - drift))

    pose, v = start, driven[0][1] * poses.tangent(start)[0]
    for step in range(count + 1):
        if step % each == 0:
            yield pose, v, acceleration(pose, v, driven[step], 0.0)
        if step == count:
            return
        poses.budget.check(f"{step} of {count} steps are done")
        poses.counters["steps"] += 1
        try:
            a = acceleration(pose, v, driven[step], k)
            ahead = acceleration(poses.pose(pose.x + h * v), v + h * a, driven[step + 1], k)
        except np.linalg.LinAlgError:
            ahead = np.full_like(v, np.nan)
        pose, v = poses.pose(pose.x + h * v + h**2 / 2 * a), v + h / 2 * (a + ahead)
        closed = bool(np.abs(system.gaps(pose.x) - poses.goal(driven[step + 1][0])).max() <= LOST)
        if not (closed and pose.branch == start.branch):
            status = Status.wrong_branch if closed else Status.diverged
            raise Failure(status, f"a step left the branch at {poses.scene.where(driven[step + 1][0])}")

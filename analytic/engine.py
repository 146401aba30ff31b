"""The vector-equation core as an engine of the comparison."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial

import numpy as np

from scenes import Motion, Sampling, Scene, Settings

from .change_points import check_way
from .decomposition import Decomposition, decompose
from .kinematics import kinematics
from .solve import MotionAt, solve_decomposed
from .variants import differenced, half_angle_position


@dataclass(frozen=True)
class AnalyticSettings(Settings):
    """How the motion is found; the forces follow from it in one way."""

    half_angles: bool = False  # instead of the triangle's area
    single: bool = False  # precision
    steps: int | None = None  # a cycle, of differences of positions instead of derivatives


def _differences(steps: int) -> AnalyticSettings:
    note = "velocities and accelerations by differences of positions, as many tools find them"
    return AnalyticSettings(f"differences {steps}", steps=steps, family="differences", order=2, note=note)


DEFAULT = AnalyticSettings("vector equations")
LADDER = (
    DEFAULT,
    AnalyticSettings("half-angle form", half_angles=True, note="the source paper's form, its misprints corrected"),
    AnalyticSettings("single precision", single=True),
    *map(_differences, (72, 360, 3600)),
)
LONG_LADDER = tuple(map(_differences, (720, 1440, 36_000, 360_000)))
FAST = EXACT = DEFAULT
ABLATIONS: tuple[AnalyticSettings, ...] = ()


def version() -> str:
    """Return the versions of what does the work."""
    return f"numpy {np.__version__}"


@dataclass
class AnalyticRun:
    """One evaluation at the commanded positions."""

    scene: Scene
    linkage: Decomposition
    sampling: Sampling
    settings: AnalyticSettings
    motion: Motion = field(init=False)

    def solve(self) -> None:
        """Evaluate every channel."""
        scene, sampling, settings = self.scene, self.sampling, self.settings
        commanded = sampling.commanded(scene).astype(np.float32 if settings.single else np.float64)
        motion_at: MotionAt | None = None
        if settings.half_angles:
            motion_at = partial(kinematics, rrr=half_angle_position)
        elif settings.steps is not None:
            motion_at = partial(differenced, step=scene.drive.cycle / settings.steps)
        self.motion = solve_decomposed(scene, self.linkage, commanded, sampling.times(scene), motion_at)

    def read(self) -> Motion:
        """Return the channels, whatever precision they were found in, as doubles."""
        return Motion(
            {channel: samples.astype(np.float64, copy=False) for channel, samples in self.motion.samples.items()}
        )

    @property
    def counters(self) -> Mapping[str, int]:
        """Return the number of positions times groups."""
        return {"group_solves": self.sampling.count * len(self.linkage.groups)}

    @property
    def residuals(self) -> Mapping[str, float]:
        """Return nothing: a closed form has no residual of its own; its floor is certified from outside."""
        return {}


def build(scene: Scene, settings: AnalyticSettings, sampling: Sampling) -> AnalyticRun:
    """Prepare an evaluation.

    Raises:
        Failure: the linkage does not decompose, cannot be assembled at the start, or has no one motion.
    """
    check_way(scene)
    linkage = decompose(scene)
    # Follows the branch of what Newton solves, once for all positions.
    solve_decomposed(scene, linkage, [scene.drive.start], [0.0])
    return AnalyticRun(scene, linkage, sampling, settings)

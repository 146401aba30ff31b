"""The vector-equation core as an engine of the comparison."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from scenes import Motion, Sampling, Scene, Settings

from .decomposition import Decomposition, decompose
from .solve import solve_decomposed

DEFAULT = Settings(label="vector equations")
LADDER = (DEFAULT,)
LONG_LADDER: tuple[Settings, ...] = ()


def version() -> str:
    """Return the versions of what does the work."""
    return f"numpy {np.__version__}"


@dataclass
class AnalyticRun:
    """One evaluation at the commanded positions."""

    scene: Scene
    linkage: Decomposition
    sampling: Sampling
    motion: Motion = field(init=False)

    def solve(self) -> None:
        """Evaluate every channel."""
        commanded, times = self.sampling.commanded(self.scene), self.sampling.times(self.scene)
        self.motion = solve_decomposed(self.scene, self.linkage, commanded, times)

    def read(self) -> Motion:
        """Return the channels; nothing is left to do."""
        return self.motion

    @property
    def counters(self) -> Mapping[str, int]:
        """Return the number of positions times groups."""
        return {"group_solves": self.sampling.count * len(self.linkage.groups)}

    @property
    def residuals(self) -> Mapping[str, float]:
        """Return nothing: a closed form has no residual of its own; its floor is certified from outside."""
        return {}


def build(scene: Scene, settings: Settings, sampling: Sampling) -> AnalyticRun:  # noqa: ARG001 - one form, no choices
    """Prepare an evaluation.

    Raises:
        Failure: the linkage does not decompose, or cannot be assembled at the start.
    """
    linkage = decompose(scene)
    # Follows the branch of what Newton solves, once for all positions.
    solve_decomposed(scene, linkage, [scene.drive.start], [0.0])
    return AnalyticRun(scene, linkage, sampling)

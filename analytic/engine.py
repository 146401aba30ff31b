"""The vector-equation core as an engine of the comparison."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from scenes import Motion, Request, Sampling, Scene, Settings

from .core.kinematics import kinematics
from .core.variants import differenced, half_angle_position
from .solve import MotionAt, Solver, solver
from .way.change_points import check_way


@dataclass(frozen=True)
class AnalyticSettings(Settings):
    """How the motion is found; the forces follow from it in one way."""

    half_angles: Annotated[bool, "angles by the half-angle form instead of the triangle's area"] = False
    single: Annotated[bool, "single precision"] = False
    steps: Annotated[int | None, "per cycle, of differences of positions instead of derivatives"] = None


def _differences(steps: int) -> AnalyticSettings:
    note = "velocities and accelerations by differences of positions, as many tools find them"
    return AnalyticSettings(f"differences {steps}", steps=steps, family="differences", order=2, note=note)


DEFAULT = AnalyticSettings("vector equations", promise=1e-12)
WORK_PRECISION = (
    DEFAULT,
    AnalyticSettings("half-angle form", half_angles=True, note="the source paper's form, its misprints corrected"),
    AnalyticSettings("single precision", single=True, drive_promise=1e-6),
    _differences(360),
)
LONG_WORK_PRECISION = tuple(map(_differences, (72, 720, 1440, 3600, 36_000, 360_000)))
FAST = EXACT = DEFAULT
ABLATIONS: tuple[AnalyticSettings, ...] = ()
at_steps = iterations_needed = None  # it takes no steps


def version() -> str:
    """Return the versions of what does the work."""
    return f"numpy {np.__version__}"


class AnalyticSimulation:
    """One evaluation at the commanded positions."""

    residuals: Mapping[str, float] = {}  # a closed form has none of its own; its floor is certified from outside

    def __init__(self, solver: Solver, request: Request, settings: AnalyticSettings) -> None:
        known = frozenset(solver.known)
        self._solver = replace(solver, request=Sampling(channels=known))  # no engine's clock counts what is its own
        self._own = replace(solver, request=Sampling(channels=frozenset(solver.own))) if solver.own else None
        self._request, self._settings = request, settings
        self._motion: Motion | None = None

    def solve(self) -> None:
        """Evaluate every channel that other engines have too."""
        self._motion = self._evaluated(self._solver)

    def _evaluated(self, solver: Solver) -> Motion:
        scene, settings = solver.scene, self._settings
        commanded = self._request.commanded(scene).astype(np.float32 if settings.single else np.float64)
        motion_at: MotionAt | None = None
        if settings.half_angles:
            motion_at = partial(kinematics, rrr=half_angle_position)
        elif settings.steps is not None:
            motion_at = partial(differenced, step=scene.drive.cycle / settings.steps)
        return solver(commanded, self._request.times(scene), motion_at)

    def read(self) -> Motion:
        """Return the channels, whatever precision they were found in, as doubles."""
        assert self._motion is not None, "expected `solve` first"
        own = self._evaluated(self._own).samples if self._own else {}
        samples = {**self._motion.samples, **own}
        return Motion({channel: values.astype(np.float64, copy=False) for channel, values in samples.items()})

    @property
    def counters(self) -> Mapping[str, int]:
        """The number of positions times groups."""
        return {"group_solves": self._request.count * len(self._solver.linkage.groups)}


def build(scene: Scene, settings: AnalyticSettings, request: Request) -> AnalyticSimulation:
    """Prepare an evaluation.

    Raises:
        Failure: the linkage does not decompose, or has no one motion.
    """
    prepared = solver(scene, request.channels)
    check_way(prepared)
    return AnalyticSimulation(prepared, request, settings)

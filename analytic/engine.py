"""The vector-equation core as an engine of the comparison, and other ways to the motion, to show what they cost."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from scenes import Failure, Motion, Request, Sampling, Scene, Settings, Status
from scenes.drive import KINDS as DRIVES
from scenes.drive import Driven, Samples
from scenes.elements import kinds_of
from scenes.elements.springs import PointPair

from .core.contacts import CONTACTS
from .core.decomposition import Linkage
from .core.dyads import Vectors, cross, turned
from .core.elements import RULES
from .core.groups.joints import KINDS as JOINTS
from .core.kinematics import kinematics
from .core.placing import Kinematics
from .solve import Solver, solver
from .way.change_points import check_way
from .way.motion_range import motion_at


@dataclass(frozen=True)
class AnalyticSettings(Settings):
    """How the motion is found; the forces follow from it in one way."""

    half_angles: Annotated[bool, "angles by the half-angle form instead of the triangle's area"] = False
    single: Annotated[bool, "single precision"] = False
    steps: Annotated[int | None, "per cycle, of differences of positions instead of derivatives"] = None


def _differences(steps: int) -> AnalyticSettings:
    note = "velocities and accelerations by differences of positions, as many tools find them"
    return AnalyticSettings(f"differences {steps}", steps=steps, family="differences", order=2, note=note)


KINDS = kinds_of((*RULES, *CONTACTS, *(joint.declared for joint in JOINTS))) | DRIVES
MIN_SPRING_LENGTH = 1e-12  # of the longest arm: a shorter one's direction is round-off
DEFAULT = AnalyticSettings("vector equations", promise=1e-12)
WORK_PRECISION = (
    DEFAULT,
    AnalyticSettings("half-angle form", half_angles=True, note="the source paper's form, its misprints corrected"),
    AnalyticSettings("single precision", single=True, drive_promise=1e-6),
    _differences(360),
)
LONG_WORK_PRECISION = tuple(map(_differences, (72, 720, 1440, 3600, 36_000, 360_000)))


class AnalyticSimulation:
    """One evaluation at the commanded positions."""

    residuals: Mapping[str, float] = {}  # a closed form has none of its own; its floor is certified from outside

    def __init__(self, solver: Solver, request: Request, settings: AnalyticSettings) -> None:
        if settings.half_angles:
            solver = replace(solver, motion_at=partial(kinematics, rrr=half_angle_position))
        elif settings.steps is not None:
            solver = replace(solver, motion_at=partial(differenced, step=solver.scene.cycle / settings.steps))
        asked = (Sampling(channels=frozenset(names)) for names in (solver.known, solver.own))
        self._solver, self._own = (replace(solver, request=some) for some in asked)  # no clock counts what is its own
        self._request, self._settings = request, settings
        self._motion: Motion | None = None

    def solve(self) -> None:
        """Evaluate every channel that other engines have too."""
        self._motion = self._evaluated(self._solver)

    def _evaluated(self, solver: Solver) -> Motion:
        inputs = self._request.inputs(solver.scene)
        if self._settings.single:
            return solver(inputs.driven().position.astype(np.float32), inputs.time)
        return solver(inputs)

    def read(self) -> Motion:
        """Return the channels, whatever precision they were found in, as doubles."""
        assert self._motion is not None, "expected `solve` first"
        own = self._evaluated(self._own).samples if self._own.own else {}
        samples = {**self._motion.samples, **own}
        motion = Motion({channel: values.astype(np.float64, copy=False) for channel, values in samples.items()})
        if self._request.wants_forces(self._solver.scene):
            self._check_springs(motion)
        return motion

    def _check_springs(self, motion: Motion) -> None:
        """Raise Failure, `nonfinite`, where the ends of a spring meet that then has no direction."""
        scene, linkage = self._solver.scene, self._solver.linkage
        position = self._request.inputs(scene).driven().position
        pairs = [pair for pair in scene.of_type(PointPair).values() if pair.needs_direction]
        z = motion_at(scene, linkage, position).z if pairs else {}
        for pair in pairs:
            apart = np.abs(z[pair.second[1]] - z[pair.first[1]])
            if not apart.min() > MIN_SPRING_LENGTH * linkage.arm:
                ends, where = " and ".join(map(".".join, pair.ends)), scene.where(float(position[apart.argmin()]))
                reason = f"the {pair.noun}'s ends {ends} meet at {where}: it has no direction"
                raise Failure(Status.nonfinite, reason, motion)

    @property
    def counters(self) -> Mapping[str, int]:
        """The number of positions times groups."""
        return {"group_solves": self._request.count * len(self._solver.linkage.groups)}


def build(scene: Scene, settings: AnalyticSettings, request: Request) -> AnalyticSimulation:
    """Prepare an evaluation, or raise Failure where the linkage does not decompose, or has no one motion."""
    prepared = solver(scene, request.channels)
    check_way(prepared)
    return AnalyticSimulation(prepared, request, settings)


def half_angle_position(
    d: Vectors, distance: Samples, r1: float, r2: float, _reach: Samples, branch: int
) -> tuple[Vectors, Vectors, Samples]:
    """Return p, q and p x q, as `dyads.rrr_position` does, from the angle of p by its half.

    |d - p| = r2 makes A cos + B sin = C with A = 2 r1 d_x, B = 2 r1 d_y, C = d^2 + r1^2 - r2^2, and the tangent of the
    half angle solves (A + C) t^2 - 2 B t + (C - A) = 0. It loses the digits of A + C where those cancel. Equations (8),
    (10) and (14) of Yang (2023), doi:10.56578/jisc020103, with their misprints corrected.
    """
    A, B, C = 2 * r1 * d.real, 2 * r1 * d.imag, distance * distance + (r1 - r2) * (r1 + r2)
    half = np.arctan((B + branch * np.sqrt(A * A + B * B - C * C)) / (A + C))
    p = r1 * np.exp(2j * half)
    q = p - d
    return p, q, cross(p, q)


def differenced(scene: Scene, linkage: Linkage, driven: Driven, *, step: float) -> Kinematics:
    """Return the kinematics, all rates by central differences of positions `step` apart, s.

    The error is of order step^2, and roundings grow with 1 / step^2.
    """
    moved = driven.rate * step, driven.acceleration * step**2 / 2

    def at(sign: int) -> Kinematics:
        position = driven.position + sign * moved[0] + moved[1] * sign**2
        return kinematics(scene, linkage, driven._replace(position=position), rates=False)

    # Central differences of second order in the time step; angles by the turn from one attitude to the next, so that no
    # wrap by a turn comes in.
    before, k, after = map(at, (-1, 0, 1))
    for point, z in k.z.items():
        k.v[point] = (after.z[point] - before.z[point]) / (2 * step)
        k.a[point] = (after.z[point] - 2 * z + before.z[point]) / step**2
    for body, u in k.u.items():
        forth, back = np.angle(after.u[body] / u), np.angle(u / before.u[body])
        k.omega[body], k.alpha[body] = (forth + back) / (2 * step), (forth - back) / step**2
        k.rate[body] = turned(k.omega[body], k.alpha[body])
    return k

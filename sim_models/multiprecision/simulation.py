"""One run at arbitrary precision: follow the pose through the samples, prove each, round the channels at the end.

They are rounded to double precision there and nowhere before.
"""

from collections.abc import Mapping, Sequence
from math import ceil, tau
from typing import NamedTuple

import numpy as np
from flint import arb, arb_mat, ctx

from scenes import Failure, Motion, ProcessorBudget, Request, Scene, Status
from scenes.model.motion import Samples

from .constraints import LinkageEquations
from .continuation import Continuation
from .drive import Command, commands
from .elements import GeneralisedForce
from .engine import MultiprecisionSettings
from .friction import JointResistance, resisted
from .loads import generalised_force
from .rows import angles, solved
from .start import start, stroke_ends

MAX_PROVEN_ERROR = 1e-20  # of the motion and of the forces, relative; far below a double's round-off


class Solution(NamedTuple):
    """Balls that hold the solution of one sample, each of shape (rows, 1)."""

    q: arb_mat  # m, rad: x, y, θ of every body
    velocity: arb_mat
    acceleration: arb_mat
    multipliers: arb_mat  # N, N m, in the order of the force channels, with those of friction


def solution_in(
    linkage: LinkageEquations,
    force: GeneralisedForce,
    q: arb_mat,
    command: Command,
    frictions: Sequence[JointResistance] = (),
) -> Solution:
    """J q' = e rate, J q'' = e acceleration + centripetal, J^T λ = M q'' - Q in a pose, e being the drive's row."""
    rows, groups = linkage.constraints, linkage.groups
    J = rows.jacobian(q)
    velocity = solved(groups, J, linkage.drive(command.rate))
    total = solved(groups, J, linkage.drive(command.acceleration) + rows.centripetal(q, velocity))
    inertial = arb_mat([[m * a] for m, a in zip(linkage.mass, total.entries(), strict=True)])
    multipliers = solved(linkage.transposed_groups, J.transpose(), inertial - force(q, velocity, command.time))
    if frictions:
        multipliers = resisted(linkage, frictions, q, velocity, multipliers)
    return Solution(q, velocity, total, multipliers)


def proven_errors(linkage: LinkageEquations, solutions: Sequence[Solution]) -> dict[str, float]:
    """Return the proven errors: of the motion, in the linkage's size, rad and the drive's pace; of the forces.

    A drive's pace is its peak rate, rad/s, or in travels of the driven slider per second. The error of the forces is
    that of any relative to the largest, or to what the heaviest body's inertia could take, where all are zero.
    """
    scene = linkage.scene
    pace = scene.pace
    levels = ([_radii(solution[level]) for solution in solutions] for level in range(3))
    motion = [np.max(radii / np.array(linkage.units)) / pace**order for order, radii in enumerate(levels)]
    errors = {"constraints": float(np.max(motion))}
    if scene.has_masses:
        force = np.max([_radii(solution.multipliers) for solution in solutions])
        peak = max(abs(float(ball)) for solution in solutions for ball in solution.multipliers.entries())
        heaviest = max(float(mass) for mass in linkage.mass[::3])
        scale = max(peak, heaviest * linkage.size * pace**2)
        errors["newton-euler"] = float(force / scale if scale > 0 else force)
    return errors


def _values(linkage: LinkageEquations, solution: Solution) -> list[arb]:
    """All channels of one sample but the time, in the order of the files."""
    scene, points, (q, velocity, acceleration, multipliers) = linkage.scene, linkage.points, solution
    # p'' = J q'' + (f'' - J q''); `centripetal` is the negative of the second term, by its use in the constraints.
    J = points.jacobian(q)
    levels = points.value(q), J * velocity, J * acceleration - points.centripetal(q, velocity)
    values = linkage.position.value(q).entries()
    for k in range(len(scene.moving_points)):
        values += [level[2 * k + axis, 0] for level in levels for axis in (0, 1)]
    for body in scene.turning:
        angle, *rates = (angles(level)[linkage.index[body]] for level in solution[:3])
        turns = ceil(float(angle) / tau - 0.5)  # whole ones, that leave it in (-π, π]
        values += [angle - 2 * arb.pi() * turns, *rates]
    return values + (multipliers.entries() if scene.has_masses else [])


def _radii(balls: arb_mat) -> Samples:
    return np.array([float(ball.rad()) for ball in balls.entries()])


class MultiprecisionSimulation:
    """One prepared run, see `scenes.model.engine.Simulation`."""

    def __init__(self, scene: Scene, settings: MultiprecisionSettings, request: Request) -> None:
        """Find the pose at the start, and the ends of press forces' strokes, see `engine.build`."""
        self._request, self._settings = request, settings
        self._rows: list[list[float]] = []  # of channels, a sample each
        self.counters: Mapping[str, int] = {}
        self.residuals: Mapping[str, float] = {}
        budget = ProcessorBudget(settings.seconds, "the start from the sketch")
        with ctx.workdps(settings.digits):  # puts back the precision that was there before
            self._linkage = LinkageEquations(scene)
            continuation = Continuation(self._linkage, settings.digits, budget)
            self._start = start(self._linkage, continuation)
            budget.task = "the end of the closing stroke"
            ends = stroke_ends(self._linkage, continuation, self._start)
            self._force = generalised_force(self._linkage, ends, self._start)
            frictions = scene.friction if request.wants_forces(scene) else ()
            self._frictions = [JointResistance(self._linkage, friction) for friction in frictions]

    def solve(self) -> None:
        """Follow the pose through the samples and enclose each."""
        linkage, digits = self._linkage, self._settings.digits
        budget = ProcessorBudget(self._settings.seconds_for(self._request), "the motion")
        continuation = Continuation(linkage, digits, budget)
        solutions, self._rows, q = list[Solution](), [], self._start
        with ctx.workdps(digits):
            for number, command in enumerate(commands(linkage.prescribed.law, linkage.law, self._request), start=1):
                budget.task = f"sample {number} of {self._request.count}"
                goal = linkage.drive(float(command.position))  # the drive's channel is where the pose is
                q = continuation.follow(q, goal)
                pose = continuation.enclose(q, goal)
                solutions.append(solution_in(linkage, self._force, pose, command, self._frictions))
                self._rows.append([float(ball) for ball in (command.time, *_values(linkage, solutions[-1]))])
            self.residuals = proven_errors(linkage, solutions)
        self.counters = continuation.counters
        for proven, result in (("constraints", "motion"), ("newton-euler", "forces")):
            if proven in self.residuals and not self.residuals[proven] <= MAX_PROVEN_ERROR:
                reason = f"{digits} digits prove the {result} only to {self.residuals[proven]:.0e}"
                raise Failure(Status.not_converged, reason)

    def read(self) -> Motion:
        """Return the channels requested, in double precision."""
        scene = self._linkage.scene
        # Forces that nobody asks for are those without friction, and fewer.
        samples = dict(zip(scene.channels.names(), np.array(self._rows).T, strict=False))
        return Motion({channel: samples[channel] for channel in self._request.wanted(scene)})

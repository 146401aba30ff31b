"""A scene's machines by the thousand: drawn, solved in blocks on all cores, and what becomes of their numbers."""

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from math import nan
from multiprocessing import current_process
from typing import NamedTuple

import numpy as np

from scenes import Sampling, Scene, Status, numbers_in
from scenes.file.changes import at_path
from scenes.model.enclosures import Enclosure
from scenes.model.motion import Samples

from ...engines import registry
from ...engines.processes.inside import Ended, Limits
from ...engines.processes.isolation import isolated
from ...engines.processes.stopping import Progress
from ...engines.processes.workers import workers
from ...judge.agreement import Judgement
from ...judge.floor import establish, solvable
from ...judge.judgement import judgement
from ...judge.peaks.numbers import CycleNumber
from ...mechanics.reference import Reference
from .family import balanced
from .machines import as_drawn, draws, gradients, machines

BLOCK = 256  # machines that a process is asked for at a time, in the same arrays: these stay in the processor's cache
SECONDS = 1800.0  # for a block: slow linkages take 0.1 s a machine
QUANTILES = (0.00135, 0.05, 0.5, 0.95, 0.99865)  # the outer ones are three standard deviations of a normal
ROUND_OFF_TOL = 1e-11  # relative: by so much a number that nothing changes differs from machine to machine
NUMBER = re.compile(r"-?\d[\d.]*(e-?\d+)?")


class Block(NamedTuple):
    """The numbers of some machines, and why some do not run."""

    first: int
    values: Samples  # shape (m, k); NaN of those that do not run
    failed: Sequence[tuple[int, str, str]]  # machine, status, reason
    met: int = 0  # how many meet all limits of the scene


@dataclass(frozen=True)
class Failed:
    """Machines that do not run for the same reason."""

    status: str
    reason: str  # of the first of them
    count: int
    first: int


@dataclass(frozen=True)
class Spread:
    """One of the designer's numbers over all machines that run, SI."""

    name: str
    of: str  # the joint, point or body
    unit: str
    nominal: float  # of the linkage as drawn
    size: float  # what the engines' differences are relative to
    mean: float
    deviation: float  # standard deviation, 0 where it is rounding
    quantiles: Mapping[str, float]
    least: int  # the machine with the least value, from 0
    largest: int
    linear: float  # the standard deviation by the linear model
    unexplained: float  # the share of the sampled variance that the linear model leaves; its mean shift counts too
    shares: Mapping[str, float]  # by path, of the variance of the linear model


@dataclass(frozen=True)
class MonteCarlo:
    """The machines that were solved; fewer than asked for where the user stopped."""

    asked: int
    seed: int
    judged: Judgement  # of the linkage as drawn
    numbers: Sequence[CycleNumber]  # the k numbers of that, each of shape (1,)
    gradients: Samples  # of these by those of the file that vary, shape (p, k), SI per unit of the file
    blocks: list[Block] = field(default_factory=list)

    @property
    def scene(self) -> Scene:
        """The linkage as drawn."""
        return self.judged.scene

    @property
    def nominal(self) -> Samples:
        """The numbers of the linkage as drawn, shape (k,), SI."""
        return np.concatenate([number.value for number in self.numbers])

    @property
    def count(self) -> int:
        """How many machines were solved."""
        return sum(len(block.values) for block in self.blocks)

    @property
    def complete(self) -> bool:
        """Whether all of them were."""
        return self.count == self.asked

    @cached_property
    def values(self) -> Samples:
        """The numbers of all machines asked for, shape (N, k), SI; NaN of those that do not run."""
        table = np.full((self.asked, len(self.numbers)), np.nan)
        for block in self.blocks:
            table[block.first : block.first + len(block.values)] = block.values
        return table

    @cached_property
    def spreads(self) -> list[Spread]:
        """What becomes of each number."""
        drawn = draws(self.scene, self.seed, 0, self.asked)
        offsets = [drawn[path] - value for path, value in zip(drawn, numbers_in(self.scene, [*drawn]), strict=True)]
        linear = self.nominal + np.transpose(offsets) @ self.gradients
        deviations = np.array([variation.deviation for variation in self.scene.variations])
        of_each = zip(self.numbers, self.values.T, linear.T, self.gradients.T, strict=True)
        return [
            spread(number, values, by_model, dict(zip(drawn, deviations * rates, strict=True)))
            for number, values, by_model, rates in of_each
        ]

    @cached_property
    def failures(self) -> list[Failed]:
        """Why machines do not run, the most frequent reason first; the places in them differ."""
        # Reasons differ in their numbers alone, as in angles and lengths: failures are grouped by the text without its
        # numbers.
        by_reason: dict[tuple[str, str], list[tuple[int, str]]] = {}
        for machine, status, reason in sorted(failed for block in self.blocks for failed in block.failed):
            by_reason.setdefault((status, NUMBER.sub("", reason)), []).append((machine, reason))
        failures = [Failed(status, lost[0][1], len(lost), lost[0][0]) for (status, _), lost in by_reason.items()]
        return sorted(failures, key=lambda failed: -failed.count)

    @property
    def running(self) -> int:
        """How many machines run."""
        return self.count - sum(failed.count for failed in self.failures)

    @property
    def met(self) -> tuple[int, float, float]:
        """How many machines meet all limits of the scene, and Clopper and Pearson's interval of the yield, of 95 %."""
        from scipy.stats import binomtest  # late, as few scenes have limits

        count = sum(block.met for block in self.blocks)
        return count, *binomtest(count, self.count).proportion_ci(0.95)

    @cached_property
    def enclosed(self) -> Mapping[str, Enclosure]:
        """By pin, its largest force over all machines whose numbers are off by no more than they may."""
        scene = self.scene
        keys = {variation: at_path(scene, variation.path) for variation in scene.variations}
        tolerances = {key: v.plus_minus * scene.size(scene.numbers[key]) for v, key in keys.items()}
        pins = {force: pin for pin, force in scene.channels.forces_of_pins.items()}
        found = registry.enclosures(scene, frozenset(pins), off=tolerances).rows if pins else ()
        return {pins[row.channel]: row for row in found if row.extreme == "most"}

    @cached_property
    def worst(self) -> tuple[int, Spread] | None:
        """The machine that is the farthest from the linkage as drawn, in standard deviations of one of its numbers."""
        moving = [k for k, figure in enumerate(self.spreads) if figure.deviation > 0]
        if not moving:
            return None
        distance = np.abs(self.values - self.nominal)[:, moving] / [self.spreads[k].deviation for k in moving]
        machine, column = np.unravel_index(np.nanargmax(distance), distance.shape)
        return int(machine), self.spreads[moving[int(column)]]

    def changes(self, machine: int) -> Mapping[str, float]:
        """The numbers of one machine by path, in the units of the file."""
        return {path: float(values[0]) for path, values in draws(self.scene, self.seed, machine, 1).items()}


def spread(number: CycleNumber, values: Samples, linear: Samples, gradient: Mapping[str, float]) -> Spread:
    """The statistics of a number of all m machines, NaN of those that do not run, and by the linear model; shape (m,).

    The gradient is by path what a standard deviation of that number of the scene changes.
    """
    kept, nominal, size = ~np.isnan(values), float(number.value[0]), float(number.size[0])
    run = values[kept] if kept.any() else np.full(1, nan)
    least, largest = (int(np.nanargmin(values)), int(np.nanargmax(values))) if kept.any() else (-1, -1)
    deviation = float(run.std(ddof=1)) if run.size > 1 else nan
    if deviation <= ROUND_OFF_TOL * max(abs(nominal), abs(size)):
        deviation = 0.0
    quantiles = {f"{q:.5g}": float(value) for q, value in zip(QUANTILES, np.quantile(run, QUANTILES), strict=True)}
    # Mean square of what the linear model leaves, a shift of the mean included, over the sampled variance: 0 where the
    # model is exact; one and more where it explains nothing.
    unexplained = float(np.mean(np.square((values - linear)[kept]))) / deviation**2 if deviation > 0 else nan
    parts = np.square([*gradient.values()])
    of_all = float(parts.sum())
    shares = {path: float(part) / of_all if of_all else 0.0 for path, part in zip(gradient, parts, strict=True)}
    named = number.name, number.curve.of, number.unit, nominal, size
    sampled = float(run.mean()), deviation, quantiles, least, largest
    return Spread(*named, *sampled, of_all**0.5, unexplained, shares)


def begun(
    scene: Scene, count: int, seed: int, engines: Sequence[str], sampling: Sampling, progress: Progress
) -> MonteCarlo:
    """The linkage as drawn, cross-checked; no machine is solved yet. UnsolvedError of `establish`."""
    with workers([*engines, registry.ORACLE], lambda: None) as runs:
        reference = establish(scene, runs=runs)
        judged = judgement(reference, engines, sampling, balanced, progress, runs)
    progress("derivatives")
    paths = [variation.path for variation in scene.variations]
    with solvable(scene):
        machine = as_drawn(reference, paths)
    return MonteCarlo(count, seed, judged, machine.numbers, gradients(reference, machine, paths))


def solved(study: MonteCarlo) -> Iterator[Block]:
    """Yield the machines in blocks, as they come from the processes that solve them."""
    parts = [range(study.asked)[first : first + BLOCK] for first in range(0, study.asked, BLOCK)]
    solve = partial(_block, study.judged.reference, len(study.numbers), study.seed)
    if current_process().daemon:  # which may have no processes of its own
        yield from map(solve, parts)
        return
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    limits = Limits(SECONDS, workers=min(cores, len(parts)))
    for part, outcome in isolated(solve, parts, limits, lambda: None):
        if isinstance(outcome, Ended):
            lost = [(machine, outcome.status.name, outcome.reason) for machine in part]
            outcome = Block(part.start, np.full((len(part), len(study.numbers)), np.nan), lost)
        yield outcome


def _block(reference: Reference, count: int, seed: int, rows: range) -> Block:
    """Draw and solve some machines, and keep nothing but their `count` numbers."""
    some = machines(reference, draws(reference.scene, seed, rows.start, len(rows)))
    values = np.full((len(rows), count), np.nan)
    if some.numbers:
        values[some.running] = np.transpose([number.value for number in some.numbers])
    ended = enumerate(zip(some.status, some.reason, strict=True), rows.start)
    failed = [(n, status.name, reason) for n, (status, reason) in ended if status is not Status.ok]
    return Block(rows.start, values, failed, int(np.sum(some.met)))

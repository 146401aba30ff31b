"""A judged scene: what it misses, and whether its models agree, in a word, and in a sentence how well, or which not."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cached_property
from math import ceil, isfinite
from typing import NamedTuple

import numpy as np

from scenes import Motion, Sampling, Scene, Status
from scenes.channels import Role
from scenes.model.enclosures import Enclosures
from scenes.model.motion import FEWEST

from ..engines import registry
from ..engines.registry import REFERENCE
from ..mechanics.axis import axis
from ..mechanics.mechanics import SHOWN_GROUPS
from ..mechanics.quantities import units
from ..mechanics.reference import Reference
from ..mechanics.round_off import Explained
from .errors import ChannelError, worst_of
from .floor import FLOOR_SAMPLES
from .measure import Gate, Measurement, Miss, gates, missed
from .peaks.peaks import Peak, peaks
from .proof import MET, HeldLimit, LimitsVerdict, SampledRun, asked, held, verdict_on
from .verdict import digits, sized, within

CONTRADICTS = (Status.wrong_branch, Status.inconsistent, Status.inaccurate)  # with a motion, but another one
FAILED = {
    Status.unsupported: "cannot model this scene",
    Status.cannot_assemble: "could not put the bodies together",
    Status.jammed: "is held by its friction",
    Status.undetermined: "found more than one set of forces",
    Status.diverged: "ran away",
    Status.not_converged: "did not converge",
    Status.nonfinite: "returned values that are not finite",
    Status.timed_out: "ran out of time",
    Status.crashed: "crashed",
}  # why there is nothing to compare
CONTRADICTION = "contradicts itself"
INSTANT_TOL = 1e-6  # of a cycle: instants are written at decimals
MIN_FLOOR = 1e-9  # relative: by so much at least a sample of the reference may be off its bounds


class FromSamples(NamedTuple):
    """What of a judgement is found by samples, and outlasts them."""

    causes: dict[str, str]
    peaks: list[Peak]


class Word(StrEnum):
    """The verdict in a word."""

    agrees = "agrees"
    in_part = "agrees in part"
    disagrees = "disagrees"
    not_solved = "not solved"


@dataclass(frozen=True)
class Agreement:
    """The verdict on all models of a scene."""

    word: Word
    sentence: str

    def __str__(self) -> str:
        return f"{self.word}: {self.sentence}"


class WorstError(NamedTuple):
    """The largest error of an engine over all channels."""

    size: float  # relative, none below the reference's floor; NaN of the reference without one
    channel: str
    position: float  # on the axis of curves and tables, SI: rad, m, or s under a law; NaN of the floor, found nowhere


def worst_error(
    scene: Scene, measurement: Measurement, groups: Sequence[str] = (), *, faults: bool = False
) -> WorstError | None:
    """The largest error of an engine in some channel groups or all, NaN above any; None where nothing was compared.

    With `faults` it is of those that nothing explains, where there is one.
    """
    rows = [row for row in measurement.errors if not groups or row.group in groups]
    if faults:
        rows = [row for row in rows if not row.unexplained <= row.floor] or rows
    if not rows:
        return None
    row = worst_of(rows)
    return WorstError(row.max, row.channel, np.nan if row.max <= row.floor else row.max_at / axis(scene).factor)


@dataclass(frozen=True)
class Judgement:
    """Every engine's run on one scene, held against its own output, the reference and the scene's tolerances."""

    scene: Scene
    sampling: Sampling
    reference: Reference
    explained: Explained  # of errors, by doubles
    measurements: list[Measurement]  # one an engine, in the order asked for
    reasons: list[str]  # what the user should know: of its numbers and its sketch, why engines run at their settings
    let_through: list[str] = field(default_factory=list, kw_only=True)  # undetected canaries: faults put into copies
    from_samples: FromSamples | None = field(default=None, kw_only=True)  # of one that has none any more

    @cached_property
    def held(self) -> list[Gate]:
        """The scene's tolerances, in the channels asked for."""
        return list(gates(self.scene, self.measurements, self.sampling.channels, self.reference.floor.doubt))

    @property
    def cycles(self) -> int:
        """The cycles of the drive that the run has, or a result of another program."""
        ends = [m.asked.times(self.scene)[-1] for m in self.measurements if m.foreign and self.scene.periodic]
        return max([self.sampling.turns, *(ceil(float(end) / self.scene.cycle - INSTANT_TOL) for end in ends)])

    @cached_property
    def proof(self) -> Enclosures:
        """What is proven over all cycles asked for, between the samples too, of what was asked for."""
        return registry.enclosures(self.scene, asked(self.scene, self.sampling), turns=self.cycles)

    @cached_property
    def limits(self) -> list[HeldLimit]:
        """The scene's limits, held against that, and against the samples of the reference and of all that is ok."""
        if not self.scene.limits:
            return []
        scale, true = self.reference.scale, self.reference.at(self.sampling.inputs(self.scene))
        floor = max([MIN_FLOOR, *self.reference.floor.by_channel.values()])
        runs = [SampledRun(_name(self), true, floor, scale)]
        for m in self.measurements:
            if m.run.status is Status.ok and m.run.engine != REFERENCE and m.run.motion and m.run.settings:
                bound = max(m.run.settings.promise, m.largest)  # which round-off may take beyond what is promised
                runs.append(SampledRun(m.run.engine, m.run.motion, bound, scale))
        return list(held(self.scene, self.sampling, self.proof, runs, units(self.reference)))

    @property
    def limits_verdict(self) -> LimitsVerdict | None:
        """Whether the scene's limits are met, whatever the models are; None without limits."""
        return verdict_on(self.limits)

    @property
    def ok(self) -> bool:
        """Whether every engine is ok, the reference not in doubt, no tolerance, limit or canary missed."""
        return not self.misses

    @property
    def missed(self) -> list[str]:
        """What a CI run is stopped by, a line each."""
        return [miss.text for miss in self.misses]

    @property
    def misses(self) -> list[Miss]:
        """The same, each with its engine and channel group; a doubt about the reference comes first."""
        return self.disagreements + [
            Miss("", "", f"limits.{limit.text}") for limit in self.limits if limit.outcome != MET
        ]

    @property
    def disagreements(self) -> list[Miss]:
        """What of that is the models', not the linkage's."""
        doubt = self.reference.floor.doubt
        has_core = any(m.run.engine == REFERENCE for m in self.measurements)
        doubted = [Miss(REFERENCE, "", f"{REFERENCE}: {doubt}")] if doubt and not has_core else []
        misses = doubted + missed(self.measurements, self.held) + [Miss("", "", line) for line in self.let_through]
        return sorted(misses, key=lambda miss: miss.engine != REFERENCE) if doubt else misses

    @cached_property
    def causes(self) -> dict[str, str]:
        """By engine that is not ok or misses a tolerance, the likely cause in a sentence; of a doubted core alone."""
        if self.from_samples is not None:
            return self.from_samples.causes
        missing = {gate.engine for gate in self.held if gate.missed}
        if not (missing or self.reference.floor.doubt) and all(m.run.status is Status.ok for m in self.measurements):
            return {}
        from .triage import sentences  # late: most runs have nothing to find a cause for

        return sentences(self.reference, self.measurements, missing)

    @property
    def agreement(self) -> Agreement:
        """Whether the models agree.

        They agree where none of them is off, and other engines confirm every channel of the reference; in part, where
        no model contradicts another and some of them, or arbitrary precision, confirm the reference.
        """
        others = [m for m in self.measurements if m.run.engine != REFERENCE]
        confirming = [m for m in others if m.run.status is Status.ok]
        if contradiction := _contradiction(self, others):
            return Agreement(Word.disagrees, contradiction)
        unsolved = _listed([f"{m.run.engine} {_why(m)}" for m in others if m.run.status is not Status.ok])
        if not confirming:
            alone = f"{unsolved}; nothing else checks it" if unsolved else "No other engine was asked"
            unable = all(m.run.status is Status.unsupported for m in others)  # which is no failure of the scene
            certified = self.reference.floor.by_channel and unable
            if certified and unsolved:
                alone = unsolved
            return Agreement(Word.in_part if certified else Word.not_solved, f"{alone}; {_certified(self)}.")
        sentences = [f"{_confirmed(self, confirming)}; {_certified(self)}."]
        whole = [m for m in confirming if _whole_cycle(self.scene, m)]
        inputs = self.scene.channels.names(Role.time, Role.input)
        given = {*inputs}.union(*(m.run.motion.samples for m in whole if m.run.motion))
        unchecked = [channel for channel in self.sampling.wanted(self.scene) if channel not in given]
        if unchecked:
            where = " over a whole cycle" * (len(whole) < len(confirming)) + ", among others" * (len(unchecked) > 1)
            sentences.append(f"No other engine that is ok gives {unchecked[0]}{where}.")
        agrees = not self.disagreements and not unchecked
        if agrees and self.held:
            count = len(self.held)
            sentences.append("The tolerance is met." if count == 1 else f"All {count} tolerances are met.")
        if not agrees and unsolved:
            sentences.append(f"{unsolved}.")
        if self.let_through:
            sentences.append("The comparison let through faults that were put into copies of these runs.")
        return Agreement(Word.agrees if agrees else Word.in_part, " ".join(sentences))

    @cached_property
    def peaks(self) -> list[Peak]:
        """The numbers by which a designer sizes the linkage, and by how much the engines differ on each."""
        if self.from_samples is not None:
            return self.from_samples.peaks
        return peaks(self.reference, self.sampling, self.measurements)

    @property
    def verdicts(self) -> dict[str, tuple[str, str]]:
        """By engine the name of its status, and the reason where it is not ok."""
        return {m.run.engine: (m.run.status.name, m.run.reason) for m in self.measurements}

    @property
    def motions(self) -> dict[str, Motion]:
        """By engine its motion, where it returned one, be it ok or not."""
        return {m.run.engine: m.run.motion for m in self.measurements if m.run.motion is not None}

    @property
    def channel_errors(self) -> list[ChannelError]:
        """One row per engine and channel: its errors against the reference."""
        return [row for measured in self.measurements for row in measured.errors]


def _whole_cycle(scene: Scene, measurement: Measurement) -> bool:
    """Whether a model was compared over a whole cycle, in steps no longer than engines are asked for at least."""
    times, cycle = measurement.asked.times(scene), scene.cycle
    step = float(np.diff(times).max(initial=0.0))  # to the first row of the next cycle too
    return bool(FEWEST * step <= (1 + INSTANT_TOL) * cycle and times[-1] - times[0] + step >= (1 - INSTANT_TOL) * cycle)


def _contradiction(judged: Judgement, others: Sequence[Measurement]) -> str:
    """Which model contradicts the rest, in what, by how much, and the likely cause; or nothing."""
    name, doubt = _name(judged), judged.reference.floor.doubt
    core = [m.run.status for m in judged.measurements if m.run.engine == REFERENCE and m.run.status is not Status.ok]
    if doubt or core:
        why = f"is not to be believed: {doubt.partition(': ')[0]}" if doubt else FAILED.get(core[0], CONTRADICTION)
        return f"{name[0].upper()}{name[1:]} {why}."
    contrary = [m for m in others if m.run.status in CONTRADICTS]
    if contrary:
        worst = max(contrary, key=lambda m: _size(judged, m))
        error = worst_error(judged.scene, worst, faults=True)
        size_text = f" by {sized(error.size)}" if error and isfinite(error.size) else ""
        names, verb = _listed([m.run.engine for m in contrary]), "disagrees" if len(contrary) == 1 else "disagree"
        most = "" if len(contrary) == 1 else f", most of all {worst.run.engine}"
        where = f"{size_text} in {error.channel}" if error else ""
        against = f"{names} {verb} with {name}{most}{where}{_cause(judged, worst.run.engine)}."
        agreeing = [m for m in others if m.run.status is Status.ok]
        return f"{against} {_confirmed(judged, agreeing)}." if agreeing else against
    ok = {m.run.engine for m in others if m.run.status is Status.ok}
    for gate in judged.held:
        if gate.missed and gate.engine in {REFERENCE, *ok}:
            size = f"off by {sized(gate.error)} in {gate.worst}" if isfinite(gate.error) else gate.worst
            cause = _cause(judged, gate.engine) if gate.engine in ok else ""
            return f"{gate.engine} misses its {gate.group} tolerance: {size}{cause}."
    return ""


def _confirmed(judged: Judgement, confirming: Sequence[Measurement]) -> str:
    size = max(_size(judged, m) for m in confirming)
    verb, each = ("agrees", "it gives") if len(confirming) == 1 else ("agree", "each gives")
    channels = "every channel" if judged.sampling.channels is None else "every channel asked for"
    if any(m.foreign or (m.run.motion and m.run.motion.unsupported) for m in confirming):
        channels += f" that {each}"
    closeness = f" to {within(size)}" if isfinite(size) else ""  # nothing but the drive may have been asked for
    return f"{_listed([m.run.engine for m in confirming])} {verb} with {_name(judged)}{closeness} in {channels}"


def _size(judged: Judgement, measurement: Measurement) -> float:
    """The largest error of an engine for comparison: infinite where it is no number."""
    worst = worst_error(judged.scene, measurement, SHOWN_GROUPS)
    return worst.size if worst is not None and isfinite(worst.size) else np.inf


def _cause(judged: Judgement, engine: str) -> str:
    cause = judged.causes.get(engine, "").removeprefix(f"{engine}: ")
    return f"; likely cause: {cause}" if cause else ""


def _why(measurement: Measurement) -> str:
    entry = registry.ENTRIES.get(measurement.run.engine)
    if entry is not None and entry.missing:
        return "cannot be run" if entry.trouble else "is not installed"
    if measurement.run.status is Status.unsupported and measurement.run.found_by == "checks":
        return "gives nothing to compare"
    return FAILED.get(measurement.run.status, CONTRADICTION)


def _name(judged: Judgement) -> str:
    return "the closed form" if registry.in_closed_form(judged.scene) else "the reference"


def _certified(judged: Judgement) -> str:
    floor, name = judged.reference.floor, _name(judged)
    if not floor.by_channel:
        return f"no calculation with 50 digits confirms {name}"
    there = f"{digits(max(floor.by_channel.values()))} digits at {FLOOR_SAMPLES} positions of the drive"
    return f"a calculation with 50 digits confirms {name} to {there}{floor.limit}"


def _listed(names: Sequence[str]) -> str:
    return " and ".join(filter(None, (", ".join(names[:-1]), *names[-1:])))

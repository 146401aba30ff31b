"""One scene solved by several engines, each held to its promise, and the reference to its own."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import combinations
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from scenes import Motion, Sampling, Scene, Settings, Status

from ..engines import registry, runner
from ..engines.reference import Reference, relative_errors
from ..engines.registry import ORACLE, REFERENCE, voter
from ..engines.runner import Run, Runs
from ..engines.stopping import kept
from .agreement import Agreement, agreement
from .errors import ChannelError
from .escalation import escalated
from .foreign import assess_result, coarse
from .gates import Gate, Miss, gates, missed
from .measure import Measurement, measure
from .notes import notes
from .peaks.peaks import Peak, peaks
from .round_off import Explained, explain
from .sketch import warnings
from .verdict import judged

if TYPE_CHECKING:
    from ..results.result import Result

Offers: TypeAlias = Callable[[str], tuple[Sequence[Settings], str]]  # of an engine: settings to try, and why these


@dataclass(frozen=True)
class Judgement:
    """Every engine's run on one scene, held against its own output, the reference and the scene's tolerances."""

    scene: Scene
    sampling: Sampling
    reference: Reference
    explained: Explained  # of errors, by doubles
    measurements: list[Measurement]  # one an engine, in the order asked for
    held: list[Gate]  # the scene's tolerances
    reasons: list[str]  # what the user should know: of its numbers and its sketch, why engines run at their settings
    let_through: list[str] = field(default_factory=list, kw_only=True)  # faults in copies of these runs, that none sees

    @property
    def ok(self) -> bool:
        """Whether every engine is ok, the reference not in doubt, no tolerance missed, and no canary let through."""
        return not self.misses

    @property
    def missed(self) -> list[str]:
        """What a CI run is stopped by, a line each."""
        return [miss.text for miss in self.misses]

    @property
    def misses(self) -> list[Miss]:
        """The same, each with its engine and channel group; a doubt about the reference comes first."""
        doubt = self.reference.floor.doubt
        asked = any(m.run.engine == REFERENCE for m in self.measurements)
        doubted = [Miss(REFERENCE, "", f"{REFERENCE}: {doubt}")] if doubt and not asked else []
        found = doubted + missed(self.measurements, self.held) + [Miss("", "", line) for line in self.let_through]
        return sorted(found, key=lambda miss: miss.engine != REFERENCE) if doubt else found

    @cached_property
    def causes(self) -> dict[str, str]:
        """By engine that is not ok or misses a tolerance, the likely cause in a sentence; of a doubted core alone."""
        off = {gate.engine for gate in self.held if gate.missed}
        if not (off or self.reference.floor.doubt) and all(m.run.status is Status.ok for m in self.measurements):
            return {}
        from .triage import sentences  # late: most runs have nothing to find a cause for

        return sentences(self.reference, self.sampling, self.measurements, off)

    @property
    def agreement(self) -> Agreement:
        """Whether the models agree, in a word and in a sentence."""
        return agreement(self)

    @cached_property
    def peaks(self) -> list[Peak]:
        """The numbers by which a designer sizes the linkage, and by how much the engines differ on each."""
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


def judgement(
    reference: Reference,
    engines: Sequence[str],
    sampling: Sampling,
    offers: Offers,
    progress: Callable[[str], None],
    runs: Runs = runner,
    results: Sequence["Result"] = (),
) -> Judgement:
    """Run every engine at the settings chosen for it, and at others if these fail; a stop leaves what is done.

    Args:
        reference: the reference of the scene, with its floor.
        engines: their names.
        sampling: the instants.
        offers: by engine the settings to try, in that order, and a sentence why, or nothing.
        progress: called with what is being done.
        runs: what runs the engines.
        results: of other programs, which come after the engines.
    """
    scene, explained = reference.scene, explain(reference, sampling)
    reasons = [*notes(scene), *warnings(reference)]

    def main_runs() -> Iterator[Measurement]:
        for engine in engines:
            progress(f"running {engine}")
            at = partial(measure, reference, engine, sampling, explained=explained, runs=runs)
            if registry.ENTRIES[engine].missing:
                yield at()
                continue
            offered, why = offers(engine)
            measured, tried = escalated(at, offered)
            reasons.extend(filter(None, (why, tried)))
            yield measured
        for result in results:
            progress(f"comparing {result.run.engine}")
            reasons.extend(result.notes)
            assessed = assess_result(reference, result)
            reasons.extend(coarse(assessed))
            yield assessed

    reference, measurements = _voted(reference, list(kept(main_runs())))
    held = list(gates(scene, measurements, sampling.channels, reference.floor.doubt))
    return Judgement(scene, sampling, reference, explained, measurements, held, reasons)


def _voted(reference: Reference, measurements: list[Measurement]) -> tuple[Reference, list[Measurement]]:
    """Return the reference and the measurements with whoever stands alone named.

    Engines that the reference alone contradicts, and that agree with each other, put one without a floor in doubt.
    Results of other programs have no vote: two may be copies of one.
    """
    voters = [m for m in measurements if m.own is None and m.run.engine not in (REFERENCE, ORACLE)]
    against = [m for m in voters if m.run.found_by == "reference"]
    doubt, by_themselves = reference.floor.doubt, dict[int, Measurement]()
    if not doubt:
        pairs = [
            (one, other)
            for one, other in combinations(against, 2)
            if voter(one.run.engine) != voter(other.run.engine) and _agree(reference, one, other)
        ]
        if reference.floor.by_channel or not pairs:
            return reference, measurements
        names = " and ".join(dict.fromkeys(m.run.engine for pair in pairs for m in pair))
        ok = [m.run.engine for m in measurements if m.run.status is Status.ok and m.run.engine != REFERENCE]
        alone = f"{' and '.join(ok)} and the core differ from others" if ok else "the core alone differs"
        votes = len({voter(m.run.engine) for pair in pairs for m in pair})
        count = f"{votes} against {1 + len({*map(voter, ok)})} with no calculation of 50 digits to decide"
        doubt = f"{alone}, {count}, suspect the core: {names} agree with each other"
        by_themselves = {id(m): replace(m, run=_by_itself(m)) for m in against}
    doubted = replace(reference, floor=replace(reference.floor, doubt=doubt))
    return doubted, [
        _doubted(m, doubt) if m.run.engine == REFERENCE else by_themselves.get(id(m), m) for m in measurements
    ]


def _doubted(core: Measurement, doubt: str) -> Measurement:
    """Return the core's own measurement, not ok."""
    status = Status.inaccurate if core.run.status is Status.ok else core.run.status
    return replace(core, run=replace(core.run, status=status, reason=doubt, found_by="reference"))


def _agree(reference: Reference, one: Measurement, other: Measurement) -> bool:
    """Return whether two runs of the same instants are within the sum of their promises of each other."""
    runs = one.run, other.run
    if any(run.motion is None or run.settings is None for run in runs):
        return False
    motions = [run.motion for run in runs if run.motion is not None]
    promises = sum(run.settings.promise for run in runs if run.settings is not None)
    errors = relative_errors(motions[0], motions[1], reference.scale)
    return bool(np.max([error.max() for error in errors.values()]) <= promises)


def _by_itself(measured: Measurement) -> Run:
    """Return the run as its own output lets one judge it."""
    return judged(replace(measured.run, status=Status.ok, reason="", found_by=""), measured.checks)

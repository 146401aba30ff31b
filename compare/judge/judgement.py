"""One scene solved by several engines, each held to its promise."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import combinations
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from scenes import Sampling, Settings, Status

from ..engines import registry
from ..engines.processes.stopping import kept
from ..engines.registry import ORACLE, REFERENCE, voter
from ..engines.runner import HERE, Run, Runs
from ..mechanics.reference import Reference
from ..mechanics.round_off import MAX_EXCUSED, Explained
from ..mechanics.scales import relative_errors
from .agreement import Judgement
from .errors import worst_of
from .measure import Measurement, Standard, escalated
from .plausibility import remarks
from .verdict import doubted_core, judged, share

if TYPE_CHECKING:
    from ..results.result import Result

Offers: TypeAlias = Callable[[str], tuple[Sequence[Settings], str]]  # of an engine: settings to try, and why these


def judgement(
    reference: Reference,
    engines: Sequence[str],
    sampling: Sampling,
    offers: Offers,
    progress: Callable[[str], None],
    runs: Runs = HERE,
    results: Sequence["Result"] = (),
) -> Judgement:
    """Run every engine at the settings chosen for it, and at others if these fail; a stop leaves what is done.

    Results of other programs come after the engines; `progress` is called with what is being done.
    """
    scene, standard = reference.scene, Standard.of(reference, sampling)
    reasons = [*remarks(reference, sampling)]

    def main_runs() -> Iterator[Measurement]:
        for engine in engines:
            progress(f"running {engine}")
            attempt = partial(standard.measure, engine, runs=runs)
            if registry.ENTRIES[engine].missing:
                yield attempt()
                continue
            offered, why = offers(engine)
            measured, tried = escalated(attempt, offered)
            reasons.extend(filter(None, (why, tried)))
            reasons.extend(beyond(measured, standard.explained))
            yield measured
        for result in results:
            from .foreign import assess_result  # late, as what few runs need

            progress(f"comparing {result.run.engine}")
            reasons.extend(result.notes)
            assessed = assess_result(reference, result)
            reasons.extend(coarse(assessed))
            yield assessed

    reference, measurements = _voted(reference, list(kept(main_runs())))
    return Judgement(scene, sampling, reference, standard.explained, measurements, reasons)


def _voted(reference: Reference, measurements: list[Measurement]) -> tuple[Reference, list[Measurement]]:
    """The reference, in doubt where engines that it alone contradicts agree with each other, and the measurements."""
    # Results of other programs have no vote: two may be copies of one.
    voters = [m for m in measurements if not m.foreign and m.run.engine not in (REFERENCE, ORACLE)]
    against = [m for m in voters if m.run.found_by == "reference"]
    if reference.rough_sketch:  # which another assembly may be the sketch's fault
        against = [m for m in against if m.run.status is not Status.wrong_branch]
    doubt, by_themselves = reference.floor.doubt, dict[int, Measurement]()
    if not doubt:
        # A vote without 50 digits: two engines that share no method and agree within the sum of their promises, while
        # both contradict the core, put it in doubt. One alone does not.
        pairs = [
            (first, second)
            for first, second in combinations(against, 2)
            if voter(first.run.engine) != voter(second.run.engine) and _agree(reference, first.run, second.run)
        ]
        if reference.floor.by_channel or not pairs:
            return reference, measurements
        names = " and ".join(dict.fromkeys(m.run.engine for pair in pairs for m in pair))
        ok = [m.run.engine for m in measurements if m.run.status is Status.ok and m.run.engine != REFERENCE]
        alone = f"{' and '.join(ok)} and the core differ from others" if ok else "the core alone differs"
        votes = len({voter(m.run.engine) for pair in pairs for m in pair})
        count = f"{votes} against {1 + len({*map(voter, ok)})} with no calculation of 50 digits to decide"
        doubt = f"{alone}, {count}, suspect the core: {names} agree with each other"
        for m in against:  # as their own output lets one judge them
            ok_run = replace(m.run, status=Status.ok, reason="", found_by="")
            by_themselves[id(m)] = replace(m, run=judged(ok_run, m.checks))
    doubted = replace(reference, floor=replace(reference.floor, doubt=doubt))
    return doubted, [
        replace(m, run=doubted_core(m.run, doubt)) if m.run.engine == REFERENCE else by_themselves.get(id(m), m)
        for m in measurements
    ]


def _agree(reference: Reference, first: Run, second: Run) -> bool:
    """Whether two runs of the same instants are within the sum of their promises of each other."""
    if first.motion is None or second.motion is None or first.settings is None or second.settings is None:
        return False
    errors = relative_errors(reference.scene.channels, first.motion, second.motion, reference.scale)
    return bool(np.max([*map(np.max, errors.values())]) <= first.settings.promise + second.settings.promise)


def beyond(measured: Measurement, explained: Explained) -> Iterator[str]:
    """Yield a sentence on an engine that is ok, and further off than its settings promise: what round-off leaves there.

    What it leaves of the reference itself is part of the verdict, see `floor`.
    """
    run = measured.run
    if run.status is not Status.ok or run.settings is None or run.engine == REFERENCE:
        return
    too_far = [
        row
        for row in measured.errors
        if row.channel in explained.sensitivity and row.commanded_max > run.settings.promise
    ]
    if too_far:
        row = worst_of(too_far, "commanded_max")
        error = f"{row.channel} is off by {share(row.commanded_max)} where {run.settings.promise:g} is promised"
        yield f"{run.engine}: {error}: round-off explains up to {share(row.explained)}, {explained.why(row.channel)}"


def coarse(measured: Measurement) -> Iterator[str]:
    """Yield a sentence where decimals excuse more than an ok result promises, or would excuse more than they may."""
    run, errors = measured.run, [row for row in measured.errors if row.group != "drive"]  # which is an input
    if not errors or run.settings is None:
        return
    ok = run.status is Status.ok
    worst = worst_of(errors, "explained" if ok else "unexplained")
    if ok and worst.explained > run.settings.promise:
        doubt = f"may be off by {share(worst.explained)} unnoticed"
        yield f"{run.engine}: {worst.channel} {doubt}, by its decimals or next to a singular configuration"
    elif not ok and worst.explained >= MAX_EXCUSED:
        why = "its decimals are of more than the 1 % that they may excuse"
        yield f"{run.engine}: {worst.channel} is written too coarsely: {why}"

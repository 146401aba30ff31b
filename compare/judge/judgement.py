"""One scene solved by several engines, each held to its promise, and the reference to its own."""

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
from ..engines.runner import HERE, Runs
from ..mechanics.reference import Reference
from ..mechanics.round_off import explain
from ..mechanics.scales import relative_errors
from .agreement import Judgement
from .foreign import assess_result, coarse
from .measure import Measurement, escalated, measure
from .notes import notes, warnings
from .verdict import doubted_core, judged

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
    scene, explained = reference.scene, explain(reference, sampling)
    sketched = [*warnings(reference)]
    reasons = [*notes(scene), *sketched]

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
    return Judgement(scene, sampling, reference, explained, measurements, reasons)


def _voted(reference: Reference, measurements: list[Measurement]) -> tuple[Reference, list[Measurement]]:
    """The reference and the measurements with whoever stands alone named.

    Engines that the reference alone contradicts, and that agree with each other, put one without a floor in doubt.
    Results of other programs have no vote: two may be copies of one.
    """
    voters = [m for m in measurements if not m.foreign and m.run.engine not in (REFERENCE, ORACLE)]
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
        for m in against:  # as their own output lets one judge them
            own = replace(m.run, status=Status.ok, reason="", found_by="")
            by_themselves[id(m)] = replace(m, run=judged(own, m.checks))
    doubted = replace(reference, floor=replace(reference.floor, doubt=doubt))
    return doubted, [
        replace(m, run=doubted_core(m.run, doubt)) if m.run.engine == REFERENCE else by_themselves.get(id(m), m)
        for m in measurements
    ]


def _agree(reference: Reference, one: Measurement, other: Measurement) -> bool:
    """Whether two runs of the same instants are within the sum of their promises of each other."""
    first, second = one.run, other.run
    if first.motion is None or second.motion is None or first.settings is None or second.settings is None:
        return False
    errors = relative_errors(first.motion, second.motion, reference.scale)
    promises = first.settings.promise + second.settings.promise
    return bool(np.max([error.max() for error in errors.values()]) <= promises)

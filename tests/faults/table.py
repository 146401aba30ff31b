"""The faults of what engines return, judged: a record each."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import TypeAlias

from compare.engines.processes.inside import Ended, Limits
from compare.engines.processes.isolation import isolated
from compare.engines.runner import Run, run
from compare.judge.causes.cause import UNKNOWN
from compare.judge.causes.words import words
from compare.judge.measure import Measurement, Standard, assess, missed
from compare.judge.triage import cause
from compare.mechanics.reference import uncertified
from scenes import InputError, Motion, Sampling, Status, load

from .catalogue import catalogue
from .fault import Clean, Fault, above

SAMPLING = Sampling(72)
ENGINES = ("exudyn", "pymunk")  # whose answers are spoilt; each fault is one's
LIMITS = Limits(seconds=3600.0)

Item: TypeAlias = tuple[str, str]  # scene and engine


@dataclass(frozen=True)
class Record:
    """One fault, whether it was found, and what was named as its cause."""

    family: str
    kind: str
    magnitude: float
    scene: str
    engine: str
    above: bool  # whether it moves a channel by more than its limit
    found: bool
    by: str  # who found it, and how the run ended
    place: str  # a body, joint or point, `drive`, `all`, or where a line is; as `true_place`
    cause: str  # a word of `Kind`, as `true_cause`
    true_place: str
    true_cause: str
    detail: str  # the sentence of the cause, or the line of code


def answer_faults(scenes: Sequence[str], poll: Callable[[], None]) -> Iterator[Record]:
    """Yield the faults of the engines' answers on some scenes, judged.

    Raises:
        InputError: a clean run is not ok, so that nothing can be learnt from spoiling it.
    """
    for (scene, engine), records in isolated(judged_faults, [*product(scenes, ENGINES)], LIMITS, poll):
        if isinstance(records, Ended):
            raise InputError(f"--scenes: {scene} by {engine}: {records.reason}")
        yield from records


def judged_faults(item: Item, every: int = len(ENGINES)) -> list[Record]:
    """Return every so many faults of an engine's run on a scene, judged.

    Raises:
        Failure: the reference cannot solve the scene.
        InputError: the clean run is not ok.
    """
    name, engine = item
    reference = uncertified(load(name))
    standard = Standard.of(reference, SAMPLING)
    whole = standard.measure(engine)
    if whole.run.status is not Status.ok:
        raise InputError(f"its clean run is not ok: {whole.run.reason}")
    clean = Clean(reference, SAMPLING, whole.run)
    records = []
    for fault in [*catalogue(clean)][ENGINES.index(engine) % every :: every]:
        outcome = _outcome(fault, whole.run)
        if outcome.motion is not None:  # else the engine itself refuses the scene, and there is nothing to judge
            judged = assess(standard, outcome)
            records.append(_record(fault, clean, outcome.motion, judged))
    return records


def _outcome(fault: Fault, clean: Run) -> Run:
    """Return the run with the fault in it."""
    if fault.scene is not None:
        return run(clean.engine, fault.scene, SAMPLING, clean.settings)
    assert fault.spoil is not None
    return replace(clean, motion=fault.spoil())


def _record(fault: Fault, clean: Clean, motion: Motion, judged: Measurement) -> Record:
    named = UNKNOWN if judged.run.status is Status.ok else cause(clean.reference, SAMPLING, motion)
    causes = [(str(one.kind), one.place) for one in (named, *named.others)]
    true = str(fault.cause), fault.place
    kind, place = true if true in causes else causes[0]  # of several that explain it as well
    return Record(
        *(fault.family, fault.kind, fault.magnitude, clean.scene.name, clean.run.engine),
        above(fault, clean, motion),
        bool(missed([judged], [])),
        f"{judged.run.found_by}: {judged.run.status.name}",
        *(place, kind, *reversed(true), words(clean.scene, named)),
    )

"""The likely cause of a disagreement, in one sentence: the simplest that explains nearly all of it, or none."""

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from scenes import Failure, Motion, Rows, Status

from ..engines.reference import Reference
from ..engines.registry import REFERENCE
from .causes.course import course_causes, noisy, starting
from .causes.drive import drive_causes, strayed
from .causes.evidence import EXACT, NEARLY_ALL, Evidence, Hypothesis, Kind, away_from_switches, evidence
from .causes.force import Carried, weight_causes
from .causes.geometry import affordable, geometry_causes
from .causes.load import late_loads, load_causes
from .causes.read_out import read_out_causes
from .causes.sample import in_some_rows, incomplete, sample_causes
from .causes.whole import whole_causes
from .errors import worst_of
from .measure import Measurement

ROUNDING = 1e-11  # relative, a sample
FEWEST = 4  # rows, of which a course can be judged
STILL = 1e-3  # of the deviation: with less in the kinematic channels, no body is elsewhere
PLURAL = re.compile(r"^(all [\w ]+s) (has its|has|is) ")
VERBS = {"has its": "have their ", "has": "have ", "is": "are "}
FAR_LESS = 0.1  # of an error: others that have less do not share its cause
ALIKE, ROUGHLY = 1.1, 1e-3  # times, and of the deviation: causes that leave no more are told apart by nothing
PRICE = 0.25  # of what is left over, for each number that was fitted


@dataclass(frozen=True)
class Cause:
    """What is likely wrong, where, and by how much."""

    kind: Kind
    place: str  # a body, joint, channel, "drive" or "all"; empty where unknown
    amount: str
    sentence: str
    others: tuple[tuple[Kind, str], ...] = ()  # kinds and places of causes that explain it as well, which it names too

    @property
    def known(self) -> bool:
        """Whether there is one."""
        return self.kind is not Kind.unknown


UNKNOWN = Cause(Kind.unknown, "", "", "the cause is unknown")


def cause(reference: Reference, sampling: Rows, motion: Motion) -> Cause:
    """Return the likely cause of the distance of a motion from what it should be.

    Args:
        reference: of the scene.
        sampling: what was asked for.
        motion: what an engine returned.
    """
    if len(motion["time"]) < FEWEST:
        return UNKNOWN
    if found := incomplete(reference, sampling, motion):
        kind, place, sentence = found
        return Cause(kind, place, "", sentence)
    try:
        return likeliest(evidence(reference, sampling, motion))
    except Failure:  # there is no reference at one of its rows
        return UNKNOWN


def ranked(evidence: Evidence) -> list[tuple[float, float, Hypothesis]]:
    """Return causes with their price and what they leave over, the best first; no costly ones if a plain one holds."""
    found: list[tuple[float, float, Hypothesis]] = []
    elsewhere = away_from_switches(evidence)
    few = affordable(elsewhere)
    stages = (
        *((_plain, evidence, False), (course_causes, evidence, False), (_of_forces, elsewhere, False)),
        *((_of_late_loads, evidence, False), (_of_some_rows, evidence, True), (_of_motion, few, True)),
    )
    for causes, of, costly in stages:
        if found and found[0][1] <= EXACT and (costly or not found[0][2].freedom):
            break
        for hypothesis in causes(of):
            left = of.left(hypothesis.predicted)
            found.append((max(left, EXACT) * (1 + PRICE * hypothesis.freedom), left, hypothesis))
        found.sort(key=lambda one: one[:2])
    return found


def _plain(evidence: Evidence) -> Iterator[Hypothesis]:
    yield from sample_causes(evidence)
    yield from read_out_causes(evidence)
    yield from whole_causes(evidence)


def _of_some_rows(evidence: Evidence) -> Iterator[Hypothesis]:
    yield from in_some_rows(evidence, read_out_causes)


def _of_late_loads(evidence: Evidence) -> Iterator[Hypothesis]:
    if _of_forces_alone(evidence):
        yield from late_loads(evidence, Carried(evidence))


def _of_forces(evidence: Evidence) -> Iterator[Hypothesis]:
    if _of_forces_alone(evidence):
        carried = Carried(evidence)
        yield from weight_causes(evidence, carried)
        yield from load_causes(evidence, carried)


def _of_forces_alone(evidence: Evidence) -> bool:
    return evidence.reference.scene.has_masses and evidence.total > 0 and evidence.moved <= NEARLY_ALL


def _of_motion(evidence: Evidence) -> Iterator[Hypothesis]:
    moves = evidence.total > 0 and (evidence.moved > STILL or evidence.blind)
    if moves:
        yield from drive_causes(evidence)
    if moves or evidence.reference.scene.springs:
        yield from geometry_causes(evidence)


def likeliest(evidence: Evidence) -> Cause:
    """Return the cheapest cause that explains nearly all; where none does, noise, or a drive that is not in its place.

    Others that explain as much at the same price are named with it. What it leaves over is in its sentence. A deviation
    of rounding has no cause.
    """
    if not evidence.total > len(evidence.rows) * ROUNDING**2:
        return UNKNOWN
    causes = ranked(evidence)
    if not (causes and causes[0][0] <= NEARLY_ALL):
        best = noisy(evidence) or starting(evidence) or strayed(evidence)
        return Cause(best.kind, best.place, best.amount, _in_plural(best.sentence)) if best else UNKNOWN
    price, left, best = causes[0]
    close = [one for cost, own, one in causes if cost <= ALIKE * price and own <= ALIKE * left + ROUGHLY]
    alike = {(one.kind, one.place): one for one in reversed(close) if (one.kind, one.place) != (best.kind, best.place)}
    but_for = f" (all but {100 * left:.0f} % of the error)" if left > EXACT else ""
    named = ", or ".join(_in_plural(one.sentence) for one in (best, *alike.values()))
    return Cause(best.kind, best.place, best.amount, named + but_for, tuple(alike))


def _in_plural(sentence: str) -> str:
    """Return a sentence whose verb fits what it is of: `all forces have`, but `rod's force has`."""
    plural = PLURAL.sub(lambda found: f"{found[1]} {VERBS[found[2]]}", sentence)
    return plural.replace("what it should be", "what they should be") if plural != sentence else sentence


def sentence(engine: str, found: Cause, others_agree: bool) -> str:
    """Return the line for a reader: `exudyn: rod's mass is 12 % too large, the others agree`."""
    return f"{engine}: {found.sentence}{', the others agree' * others_agree}"


def sentences(
    reference: Reference, sampling: Rows, measurements: Sequence[Measurement], off: Collection[str] = ()
) -> dict[str, str]:
    """Return a line for each engine whose cause is known; where the core is in doubt, for it alone.

    Engines that are ok, or returned no motion, have none.

    Args:
        reference: of the scene, after all engines have been heard.
        sampling: what was asked of the engines.
        measurements: one an engine, or a result of another program.
        off: engines that are ok and miss a tolerance.
    """
    if doubt := reference.floor.doubt:
        return {REFERENCE: f"{REFERENCE}: {doubt}"}
    failed = [m for m in measurements if m.run.status is not Status.ok or m.run.engine in off]
    alone = len(failed) == 1 and len(measurements) > 2 and _alone(failed[0], measurements)
    causes = {
        m.run.engine: _too_coarse(m) or cause(reference, m.own or sampling, m.run.motion)
        for m in failed
        if m.run.motion is not None
    }
    return {engine: sentence(engine, found, alone) for engine, found in causes.items() if found.known}


def _alone(failed: Measurement, measurements: Sequence[Measurement]) -> bool:
    """Return whether all others are far nearer to the reference in the channel in which one is off the most."""
    others = [m for m in measurements if m is not failed and m.run.engine != REFERENCE]
    if not failed.errors:
        return False
    worst = worst_of(failed.errors)
    found = [[row.max for row in m.errors if row.channel == worst.channel] for m in others]
    return all(own and max(own) <= FAR_LESS * worst.max for own in found)


def _too_coarse(measured: Measurement) -> Cause | None:
    """Return that the settings are the cause, where others of the engine leave hardly any of the error."""
    what = f"its settings are too coarse: of its error {measured.finer}"
    return Cause(Kind.solver, "all", measured.finer, what) if measured.finer else None

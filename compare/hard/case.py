"""One engine on one rung of a hard ladder: every attempt, what is wrong with it, and who noticed.

A run with status ok is wrong if it is off by more than its engine promises and round-off explains. A failure is a false
alarm if what was computed is within that, or if bodies that can be assembled end as `cannot_assemble`.
"""

from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from scenes import Failure, InputError, Sampling, Scene, Settings, Status, hard
from scenes.motion import quantity

from ..engines import registry
from ..engines.reference import Reference, found
from ..engines.registry import ORACLE, REFERENCE
from ..engines.settings import tiers
from ..judge.errors import SHOWN_GROUPS
from ..judge.escalation import attempts
from ..judge.gates import gates
from ..judge.measure import Measurement, checked_run, measure
from ..judge.round_off import Explained, explain
from .digits import digits_lost

SAMPLES, FEW, ORACLE_SAMPLES = 360, 36, 72  # a cycle; few where there are many cycles


class Outcome(StrEnum):
    """How an attempt is judged."""

    right = "right"  # ok, and within the promise
    refused = "refused"  # failed by the engine or by a check without a reference, and wrong; or nothing is to be solved
    false_alarm = "false alarm"  # failed, and within the promise
    silent = "silent"  # ok by the engine and by all checks without a reference, and wrong by the reference alone
    uncertified = "not certified"  # the reference, where arbitrary precision had no answer


@dataclass(frozen=True)
class Case:
    """What is examined at a time."""

    ladder: str
    rung: str
    engine: str

    def __str__(self) -> str:
        """Name it, as it is kept."""
        return f"{self.ladder}, {self.rung}: {self.engine}"


Row = dict[str, Any]


def examine(case: Case) -> list[Row]:
    """Return one row an attempt of the engine; of the reference one, measured by arbitrary precision."""
    ladder = hard.ladder(case.ladder)
    rung = next(rung for rung in ladder.rungs if rung.label == case.rung)
    try:
        scene = rung.scene()
    except InputError as error:
        return [_invalid(case, error, rung.status)]
    samples = ORACLE_SAMPLES if case.engine == REFERENCE else SAMPLES if rung.turns == 1 else FEW
    sampling = Sampling(samples, rung.turns)
    try:
        reference = found(scene)
        explained = explain(reference, sampling)
    except InputError as error:
        return [_invalid(case, error, rung.status)]
    except Failure as failure:
        return [_nothing_to_solve(case, scene, sampling, failure, rung.status)]
    if case.engine == REFERENCE:
        row = _certified(case, reference, sampling, explained, rung.status)
        return [_counted(row, scene) if ladder.digits and row["outcome"] == Outcome.right else row]
    scene = _promised(scene, case.engine)

    def judged(settings: Settings) -> Measurement:
        return _held_to_its_promise(scene, measure(reference, case.engine, sampling, settings, explained))

    made = attempts(judged, case.engine, tiers(case.engine)["balanced"])
    return [_attempted(case, scene, reference, measured, explained) for measured in made]


def _invalid(case: Case, error: InputError, expected: str) -> Row:
    outcome = Outcome.refused if expected == hard.INVALID else Outcome.false_alarm
    return case_row(case, hard.INVALID, str(error), "reader", outcome)


def _promised(scene: Scene, engine: str) -> Scene:
    """Return the scene with what the engine promises for its tolerances."""
    return replace(scene, tolerances={engine: dict.fromkeys(SHOWN_GROUPS, registry.ENTRIES[engine].promise)})


def _held_to_its_promise(scene: Scene, measured: Measurement) -> Measurement:
    """Return the measurement, its status corrected where it breaks its promise, by itself or by the reference."""
    run = measured.run
    missed = [str(gate) for gate in gates(scene, [measured]) if gate.missed]
    if run.status is not Status.ok or not missed:
        return measured
    estimate, promise = measured.estimate, registry.ENTRIES[run.engine].promise
    found_by, reason = "reference", f"off the reference: {missed[0]}"
    if not estimate <= promise:
        found_by, reason = "checks", f"off by {estimate:.1e}, by its own poses; it promises {promise:g}"
    return replace(measured, run=replace(run, status=Status.not_converged, reason=reason, found_by=found_by))


def _attempted(case: Case, scene: Scene, reference: Reference, measured: Measurement, explained: Explained) -> Row:
    run = measured.run
    if run.status is Status.ok:
        outcome = Outcome.right
    elif run.found_by == "reference":
        outcome = Outcome.silent
    else:
        as_if_ok = replace(measured, run=replace(run, status=Status.ok))
        kept = len(measured.errors) > 0 and not any(gate.missed for gate in gates(scene, [as_if_ok]))
        denied = run.status is Status.cannot_assemble and explained.decidable
        outcome = Outcome.false_alarm if kept or denied else Outcome.refused
    setting = run.settings.label if run.settings else ""
    attempt = {"setting": setting, "seconds": run.seconds}
    row = case_row(case, run.status.name, run.reason, run.found_by, outcome) | attempt
    return row | _figures(measured, reference, explained)


def _figures(measured: Measurement, reference: Reference, explained: Explained) -> Row:
    """Return condition, distance to lock and errors by group."""
    row: Row = {"condition": float(explained.condition.max())}
    if measured.run.motion is not None and measured.comparison is not None:
        motion = reference.at(measured.comparison.position, measured.run.motion["time"])
        locks = [float(motion[channel].min()) for channel in motion.samples if quantity(channel) == "to_lock"]
        row["to_lock_m"] = min(locks, default=None)
    if len(measured.errors):
        by_group = measured.errors.groupby("group")[["max", "explained", "unexplained"]].max(skipna=False)
        for group, worst in by_group.iterrows():
            row |= {f"{group}_{figure}": float(value) for figure, value in worst.items()}
    return row


def _certified(case: Case, reference: Reference, sampling: Sampling, explained: Explained, expected: str) -> Row:
    """Return the row of the reference itself, which arbitrary precision knows better."""
    measured = measure(reference, ORACLE, sampling, explained=explained)
    scene = _promised(reference.scene, ORACLE)
    missed = [str(gate) for gate in gates(scene, [measured]) if gate.missed]
    outcome = Outcome.right
    if expected != Status.ok.name:
        outcome, missed = Outcome.silent, [f"expected {expected}"]
    elif measured.run.status is not Status.ok:
        outcome = Outcome.uncertified
    elif missed:
        outcome = Outcome.silent
    row = case_row(case, Status.ok.name, "; ".join(missed), "", outcome)
    row["setting"] = f"against {registry.ENTRIES[ORACLE].distribution}"
    return row | _figures(measured, reference, explained)


def _counted(row: Row, scene: Scene) -> Row:
    """Return the reference's row with the digits that it loses by group, and those that the condition allows."""
    lost = digits_lost(scene)
    groups = lost.set_index("group")[["lost", "allowed"]].to_dict("index")
    figures = {f"{group}_{name}": value for group, of in groups.items() for name, value in of.items()}
    over = [f"{group} loses {of['lost']:.1f} digits" for group, of in groups.items() if not of["lost"] <= of["allowed"]]
    wrong = {"outcome": str(Outcome.silent), "reason": "; ".join(over)} if over else {}
    return row | figures | wrong


def _nothing_to_solve(case: Case, scene: Scene, sampling: Sampling, failure: Failure, expected: str) -> Row:
    """Return the row of an engine where the reference finds no motion: neither may it, nor the oracle."""
    outcome = checked_run(ORACLE if case.engine == REFERENCE else case.engine, scene, sampling)
    if case.engine == REFERENCE:
        agreed = outcome.status is not Status.ok and expected == failure.status.name
        judged = Outcome.refused if agreed else Outcome.false_alarm
        return case_row(case, failure.status.name, failure.reason, "engine", judged)
    if outcome.status is not Status.ok:
        return case_row(case, outcome.status.name, outcome.reason, outcome.found_by, Outcome.refused)
    reason = f"ok where the reference has no motion: {failure.reason}"
    return case_row(case, failure.status.name, reason, "reference", Outcome.silent)


def case_row(case: Case, status: str, reason: str, found_by: str, outcome: Outcome) -> Row:
    """Return a row without figures."""
    of = {"ladder": case.ladder, "rung": case.rung, "engine": case.engine, "setting": "", "condition": float("nan")}
    return of | {"status": status, "outcome": str(outcome), "found_by": found_by, "reason": reason}

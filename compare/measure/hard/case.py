"""The hard cases: every engine on every rung of every ladder, each in a process of its own, kept as they come.

Each row tells what is wrong with an attempt, and who noticed. A run with status ok is wrong if it is off by more than
its engine promises and round-off explains. A failure is a false alarm if what was computed is within that, or if bodies
that can be assembled end as `cannot_assemble`.
"""

from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum
from functools import partial
from multiprocessing import current_process
from pathlib import Path
from typing import Any, NamedTuple

import pandas as pd

from scenes import Failure, InputError, Sampling, Scene, Status, hard
from scenes.channels import TO_LOCK
from scenes.hard import Ladder
from scenes.model.inputs import passing

from ...engines import registry
from ...engines.kept import Kept
from ...engines.processes.inside import Ended, Limits
from ...engines.processes.isolation import isolated
from ...engines.processes.stopping import Progress
from ...engines.processes.stopping import kept as until_stopped
from ...engines.processes.workers import workers
from ...engines.registry import ORACLE, REFERENCE
from ...engines.runner import HERE, Runs
from ...judge.errors import worst_of
from ...judge.floor import NO_ANSWER
from ...judge.measure import Measurement, Standard, attempts, checked_run, offers
from ...mechanics.reference import Reference, uncertified
from .digits import digits_lost

PARTIAL = "hard.partial.jsonl"
SAMPLES, FEW_SAMPLES, ORACLE_SAMPLES = 360, 36, 72  # a cycle; few where there are many cycles


class Outcome(StrEnum):
    """How an attempt is judged."""

    right = "right"  # ok, and within the promise
    refused = "refused"  # failed by the engine or by a check without a reference, and wrong; or nothing is to be solved
    false_alarm = "false alarm"  # failed, and within the promise
    silent = "silent"  # ok by the engine and by all checks without a reference, and wrong by the reference alone
    uncertified = "not certified"  # the reference, where arbitrary precision had no answer


class Case(NamedTuple):
    """What is examined at a time."""

    ladder: str
    rung: str
    engine: str

    def __str__(self) -> str:
        """Name it, as it is kept."""
        return f"{self.ladder}, {self.rung}: {self.engine}"


Row = dict[str, Any]


def hard_cases(
    ladders: Sequence[str], engines: Sequence[str], folder: Path, progress: Progress, note: Callable[[str], None]
) -> pd.DataFrame:
    """One row an attempt, in the order of the ladders.

    Results are kept in `folder` as they come, and what is kept there is not done again until `forget` is called. A stop
    leaves what is done, there and in what is returned. Where nothing can be kept there, that is noted.
    """
    limits, read = Limits(), {name: hard.ladder(name) for name in ladders}
    wanted = [
        Case(name, rung.label, engine) for name, ladder in read.items() for rung in ladder.rungs for engine in engines
    ]
    kept = Kept(folder / PARTIAL, limits)
    rows = dict(kept.read())
    left = [case for case in wanted if str(case) not in rows]

    def poll() -> None:
        progress(f"hard cases, {len(rows)} of {len(wanted)} done")

    for case, result in until_stopped(isolated(partial(examine, read), left, limits, poll)):
        if isinstance(result, Ended):  # of the reference it is arbitrary precision that gave no answer
            outcome = Outcome.uncertified if case.engine == REFERENCE else Outcome.refused
            result = [case_row(case, result.status.name, result.reason, "isolation", outcome)]
        rows[str(case)] = result
        kept.add(str(case), result)
    if kept.trouble:
        note(kept.trouble)
    return pd.DataFrame([row for case in wanted for row in rows.get(str(case), [])])


def forget(folder: Path) -> None:
    """Drop what is kept: a command that came to its end starts anew the next time."""
    Kept(folder / PARTIAL, "").forget()


def examine(ladders: Mapping[str, Ladder], case: Case) -> list[Row]:
    """One row an attempt of the engine; of the reference one, measured by arbitrary precision.

    The ladders are by name. This process judges, so an engine from outside has one of its own below it.
    """
    if not registry.ENTRIES[case.engine].outside:
        return _examined(ladders[case.ladder], case, HERE)
    current_process().daemon = False  # it may have processes of its own, which end with it
    with workers([case.engine], lambda: None) as runs:
        return _examined(ladders[case.ladder], case, runs)


def _examined(ladder: Ladder, case: Case, runs: Runs) -> list[Row]:
    rung = next(rung for rung in ladder.rungs if rung.label == case.rung)
    samples = FEW_SAMPLES if rung.turns > 1 else ORACLE_SAMPLES if case.engine == REFERENCE else SAMPLES
    sampling = Sampling(samples, rung.turns)
    try:
        scene = rung.scene()
        reference = uncertified(scene)
        standard = Standard.of(reference, sampling)
    except InputError as error:
        outcome = Outcome.refused if rung.status == hard.INVALID else Outcome.false_alarm
        return [case_row(case, hard.INVALID, str(error), "reader", outcome)]
    except Failure as failure:
        return [_nothing_to_solve(case, scene, sampling, failure, rung.status, runs)]
    if case.engine == REFERENCE:
        row = _certified(case, standard, rung.status)
        return [_counted(row, reference) if ladder.file.digits and row["outcome"] == Outcome.right else row]
    attempt = partial(standard.measure, case.engine, runs=runs)
    made = attempts(attempt, offers(case.engine, "balanced"))
    return [_attempted(case, standard, measured) for measured in made]


def _attempted(case: Case, standard: Standard, measured: Measurement) -> Row:
    run = measured.run
    promise, setting = (run.settings.promise, run.settings.label) if run.settings else (0.0, "")
    # An attempt is judged by what it computed, whatever status it ended with: within the promise, after round-off is
    # explained, its failure was a false alarm.
    kept = bool(measured.errors) and worst_of(measured.errors, "unexplained").unexplained <= promise
    denied = run.status is Status.cannot_assemble and standard.explained.decidable
    outcome = Outcome.false_alarm if kept or denied else Outcome.refused
    if run.status is Status.ok:
        outcome = Outcome.right
    elif run.found_by == "reference":
        outcome = Outcome.silent
    row = case_row(case, run.status.name, run.reason, run.found_by, outcome)
    return row | {"setting": setting, "seconds": run.seconds} | _figures(measured, standard)


def _figures(measured: Measurement, standard: Standard) -> Row:
    reference, explained = standard.reference, standard.explained
    row: Row = {"condition": float(explained.condition.max())}
    if measured.run.motion is not None and measured.comparison is not None:
        place, time = measured.comparison.position, measured.run.motion["time"]
        motion = reference.at(passing(reference.scene, place, time))
        channels = reference.scene.channels
        locks = [float(values.min()) for name, values in motion.samples.items() if channels[name].quantity == TO_LOCK]
        row["to_lock_m"] = min(locks, default=None)
    worst = {figure: measured.worst(figure) for figure in ("max", "explained", "unexplained")}
    return row | {f"{group}_{figure}": sizes[group] for group in worst["max"] for figure, sizes in worst.items()}


def _certified(case: Case, standard: Standard, expected: str) -> Row:
    """The row of the reference itself, which arbitrary precision knows better."""
    measured = standard.measure(ORACLE)
    run = measured.run
    outcome, missed = (Outcome.right, "") if run.status is Status.ok else (Outcome.silent, run.reason)
    if expected != Status.ok.name:
        outcome, missed = Outcome.silent, f"expected {expected}"
    elif run.status in NO_ANSWER:
        outcome, missed = Outcome.uncertified, ""
    row = case_row(case, Status.ok.name, missed, "", outcome)
    setting = {"setting": f"against {registry.ENTRIES[ORACLE].distribution}"}
    return row | setting | _figures(measured, standard)


def _counted(row: Row, reference: Reference) -> Row:
    """The reference's row with the digits that it loses by group, and those that the condition allows."""
    groups = digits_lost(reference)
    figures = {f"{group}_{name}": value for group, lost in groups.items() for name, value in lost.items()}
    beyond = [
        f"{group} loses {lost['lost']:.1f} digits"
        for group, lost in groups.items()
        if not lost["lost"] <= lost["allowed"]
    ]
    wrong = {"outcome": str(Outcome.silent), "reason": "; ".join(beyond)} if beyond else {}
    return row | figures | wrong


def _nothing_to_solve(case: Case, scene: Scene, sampling: Sampling, failure: Failure, expected: str, runs: Runs) -> Row:
    """The row of an engine where the reference finds no motion: neither may it, nor the oracle."""
    run = checked_run(ORACLE if case.engine == REFERENCE else case.engine, scene, sampling, runs=runs)
    if case.engine == REFERENCE:
        agreed = run.status is not Status.ok and expected == failure.status.name
        outcome = Outcome.refused if agreed else Outcome.false_alarm
        return case_row(case, failure.status.name, failure.reason, "engine", outcome)
    if run.status is not Status.ok:
        return case_row(case, run.status.name, run.reason, run.found_by, Outcome.refused)
    reason = f"ok where the reference has no motion: {failure.reason}"
    return case_row(case, failure.status.name, reason, "reference", Outcome.silent)


def case_row(case: Case, status: str, reason: str, found_by: str, outcome: Outcome) -> Row:
    """A row without figures."""
    known = {**case._asdict(), "setting": "", "condition": float("nan")}
    return known | {"status": status, "outcome": str(outcome), "found_by": found_by, "reason": reason}

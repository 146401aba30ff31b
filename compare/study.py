"""One scene through the whole comparison."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import TYPE_CHECKING, Self

from scenes import Motion, Sampling, Scene, Settings

from .engines import registry
from .engines.processes.workers import workers
from .engines.registry import ORACLE, REFERENCE, Accuracy, settings_of, tiers
from .engines.threads import one_thread
from .judge.agreement import Judgement
from .judge.errors import group_floors
from .judge.floor import establish
from .judge.judgement import judgement
from .judge.measure import offers, promising
from .measure.speed import work_precision
from .measure.speed.speed_table import NO_CLOCK, Budget, speed_table
from .measure.speed.work_precision import SpeedRow

if TYPE_CHECKING:
    from pandas import DataFrame

    from .results.result import Result


@dataclass(frozen=True)
class Study(Judgement):
    """Everything that is reported about one scene."""

    motion: Motion  # the reference's, as commanded
    speed: Sequence[SpeedRow]  # one a setting
    cheapest: Sequence[work_precision.Choice]  # setting for every error
    orders: Sequence[work_precision.Order]  # of convergence, of every family
    step_costs: Sequence[work_precision.StepCost]  # of every family
    maps: "DataFrame | None" = None  # of stability, one row a cell
    hard: "DataFrame | None" = None  # one row an attempt at a hard case

    @classmethod
    def of(cls, judged: Judgement, speed: Sequence[SpeedRow] = ()) -> Self:
        """A judgement with the reference's motion, what was measured of settings, and what follows from that."""
        motion = judged.reference.at(judged.sampling.inputs(judged.scene))
        known = {field.name: getattr(judged, field.name) for field in fields(Judgement)}
        return cls(
            **known,
            motion=motion,
            speed=speed,
            cheapest=[*work_precision.choices(speed)],
            orders=[*work_precision.orders(speed, group_floors(judged.reference))],
            step_costs=[*work_precision.step_costs(speed)],
        )


def judged(scene: Scene, engines: Sequence[str], sampling: Sampling, accuracy: Accuracy = "balanced") -> Study:
    """Solve a scene by every engine named, measure, gate, and check the comparison; nothing is timed or written."""
    from .judge.canaries.canaries import canaries  # late: no report needs it

    with one_thread():
        judged = study(scene, engines, sampling, NO_CLOCK, lambda _: None, accuracy)
        judged.let_through.extend(canaries(judged))
    return judged


def study(
    scene: Scene,
    engines: Sequence[str],
    sampling: Sampling,
    budget: Budget,
    progress: Callable[[str], None],
    accuracy: Accuracy = "balanced",
    results: Sequence["Result"] = (),
) -> Study:
    """Solve a scene by every engine named, measure, gate, and time; results of other programs are judged beside them.

    A stop leaves what is done. Where the accuracy is a number, the settings that the engines offer are measured before
    one of them is chosen; without a clock they are measured for that alone. InputError is raised where the reference
    cannot solve the scene.
    """
    doing = "solving and certifying the reference"

    def report(now: str) -> None:
        nonlocal doing
        doing = now
        progress(doing)

    report(doing)
    able = [engine for engine in engines if not registry.ENTRIES[engine].missing]
    for name in (REFERENCE, *able):  # core, settings and motion laws: what all processes have a part of
        registry.engine(name)
    _ = scene.pace
    with workers([*engines, ORACLE], lambda: progress(doing)) as runs:
        reference = establish(scene, sampling.channels, runs)

        def judged_by(speed: Sequence[SpeedRow]) -> Judgement:
            return judgement(reference, engines, sampling, partial(_offers, accuracy, speed), report, runs, results)

        first = judged_by(()) if isinstance(accuracy, str) else None  # so that a stop leaves the main runs
        if first and budget == NO_CLOCK:
            return Study.of(first)
        if not first:  # an accuracy is chosen by no clock
            budget = replace(budget, share=1.0)
        main = first.measurements if first and not budget.full else ()
        speed = speed_table(reference, able, budget, report, sampling.channels, runs, main)
        judged = first or judged_by(speed)
    names = [*engines, *(result.run.engine for result in results)]
    judged.reasons.extend(_left_out(names, len(judged.measurements), able, len(speed), full=budget.full))
    return Study.of(judged, speed)


def _offers(accuracy: Accuracy, speed: Sequence[SpeedRow], engine: str) -> tuple[Sequence[Settings], str]:
    """What to try of an engine, and why: by the name of its settings, or by the errors and times of a speed table."""
    if isinstance(accuracy, str):
        settings, why = offers(engine, accuracy), ""
    else:
        cheapest = work_precision.within(engine, accuracy, speed)
        settings = promising(accuracy, (*cheapest, *[*tiers(engine).values()][::-1]))
        level = f"measured to be within {accuracy:g} in every group"
        why = f"{engine}: no setting was {level}; run at its most accurate one"
        if cheapest:
            why = f"{engine}: {settings[0].label} is the cheapest {level}"
    first = settings[0]
    note = f"{engine}, {first.label}: {first.note}" if first.note else ""
    return settings, "; ".join(filter(None, (why, note)))


def _left_out(names: Sequence[str], done: int, able: Sequence[str], measured: int, *, full: bool) -> Iterator[str]:
    """Yield what is not there because the user stopped: runs beyond those done, settings beyond those measured."""
    if left := names[done:]:
        yield f"stopped before running {', '.join(left)}"
    settings = sum(len(settings_of(engine, full=full)) for engine in able)
    if measured < settings:
        yield f"stopped when {measured} of {settings} settings had been measured, and none timed"

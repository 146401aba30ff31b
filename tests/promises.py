"""Whether verdicts keep their word: runs called ok within what was promised, and no run refused that is."""

from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import partial
from typing import Any
from unittest.mock import patch

import analytic
import compare
from compare import study
from compare.engines.registry import TIERS, Accuracy
from compare.engines.runner import HERE, Run
from compare.judge import judgement
from compare.judge.measure import checked_run, measure
from compare.mechanics.reference import uncertified
from scenes import Failure, InputError, Sampling, Scene
from scenes.elements import PLAIN_KINDS
from scenes.scene import MotionLaw

from . import agreement
from .true_errors import DRIVE, Truth, by_absolute

ENGINES = ("analytic", "exudyn", "pymunk")
NUMBERS = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6)
ACCURACIES: tuple[Accuracy, ...] = (*TIERS, *NUMBERS)
INSTANTS = 12  # a cycle, at which absolute coordinates hold the core: a few milliseconds each


@dataclass(frozen=True)
class PromiseRecord:
    """One verdict beside the truth."""

    scene: str
    features: str
    engine: str
    accuracy: str
    samples: int
    setting: str
    status: str
    found_by: str
    reason: str
    promise: float
    error: float  # the largest but for the drive, relative; NaN where there is no motion
    of: str  # the vector that is furthest off
    drive: float
    drive_promise: float
    fate: str = ""  # what friction does at some instants: `jammed`, `undetermined` or both

    @property
    def within(self) -> bool:
        return self.error <= self.promise and self.drive <= self.drive_promise

    @property
    def broken(self) -> bool:
        """Whether a run was called ok and is off by more than promised.

        The core says besides whether other forces fit; the engines are held to those that friction from none leads to.
        """
        overlooked = self.engine == "analytic" and "undetermined" in self.fate
        return self.status == "ok" and (overlooked or not self.within)

    @property
    def false_alarm(self) -> bool:
        """Whether the comparison refused a run that is within its promise."""
        if self.status in ("jammed", "undetermined"):
            return self.status not in self.fate
        return self.status != "ok" and self.found_by in ("checks", "reference") and self.within


def records(
    scene: Scene, wanted: dict[int, tuple[Accuracy, ...]], engines: Sequence[str] = ENGINES
) -> Iterator[PromiseRecord]:
    """Yield the verdicts of every engine on a scene, by samples a cycle and accuracy, beside the truth."""
    truth = Truth(scene)
    core = 0.0 if scene.friction or truth.is_remainder else core_error(scene)
    with _shared():
        for samples, accuracies in wanted.items():
            for accuracy in accuracies:
                for run in _judged(scene, engines, samples, accuracy):
                    off = core if run.engine == "analytic" else 0.0
                    yield record(truth, run, Sampling(samples), f"{accuracy}", off)


def judged_runs(scene: Scene, engines: Iterable[str], sampling: Sampling) -> list[Run]:
    """Return the runs of engines at their default settings, judged by themselves where friction leaves no reference."""
    try:
        reference = uncertified(scene)
    except Failure:
        assert scene.friction
        return [checked_run(engine, scene, sampling) for engine in engines]
    return [measure(reference, engine, sampling).run for engine in engines]


def _judged(scene: Scene, engines: Sequence[str], samples: int, accuracy: Accuracy) -> list[Run]:
    try:
        return [m.run for m in compare.check(scene, engines, samples, accuracy=accuracy).measurements]
    except InputError:
        return judged_runs(scene, engines, Sampling(samples))


def record(truth: Truth, run: Run, sampling: Sampling, accuracy: str = "balanced", least: float = 0.0) -> PromiseRecord:
    """Return the verdict on a run beside the truth; `least` is how far it is known to be off, relative."""
    scene, settings, worst = truth.scene, run.settings, {DRIVE: float("nan"), "": float("nan")}
    fate = truth.fates(sampling)
    assert settings is not None
    if run.motion is not None and "jammed" not in fate:
        worst = {name: float(error.max()) for name, error in truth.errors(run.motion, sampling).items()}
    drive = worst.pop(DRIVE)
    of = max(worst, key=lambda name: worst[name] if worst[name] >= 0 else float("inf"))
    return PromiseRecord(
        *(scene.name, " ".join(features(scene)), run.engine, accuracy, sampling.samples, settings.label),
        *(run.status.name, run.found_by, run.reason, settings.promise),
        *(max(worst[of], least), of, drive, settings.drive_promise),
        fate,
    )


def core_error(scene: Scene) -> float:
    """Return how far the core is off absolute coordinates, by the scales of `agreement`."""
    time = Sampling(INSTANTS).times(scene)
    motion = analytic.solve(scene, scene.drive.law.at(time).position, time)
    lightest = min((body.mass for body in scene.bodies.values() if body.mass), default=0.0)
    expected = by_absolute(scene, time)
    return max(float(error.max()) for error in agreement.errors(motion, expected, mass=lightest).values())


def features(scene: Scene) -> Iterator[str]:
    """Yield what a scene has that makes it harder than a crank at a constant speed."""
    yield "crank" if scene.drive.slide is None else "slider"
    if isinstance(scene.drive.law, MotionLaw):
        yield "periodic-law" if scene.periodic else "law-once"
    for kind, name in (("press forces", "press"), ("force tables", "table")):
        if any(load.kind == kind for load in scene.loads):
            yield name
    if scene.springs:
        yield "spring"
    yield from (kind.replace(" ", "-") for kind in sorted(scene.kinds - PLAIN_KINDS))
    if not all(body.mass for body in scene.bodies.values()):
        yield "massless"


@contextmanager
def _shared() -> Iterator[None]:
    """Let the judgements of one scene share its reference, what round-off explains, the speed table and equal runs."""
    run, explain = HERE.run, vars(judgement)["explain"]
    establish, speed_table = vars(study)["establish"], vars(study)["speed_table"]
    kept: dict[Hashable, Any] = {}

    def once(real: Callable[..., Any], key: Hashable, *arguments: Any) -> Any:
        if (real, key) not in kept:
            kept[real, key] = real(*arguments)
        return kept[real, key]

    def equal_runs(engine: str, scene: Scene, sampling: Sampling, settings: Any = None) -> Run:
        ran: Run = once(run, (engine, getattr(settings, "label", None), sampling), engine, scene, sampling, settings)
        return ran if settings is None else replace(ran, settings=settings)  # of another promise

    with (
        patch.object(HERE, "run", equal_runs),
        patch.object(judgement, "explain", lambda reference, sampling: once(explain, sampling, reference, sampling)),
        patch.object(study, "establish", partial(once, establish, None)),
        patch.object(study, "speed_table", partial(once, speed_table, None)),
        patch.object(study, "workers", lambda *_: nullcontext(HERE)),
    ):
        yield

"""Stand-ins for tests of speed against error: a clock, an engine whose errors and times are known, and its table."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from itertools import repeat
from math import inf, nan
from typing import Any

from compare.judge.agreement import Judgement
from compare.measure.speed.speed_table import Budget
from compare.measure.speed.work_precision import SpeedRow
from compare.mechanics.reference import Reference
from compare.mechanics.round_off import explain
from compare.study import Study
from scenes import Failure, Motion, Sampling, Scene, Settings, Status
from scenes.elements import PLAIN_KINDS

STEPS = (72, 144, 360, 720, 1440, 7200)
FULL = Budget(10, inf, full=True, point_s=inf)


BLANK: dict[str, Any] = {name.name: nan if "float" in str(name.type) else "" for name in fields(SpeedRow)}
SOLVED: dict[str, Any] = {
    "role": "work-precision",
    "status": "ok",
    "errors": {},
    "counters": {},
    "expected_order": None,
}
ROW = SpeedRow(**(BLANK | SOLVED))  # a setting that solved a scene, of which nothing else is known


class Clock:
    """A clock that goes only as far as the jobs under it take it, and a tick whenever one looks at it."""

    def __init__(self, tick: float = 0.0) -> None:
        self.now, self.tick = 0.0, tick

    def __call__(self) -> float:
        self.now += self.tick
        return self.now


def quiet(_: str) -> None:
    return


def table(*rows: tuple[str, str, float, float], **columns: Any) -> list[SpeedRow]:
    """Return a speed table of engine, setting, seconds and largest reaction error; lists have a value for each row."""
    found = []
    for number, (engine, setting, seconds, error) in enumerate(rows):
        own = {name: value[number] if isinstance(value, list) else value for name, value in columns.items()}
        known = replace(ROW, engine=engine, setting=setting, solve_min_s=seconds, errors={"reaction_max": error})
        found.append(replace(known, **own))
    return found


def family(steps: Sequence[int], errors: Sequence[float], order: float = 2.0) -> list[SpeedRow]:
    rows = [("a", f"{n} steps", 1e-3 + 1e-5 * n, error) for n, error in zip(steps, errors, strict=True)]
    return table(*rows, family="f", expected_order=order, steps=list(steps), steps_made=list(steps))


def rows_of(speed: Sequence[SpeedRow]) -> dict[str, dict[str, Any]]:
    return {row.setting: row.cells for row in speed}


def study_of(reference: Reference, speed: Sequence[SpeedRow]) -> Study:
    sampling = Sampling(72)
    return Study.of(Judgement(reference.scene, sampling, reference, explain(reference, sampling), [], []), speed)


@dataclass(frozen=True)
class StubSettings(Settings):
    steps: int = 72


def second_order(steps: int, note: str = "") -> StubSettings:
    return StubSettings(f"{steps} steps{note and ', noted'}", steps, family=f"second{note}", order=2, note=note)


class StubEngine:
    """An engine of second order, a millisecond a step, that is off in one component of one joint."""

    WORK_PRECISION: tuple[Settings, ...] = tuple(map(second_order, (72, 100, 360)))
    LONG_WORK_PRECISION: tuple[Settings, ...] = (second_order(3600),)
    FAST, DEFAULT, EXACT = WORK_PRECISION[0], second_order(720), LONG_WORK_PRECISION[0]
    ABLATIONS: tuple[Settings, ...] = (StubSettings("in space", 720),)
    KINDS = PLAIN_KINDS

    def __init__(self, reference: Reference, clock: Clock) -> None:
        self.reference, self.clock = reference, clock
        self.slowness: Iterator[float] = repeat(1.0)

    def version(self) -> str:
        return "stub 1"

    def build(self, scene: Scene, settings: StubSettings, sampling: Sampling) -> "StubRun":  # noqa: ARG002
        return StubRun(self, settings, sampling)


@dataclass
class StubRun:
    engine: StubEngine
    settings: StubSettings
    sampling: Sampling
    residuals: Mapping[str, float] = field(default_factory=dict)

    @property
    def steps(self) -> int:
        return self.sampling.samples * -(-self.settings.steps // self.sampling.samples)

    @property
    def counters(self) -> Mapping[str, int]:
        return {"steps": self.steps, "bodies": 10 if self.settings.label == "in space" else 5}

    def solve(self) -> None:
        if self.settings.label == "fails":
            raise Failure(Status.diverged, "it ran away")
        slowness = next(self.engine.slowness) * (3 if self.settings.label == "in space" else 1)
        self.engine.clock.now += slowness * 1e-3 * self.steps

    def read(self) -> Motion:
        reference = self.engine.reference
        scene = reference.scene
        exact = reference.at(self.sampling.inputs(scene))
        off = exact["P3.fx"] + reference.scale["P3.fx"] * self.steps**-2.0
        return Motion(dict(exact.samples) | {"P3.fx": off})

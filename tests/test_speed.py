"""Speed against error: what the clock does, and what is read from its table, on times and errors known beforehand."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain, repeat
from math import inf, nan
from typing import Any

import numpy as np
import pandas as pd
import pytest

import scenes
from compare import registry
from compare.asked import TIERS
from compare.explained import explain
from compare.reference import Reference, establish
from compare.report import page
from compare.speed import tables as speed_tables
from compare.speed.choice import cheapest_within, offered
from compare.speed.figure import work_precision as picture
from compare.speed.ladders import speed_table
from compare.speed.timing import Budget, take_turns
from compare.speed.work_precision import above_floor, cheapest, choices, front, orders, solved, step_costs
from compare.study import Study, study
from scenes import Failure, Motion, Sampling, Scene, Settings, Status

# --- the clock --------------------------------------------------------------------------------------------------------


class Clock:
    """A clock that goes only as far as the jobs under it take it, and a tick whenever one looks at it."""

    def __init__(self, tick: float = 0.0) -> None:
        self.now, self.tick = 0.0, tick
        self.turns = ""

    def __call__(self) -> float:
        self.now += self.tick
        return self.now


@dataclass
class Job:
    """A simulation, and what builds it, that takes the given times to solve, then the last one again and again."""

    clock: Clock
    name: str
    solves: Sequence[float]
    build: float = 0.0
    reading: float = 0.0
    done: int = 0
    counters: Mapping[str, int] = field(default_factory=dict)
    residuals: Mapping[str, float] = field(default_factory=dict)

    def __call__(self) -> "Job":
        self.clock.now += self.build
        return self

    def solve(self) -> None:
        self.clock.turns += self.name
        self.clock.now += self.solves[min(self.done, len(self.solves) - 1)]
        self.done += 1

    def read(self) -> Motion:
        self.clock.now += self.reading
        return Motion({})


def quiet(_: str) -> None:
    return


def test_settings_take_turns() -> None:
    clock = Clock()
    take_turns([Job(clock, name, [1.0]) for name in "abc"], Budget(10, inf), quiet, clock, clock)
    assert clock.turns == "abcabcabc"


def test_build_solve_and_read_are_timed_apart() -> None:
    clock = Clock()
    (times,) = take_turns([Job(clock, "a", [2.0], build=1.0, reading=4.0)], Budget(10, inf), quiet, clock, clock)
    assert (times.build, times.solve, times.read) == ([1.0] * 3, [2.0] * 3, [4.0] * 3)


def test_rounds_go_on_until_the_fastest_time_is_known() -> None:
    """`a` is known after 3 rounds and drops out; of `b` the three fastest agree after 6."""
    clock = Clock()
    jobs = [Job(clock, "a", [1.0]), Job(clock, "b", [3.0, 1.0, 2.0, 1.01, 5.0, 1.019, 1.0])]
    times = take_turns(jobs, Budget(100, inf), quiet, clock, clock)
    assert [len(of.solve) for of in times] == [3, 6]
    assert clock.turns == "abababbbb"


def test_a_lucky_time_has_to_come_again() -> None:
    clock = Clock()
    (times,) = take_turns([Job(clock, "a", [1.0, 0.5, 1.0])], Budget(8, inf), quiet, clock, clock)
    assert len(times.solve) == 8


@pytest.mark.parametrize(("budget", "runs"), [(Budget(0, 0.0), 3), (Budget(99, 7.0), 4), (Budget(5, inf), 5)])
def test_what_a_budget_ends(budget: Budget, runs: int) -> None:
    """Solves of 1, 2, 3 ... seconds are never known; three of them are taken in any case."""
    clock = Clock()
    (times,) = take_turns([Job(clock, "a", [float(n) for n in range(1, 99)])], budget, quiet, clock, clock)
    assert len(times.solve) == runs


# --- what a table says ------------------------------------------------------------------------------------------------


def table(*rows: tuple[str, str, float, float], **columns: Any) -> pd.DataFrame:
    """Return a speed table of engine, setting, seconds and largest reaction error."""
    known = pd.DataFrame(rows, columns=["engine", "setting", "solve_min_s", "reaction_max"])
    rest: dict[str, Any] = {"note": "", "role": "ladder", "status": "ok", "family": "", "expected_order": nan} | columns
    return known.assign(**rest)


def test_cheapest() -> None:
    points = table(
        ("a", "coarse", 1.0, 1e-1), ("a", "fine", 3.0, 1e-3), ("b", "fine", 2.0, 1e-3), ("b", "odd", 0.1, nan)
    )
    found = {level: cheapest(points, "reaction_max", level) for level in (1.0, 1e-1, 1e-2, 1e-3, 1e-4)}
    named = {level: None if row is None else (row["engine"], row["setting"]) for level, row in found.items()}
    fine, coarse = ("b", "fine"), ("a", "coarse")
    assert named == {1.0: coarse, 1e-1: coarse, 1e-2: fine, 1e-3: fine, 1e-4: None}


def test_of_settings_as_fast_the_most_accurate_is_cheapest() -> None:
    for first, second in ((1.0, 1.09), (1.09, 1.0)):  # as two runs might find them
        points = table(("a", "rough", first, 1e-3), ("b", "good", second, 1e-6))
        best = cheapest(points, "reaction_max", 1e-2)
        assert best is not None
        assert best["setting"] == "good"
    best = cheapest(table(("a", "rough", 1.0, 1e-3), ("b", "good", 1.2, 1e-6)), "reaction_max", 1e-2)
    assert best is not None
    assert best["setting"] == "rough"


def test_front() -> None:
    points = table(
        ("a", "1", 1.0, 1e-1),
        ("a", "2", 2.0, 1e-2),
        ("a", "beaten", 3.0, 5e-2),
        ("b", "3", 4.0, 1e-5),
        ("b", "as fast", 4.2, 1e-6),  # as fast as `3`, and better
        ("b", "noted", 0.5, 1e-9),
    )
    points.loc[5, "note"] = "for show"
    assert front(points, "reaction_max")["setting"].tolist() == ["1", "2", "as fast"]


def test_whatever_is_cheapest_for_an_error_is_on_the_front() -> None:
    random = np.random.default_rng(1)
    for _ in range(20):
        rows = [("a", str(n), *values) for n, values in enumerate(np.exp(random.normal(0, [0.3, 5], (30, 2))))]
        points = table(*rows)
        best = front(points, "reaction_max")
        assert best["reaction_max"].is_monotonic_decreasing
        for level in np.exp(random.normal(0, 5, 30)):
            row = cheapest(points, "reaction_max", level)
            assert row is None or row["setting"] in set(best["setting"])


def test_settings_with_a_note_compete_apart() -> None:
    points = table(
        ("a", "own", 2.0, 1e-4), ("a", "newcomer", 1.0, 1e-4), ("b", "own", 8.0, 1e-9), ("b", "failed", 0.1, 1e-9)
    )
    points.loc[1, "note"] = "the engine's defaults"
    points.loc[3, "status"] = "diverged"
    found = {(row["level"], row["engine"], row["note"]): row for row in choices(points).to_dict("records")}
    assert found["0.1 %", "a", ""]["ratio"] == 1
    assert found["0.1 %", "a", "the engine's defaults"]["ratio"] == 0.5
    assert found["0.1 %", "b", ""]["ratio"] == 4
    assert found["1e-6", "a", ""]["setting"] == ""
    assert found["1e-6", "b", ""]["setting"] == "own"
    assert found["1e-6", "b", ""]["ratio"] == 1


def family(steps: Sequence[int], errors: Sequence[float], order: float = 2.0) -> pd.DataFrame:
    rows = [("a", f"{n} steps", 1e-3 + 1e-5 * n, error) for n, error in zip(steps, errors, strict=True)]
    return table(*rows, family="f", expected_order=order, steps=list(steps), steps_made=list(steps))


def order_of(points: pd.DataFrame, floor: float = 0.0) -> tuple[float, float, int]:
    (row,) = orders(points, {"reaction": floor}).to_dict("records")
    return row["order"], row["residual"], row["points"]


STEPS = (72, 144, 360, 720, 1440, 7200)


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_orders(order: int) -> None:
    found, residual, points = order_of(family(STEPS, [3.0 * n**-order for n in STEPS]))
    assert found == pytest.approx(order, abs=1e-12)
    assert residual <= 1e-12
    assert points == len(STEPS)


def test_the_residual_of_an_order() -> None:
    """Errors 0.04 decades above a line, twice that below it, and as much above it again."""
    errors = np.array([1e-4, 1e-4 / 4, 1e-4 / 16]) * 10 ** np.array([0.04, -0.08, 0.04])
    found, residual, points = order_of(family((100, 200, 400), errors))
    assert found == pytest.approx(2, abs=1e-12)
    assert residual == pytest.approx(0.04 * np.sqrt(2), rel=1e-9)
    assert points == 3


def test_too_coarse_settings_are_left_out() -> None:
    """An error of second order, less one of fourth order that counts at 72 steps: 29 % there, 7 % at 144."""
    found, residual, points = order_of(family(STEPS, [n**-2.0 - 1500 * n**-4.0 for n in STEPS]))
    assert points == len(STEPS) - 1
    assert found == pytest.approx(2, abs=0.02)
    assert residual <= 0.02


@pytest.mark.parametrize(("floor", "of_reference"), [(1e-8, 0.0), (1e-8, 1e-8), (0.0, 1e-7)])
def test_orders_are_fitted_above_the_floor(floor: float, of_reference: float) -> None:
    """A floor of the family's own, which shows in its errors, or the reference's."""
    steps = (72, 144, 360, 720, 1440, 7200, 14400)
    found, _, points = order_of(family(steps, [n**-2.0 + floor for n in steps]), of_reference)
    assert points < len(steps)
    assert found == pytest.approx(2, abs=0.02)


def test_growing_round_off_is_below_the_floor() -> None:
    errors = [n**-4.0 + 3e-13 * n for n in STEPS]  # least at 360, and more than ten times that at 7200
    assert above_floor(np.array(STEPS, float), np.array(errors), 0.0) == 2
    assert np.isnan(order_of(family(STEPS, errors))[0]), "of two points there is no residual"


def test_what_a_step_costs() -> None:
    (row,) = step_costs(family(STEPS, [1.0] * len(STEPS))).to_dict("records")
    assert row["fixed_s"] == pytest.approx(1e-3)
    assert row["step_s"] == pytest.approx(1e-5)
    assert row["residual"] <= 1e-12
    assert step_costs(family(STEPS[:2], [1.0] * 2)).empty


# --- a table of an engine whose errors and times are known ------------------------------------------------------------


@dataclass(frozen=True)
class StubSettings(Settings):
    steps: int = 72


def _second_order(steps: int, note: str = "") -> StubSettings:
    return StubSettings(f"{steps} steps{note and ', noted'}", steps, family=f"second{note}", order=2, note=note)


class StubEngine:
    """An engine of second order, a millisecond a step, that is off in one component of one joint."""

    LADDER: tuple[Settings, ...] = tuple(map(_second_order, (72, 100, 360)))
    LONG_LADDER: tuple[Settings, ...] = (_second_order(3600),)
    FAST, DEFAULT, EXACT = LADDER[0], _second_order(720), LONG_LADDER[0]
    ABLATIONS: tuple[Settings, ...] = (StubSettings("in space", 720),)

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
        self.engine.clock.now += (
            next(self.engine.slowness) * 1e-3 * self.steps * (3 if self.settings.label == "in space" else 1)
        )

    def read(self) -> Motion:
        reference = self.engine.reference
        scene = replace(reference.scene, asked=None)
        exact = reference.at(self.sampling.commanded(scene), self.sampling.times(scene))
        off = exact["P3.fx"] + reference.scale["P3.fx"] * self.steps**-2.0
        return Motion(dict(exact.samples) | {"P3.fx": off})


@pytest.fixture(scope="module")
def reference() -> Reference:
    return establish(scenes.load("toggle_press"))


@pytest.fixture
def stub(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> StubEngine:
    """Return an engine named `stub`, the only one there is besides the analytic core, under a clock of its own."""
    clock, real = Clock(tick=1e-9), registry.engine
    engine = StubEngine(reference, clock)
    monkeypatch.setitem(registry.ENTRIES, "stub", registry.Entry("a stub", "", "numpy", "numpy", "", 1e-3))
    monkeypatch.setattr(registry, "engine", lambda name: engine if name == "stub" else real(name))
    monkeypatch.setattr("compare.runner.perf_counter", clock)
    monkeypatch.setattr("compare.speed.ladders.take_turns", partial(take_turns, clock=clock, wall=clock))
    return engine


def rows_of(speed: pd.DataFrame) -> dict[str, dict[str, object]]:
    return {str(row["setting"]): {str(k): v for k, v in row.items()} for row in speed.to_dict("records")}


FULL = Budget(10, inf, long_ladders=True, point_s=inf)


@pytest.mark.usefixtures("stub")
def test_a_table(reference: Reference) -> None:
    rows = rows_of(speed_table(reference, ["stub"], Budget(10, inf), quiet))
    assert list(rows) == ["72 steps", "100 steps", "360 steps"]
    assert rows["100 steps"]["steps"] == 144  # rounded up to a multiple of the samples, as engines do
    assert rows["100 steps"]["reaction_max"] == pytest.approx(144**-2.0, rel=1e-9)
    assert rows["100 steps"]["solve_min_s"] == pytest.approx(0.144)
    assert rows["100 steps"]["timed_runs"] == 3
    assert [row["tier"] for row in rows.values()] == ["fast", "", ""]


def test_the_fastest_solve_is_the_headline(reference: Reference, stub: StubEngine) -> None:
    """Three error runs, then three rounds over three settings, each of another speed."""
    stub.slowness = chain([9.0] * 3, [1.5] * 3, [2.0] * 3, repeat(1.0))
    row = rows_of(speed_table(reference, ["stub"], Budget(0, 0.0, point_s=inf), quiet))["100 steps"]
    found = [row[f"solve_{of}_s"] for of in ("min", "median", "spread", "wall")]
    assert found == pytest.approx([0.144, 0.216, 0.144, 0.144])


@pytest.mark.usefixtures("stub")
def test_orders_and_costs_of_a_table(reference: Reference) -> None:
    speed = speed_table(reference, ["stub"], FULL, quiet)
    (row,) = orders(speed, {}).query("group == 'reaction'").to_dict("records")
    assert row["order"] == pytest.approx(2, abs=1e-6)
    assert row["points"] == 5
    (row,) = step_costs(speed).to_dict("records")
    assert row["step_s"] == pytest.approx(1e-3)
    assert row["fixed_s"] == pytest.approx(0, abs=1e-9)


@pytest.mark.usefixtures("stub")
def test_ablations_are_compared_with_the_default_and_nothing_else(reference: Reference) -> None:
    speed = speed_table(reference, ["stub"], FULL, quiet)
    default, ablation = speed_tables.ablations(study_of(reference, speed)).to_dict("records")
    assert (default["setting"], default["bodies"], default["ratio"]) == ("720 steps", "5", 1)
    assert (ablation["setting"], ablation["bodies"]) == ("in space", "10")
    assert ablation["ratio"] == pytest.approx(3)
    assert "in space" not in set(solved(speed)["setting"])
    assert "in space" not in rows_of(speed_table(reference, ["stub"], Budget(1, 0.0), quiet))


@pytest.mark.usefixtures("stub")
def test_a_failed_setting_stays(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(StubEngine, "LADDER", (StubSettings("fails"), *StubEngine.LADDER))
    speed = speed_table(reference, ["stub"], Budget(10, inf), quiet)
    row = rows_of(speed)["fails"]
    assert (row["status"], row["reason"], row["timed_runs"]) == ("diverged", "it ran away", 0)
    assert np.isnan(float(str(row["solve_min_s"])))
    assert "fails" not in set(choices(speed)["setting"])


@pytest.mark.usefixtures("stub")
def test_no_setting_eats_the_budget(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    """With 0.3 s for one setting the 360 steps are not repeated, and the 720 and 3600 of their family are not run."""
    noted = _second_order(3600, note="of another family")
    monkeypatch.setattr(StubEngine, "LADDER", (*StubEngine.LADDER, noted))
    rows = rows_of(speed_table(reference, ["stub"], replace(FULL, point_s=0.3), quiet))
    assert {name: row["timed_runs"] for name, row in rows.items() if row["status"] == "ok"} == {
        "72 steps": 3, "100 steps": 3, "360 steps": 0, noted.label: 0, "in space": 0,
    }  # fmt: skip
    assert rows["360 steps"]["solve_min_s"] == pytest.approx(0.36)
    for name in ("720 steps", "3600 steps"):
        assert rows[name]["status"] == "timed_out"
        assert "360 steps a cycle took longer than 0.3 s" in str(rows[name]["reason"])


# --- the settings of the main run -------------------------------------------------------------------------------------


@pytest.mark.parametrize("tier", TIERS)
def test_an_accuracy_by_name(stub: StubEngine, tier: str) -> None:
    settings, why = offered("stub", tier)
    assert settings is {"fast": stub.FAST, "balanced": stub.DEFAULT, "exact": stub.EXACT}[tier]
    assert why == ""


def test_a_note_is_told(stub: StubEngine, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(StubEngine, "EXACT", _second_order(72, note="for show"))
    speed = table(("stub", "72 steps", 1.0, 1e-3))
    for settings, why in (offered("stub", "exact"), cheapest_within("stub", 1e-9, speed)):
        assert settings is stub.EXACT
        assert why.endswith("stub, 72 steps, noted: for show")


@pytest.mark.usefixtures("stub")
@pytest.mark.parametrize(
    ("level", "label", "said"),
    [
        (1e-2, "100 steps", "100 steps is the cheapest measured to be within 0.01"),
        (1e-5, "360 steps", "within 1e-05"),
        (1e-9, "3600 steps", "no setting was measured to be within 1e-09"),
    ],
)
def test_an_accuracy_by_number(reference: Reference, level: float, label: str, said: str) -> None:
    speed = speed_table(reference, ["stub", "analytic"], Budget(1, 0.0), quiet)
    speed.loc[speed["setting"] == "72 steps", "torque_max"] = nan  # what has no error in a group does not meet it
    settings, why = cheapest_within("stub", level, speed)
    assert settings.label == label
    assert said in why


@pytest.mark.usefixtures("stub")
def test_what_has_a_note_is_not_chosen(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(StubEngine, "LADDER", (_second_order(72, note="for show"), *StubEngine.LADDER))
    speed = speed_table(reference, ["stub"], Budget(1, 0.0), quiet)
    assert cheapest_within("stub", 1e-2, speed)[0] is StubEngine.LADDER[1]


def test_the_main_run_takes_what_was_chosen(reference: Reference, stub: StubEngine) -> None:
    result = study(reference.scene, ["stub", "analytic"], Sampling(360), Budget(1, 0.0), quiet, 1e-5)
    assert [m.run.settings and m.run.settings.label for m in result.measurements] == ["360 steps", "vector equations"]
    assert any("360 steps is the cheapest" in reason for reason in result.reasons)
    result = study(reference.scene, ["stub"], Sampling(360), Budget(1, 0.0), quiet)
    assert result.measurements[0].run.settings is stub.DEFAULT
    assert result.reasons == []


# --- what is shown ----------------------------------------------------------------------------------------------------


def study_of(reference: Reference, speed: pd.DataFrame) -> Study:
    sampling = Sampling(72)
    motion = reference.at(sampling.commanded(reference.scene), sampling.times(reference.scene))
    return Study(reference.scene, sampling, reference, explain(reference, sampling), motion, [], [], speed, [])


def test_the_sentence(reference: Reference) -> None:
    speed = table(
        ("analytic", "equations", 1e-3, 1e-15), ("exudyn", "pointwise", 7e-3, 1e-8), ("pymunk", "x", 5e-3, 0.1)
    )
    said = speed_tables.verdict(study_of(reference, speed))
    assert said == (
        "Cheapest setting that gives reactions to 0.1 %: analytic, equations, 1 ms a turn;"
        " besides the reference: exudyn, pointwise, 7 ms a turn."
    )
    said = speed_tables.verdict(study_of(reference, speed.iloc[1:]))
    assert said == "Cheapest setting that gives reactions to 0.1 %: exudyn, pointwise, 7 ms a turn."
    assert "none that was tried" in speed_tables.verdict(study_of(reference, speed.iloc[2:]))


def test_tables_of_text(reference: Reference) -> None:
    points = family(STEPS, [n**-2.0 for n in STEPS])
    result = study_of(reference, pd.concat([points, table(("b", "noted", 1.0, 1e-3), note="slow, and so on")]))
    found = speed_tables.cheapest_settings(result)
    own, noted = found["reaction"].to_dict("records")
    assert list(own.values()) == [
        "a", *["72 steps, 1.72 ms (×1)"] * 3, "144 steps, 2.44 ms (×1)", "1440 steps, 15.4 ms (×1)", "–",
    ]  # fmt: skip
    assert list(own) == ["engine", "10 %", "1 %", "0.1 %", "1e-4", "1e-6", "1e-8"]
    assert list(noted.values()) == ["b: slow", *["noted, 1e+03 ms (×581)"] * 3, "–", "–", "–"]
    (row,) = speed_tables.orders(result).to_dict("records")
    assert row == {"engine": "a", "family": "f", "expected": "2", "reaction": row["reaction"]}
    assert row["reaction"].startswith("2.00 (")


def test_where_nothing_was_timed(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = replace(registry.ENTRIES["pymunk"], package="no_such_package")
    monkeypatch.setitem(registry.ENTRIES, "pymunk", missing)
    result = study(reference.scene, ["pymunk"], Sampling(72), Budget(1, 0.0), quiet, 1e-4)
    assert len(picture(result).data) == 0
    assert speed_tables.verdict(result) == ""
    assert "pip install" in page(result)


@pytest.mark.usefixtures("stub")
def test_the_picture(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    noted, failing = _second_order(144, note="for show, only"), StubSettings("fails")
    monkeypatch.setattr(StubEngine, "LADDER", (*StubEngine.LADDER, noted, failing))
    result = study(reference.scene, ["analytic", "stub"], Sampling(72), Budget(1, 0.0), quiet)
    figure = picture(result)
    reactions = [(number, trace) for number, trace in enumerate(figure.data) if trace.xaxis == "x4"]
    drawn = {trace.name: trace for _, trace in reactions}
    assert [*drawn["stub"].x] == pytest.approx([72, 144, 360])
    assert [*drawn["stub"].y] == pytest.approx([72**-2.0, 144**-2.0, 360**-2.0])
    assert drawn["stub: for show"].marker.symbol != drawn["stub"].marker.symbol
    assert "for show, only" in drawn["stub: for show"].text[0]
    assert "360 steps a cycle" in drawn["stub"].text[2]
    assert drawn["reference's floor"].y[0] == max(
        floor for channel, floor in reference.floor.by_channel.items() if channel.endswith(("fx", "fy", "guide_force"))
    )
    steps = drawn["Pareto front without the reference"]
    assert steps.line.shape == "hv"
    assert [*steps.x] == pytest.approx([72, 72, 144, 360, 360])
    largest, rms = (button.args[0]["y"] for button in figure.layout.updatemenus[0].buttons)
    own = next(number for number, trace in reactions if trace.name == "stub")
    assert largest[own] == pytest.approx([*drawn["stub"].y])
    assert rms[own] == pytest.approx(
        result.speed.query("engine == 'stub' and status == 'ok' and note == ''")["reaction_rms"]
    )
    assert len(largest) == len(rms) == len(figure.data)

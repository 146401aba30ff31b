"""Speed against error: the table of an engine whose errors and times are known, what is chosen by it, and shown."""

from dataclasses import replace
from itertools import chain, count, repeat
from math import inf, nan

import numpy as np
import pytest

import scenes
from compare.engines import registry
from compare.engines.registry import TIERS
from compare.measure.speed.speed_table import Budget, speed_table
from compare.measure.speed.work_precision import choices, orders, solved, step_costs
from compare.mechanics.reference import Reference
from compare.report.figures.offline import offline
from compare.report.figures.speed import work_precision as picture
from compare.report.pages.report import page
from compare.report.tables import speed as speed_tables
from compare.study import _offers, study
from scenes import Failure, Sampling, Status

from .stubs import (
    FULL,
    STEPS,
    StubEngine,
    StubRun,
    StubSettings,
    family,
    quiet,
    rows_of,
    second_order,
    study_of,
    table,
)


@pytest.mark.usefixtures("stub")
def test_a_table(reference: Reference) -> None:
    """And the orders and costs of one."""
    rows = rows_of(speed_table(reference, ["stub"], Budget(10, inf), quiet))
    assert list(rows) == ["72 steps", "100 steps", "360 steps"]
    assert rows["100 steps"]["steps"] == 144  # rounded up to a multiple of the samples, as engines do
    assert rows["100 steps"]["reaction_max"] == pytest.approx(144**-2.0, rel=1e-9)
    assert rows["100 steps"]["solve_min_s"] == pytest.approx(0.144)
    assert rows["100 steps"]["timed_runs"] == 3
    assert [row["tier"] for row in rows.values()] == ["fast", "", ""]
    speed = speed_table(reference, ["stub"], FULL, quiet)
    (row,) = (row for row in orders(speed, {}) if row.group == "reaction")
    assert row.points == 5
    assert row.order == pytest.approx(2, abs=1e-6)
    (cost,) = step_costs(speed)
    assert [cost.step_s, cost.fixed_s] == pytest.approx([1e-3, 0], abs=1e-9)


def test_a_clock_that_stands_still_divides_nothing_by_zero(reference: Reference, stub: StubEngine) -> None:
    """As Python's own does between its ticks, under a limit of processor time."""
    stub.slowness, stub.clock.tick = repeat(0.0), 0.0
    speed = speed_table(reference, ["stub"], FULL, quiet)
    assert {row.solve_min_s for row in speed} == {row.solve_wall_s for row in speed} == {1e-6}
    assert {choice.ratio for choice in choices(speed) if choice.setting} == {1.0}


def test_the_fastest_solve_is_the_headline(reference: Reference, stub: StubEngine) -> None:
    """Three error runs, then three rounds over three settings, each of another speed."""
    stub.slowness = chain([9.0] * 3, [1.5] * 3, [2.0] * 3, repeat(1.0))
    stub.LONG_WORK_PRECISION, stub.ABLATIONS = (), ()
    stub.FAST = stub.EXACT = stub.WORK_PRECISION[0]
    stub.DEFAULT = second_order(72)
    row = rows_of(speed_table(reference, ["stub"], Budget(0, inf, full=True, point_s=inf), quiet))["100 steps"]
    found = [row[f"solve_{of}_s"] for of in ("min", "median", "spread", "wall")]
    assert found == pytest.approx([0.144, 0.216, 0.144, 0.144])


@pytest.mark.usefixtures("stub")
def test_ablations_are_compared_with_the_default_and_nothing_else(reference: Reference) -> None:
    speed = speed_table(reference, ["stub"], FULL, quiet)
    default, ablation = speed_tables.ablations(study_of(reference, speed))
    assert (default["setting"], default["bodies"], default["ratio"]) == ("720 steps", 5, 1)
    assert (ablation["setting"], ablation["bodies"]) == ("in space", 10)
    assert ablation["ratio"] == pytest.approx(3)
    assert "in space" not in {row.setting for row in solved(speed)}
    assert "in space" not in rows_of(speed_table(reference, ["stub"], Budget(1, 0.0), quiet))


@pytest.mark.usefixtures("stub")
def test_a_failed_setting_stays(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(StubEngine, "WORK_PRECISION", (StubSettings("fails"), *StubEngine.WORK_PRECISION))
    speed = speed_table(reference, ["stub"], Budget(10, inf), quiet)
    row = rows_of(speed)["fails"]
    assert (row["status"], row["reason"], row["timed_runs"]) == ("diverged", "it ran away", 0)
    assert np.isnan(row["solve_min_s"])
    assert "fails" not in {choice.setting for choice in choices(speed)}


def test_a_setting_that_fails_under_the_clock_keeps_the_times_of_its_error_run(
    reference: Reference, stub: StubEngine, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The second of three, in the second round, after it was twice as fast in the first."""
    stub.slowness, runs, solve = chain([1.0] * 3, repeat(0.5)), count(), StubRun.solve

    def failing(run: StubRun) -> None:
        solve(run)
        if next(runs) == 7:
            raise Failure(Status.diverged, "")

    monkeypatch.setattr(StubRun, "solve", failing)
    rows = rows_of(speed_table(reference, ["stub"], Budget(10, inf), quiet)).values()
    assert [row["timed_runs"] for row in rows] == [3, 0, 3]
    assert [row["solve_min_s"] for row in rows] == pytest.approx([0.036, 0.144, 0.18])


@pytest.mark.usefixtures("stub")
def test_no_setting_eats_the_budget(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    """With 0.3 s for one setting the 360 steps are not repeated, and the 720 and 3600 of their family are not run."""
    noted = second_order(3600, note="of another family")
    monkeypatch.setattr(StubEngine, "WORK_PRECISION", (*StubEngine.WORK_PRECISION, noted))
    rows = rows_of(speed_table(reference, ["stub"], replace(FULL, point_s=0.3), quiet))
    assert {name: row["timed_runs"] for name, row in rows.items() if row["status"] == "ok"} == {
        "72 steps": 3, "100 steps": 3, "360 steps": 0, noted.label: 0, "in space": 0,
    }  # fmt: skip
    assert rows["360 steps"]["solve_min_s"] == pytest.approx(0.36)
    for name in ("720 steps", "3600 steps"):
        assert rows[name]["status"] == "timed_out"
        assert "360 steps per cycle took longer than 0.3 s" in str(rows[name]["reason"])


def test_an_accuracy_by_name(stub: StubEngine, monkeypatch: pytest.MonkeyPatch) -> None:
    """A note goes with its settings."""
    for tier, own in zip(TIERS, (stub.FAST, stub.DEFAULT, stub.EXACT), strict=True):
        (settings, *_), why = _offers(tier, table(), "stub")
        assert (settings, why) == (own, "")
    monkeypatch.setattr(StubEngine, "EXACT", second_order(72, note="for show"))
    speed = table(("stub", "72 steps", 1.0, 1e-3))
    for accuracy in ("exact", 1e-9):
        (settings, *_), why = _offers(accuracy, speed, "stub")
        assert settings.label == stub.EXACT.label
        assert why.endswith(f"stub, {stub.EXACT.label}: for show")


@pytest.mark.usefixtures("stub")
def test_an_accuracy_by_number(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither what has no error in a group is chosen for it, nor what has a note."""
    monkeypatch.setattr(StubEngine, "WORK_PRECISION", (second_order(72, note="for show"), *StubEngine.WORK_PRECISION))
    speed = speed_table(reference, ["stub", "analytic"], Budget(1, 0.0), quiet)
    (settings, *_), _ = _offers(1e-2, speed, "stub")
    assert settings.label == StubEngine.WORK_PRECISION[1].label == "72 steps"
    speed = [
        replace(row, errors={**row.errors, "torque_max": nan}) if row.setting == "72 steps" else row for row in speed
    ]
    for level, label, said in (
        (1e-2, "100 steps", "100 steps is the cheapest measured to be within 0.01"),
        (1e-5, "360 steps", "within 1e-05"),
        (1e-9, "3600 steps", "no setting was measured to be within 1e-09"),
    ):
        (settings, *_), why = _offers(level, speed, "stub")
        assert settings.label == label
        assert said in why


def test_the_main_run_takes_what_was_chosen(reference: Reference, stub: StubEngine) -> None:
    result = study(reference.scene, ["stub", "analytic"], Sampling(360), Budget(1, 0.0), quiet, 1e-5)
    assert [m.run.settings and m.run.settings.label for m in result.measurements] == ["360 steps", "vector equations"]
    assert any("360 steps is the cheapest" in reason for reason in result.reasons)
    result = study(reference.scene, ["stub"], Sampling(360), Budget(1, 0.0), quiet)
    assert result.measurements[0].run.settings == stub.DEFAULT
    assert result.reasons == []


def test_the_sentence(reference: Reference) -> None:
    speed = table(
        ("analytic", "equations", 1e-3, 1e-15), ("exudyn", "pointwise", 7e-3, 1e-8), ("pymunk", "x", 5e-3, 0.1)
    )
    said = speed_tables.verdict(study_of(reference, speed))
    assert said == (
        "The fastest way to reactions within 0.1 %: analytic with the setting “equations”, 1 ms per turn;"
        " of the other engines, exudyn with the setting “pointwise”, 7 ms per turn."
    )
    level = [*speed, *table(("pymunk", "y", 5e-3, 1e-3), ("pymunk", "z", 6e-3, 1e-4))]
    assert speed_tables.verdict(study_of(reference, level)).endswith(
        "of the other engines, about equally fast, exudyn with the setting “pointwise”, 7 ms per turn"
        " and pymunk with the setting “z”, 6 ms per turn."
    )
    said = speed_tables.verdict(study_of(reference, speed[1:]))
    assert said == "The fastest way to reactions within 0.1 %: exudyn with the setting “pointwise”, 7 ms per turn."
    assert "no setting that was tried" in speed_tables.verdict(study_of(reference, speed[2:]))


def test_tables_of_text(reference: Reference) -> None:
    points = family(STEPS, [n**-2.0 for n in STEPS])
    result = study_of(reference, [*points, *table(("b", "noted", 1.0, 1e-3), note="slow, and so on")])
    found = speed_tables.cheapest_settings(result)
    own, noted = found["reaction"]
    assert list(own.values()) == [
        "a", *["144 steps, 2.44 ms (×1.42, level with 1 more, cheapest engine)"] * 3,
        "144 steps, 2.44 ms (×1, cheapest engine)", "1440 steps, 15.4 ms (×1, cheapest engine)", "–",
    ]  # fmt: skip
    assert list(own) == ["engine", "10 %", "1 %", "0.1 %", "1e-4", "1e-6", "1e-8"]
    assert list(noted.values()) == ["b: slow", *["noted, 1e+03 ms (×581)"] * 3, "–", "–", "–"]
    (row,) = speed_tables.orders(result)
    assert row == {"engine": "a", "family": "f", "expected": "2", "reaction": row["reaction"]}
    assert str(row["reaction"]).startswith("2.00 (2.00, 2.00, 2.00, 2.00, 2.00; ")


def test_where_nothing_was_timed(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = replace(registry.ENTRIES["pymunk"], package="no_such_package")
    monkeypatch.setitem(registry.ENTRIES, "pymunk", missing)
    result = study(reference.scene, ["pymunk"], Sampling(72), Budget(1, 0.0), quiet, 1e-4)
    assert picture(result).traces == []
    assert speed_tables.verdict(result) == ""
    assert "pip install" in page(result)
    result = study(scenes.load("four_bar"), ["multiprecision"], Sampling(24), Budget(1, 0.0), quiet)
    assert [trace for trace in picture(result).traces if trace["name"] == "multiprecision"], "which takes no steps"


@pytest.mark.usefixtures("stub")
def test_the_picture(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    noted, failing = second_order(144, note="for show, only"), StubSettings("fails")
    monkeypatch.setattr(StubEngine, "WORK_PRECISION", (*StubEngine.WORK_PRECISION, noted, failing))
    result = study(reference.scene, ["analytic", "stub"], Sampling(72), Budget(1, 0.0), quiet)
    figure = offline(picture(result))
    reactions = [(number, trace) for number, trace in enumerate(figure.data) if trace.xaxis == "x4"]
    drawn = {trace.name: trace for _, trace in reactions}
    assert [*drawn["stub"].x] == pytest.approx([72, 144, 360])
    assert [*drawn["stub"].y] == pytest.approx([72**-2.0, 144**-2.0, 360**-2.0])
    assert drawn["stub: for show"].marker.symbol != drawn["stub"].marker.symbol
    assert "for show, only" in drawn["stub: for show"].text[0]
    assert "360 steps per cycle" in drawn["stub"].text[2]
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
        [row.error("reaction_rms") for row in solved(result.speed) if row.engine == "stub" and not row.note]
    )
    assert len(largest) == len(rms) == len(figure.data)

"""The canaries: none is let through by the comparison as it is, and each wrong comparison lets some through."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import scenes
from compare.judge import checks, errors, measure, verdict
from compare.judge import gates as gates_module
from compare.judge.agreement import Judgement
from compare.judge.canaries import thinned
from compare.judge.canaries.canaries import canaries
from compare.judge.canaries.sizes import sizes
from compare.judge.gates import Gate, gates
from compare.judge.judgement import judgement
from compare.judge.measure import offers
from compare.mechanics import reference, scales
from compare.mechanics.round_off import Explained
from scenes import Motion, Sampling, Status
from tests import scene_files
from tests.comparisons import SAMPLING, SLOW, References, all_checks
from tests.faults.mutants import applied, mutants
from tests.faults.wrong_code import COMPARISON, _canaried, known

Patch = Callable[[pytest.MonkeyPatch], None]


@pytest.fixture(scope="module")
def press(references: References) -> Judgement:
    engines = ("analytic", "exudyn")
    return judgement(references("toggle_press"), engines, SAMPLING, lambda name: (offers(name, "balanced"), ""), print)


@pytest.mark.parametrize("name", ["three_at_a_pin", "busy", "telescope"])
def test_none_is_let_through(name: str, references: References) -> None:
    found = judgement(references(name), ("analytic",), SAMPLING, lambda name: (offers(name, "balanced"), ""), print)
    assert found.ok
    assert not canaries(found)


@pytest.mark.parametrize(
    ("scene", "channel"),
    [
        ("four_bar", "T.x"),
        ("four_bar", "crank.omega"),
        ("four_bar", "crank.alpha"),
        ("toggle_press", "slider.guide_moment"),
        ("crank_press", "B.x"),
        ("crank_press", "rod.angle"),
    ],
)
def test_a_component_alone_is_broken_if_it_moves(scene: str, channel: str, references: References) -> None:
    sampling = Sampling(36, channels=frozenset({channel}))
    found = judgement(
        references(scene), ("analytic", "pymunk"), sampling, lambda name: (offers(name, "balanced"), ""), print
    )
    assert found.ok
    assert not canaries(found)


def test_a_body_may_have_the_name_of_a_point(tmp_path: Path) -> None:
    """Its angle is relative to a radian, not to the travel of the point."""
    file = tmp_path / "named.toml"
    file.write_text(re.sub(r"\bA\b", "crank", scene_files.text("four_bar")), encoding="utf-8")
    found = reference.uncertified(scenes.load(file))
    of = sizes(found.scene, found.cycle, found.cycle, found.scale)
    assert of["crank.x"].max() < 1.0
    assert (of["crank.angle"] == 1.0).all()


def test_what_changes_little_is_still_planted(references: References, monkeypatch: pytest.MonkeyPatch) -> None:
    """A rod's angle alone, whose sign and whose lag a comparison with a promise of 1000 does not notice."""
    sampling = Sampling(72, channels=frozenset({"rod.angle"}))
    offered = offers("analytic", "balanced")
    found = judgement(references("crank_press"), ("analytic",), sampling, lambda _: (offered, ""), print)
    a_wider_promise(monkeypatch)
    assert {"rod.angle of the opposite sign", "all but the drive late by a sample"} <= {
        line.partition(" with ")[2] for line in canaries(found)
    }


TIP = (40.0, 0.0)  # m: of a crank of 1 m, so that it is some 40 times as fast as the slider that drives it
SLOW_DRIVE = {
    "bodies.crank": {"points": {"O": [0, 0], "A": [1, 0], "T": TIP}, "mass": 1, "com": [0.5, 0], "inertia": 0.1},
    "drive": {"body": "slider", "speed": -1, "start": 3.6, "end": 2.6},
    "sketch": {"displacement": 3.6, "A": [0.7, 0.7], "B": [3.6, 0], "T": [28, 28]},
    "output": {"point": "T"},
}


def test_power_is_found_out_of_balance_where_the_drive_is_slow() -> None:
    slow = reference.uncertified(scene_files.load("slider_crank", SLOW_DRIVE))
    found = judgement(slow, ("pymunk",), SAMPLING, lambda name: (offers(name, "balanced"), ""), print)
    assert found.ok
    assert not canaries(found)


def test_several_engines(press: Judgement) -> None:
    assert not canaries(press)


def test_nothing_is_broken_where_no_run_is_ok(press: Judgement) -> None:
    failed = [replace(m, run=replace(m.run, status=Status.crashed)) for m in press.measurements]
    assert not canaries(replace(press, measurements=failed))


def no_gates_for_failed_engines(patch: pytest.MonkeyPatch) -> None:
    real = gates
    patch.setattr(thinned, "gates", lambda scene, ms: real(scene, [m for m in ms if m.run.status is Status.ok]))


def compared_with_itself(patch: pytest.MonkeyPatch) -> None:
    real = errors.compare

    def itself(of: Any, sampling: Any, motion: Motion) -> Any:
        return real(replace(of, at=lambda *_: motion), sampling, motion)

    patch.setattr(measure, "compare", itself)


def a_channel_left_out(patch: pytest.MonkeyPatch) -> None:
    real = scales.relative_errors
    left_out = lambda *of: {c: off for c, off in real(*of).items() if c != "P3.fx"}  # noqa: E731
    patch.setattr(reference, "relative_errors", left_out)


def completeness_not_checked(patch: pytest.MonkeyPatch) -> None:
    for module in (measure, thinned):
        patch.setattr(module, "complete", lambda run, *_: run)


def wider_limits(patch: pytest.MonkeyPatch) -> None:
    real = verdict.limits
    patch.setattr(verdict, "limits", lambda settings: [one._replace(most=1000 * one.most) for one in real(settings)])


def a_wider_promise(patch: pytest.MonkeyPatch) -> None:
    real = verdict.compared

    def wide(run: Any, *rest: Any) -> Any:
        return replace(real(replace(run, settings=replace(run.settings, promise=1000.0)), *rest), settings=run.settings)

    patch.setattr(measure, "compared", wide)


def no_number_passes(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(Gate, "missed", property(lambda gate: gate.error > gate.tolerance))


def drive_not_gated(patch: pytest.MonkeyPatch) -> None:
    real = verdict.limits
    patch.setattr(verdict, "limits", lambda settings: [one for one in real(settings) if one.check != "drive"])


def checks_not_run(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(measure, "checks", lambda *_: [])


def rows_not_checked(patch: pytest.MonkeyPatch) -> None:
    from compare.engines import runner

    patch.setattr(runner, "_check_rows", lambda *_: None)


def nothing_missed(patch: pytest.MonkeyPatch) -> None:
    patch.setattr(thinned, "missed", lambda *_: [])


@pytest.mark.parametrize(
    "wrong",
    [
        no_gates_for_failed_engines,
        compared_with_itself,
        a_channel_left_out,
        completeness_not_checked,
        wider_limits,
        a_wider_promise,
        no_number_passes,
        drive_not_gated,
        checks_not_run,
        rows_not_checked,
        nothing_missed,
    ],
)
def test_a_wrong_comparison_is_noticed(wrong: Patch, press: Judgement, monkeypatch: pytest.MonkeyPatch) -> None:
    wrong(monkeypatch)
    assert canaries(press)


# --- wrong from the start, as on the command line: in the reference's scales too --------------------------------------


def sizes_a_thousand_times_too_large(patch: pytest.MonkeyPatch) -> None:
    real = scales.sizes
    for module in (scales, checks):
        patch.setattr(module, "sizes", lambda *of: 1000 * real(*of))


def one_scale_for_all_forces(patch: pytest.MonkeyPatch) -> None:
    real = scales.force_scales

    def one(*of: Any) -> dict[str, float]:
        scale = real(*of)
        return dict.fromkeys(scale, max(scale.values()))

    patch.setattr(scales, "force_scales", one)


def round_off_that_explains_a_million_times_as_much(patch: pytest.MonkeyPatch) -> None:
    real = Explained.error
    patch.setattr(Explained, "error", lambda *of: 1e6 * real(*of))


def the_first_row_for_the_worst(patch: pytest.MonkeyPatch) -> None:
    for module in (errors, measure, gates_module):
        patch.setattr(module, "worst_of", lambda rows, _="max": rows[0])


def the_best_row_for_the_worst(patch: pytest.MonkeyPatch) -> None:
    for module in (errors, measure, gates_module):
        patch.setattr(module, "worst_of", lambda rows, of="max": min(rows, key=lambda row: getattr(row, of)))


def no_check_of(name: str) -> Patch:
    def patched(patch: pytest.MonkeyPatch) -> None:
        real = checks.checks
        patch.setattr(measure, "checks", lambda *of: [one for one in real(*of) if one.check != name])

    return patched


def lax_check_of(name: str) -> Patch:
    def patched(patch: pytest.MonkeyPatch) -> None:
        def thousandth(check: Any) -> Any:
            return replace(check, worst=check.worst / 1000) if check.check == name else check

        real = checks.checks
        patch.setattr(measure, "checks", lambda *of: [thousandth(one) for one in real(*of)])

    return patched


NAMES = sorted(all_checks(scene_files.load("toggle_press")))
FROM_THE_START = {
    "sizes times 1000": sizes_a_thousand_times_too_large,
    "one scale for all forces": one_scale_for_all_forces,
    "round-off times 1e6": round_off_that_explains_a_million_times_as_much,
    "the first row": the_first_row_for_the_worst,
    "the best row": the_best_row_for_the_worst,
    **{f"no check of {name}": no_check_of(name) for name in NAMES},
    **{f"a lax check of {name}": lax_check_of(name) for name in NAMES if name != "branch"},
}


@pytest.mark.parametrize("wrong", FROM_THE_START)
def test_what_is_wrong_from_the_start_is_noticed(wrong: str, press: Judgement, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = {m.run.engine: m.run for m in press.measurements}
    FROM_THE_START[wrong](monkeypatch)
    found = judgement(
        reference.uncertified(press.scene),
        [*runs],
        SAMPLING,
        lambda name: (offers(name, "balanced"), ""),
        print,
        known(runs),
    )
    assert canaries(found)


@SLOW
def test_wrong_lines_of_the_table_are_found() -> None:
    wanted = {"worst_of": {"name", "row"}, "force_scales": {"comparison"}, "Explained.error": {"result"}}
    lines = [
        one
        for module, functions in COMPARISON.items()
        for one in mutants(module, tuple(wanted.keys() & {*functions}))
        if one.function in wanted
        and one.kind in wanted[one.function]
        and ("NOTHING" in one.line or "return" in one.line)
    ]
    records = [_canaried((line, "toggle_press")) for line in lines]
    assert {one.function for one in lines} == wanted.keys()
    assert all(record is not None and record.above and record.found for record in records)


MEASURED = [("compare.mechanics.scales", "_distance"), ("compare.judge.checks", "_drive")]


@pytest.mark.parametrize(("module", "function"), MEASURED)
def test_a_dropped_abs_is_noticed(module: str, function: str, press: Judgement) -> None:
    *_, mutant = [one for one in mutants(module, (function,)) if one.kind == "abs dropped"]
    with applied(mutant):
        assert canaries(press)

"""The canaries: none is let through by the comparison as it is, and each wrong comparison lets some through."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import scenes
from compare.engines import runner
from compare.engines.runner import HERE, Runs
from compare.judge import checks, errors, measure, verdict
from compare.judge.agreement import Judgement
from compare.judge.canaries import noticed
from compare.judge.canaries.canaries import canaries
from compare.judge.canaries.sizes import sizes
from compare.judge.checks import Check
from compare.judge.errors import compare
from compare.judge.judgement import judgement
from compare.judge.measure import Gate, gates, offers
from compare.judge.verdict import compared, limits
from compare.mechanics import reference, scales
from compare.mechanics.round_off import Explained
from compare.mechanics.scales import force_scales, judged_errors
from compare.mechanics.scales import sizes as scale_sizes
from scenes import Motion, Sampling, Status
from tests import scene_files
from tests.comparisons import SAMPLING, SLOW, References, all_checks, sampled
from tests.faults.mutants import applied, mutants
from tests.faults.wrong_code import COMPARISON, _canaried, known

Patch = tuple[Any, str, Any]  # a place, a name in it, and what is wrong there


def judged(
    of: reference.Reference, engines: Sequence[str], sampling: Sampling = SAMPLING, runs: Runs = HERE
) -> Judgement:
    return judgement(of, engines, sampling, lambda name: (offers(name, "balanced"), ""), print, runs)


@pytest.fixture(scope="module")
def press(references: References) -> Judgement:
    return judged(references("toggle_press"), ("analytic", "exudyn"))


@sampled(1)
@pytest.mark.parametrize("name", ["three_at_a_pin", "busy", "telescope"])
def test_none_is_let_through(name: str, references: References) -> None:
    found = judged(references(name), ("analytic",))
    assert found.ok
    assert not canaries(found)


ALONE = {"four_bar": ["T.x", "crank.omega", "crank.alpha"], "toggle_press": ["slider.guide_moment"]}
ALONE["crank_press"] = ["B.x", "rod.angle"]


@sampled(2)
@pytest.mark.parametrize(("scene", "channel"), [(scene, channel) for scene, of in ALONE.items() for channel in of])
def test_a_component_alone_is_broken_if_it_moves(scene: str, channel: str, references: References) -> None:
    found = judged(references(scene), ("analytic", "pymunk"), Sampling(36, channels=frozenset({channel})))
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
    found = judged(references("crank_press"), ("analytic",), Sampling(72, channels=frozenset({"rod.angle"})))
    patched(monkeypatch, WRONG["a wider promise"])
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
    found = judged(reference.uncertified(scene_files.load("slider_crank", SLOW_DRIVE)), ("pymunk",))
    assert found.ok
    assert not canaries(found)


ON_GROUND = {  # the bucket, with its cylinder the other way round: the rod's one point does not move
    "bodies.cylinder.points": {"B": [0, 0]},
    "bodies.rod": {
        "points": {"A": [0, 0]},
        "mass": 1,
        "slides": {"on": "cylinder", "through": [0, 0], "along": [1, 0]},
    },
}


def test_power_is_found_out_of_balance_where_the_driven_point_stands() -> None:
    found = judged(reference.uncertified(scene_files.load("bucket", ON_GROUND)), ("analytic",))
    assert found.ok
    assert not canaries(found)


ALONG = {"1 to 1": [1, 1], "1 to 1, backwards": [-1, -1], "nearly": [1, 1.0001]}  # as all places are shifted


@pytest.mark.parametrize("along", ALONG.values(), ids=ALONG)
def test_places_off_along_the_only_guide_are_no_fault(along: list[float]) -> None:
    """They are on it as before: the same shift across it shows that its closure is checked."""
    guided = reference.uncertified(scene_files.load("mass_on_spring", {"bodies.mass.slides.along": along}))
    found = judged(guided, ("analytic", "exudyn"))
    assert found.ok
    assert not canaries(found)


@pytest.mark.parametrize("patch", ["no check", "a lax check"])
def test_a_guide_whose_closure_is_not_checked_is_a_fault(patch: str, monkeypatch: pytest.MonkeyPatch) -> None:
    patched(monkeypatch, FROM_THE_START[f"{patch} of closure"])
    guided = reference.uncertified(scene_files.load("mass_on_spring", {"bodies.mass.slides.along": [1, 1]}))
    assert "too large, by one check" in " ".join(canaries(judged(guided, ("analytic",))))


def test_several_engines(press: Judgement) -> None:
    assert not canaries(press)


def test_nothing_is_broken_where_no_run_is_ok(press: Judgement) -> None:
    failed = [replace(m, run=replace(m.run, status=Status.crashed)) for m in press.measurements]
    assert not canaries(replace(press, measurements=failed))


def compared_with_itself(of: Any, sampling: Any, motion: Motion) -> Any:
    return compare(replace(of, at=lambda *_: motion), sampling, motion)


def widely_compared(run: Any, *rest: Any) -> Any:
    wide = replace(run, settings=replace(run.settings, promise=1000.0))
    return replace(compared(wide, *rest), settings=run.settings)


WRONG: dict[str, list[Patch]] = {  # the comparison where it is wrong, and what stands there
    "no gates for failed engines": [
        (noticed, "gates", lambda scene, ms: gates(scene, [m for m in ms if m.run.status is Status.ok]))
    ],
    "compared with itself": [(measure, "compare", compared_with_itself)],
    "a channel left out": [
        (reference, "judged_errors", lambda *of: {c: e for c, e in judged_errors(*of).items() if c != "P3.fx"})
    ],
    "completeness not checked": [(module, "complete", lambda run, *_: run) for module in (measure, noticed)],
    "wider limits": [
        (verdict, "limits", lambda settings: [one._replace(most=1000 * one.most) for one in limits(settings)])
    ],
    "a wider promise": [(measure, "compared", widely_compared)],
    "no number passes": [(Gate, "missed", property(lambda gate: gate.error > gate.tolerance))],
    "drive not gated": [
        (verdict, "limits", lambda settings: [one for one in limits(settings) if one.check != "drive"])
    ],
    "checks not run": [(measure, "checks", lambda *_: [])],
    "rows not checked": [(runner, "_check_rows", lambda *_: None)],
    "nothing missed": [(noticed, "missed", lambda *_: [])],
}


def patched(patch: pytest.MonkeyPatch, places: Sequence[Patch]) -> None:
    for module, name, wrong in places:
        patch.setattr(module, name, wrong)


@sampled(3)
@pytest.mark.parametrize("wrong", WRONG)
def test_a_wrong_comparison_is_noticed(wrong: str, press: Judgement, monkeypatch: pytest.MonkeyPatch) -> None:
    patched(monkeypatch, WRONG[wrong])
    assert canaries(press)


# --- wrong from the start, as on the command line: in the reference's scales too --------------------------------------


def one_scale_for_all_forces(*of: Any) -> dict[str, float]:
    scale = force_scales(*of)
    return dict.fromkeys(scale, max(scale.values()))


def no_check_of(name: str) -> Patch:
    return measure, "checks", lambda *of: [one for one in checks.checks(*of) if one.check != name]


def lax_check_of(name: str) -> Patch:
    def lax(*of: Any) -> list[Check]:
        return [replace(one, worst=one.worst / (1000 if one.check == name else 1)) for one in checks.checks(*of)]

    return measure, "checks", lax


NAMES = sorted(all_checks(scene_files.load("toggle_press")))
EXPLAINS, ROWS = Explained.error, (errors, measure)
FROM_THE_START: dict[str, list[Patch]] = {
    "sizes times 1000": [(module, "sizes", lambda *of: 1000 * scale_sizes(*of)) for module in (scales, checks)],
    "one scale for all forces": [(scales, "force_scales", one_scale_for_all_forces)],
    "round-off times 1e6": [(Explained, "error", lambda *of: 1e6 * EXPLAINS(*of))],
    "the first row": [(module, "worst_of", lambda rows, _="max": rows[0]) for module in ROWS],
    "the best row": [
        (module, "worst_of", lambda rows, of="max": min(rows, key=lambda row: getattr(row, of))) for module in ROWS
    ],
    **{f"no check of {name}": [no_check_of(name)] for name in NAMES},
    **{f"a lax check of {name}": [lax_check_of(name)] for name in NAMES if name != "branch"},
}


@sampled(3)
@pytest.mark.parametrize("wrong", FROM_THE_START)
def test_what_is_wrong_from_the_start_is_noticed(wrong: str, press: Judgement, monkeypatch: pytest.MonkeyPatch) -> None:
    runs = {m.run.engine: m.run for m in press.measurements}
    patched(monkeypatch, FROM_THE_START[wrong])
    assert canaries(judged(reference.uncertified(press.scene), [*runs], SAMPLING, known(runs)))


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


MEASURED = [("compare.mechanics.scales", "relative_errors"), ("compare.judge.checks", "_off")]


@sampled(1)
@pytest.mark.parametrize(("module", "function"), MEASURED)
def test_a_dropped_abs_is_noticed(module: str, function: str, press: Judgement) -> None:
    *_, mutant = [one for one in mutants(module, (function,)) if one.kind == "abs dropped"]
    with applied(mutant):
        assert canaries(press)

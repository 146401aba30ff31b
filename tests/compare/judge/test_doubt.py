"""The core under suspicion: a reference that is wrong is not ok, and no simulator is blamed for it."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

import analytic
import compare
import scenes
from analytic.solve import Solver
from compare.engines import registry
from compare.engines.runner import Run
from compare.judge.agreement import Judgement
from compare.judge.judgement import _voted
from compare.judge.measure import Measurement
from compare.mechanics.reference import Reference
from compare.run import main
from scenes import InputError, Motion, Scene, Settings, Status
from scenes.model.inputs import Inputs
from tests import scene_files
from tests.comparisons import commanded, sampled

Spoil = Callable[[Motion], Motion]
UNDECIDED = "with no calculation of 50 digits to decide"


def judged(monkeypatch: pytest.MonkeyPatch, scene: Scene, other: Scene, spoil: Spoil) -> Judgement:
    """Judge a scene by a core that solves another one, and spoils the motion."""
    real = analytic.solver

    class Spoilt(Solver):
        def __call__(self, position: ArrayLike | Inputs, time: ArrayLike | None = None, *more: Any) -> Motion:
            return spoil(super().__call__(position, time, *more))

    def spoilt(scene: Scene, channels: frozenset[str] | None = None) -> Solver:
        return Spoilt(**vars(real(replace(scene, sketch=other.sketch), channels)))

    monkeypatch.setattr("analytic.solver", spoilt)
    monkeypatch.setattr("analytic.engine.solver", spoilt)
    return compare.check(scene, samples=72)


def faster(motion: Motion) -> Motion:
    return Motion({c: values * (1.0 + 1e-9 * c.endswith(".omega")) for c, values in motion.samples.items()})


def test_a_core_that_contradicts_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """A rate that is off by 1e-9 is far below every promise of the simulators, and far above its own."""
    scene = scenes.load("toggle_press")
    result = judged(monkeypatch, scene, scene, faster)
    assert [*result.verdicts] == ["analytic", "exudyn", "pymunk"]
    assert [status for status, _ in result.verdicts.values()] == ["inconsistent", "ok", "ok"]
    assert not result.ok
    assert result.verdicts["analytic"][1].startswith("the core contradicts itself, suspect the core: ")


def test_a_core_that_fails_by_a_fault_of_its_own_is_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def recurse(*_: object) -> Motion:
        return recurse()

    monkeypatch.setattr(registry, "reference", recurse)
    with pytest.raises(InputError, match="the reference failed: RecursionError: maximum recursion depth") as failure:
        compare.check("four_bar", samples=24)
    assert str(failure.value).isprintable()


@sampled(1)
@pytest.mark.parametrize("oracle", [True, False])
def test_a_core_that_stands_alone(monkeypatch: pytest.MonkeyPatch, oracle: bool) -> None:
    """With its rod upwards, all in itself right: against arbitrary precision, or two simulators that agree."""
    if not oracle:
        missing = replace(registry.ENTRIES["multiprecision"], package="no_such_package")
        monkeypatch.setitem(registry.ENTRIES, "multiprecision", missing)
    upside_down = scene_files.load("toggle_press", {"sketch.P5": [0, -400]})
    result = judged(monkeypatch, scenes.load("toggle_press"), upside_down, lambda motion: motion)
    assert result.verdicts["analytic"][0] == "inaccurate"
    assert "suspect the core" in result.verdicts["analytic"][1]
    assert {result.verdicts[engine] for engine in ("exudyn", "pymunk")} == {("ok", "")}
    assert not result.ok


def test_a_doubt_stops_though_the_core_is_not_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compare.judge.floor._doubt", lambda *_: "the core and arbitrary precision differ")
    result = compare.check("four_bar", engines=("exudyn",), samples=72)
    assert result.verdicts == {"exudyn": ("ok", "")}
    assert result.missed == [f"analytic: {result.reference.floor.doubt}"]
    assert result.reference.floor.doubt.startswith("the core and arbitrary precision differ")


@pytest.fixture
def doubted(monkeypatch: pytest.MonkeyPatch) -> Scene:
    """Have the core doubted, and return the toggle press."""
    monkeypatch.setattr("compare.judge.floor._doubt", lambda *_: "the core contradicts itself, suspect the core: power")
    return scenes.load("toggle_press")


def test_tolerances_against_a_reference_in_doubt_are_not_held(doubted: Scene) -> None:
    tolerances = {engine: dict.fromkeys(of, 1e-99) for engine, of in doubted.tolerances.items()}
    result = compare.check(replace(doubted, tolerances=tolerances), ("exudyn", "pymunk", "analytic"), samples=24)
    assert not result.ok
    assert result.missed == ["analytic: inaccurate: the core contradicts itself, suspect the core: power"]
    assert set(result.gates["met"]) == {"not held"}
    assert set(result.gates["worst"]) == {"the reference is in doubt"}
    assert result.gates["error"].isna().all()


def test_what_fails_by_itself_is_named_after_a_core_in_doubt(doubted: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    def crash(*_: object) -> object:
        raise RuntimeError("no memory")

    monkeypatch.setattr("sim_models.exudyn.engine.build", crash)
    result = compare.check(doubted, ("exudyn", "analytic"), samples=24)
    core, exudyn = result.missed
    assert core.startswith("analytic: inaccurate: the core contradicts itself")
    assert exudyn.startswith("exudyn: crashed: ")


@pytest.mark.usefixtures("doubted")
def test_what_is_not_held_is_reported_as_such(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """On the terminal, to GitHub, in the page and in `summary.json`."""
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(tmp_path / "summary.md"))
    asked = ["four_bar", "--engines", "analytic,exudyn", "--samples", "24", "--check", "--format", "github"]
    assert main([*asked, "--out", str(tmp_path)]) == 1
    lines = capsys.readouterr().out.splitlines()
    (missed,) = (line for line in lines if "  missed: " in line)
    assert missed.startswith("four_bar  missed: analytic: inaccurate: the core contradicts itself")
    assert "four_bar  not held: exudyn velocity: a tolerance of 2e-07; the reference is in doubt" in lines
    (annotation,) = (line for line in lines if line.startswith("::error"))
    assert "analytic" in annotation
    gates = json.loads((tmp_path / "four_bar" / "summary.json").read_text(encoding="utf-8"))["gates"]
    assert {(gate["met"], gate["error"]) for gate in gates} == {("not held", None)}
    assert "not held" in (tmp_path / "four_bar" / "report.html").read_text(encoding="utf-8")
    assert " of 2e-07, not held |" in (tmp_path / "summary.md").read_text(encoding="utf-8")


def test_one_simulator_alone_is_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Against the core and arbitrary precision, be it ever so consistent."""
    scene = scenes.load("four_bar")
    real = registry.engine("exudyn").build

    def late(other: Scene, *more: Any) -> object:
        return real(replace(other, gravity=None), *more)

    monkeypatch.setattr("sim_models.exudyn.engine.build", late)
    result = compare.check(scene, samples=72)
    assert result.verdicts["analytic"] == ("ok", "")
    assert result.verdicts["exudyn"][0] in ("inaccurate", "inconsistent")
    assert result.verdicts["pymunk"] == ("ok", "")
    assert np.isfinite(result.errors["max"]).all()


def test_of_many_engines_those_that_agree_are_named(reference: Reference) -> None:
    """Without a floor: two that agree with each other, one wrong in its own way, and one that the core agrees with."""
    motion = commanded(reference)
    settings, floorless = Settings("", promise=1e-3), replace(reference, floor=replace(reference.floor, by_channel={}))

    def off(engine: str, by: float) -> Measurement:
        samples = {channel: values * (1.0 + by) for channel, values in motion.samples.items()}
        status, found_by = (Status.inaccurate, "reference") if by else (Status.ok, "")
        return Measurement(Run(engine, settings, status, "", found_by, motion=Motion(samples)), None, [])

    apart = [off("analytic", 0.0), off("exudyn", 0.1), off("pymunk", 0.5), off("casadi", 0.1001)]
    alone, measured = _voted(floorless, apart)
    assert alone.floor.doubt == (
        f"the core alone differs, 2 against 1 {UNDECIDED}, suspect the core: exudyn and casadi agree with each other"
    )
    assert [m.run.status for m in measured] == [Status.inaccurate, *[Status.ok] * 3]
    divided, _ = _voted(floorless, [*apart, off("pinocchio", 0.0)])
    assert divided.floor.doubt.startswith(
        f"pinocchio and the core differ from others, 2 against 2 {UNDECIDED}, suspect the core: exudyn and casadi "
    )
    one_opinion, _ = _voted(floorless, [off("analytic", 0.0), off("casadi", 0.1), off("pinocchio", 0.1)])
    assert not one_opinion.floor.doubt  # they share how a linkage is assembled
    each_by_itself, _ = _voted(floorless, [off("analytic", 0.0), *(off(f"{by}", by) for by in (0.1, 0.2, 0.3, 0.4))])
    assert not each_by_itself.floor.doubt

"""`compare.check`: what the command line judges, as one call without files and clocks."""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import compare
import scenes
from compare.engines import registry, runner
from compare.engines.runner import Run
from compare.run import main
from scenes import Failure, InputError, Motion, Sampling, Scene, Settings, Status
from scenes.scene import ConstantSpeed
from tests import scene_files
from tests.comparisons import SLOW, Plug, sampled


def test_a_shipped_scene_is_judged_as_by_the_command_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    result = compare.check("four_bar", engines=("analytic", "exudyn"), samples=72)
    assert result.ok
    assert result.verdicts == {"analytic": ("ok", ""), "exudyn": ("ok", "")}
    assert result.motions["exudyn"]["T.x"].shape == (73,)
    assert set(result.errors["engine"]) == {"analytic", "exudyn"}
    assert set(result.gates["met"]) == {"met"}
    assert not list(tmp_path.iterdir()), "a file was written"
    assert main(["four_bar", "--engines", "analytic,exudyn", "--samples", "72", "--check", "--out", "out"]) == 0
    written = np.genfromtxt("out/four_bar/motion.exudyn.csv", delimiter=",", names=True, deletechars="")
    assert (written["T.x_[m]"] == result.motions["exudyn"]["T.x"]).all()
    assert capsys.readouterr().err == ""


def test_where_nothing_accelerates_and_no_force_acts() -> None:
    """Forces and accelerations are rounding, and are not held against each other; nor does a canary swap them."""
    wedge = scene_files.load("wedge")
    law = ConstantSpeed(speed=0.7, start=0.02, end=0.13)
    scene = replace(wedge.with_law(law), gravity=None, loads=(), springs=())
    result = compare.check(scene, samples=72)
    assert result.ok, result.missed
    assert result.reference.scale["F.fx"] == 1.0


def test_a_body_of_four_points_without_masses_needs_no_centre_of_mass() -> None:
    scene = scene_files.load("driven_toggle", scene_files.without_masses("driven_toggle"))
    assert len(scene.bodies["plate"].points) == 4
    assert scene.bodies["plate"].com is None
    result = compare.check(scene, samples=36)
    assert result.ok, result.missed
    assert result.reference.floor.by_channel, "arbitrary precision cannot take it"


@sampled(1)
@pytest.mark.parametrize("key", ["force", "torque"])  # the first files have `torque` for a slider's force too
def test_the_force_of_the_drive_is_a_group_of_its_own(key: str) -> None:
    scene = scene_files.load("driven_toggle", {"tolerances": {"analytic": {key: 1e-99}}})
    result = compare.check(scene, engines=("analytic",), samples=8)
    groups = result.errors.set_index("channel")["group"]
    assert groups["drive.force"] == "force"
    assert "torque" not in set(groups)
    assert result.gates[["group", "met", "worst"]].to_numpy().tolist() == [["force", "missed", "drive.force"]]


def test_no_clock_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compare.engines.processes.workers.Workers.timed", None)
    result = compare.check("four_bar", engines=("analytic",), samples=72, accuracy=1e-4)
    assert result.ok
    assert "cheapest measured to be within 0.0001" in result.reasons[0]


@SLOW
def test_equal_calls_choose_the_same_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the clock shows. Single precision is good to 1e-4 too, but its drive is not where it was asked to be."""
    chosen = []
    for slow in ("vector equations", "single precision", "pointwise"):

        def run(
            engine: str, scene: Scene, sampling: Sampling, settings: Settings | None = None, slow: str = slow
        ) -> Run:
            done = runner.run(engine, scene, sampling, settings)
            return replace(done, solve_s=1e3 if done.settings and done.settings.label == slow else 1e-3)

        with monkeypatch.context() as patch:
            patch.setattr("compare.study.workers", lambda *_: nullcontext(SimpleNamespace(run=run, apart=0.0)))
            result = compare.check("four_bar", engines=("analytic", "exudyn"), samples=72, accuracy=1e-4)
        assert result.ok
        chosen.append([m.run.settings.label for m in result.measurements if m.run.settings])
    assert chosen == 3 * [["vector equations", "pointwise"]]


def test_a_missed_tolerance_is_not_ok() -> None:
    scene = replace(scenes.load("four_bar"), tolerances={"pymunk": {"position": 1e-15}})
    result = compare.check(scene, engines=("pymunk",), samples=72)
    assert result.verdicts["pymunk"][0] == "ok"
    assert not result.ok
    assert result.gates["met"].tolist() == ["missed"]


@sampled(1)
@pytest.mark.parametrize("outcome", [Failure(Status.diverged, "it ran away"), Motion({})])
def test_an_engine_that_fails_is_not_ok_though_no_tolerance_is_declared(plug: Plug, outcome: Motion | Failure) -> None:
    plug(outcome)
    result = compare.check("four_bar", engines=("analytic", "stub"), samples=72)
    assert result.verdicts["analytic"][0] == "ok"
    assert result.verdicts["stub"][0] != "ok"
    assert not result.ok
    assert result.gates.empty


def test_a_run_that_ends_has_one_cycle() -> None:
    with pytest.raises(InputError, match="runs once from start to end"):
        compare.check("double_toggle_clamp", turns=2)


@sampled(2)
@pytest.mark.parametrize("engine", [*registry.DEFAULT_ENGINES, registry.ORACLE, "casadi", "pinocchio", "mujoco"])
@pytest.mark.parametrize("place", [1000, 1010])
def test_a_spring_without_free_length_whose_ends_meet_or_nearly(engine: str, place: int) -> None:
    """In the first row and again in each of the others at the start of a turn."""
    if registry.ENTRIES[engine].missing:
        pytest.skip(f"{engine} is not installed")
    spring = {"between": ["ground.S", "lever.C"], "stiffness": 3, "length": 0}
    scene = scene_files.load("lever", {"ground.points.S": [place, 0], "springs": [spring]})
    result = compare.check(scene, engines=(engine,), samples=24, turns=2)
    assert result.verdicts[engine] == ("ok", "")
    assert result.ok
    motion = result.motions[engine]
    assert abs(motion["C.x"][0] - 1) <= 1e-12
    moment = 49.05 * np.cos(motion["crank_angle"]) + 3 * place * np.sin(motion["crank_angle"])
    assert np.abs(motion["drive.torque"] - moment).max() <= 3000 * 1e-2  # of pymunk; others are far closer

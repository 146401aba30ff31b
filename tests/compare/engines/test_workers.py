"""Every engine in a process of its own: each death is a row, the others go on, and nothing is left behind."""

import os
import subprocess
import sys
from dataclasses import replace
from itertools import chain, repeat
from pathlib import Path
from pickle import loads
from signal import SIGINT
from time import process_time, sleep
from unittest.mock import Mock, patch

import pytest

import scenes
from compare.contract.test_process import digest
from compare.engines import registry, runner
from compare.engines.processes.inside import LINUX, Ended, Limits, packed
from compare.engines.processes.stopping import Stopped
from compare.engines.processes.workers import Workers, workers
from compare.engines.registry import ORACLE
from compare.engines.runner import Run, limits
from scenes import Positions, Request, Sampling, Scene, Status
from tests.comparisons import SLOW, sampled
from tests.deaths import DEATHS, TWELVE, children, doomed

SAMPLING = Sampling(24)
CORE = registry.engine("analytic").DEFAULT
ROOT = Path(__file__).parents[3]


def quiet() -> None:
    return


@pytest.fixture
def scene() -> Scene:
    return scenes.load("four_bar")


@sampled(3)
@pytest.mark.parametrize(
    "death", [*TWELVE, "much talk", *(pytest.param(d, marks=SLOW) for d in DEATHS if d not in (*TWELVE, "much talk"))]
)
def test_a_death_is_a_row_and_the_other_engines_and_scenes_go_on(
    death: str, scene: Scene, capfd: pytest.CaptureFixture[str]
) -> None:
    """Of the analytic core as an engine, which needs no import; nothing that it prints is shown."""
    _, status, reason = DEATHS[death]
    stage = "read" if death in ("no motion", "samples of functions") else "solve"
    with doomed({"analytic": death}, stage), workers(["analytic", "pymunk"], quiet) as runs:
        run = runs.run("analytic", scene, SAMPLING)
        assert (run.status, run.motion, run.settings) == (status, None, CORE)
        assert reason in run.reason
        assert run.reason.isprintable()
        assert 0 < len(run.reason) <= 400
        assert run.version.startswith("numpy")
        assert runs.run("pymunk", scene, SAMPLING).status is Status.ok
        if status is not Status.timed_out:  # it takes a while
            assert "not run again" not in runs.run("analytic", scenes.load("crank_press"), SAMPLING).reason
    assert capfd.readouterr() == ("", "")


@pytest.mark.skipif(not LINUX, reason="elsewhere no other process's clock is known")
@pytest.mark.parametrize(("works", "sleeps"), [(0.0, 0.6), (0.2, 0.4)])
def test_a_run_that_fails_has_taken_its_processor_time(works: float, sleeps: float, scene: Scene) -> None:
    """Not the time on the wall, of which it sleeps a part, as it waits for a busy machine."""

    def failed() -> None:
        began = process_time()
        while process_time() < began + works:
            pass
        sleep(sleeps)
        raise ZeroDivisionError

    dies = patch.dict(DEATHS, {"late": (failed, Status.crashed, "")})
    with dies, doomed({"analytic": "late"}), workers(["analytic"], quiet) as runs:
        assert runs.run("analytic", scene, SAMPLING).status is Status.crashed
        assert works <= runs.apart < works + 0.2  # what else it does for a run takes a few hundredths


@sampled(1)
@pytest.mark.parametrize(("death", "begun"), [("memory", 1), ("abort", 3), ("recursion", 1)])
def test_what_was_ended_at_a_limit_is_not_asked_again(death: str, begun: int, scene: Scene) -> None:
    """What crashed is, a few times; an exception leaves the process as it was."""
    counted = patch.object(Workers, "begin", autospec=True, side_effect=Workers.begin)
    with counted as begin, doomed({"analytic": death}), workers(["analytic"], quiet) as runs:
        ended = [runs.run("analytic", scene, SAMPLING) for _ in range(5)]
    assert begin.call_count == begun
    assert {run.status for run in ended} == {DEATHS[death][1]}
    assert ended[-1].reason.startswith("not run again, since ") == (death != "recursion")


def test_what_is_asked_of_an_engine_beside_its_runs_may_hang(scene: Scene) -> None:
    """As how many iterations it needs: that ends, and nothing is asked again of it on this scene."""
    with doomed({}), workers(["analytic"], quiet) as runs:
        ended = runs.asked("analytic", scene, DEATHS["hang in Python"][0], Limits(0.3))
        again = runs.run("analytic", scene, SAMPLING)
        assert runs.asked("analytic", scenes.load("crank_press"), os.getpid) != os.getpid()
    assert isinstance(ended, Ended)
    assert (ended.status, ended.at_limit) == (Status.timed_out, True)
    assert again.reason == f"not run again, since {ended.reason}"


@pytest.mark.parametrize(
    "name", ["pymunk", *(pytest.param(name, marks=SLOW) for name in ("analytic", "exudyn", ORACLE))]
)
def test_a_run_is_the_same_as_in_this_process(name: str, scene: Scene) -> None:
    settings = registry.engine(name).FAST
    here = runner.run(name, scene, SAMPLING, settings)
    with workers([name], quiet) as runs:
        there = runs.run(name, scene, SAMPLING, settings)
        (timed,) = runs.timed(name, scene, SAMPLING, [settings])
    assert digest(there.motion) == digest(here.motion) != digest(None)
    assert bare(there) == bare(here) == replace(bare(timed), residuals=here.residuals)  # those are found when reading
    assert timed.motion is None
    for run in (there, timed):
        assert 0 < run.solve_s <= run.wall_s + 1e-3  # on one thread, but for what is between the looks at two clocks


def bare(run: Run) -> Run:
    return replace(run, motion=None, build_s=0.0, solve_s=0.0, read_s=0.0, wall_s=0.0)


def test_the_clock_is_fine_under_a_limit_of_processor_time() -> None:
    """Where Python's own goes by ticks of 4 ms, and a run of the core takes none."""
    code = (
        "from resource import RLIMIT_CPU, setrlimit; setrlimit(RLIMIT_CPU, (600, 600))\n"
        "import scenes; from compare.engines.runner import run\n"
        "asked = scenes.load('four_bar'), scenes.Sampling(24)\n"
        "print(len({run('analytic', *asked).solve_s for _ in range(9)}))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert int(done.stdout) > 2


@pytest.mark.parametrize(
    ("asked", "least"), [(SAMPLING, 20.0), (Sampling(360, turns=1000), 1000.0), (Positions((0.0,) * 360_000), 1000.0)]
)
def test_limits_grow_with_what_is_asked(asked: Request, least: float, toggle_press: Scene) -> None:
    most = limits(toggle_press, asked, [CORE])
    assert least <= most.seconds <= 3 * least
    assert most.memory >= 3 * 8 * asked.count * len(asked.wanted(toggle_press))  # a motion on both sides, and one sent


def test_a_stop_ends_what_runs_and_a_process_begun_anew_goes_on(scene: Scene) -> None:
    poll = Mock(side_effect=chain([Stopped], repeat(None)))
    with doomed({"exudyn": "asleep in C"}), workers(["exudyn", "analytic"], poll) as runs:
        with pytest.raises(Stopped):
            runs.run("exudyn", scene, SAMPLING)
        assert len(children()) == 1
        assert runs.run("analytic", scene, SAMPLING).status is Status.ok


def test_ctrl_c_is_for_the_parent_alone(scene: Scene) -> None:
    with workers(["analytic"], quiet) as runs:
        (begun,) = children()
        os.kill(begun, SIGINT)
        assert runs.run("analytic", scene, SAMPLING).status is Status.ok
        assert children() == [begun]


def test_engines_of_a_worker_of_the_caller_s_run_in_it(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("multiprocessing.process._current_process._config", {"daemon": True})
    with workers(["analytic"], quiet) as runs:
        assert children() == []
        assert runs.run("analytic", scene, SAMPLING).status is Status.ok


def test_a_scene_is_sent_once_and_none_is_taken_for_another(scene: Scene) -> None:
    """What was found of a scene stays with it in the engine's process; one with another name or number is another."""
    other = replace(scene, gravity=(0.0, -1.0))
    first, second = packed((1, scene)), packed((2, scene))
    known = loads(first)[1]
    assert loads(second)[1] is known
    assert known == scene
    assert known.tables == scene.tables
    for sent, asked in ((packed(other), other), (first, scene), (packed(scene), scene)):
        received = loads(sent)
        received = received[1] if isinstance(received, tuple) else received
        assert (received, received.gravity) == (asked, asked.gravity)

"""Engines that attack the process which judges them: none runs code there, prints there, or answers for another."""

import os
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import scenes
from compare.engines import registry
from compare.engines.processes import messages
from compare.engines.processes.inside import Limits
from compare.engines.processes.workers import workers
from compare.engines.runner import Run
from compare.judge.measure import checked_run
from compare.measure.hard import case as hard
from scenes import Sampling, Status
from tests import scene_files
from tests.comparisons import SLOW
from tests.sites import install, known

HONEST = """
import os, sys
import numpy as np
import analytic.engine as core
from scenes import Failure, Motion, Settings, Status
DEFAULT = Settings("plain", promise=1e-6)
class Bomb:
    def __reduce__(self):
        return os.system, ("touch $MARK$PPID",)  # by the number of the process that reads it
class Text(str):
    def __reduce__(self):
        return Bomb().__reduce__()
class Whole(int):
    __reduce__ = Text.__reduce__
class Real(float):
    __reduce__ = Text.__reduce__
class Array(np.ndarray):
    def __reduce__(self):
        return Bomb().__reduce__()
    def __reduce_ex__(self, _):
        return Bomb().__reduce__()
def boxed():
    box = np.empty(1, object)
    box[0] = Bomb()
    return box
class build:
    counters, residuals = {}, {}
    def __init__(self, scene, settings, request):
        self.run, self.wanted, self.scene = core.build(scene, core.DEFAULT, request), request.wanted(scene), scene
    def solve(self):
        self.run.solve()
    def read(self):
        motion = self.run.read()
        return spoilt({c: motion[c] for c in self.wanted}, self)
def spoilt(s, run):
    return Motion(s)
"""
# By name: what it does, the status of its row, and what is in the reason.
IN_A_MOTION = {
    "object_array": ("def spoilt(s, run):\n    s['A.x'] = boxed()\n    return Motion(s)", "crashed", "is of object"),
    "object_beside": ("def spoilt(s, run):\n    s['more'] = boxed()\n    return Motion(s)", "crashed", "is of object"),
    "own_array": ("def spoilt(s, run):\n    return Motion({c: v.view(Array) for c, v in s.items()})", "ok", ""),
    "own_names": ("def spoilt(s, run):\n    return Motion({Text(c): v for c, v in s.items()})", "ok", ""),
    "own_reasons": ("def spoilt(s, run):\n    return Motion(s, {'more': Text('why'), Text('b'): Bomb()})", "ok", ""),
    "records": (
        "def spoilt(s, run):\n    s['A.x'] = np.zeros(25, [('a', 'f8'), ('b', 'O')])\n    return Motion(s)",
        "crashed",
        "expected float64",
    ),
    "own_counters": ("build.counters = {Text('steps'): Whole(3)}; build.residuals = {Text('r'): Real(1e-9)}", "ok", ""),
    "own_failure": (
        "class F(Failure):\n    __reduce__ = Text.__reduce__\n    reason = Text('of its own')\n"
        "def spoilt(s, run):\n    raise F(Status.diverged, Text('why'), Motion({'A.x': boxed()}))",
        "crashed",
        "is of object",
    ),
    "own_error": (
        "class E(Exception):\n    __reduce__ = Text.__reduce__\n    def __str__(self):\n        return Text('told')\n"
        "def spoilt(s, run):\n    raise E(Bomb())",
        "crashed",
        "E: told",
    ),
    "own_settings": ("class S(Settings):\n    __reduce__ = Text.__reduce__\nDEFAULT = S('of its own')", "crashed", ""),
    "huge_array": ("def spoilt(s, run):\n    return Motion(s | {'more': np.zeros(2**29)})", "crashed", "emory"),
    "wild_numbers": (
        "def spoilt(s, run):\n    known = {c: s[c] for c in ('time', 'crank_angle')}\n"
        "    return Motion({c: 1e30 * np.sign(np.sin(99 * v)) for c, v in s.items()} | known)",
        "diverged",
        "",
    ),
    "not_finite": (
        "def spoilt(s, run):\n    s |= {c: np.full_like(v, np.inf) for c, v in s.items()}\n    return Motion(s)",
        "nonfinite",
        "time is not finite",
    ),
    "complex": (
        "def spoilt(s, run):\n    return Motion({c: v * (1 + np.inf * 1j) for c, v in s.items()})",
        "crashed",
        "complex128, expected float64",
    ),
}
# What an engine writes to its process's connection by itself, in the place of an answer.
WRITES = """
import json, pickle, stat
from compare.engines.processes.messages import written
def head(text, data=b""):
    return len(text).to_bytes(8, "big") + text + data
def whole(samples, **more):
    told = {"status": "ok", "reason": "", "version": "forged", "counters": {}, "residuals": {}}
    told |= {"motion": {"samples": samples, "unsupported": {}}}
    return told | dict.fromkeys(("build_s", "solve_s", "read_s", "wall_s"), 1.0) | more
def spoilt(s, run):
    frame = forged(s)
    for descriptor in range(3, 1024):
        try:
            if stat.S_ISSOCK(os.fstat(descriptor).st_mode):
                os.write(descriptor, len(frame).to_bytes(4, "big") + frame)
        except OSError:
            pass
    os._exit(0)
"""
FORGED = {  # the message that it writes of its samples, and what its row says then
    "of_the_core": ("written([[whole(s, engine='analytic', settings='exact')]])", ""),
    "pickled": ("pickle.dumps((Bomb(),))", "its result cannot be read: "),
    "pickled_in_a_frame": ("head(pickle.dumps([Bomb()]))", "its result cannot be read: "),
    "printed": ("b'some text on standard output' * 9", "its result cannot be read: "),
    "of_objects": ("head(b'[{\"array\":[\"|O8\",[1],0]}]', b'12345678')", "one of numbers"),
    "of_records": ("head(b'[{\"array\":[\"(2,)f8,O\",[1],0]}]', b'12345678' * 9)", "one of numbers"),
    "beyond_its_end": ("head(b'[{\"array\":[\"<f8\",[9],0]}]', b'12345678')", "its result cannot be read: "),
    "before_its_begin": ("head(b'[{\"array\":[\"<f8\",[1],-8]}]', b'12345678')", "one of numbers"),
    "of_a_huge_shape": ('head(b\'[{"array":["<f8",[1000000000000,0],0]}]\')', "its answer is none: "),
    "nested": ("head(b'[' * 100_000)", "its result cannot be read: "),
    "much_text": ("head(b'[' + b'[],' * 2**21 + b'1]')", "of too many names"),
    "a_huge_number": ("head(b'[' + b'9' * 5000 + b']')", "its result cannot be read: "),
    "nothing": ("written([])", "its result cannot be read: "),
    "a_number": ("written([1])", "its answer is none: "),
    "one_more": ("written([[whole(s), whole(s)]])", "its answer is none: "),
    "no_motion": ("written([[whole(s, motion=None)]])", "its answer is none: ValueError: it is ok, without a motion"),
    "lists": ("written([[whole({c: v.tolist() for c, v in s.items()})]])", "its answer is none: TypeError"),
    "no_status": ("written([[whole(s, status='excellent')]])", "its answer is none: KeyError"),
    "a_status_alone": ("written([[{'status': 'ok'}]])", "its answer is none: "),
    "timeless": ("written([[whole(s, build_s=float('nan'), solve_s=-1e300, wall_s=1e300)]])", ""),
    "unprintable": ("written([[whole(s, status='diverged', reason='\\ud800\\x1b[31m\\n')]])", "\\ud800\\x1b[31m"),
}


@pytest.fixture(scope="module", autouse=True)
def _installed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    site = tmp_path_factory.mktemp("site")
    texts = {name: f"{HONEST}{text}\n" for name, (text, *_) in IN_A_MOTION.items()}
    texts |= {name: f"{HONEST}{WRITES}def forged(s):\n    return {text}\n" for name, (text, _) in FORGED.items()}
    install(site, "acme", {name: name for name in texts} | {"Analytic": "own_names"}, texts)
    install(site, "a/../b", {"elsewhere": "own_names"})
    with pytest.MonkeyPatch.context() as patch, known(site, ()):
        patch.setenv("MARK", f"{site}/mark-")
        yield site
    assert not {*texts} & {*sys.modules}, "imported"


@pytest.fixture(autouse=True)
def _mark(_installed: Path) -> Iterator[None]:
    """Look for the file that is made where this process runs an engine's code."""
    yield
    assert not (_installed / f"mark-{os.getpid()}").exists()


def first_of(engines: Iterable[str], number: int) -> list[Any]:
    """Return lists of engines, a process each, of which the second is slow."""
    names = [*engines]
    return [pytest.param(names[:number], id="some"), pytest.param(names[number:], id="others", marks=SLOW)]


def judged(engines: Iterable[str]) -> dict[str, Run]:
    """The run of each, judged by itself."""
    scene = scenes.load("four_bar")
    with workers((), lambda: None) as runs:
        return {name: checked_run(name, scene, Sampling(24), runs=runs) for name in engines}


@pytest.mark.parametrize("engines", first_of(IN_A_MOTION, 4))
def test_nothing_but_numbers_and_text_comes_back(engines: list[str], capfd: pytest.CaptureFixture[str]) -> None:
    for engine, run in judged(engines).items():
        _, status, reason = IN_A_MOTION[engine]
        assert (run.status.name, reason in run.reason) == (status, True), run
        assert {type(channel) for channel in (run.motion.samples if run.motion else ())} <= {str}
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("engines", first_of(FORGED, 4))
def test_a_forged_answer_is_a_row_of_its_own_engine(engines: list[str], capfd: pytest.CaptureFixture[str]) -> None:
    for engine, run in judged(engines).items():
        _, reason = FORGED[engine]
        status = Status.diverged if engine == "unprintable" else Status.crashed if reason else Status.ok
        assert (run.status, reason in run.reason, run.reason.isprintable()) == (status, True, True), run
        assert (run.engine, run.settings and run.settings.label) == (engine, "plain")
        assert 0 < run.seconds < 1e31 or run.status is not Status.ok
    assert capfd.readouterr() == ("", "")


def test_an_engine_reaches_no_process_of_another() -> None:
    """A worker that waits for its next task believes what comes as one, and it is a pickle."""
    assert [run.status for run in judged(["own_names", "pickled"]).values()] == [Status.ok, Status.crashed]
    assert not [*Path(os.environ["MARK"]).parent.glob("mark-*")]


@SLOW
def test_wild_numbers_are_no_warning(tmp_path: Path) -> None:
    """Nor the end of a run whose warnings are errors."""
    code = "import sys; from compare.run import main; sys.exit(main(sys.argv[1:]))"
    engines = "analytic,wild_numbers,not_finite"
    command = [sys.executable, "-W", "error", "-c", code, "four_bar", "--samples", "24", "--out", str(tmp_path)]
    surroundings = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(
        [*command, "--engines", engines], env=surroundings, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "wild_numbers" in done.stdout


def test_names_that_are_those_of_others() -> None:
    """No name is another one but for its case, and none leaves the folder of the report."""
    assert {"analytic", "Analytic@acme"} <= {*registry.ENTRIES}
    assert registry.ENTRIES["elsewhere"].missing == (
        "its distribution's name is expected to be letters, digits, '_', '.' and '-', 40 at most"
    )


@SLOW
@pytest.mark.parametrize("text", ["own_array", "pickled"])
def test_the_hard_cases_judge_in_another_process(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hard, "Limits", lambda: Limits(seconds=20.0, workers=1))
    ladder = tmp_path / "rod.toml"
    rungs = (scene_files.FOLDER / "ladders" / "rod.toml").read_text(encoding="utf-8")
    ladder.write_text(rungs.partition("[steps]")[0] + "[steps]\nas_is = 300\n", encoding="utf-8")
    table = hard.hard_cases([str(ladder)], [text], tmp_path / "out", print, print)
    assert [*table["engine"]] == [text]
    assert [*table["outcome"]] == ["right" if text == "own_array" else "refused"]


def test_messages_are_what_was_written() -> None:
    value = {"a": [None, True, 1, 0.5, "ü\ud800"], "b": np.arange(6.0).reshape(2, 3), "c": np.zeros(0, "i4")}
    known = messages.read(messages.written(value))
    assert known["a"] == value["a"]
    for name in "bc":
        assert (known[name].dtype, known[name].tolist()) == (value[name].dtype, value[name].tolist())  # type: ignore[attr-defined]
    with pytest.raises(TypeError, match="set is no data"):
        messages.written([{1}])

"""Engines that other distributions offer: found by their metadata, run as any other; whatever is wrong is a row."""

import json
import os
import subprocess
import sys
import warnings
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

import compare
from compare.engines import TRACEBACK, registry
from compare.engines.kept import version
from compare.engines.registry import settings_of, tiers
from compare.run import main
from scenes import load
from tests.sites import GOOD, install, known

OWN = f"{GOOD}from scenes import Failure, Settings, Status\nclass N:\n    def __init__(self, *_): pass\n"
CHANGES = f"""{GOOD}
import os, sys, warnings
import numpy as np
os.chdir("/")
os.environ["OF_AN_IMPORT"] = "1"
np.seterr(all="raise")
warnings.simplefilter("error")
print("to the user")
print("to the user", file=sys.stderr)
"""
MODULES = {  # by name of the engine; why a run of it is crashed, where it is
    "good": (GOOD, ""),
    "changes": (CHANGES, ""),
    "absent_import": ("import no_such_module", "ModuleNotFoundError: No module named 'no_such_module'"),
    "dies": ("import os\nprint('to the user', flush=True)\nos.abort()", "its process ended by SIGABRT"),
    "empty": ("", "TypeError: expected a module with DEFAULT, of scenes.Settings, and build("),
    "unsendable": (f"{OWN}DEFAULT = Settings('any', note=lambda: 0)", "TypeError: any: expected an order"),
    "no_motion": (f"{OWN}class build(N):\n    solve = read = lambda self: None", "TypeError: expected scenes.Motion"),
    "fails_ok": (f"{OWN}def build(*_): raise Failure(Status.ok, 'well')", "a failure is expected to have"),
    "promises_nothing": (f"{OWN}DEFAULT = Settings('any', promise=1e9)", "any: expected a promise between 0 and 1"),
    "no_tier": (f"{OWN}FAST = None", "expected scenes.Settings, found NoneType"),
    "one_label": (f"{OWN}EXACT = Settings('a')\nFAST = Settings('a', order=2)", "each of its settings, found two of a"),
    "steps": (f"{OWN}at_steps = lambda steps: steps", "expected scenes.Settings, found int"),
}
NAMED = {  # entry points of other names than their modules; why a run of them is unsupported
    "no_module": ("nowhere_to_be_found", "acme lacks its module nowhere_to_be_found: pip install acme"),
    "attribute": ("good:build", "its entry point is expected to name a module, found good:build"),
    "main_module": ("__main__", "acme lacks its module __main__: pip install acme"),
}
NEEDY = "it needs no-such-thing, which is not installed: pip install needy"
SPOILT = """
from analytic.engine import build as real
from scenes import Failure, Motion, Settings, Status
import numpy as np
DEFAULT = Settings("plain", promise=1e-6)
class build:
    def __init__(self, scene, settings, request):
        import analytic.engine as core
        self.run, self.wanted = core.build(scene, core.DEFAULT, request), request.wanted(scene)
        self.solve = self.run.solve
    def read(self):
        motion = self.run.read()
        s = {c: motion[c] for c in self.wanted}
        return spoilt(s)
"""
RETURNED = {  # what comes back, and the reason why it is not ok
    "huge": ("s['A.x'] = s['A.x'] + 1e200", "A.x is 1e+200 at crank angle 0.0000 deg"),
    "unknown": ("s |= {'A.foo': s['time'], 'nothing': s['time']}", ""),
    "another_length": ("s |= {'A.z': s['time'][:3], 'B.x': s['time'][:3]}", "B.x is of shape (3,), expected (25,)"),
    "of_no_text": ("s |= {5: s['time'], None: s['time'], (1, 2): s['time']}", ""),
    "of_its_own": ("s = {K(c): v for c, v in s.items()}", ""),
    "very_many": ("s |= {f'X{k}.x': s['time'] for k in range(20_000)}", ""),
    "texts": ("s['A.x'] = s['A.x'].astype(str)", "A.x is of <U32, expected float64"),
    "a_number": ("s['A.x'] = 1.0", "A.x is of shape (), expected (25,)"),
    "fails_short": ("raise Failure(Status.diverged, 'why', Motion({c: v[:3] for c, v in s.items()}))", "why"),
    "fails_huge": ("raise Failure(Status.diverged, 'why', Motion({c: 1e200 * v for c, v in s.items()}))", "why"),
    "counts": ("build.counters = {'steps': 10**5000}", "OverflowError: Python int too large to convert to C long"),
}
FINE = f"{SPOILT}spoilt = Motion\n"
LINE = SPOILT.count("\n") + 2
RAISING = {  # also where a library raises that an engine calls: the place is in the engine
    "raises": ("return 1 / 0", f"ZeroDivisionError: division by zero (raises.py, line {LINE})"),
    "below": ("return np.linalg.inv(np.zeros((2, 2)))", f"LinAlgError: Singular matrix (below.py, line {LINE})"),
}
BREAKS = {"breaks": (f"{GOOD}\n1 / 0", "ZeroDivisionError: division by zero (breaks.py, line 3)")}
ENDINGS = {  # what an import leaves for later
    "a_thread": f"{FINE}import threading, time\nthreading.Thread(target=time.sleep, args=(600,)).start()",
    "an_exit": f"{FINE}import atexit, time\natexit.register(time.sleep, 600)",
    "own_settings": (
        f"{FINE}from dataclasses import dataclass\n@dataclass(frozen=True)\nclass Own(Settings):\n"
        "    level: float = 1e-3\n    kind: object = (1, 2)\nDEFAULT = Own('own', promise=1e-6)\n"
    ),
}


@pytest.fixture(scope="module", autouse=True)
def _installed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    load("four_bar")  # pydantic reads the metadata of all that is installed once: here before some is nobody's text
    site = tmp_path_factory.mktemp("site")
    texts = {name: text for name, (text, *_) in (MODULES | BREAKS).items()} | ENDINGS
    texts |= {name: f"{SPOILT}def spoilt(s):\n    {body}\n" for name, (body, _) in RAISING.items()}
    for name, (body, _) in RETURNED.items():
        texts[name] = f"{SPOILT}class K(str): pass\ndef spoilt(s):\n    {body}\n    return Motion(s)"
    points = {name: name for name in texts} | {name: module for name, (module, *_) in NAMED.items()}
    points |= dict.fromkeys(("../up", "a,b", "exudyn"), "good")
    install(site, "acme", points, texts, "Summary: Engines of\x1b Acme\n")
    needs = "Requires-Dist: numpy\nRequires-Dist: other; extra == 'x'\nRequires-Dist: no-such-thing>=1\n"
    install(site, "needy", {"needy": "good"}, metadata=needs)
    for name, broken in {"latin": "mine = größe".encode("latin-1"), "torn": b"[console_scripts]\nmine"}.items():
        install(site, name, {name: "good"})
        (site / f"{name}-1.0.dist-info" / "entry_points.txt").write_bytes(broken)
    assert not {"good", "dies"} & sys.modules.keys(), "imported"
    with known(site, MODULES):
        yield


def test_all_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--list"]) == 0
    lines = [line.split(maxsplit=2) for line in capsys.readouterr().out.splitlines() if line.startswith("engine")]
    listed = {name: text for _, name, text in lines}
    assert listed["good"] == "Engines of\\x1b Acme (acme 1.0)"
    assert listed["needy"].startswith("an engine of needy (it needs no-such-thing")
    assert listed["exudyn"].endswith("(exudyn 1.13.6)")
    for name in ("../up", "a,b"):
        assert "its name is expected to be letters" in listed[name]
    assert not {"good", "dies"} & sys.modules.keys(), "imported"


def test_each_is_run_or_is_a_row(capfd: pytest.CaptureFixture[str]) -> None:
    """What nobody asked for is left out, and an error has its place in the engine."""
    reasons = {name: reason for name, (_, reason) in (MODULES | BREAKS | RAISING | NAMED | RETURNED).items()}
    reasons |= {"needy": NEEDY, "exudyn@acme": ""}
    before = Path.cwd(), np.geterr(), {**os.environ}, [*warnings.filters]
    checked = compare.check("four_bar", ("analytic", *reasons), samples=24)
    assert (Path.cwd(), np.geterr(), {**os.environ}, [*warnings.filters]) == before
    for engine, reason in reasons.items():
        status, given = checked.verdicts[engine]
        other = {"unsupported"} if engine in (*NAMED, "needy") else {"crashed", "diverged"}
        assert status in (other if reason else {"ok"}), checked.verdicts[engine]
        assert status != "diverged" or engine in RETURNED
        assert given == reason if engine in RAISING | BREAKS else reason in given
    motions = checked.motions
    assert {*motions["very_many"].samples} == {*motions["of_no_text"].samples} == {*checked.scene.channels.names()}
    assert capfd.readouterr() == ("", "")
    assert "of_its_own" not in sys.modules, "imported"
    assert main(["--engines", "godo"]) == main(["four_bar", "--engines", "analytic,needy"]) == 2
    wrong = f"--engines: no engine 'godo'; did you mean 'good'?\n--engines needy: {NEEDY}\n"
    assert capfd.readouterr().err == wrong


def test_a_traceback_is_printed_on_request(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv(TRACEBACK, "1")
    compare.check("four_bar", ("analytic", "raises"), samples=24)
    printed = capfd.readouterr().err
    assert f'raises.py", line {LINE}, in spoilt' in printed
    assert printed.splitlines()[-1] == "ZeroDivisionError: division by zero"


def test_no_engine_is_imported_here(tmp_path: Path) -> None:
    """What its import leaves for the exit of a process does not hold that of the command."""
    code = "import sys; from compare.run import main; main(sys.argv[4:]); print({*sys.argv[1:4]} & {*sys.modules})"
    arguments = ["four_bar", "--samples", "24", "--out", str(tmp_path), "--engines", f"analytic,{','.join(ENDINGS)}"]
    surroundings = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), "PYDANTIC_DISABLE_PLUGINS": "__all__"}
    command = [sys.executable, "-c", code, *ENDINGS, *arguments]
    done = subprocess.run(command, env=surroundings, capture_output=True, text=True, check=False, timeout=60)
    assert (done.stdout.splitlines()[-1:], done.stderr) == (["set()"], "")
    page, summary = ((tmp_path / "four_bar" / name).read_text("utf-8") for name in ("report.html", "summary.json"))
    assert "(1, 2)" in page, "settings of its own"
    engines = json.loads(summary)["engines"]
    assert {name: engines[name]["status"] for name in ENDINGS} == dict.fromkeys(ENDINGS, "ok")
    assert engines["own_settings"]["settings"]["level"] == 1e-3


def test_what_a_module_leaves_out_is_its_default() -> None:
    engine = registry.engine("good")
    assert engine.version() == "acme 1.0"
    assert {*tiers("good").values()} == {engine.DEFAULT} == {*settings_of("good", full=True)}
    assert engine.at_steps is engine.iterations_needed is None


def test_results_are_kept_of_the_same_code_alone() -> None:
    """Another source of an engine is another version of everything, be its distribution's version the same."""
    known, file = [], Path(str(find_spec("good").origin))  # type: ignore[union-attr]
    for text in (GOOD, f"{GOOD}\n", GOOD):
        file.write_text(text, encoding="utf-8")
        version.cache_clear()
        known.append(version())
    assert known[0] == known[2] != known[1]

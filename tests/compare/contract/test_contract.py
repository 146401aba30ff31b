"""The contract: shipped engines and the example of `docs/engines.md` keep to it, and a wrong one fails each clause."""

import inspect
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from os import pathsep
from pathlib import Path

import pytest

import scenes
from compare.contract import asked, test_motion, test_process, test_protocol, test_refusals
from compare.engines import TRACEBACK, registry
from tests.compare.contract.faults import FAULTS, Fault
from tests.comparisons import SLOW, sampled
from tests.sites import GOOD, install, known

ROOT = Path(__file__).parents[3]
CONTRACT = ("--pyargs", "compare.contract", "--engine")
CLAUSES = {
    name.removeprefix("test_"): clause
    for module in (test_motion, test_protocol, test_refusals)
    for name, clause in vars(module).items()
    if name.startswith("test_")
}
PAGE = (ROOT / "docs" / "engines.md").read_text("utf-8")
EXAMPLE = "".join(re.findall(r"^```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL))
NOISY = f"""{GOOD}
import os, random
from pathlib import Path
real = build
def build(scene, settings, request):
    print("to the user")
    random.seed(1)
    Path("left.txt").touch()
    run, (r, v) = real(scene, settings, request), (1 + 1e-14 * os.getpid(), vars(scene))
    read = run.read
    run.read = lambda: type(read())({{channel: samples * r for channel, samples in read().samples.items()}})
    return run
"""
CRASHING = f"{GOOD}def build(*asked):\n    return 1 / 0\n"
PROCESS = {name for name in vars(test_process) if name.startswith("test_")}


class Reports:
    def __init__(self) -> None:
        self.passed: set[str] = set()
        self.failed: dict[str, str] = {}

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        name = report.nodeid.rpartition("::")[2]
        if report.failed:
            self.failed[name] = str(report.longrepr)
        elif report.when == "call" and report.passed:
            self.passed.add(name)


def held(name: str, folder: Path, *options: str) -> Reports:
    """Hold the contract against an engine, in this process, and return what pytest reports."""
    reports, file = Reports(), folder / "none.ini"
    file.write_text("[pytest]\n", encoding="utf-8")
    quiet = (*(f"-pno:{plugin}" for plugin in ("xdist", "cacheprovider", "terminal")), "-s")
    pytest.main(["-c", str(file), *quiet, "-pcompare.contract.asked", *CONTRACT, name, *options], plugins=[reports])
    return reports


@sampled(2)
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("analytic", "not test_process"),
        *((name, "test_protocol or four_bar") for name in ("exudyn", "pymunk", "multiprecision")),
        *(pytest.param(name, "", marks=SLOW) for name in ("casadi", "mujoco", "pinocchio", "pymunk")),
    ],
)
def test_a_shipped_engine_keeps_to_it(name: str, options: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(asked, "shipped", lambda: ("four_bar", "quick_return"))
    reports = held(name, tmp_path, "-k", options)
    assert reports.failed == {}
    assert len(reports.passed) >= 8


def test_every_clause_can_fail() -> None:
    assert {fault.clause for fault in FAULTS.values()} == {*CLAUSES}


@sampled(8)
@pytest.mark.parametrize("name", FAULTS)
def test_a_wrong_engine_fails(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Called as pytest calls a clause: the values of its parameters by their names."""
    real, fault, scene = registry.engine, FAULTS[name], scenes.load("four_bar")
    values = {"name": name, "scene": scene, "solved": scene, "tier": "fast"}
    values |= dict(zip(("ladder", "label"), test_refusals.IMPOSSIBLE[0], strict=True))

    def fails(fault: Fault) -> str:
        clause, wrong = CLAUSES[fault.clause], fault.engine()
        monkeypatch.setattr(registry, "engine", lambda engine: wrong if engine == name else real(engine))
        asked.first_run.cache_clear()
        try:
            clause(**{each: (values | {"engine": wrong})[each] for each in inspect.signature(clause).parameters})
        except Exception as error:
            return f"{type(error).__name__} {error}"
        return ""

    monkeypatch.setitem(registry.ENTRIES, name, registry.Entry("wrong", "", "numpy", "numpy", ""))
    assert fails(Fault(fault.clause)) == "", "an engine without a fault"
    assert fault.words in fails(fault) != ""


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return a folder in which both are installed, for this process and those that it begins."""
    points = dict(re.findall(r"^(\w+) = \"(\w+)\"$", PAGE, re.MULTILINE)) | {"noisy": "noisy", "crashing": "crashing"}
    modules = {"natural_coordinates": EXAMPLE, "noisy": NOISY, "sitecustomize": "import noisy", "crashing": CRASHING}
    install(tmp_path / "site", "acme", points, modules)
    plugged = {"linkage_crosscheck": "linkage_crosscheck.pytest_plugin"}
    install(tmp_path / "site", "plugged", plugged, group="pytest11")
    monkeypatch.setenv("PYTHONPATH", pathsep.join((str(tmp_path / "site"), str(ROOT))))
    monkeypatch.setattr(asked, "shipped", lambda: ("stephenson_six_bar", "four_bar"))
    monkeypatch.chdir(tmp_path)
    with known(tmp_path / "site", modules.keys() - {"sitecustomize"}):
        yield tmp_path


def test_the_example_keeps_to_the_contract(site: Path) -> None:
    assert len([line for line in EXAMPLE.splitlines() if line.strip()]) < 40
    reports = held("natural", site, "-k", "not test_process")
    assert reports.failed == {}
    assert "test_the_promise_is_kept[stephenson_six_bar]" in reports.passed


@SLOW
@pytest.mark.parametrize(
    "command",
    [
        "-m compare.run stephenson_six_bar --engines analytic,natural --samples 36 --check",
        f"-m pytest {' '.join(CONTRACT)} natural -k stephenson",
    ],
)
@pytest.mark.usefixtures("site")
def test_the_example_runs_by_the_commands_of_its_page(command: str) -> None:
    done = subprocess.run([sys.executable, *command.split()], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "natural " in done.stdout or "4 passed" in done.stdout


@SLOW
def test_an_engine_that_a_process_sees_too_much_of(site: Path) -> None:
    reports = held("noisy", site, "-k", "test_process")
    assert {*reports.failed} == PROCESS


def test_a_crash_shows_its_traceback_in_every_clause(site: Path, capfd: pytest.CaptureFixture[str]) -> None:
    reports = held("crashing", site, "-k", "test_a_shipped_scene_is_solved_or_refused")
    shown = f"{''.join(reports.failed.values())}{capfd.readouterr().err}"
    assert len(reports.failed) == 2
    assert shown.count('crashing.py", line 3, in build') >= 2
    assert "ZeroDivisionError: division by zero (crashing.py, line 3)" in shown
    assert not os.environ.get(TRACEBACK)

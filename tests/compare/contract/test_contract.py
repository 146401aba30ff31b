"""The contract: the shipped engines keep to it, and a wrong one fails each clause."""

import inspect
from pathlib import Path

import pytest

import scenes
from compare.contract import asked, test_motion, test_protocol, test_refusals
from compare.engines import registry
from tests.compare.contract.faults import FAULTS, Fault
from tests.comparisons import SLOW

ROOT = Path(__file__).parents[3]
CONTRACT = ("--pyargs", "compare.contract", "--engine")
CLAUSES = {
    name.removeprefix("test_"): clause
    for module in (test_motion, test_protocol, test_refusals)
    for name, clause in vars(module).items()
    if name.startswith("test_")
}


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

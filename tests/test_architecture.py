"""The arrows between the packages, and the protocol by which engines are reached: CI keeps both."""

import subprocess
import sys
from pathlib import Path
from typing import Any, Protocol

import pytest

from analytic import engine as analytic
from compare.engines import registry
from scenes import Engine, Request, Scene, Simulation
from sim_models.casadi import engine as casadi
from sim_models.exudyn import engine as exudyn
from sim_models.mujoco import engine as mujoco
from sim_models.multiprecision import engine as multiprecision
from sim_models.pinocchio import engine as pinocchio
from sim_models.pymunk import engine as pymunk

ROOT = Path(__file__).parents[1]
PACKAGES = ("analytic", "compare", "linkage_crosscheck", "papers", "scenes", "sim_models")
FORBIDDEN = {  # by module what it must not import
    "sim_models.exudyn.poses": "analytic.core.dyads sim_models.pymunk.constraints",
    "sim_models.pymunk.engine": "compare.engines.registry",
    "analytic.core.dyads": "sim_models.pymunk.engine analytic.way.slider analytic.recorded.program",
    "scenes.model.motion": "analytic",
    "scenes.scene": "compare.run",
    "compare.engines.registry": "sim_models.pymunk.settings",
    "compare.run": "papers.audit linkage_crosscheck.pytest_plugin",
    "compare.judge.checks": "analytic.solve compare.measure.speed.speed_table compare.measure.hard.case"
    " compare.measure.many.grid compare.judge.canaries.canaries compare.contract.asked",
    "compare.engines.runner": "compare.judge.measure compare.mechanics.reference",
    "compare.measure.speed.speed_table": "compare.measure.hard.case compare.study",
    "compare.measure.hard.case": "compare.measure.many.grid compare.judge.canaries.canaries",
    "compare.measure.many.grid": "compare.measure.speed.speed_table compare.report.pages.html",
    "compare.mechanics.reference": "compare.judge.checks",
    "compare.judge.canaries.canaries": "compare.measure.speed.speed_table",
    "compare.study": "compare.report.pages.html",
    "compare.report.pages.html": "compare.run",
    "compare.report.numbers": "compare.cli.report compare.ci.github",
    "compare.ci.github": "compare.cli.report",
    "compare.cli.report": "compare.run",
    "compare.report.pages.report": "papers.audit",
}
PAIRS = [(module, imported) for module, several in FORBIDDEN.items() for imported in several.split()]


def lint_imports(folder: Path) -> subprocess.CompletedProcess[str]:
    command = [str(Path(sys.executable).with_name("lint-imports")), "--no-cache"]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


def copy_sources(folder: Path) -> None:
    for path in (ROOT / "pyproject.toml", *(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))):
        target = folder / path.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(path.read_bytes())


def test_the_contracts_hold() -> None:
    result = lint_imports(ROOT)
    assert result.returncode == 0, result.stdout


@pytest.fixture(scope="module")
def complaints(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the report on a copy of the sources that has all forbidden lines in it."""
    folder = tmp_path_factory.mktemp("sources")
    copy_sources(folder)
    for module, imported in PAIRS:
        file = folder / f"{module.replace('.', '/')}.py"
        file.write_text(f"import {imported}\n{file.read_text(encoding='utf-8')}", encoding="utf-8")
    result = lint_imports(folder)
    assert result.returncode == 1
    return " ".join(result.stdout.split())


@pytest.mark.parametrize(("module", "imported"), PAIRS)
def test_a_forbidden_import_is_caught(module: str, imported: str, complaints: str) -> None:
    assert f"- {module} -> {imported} (l." in complaints


def test_a_module_without_a_layer_is_caught(tmp_path: Path) -> None:
    copy_sources(tmp_path)
    (tmp_path / "compare" / "another.py").touch()
    result = lint_imports(tmp_path)
    assert result.returncode == 1
    assert "compare.another" in result.stdout


def test_the_root_of_the_comparison_is_small() -> None:
    assert len(list((ROOT / "compare").glob("*.py"))) <= 6


def test_the_analytic_run_imports_no_other_engine(tmp_path: Path) -> None:
    code = (
        "import sys\nfrom compare.run import main\nfrom tests.comparisons import only_few_settings\n"
        f"with only_few_settings(): assert main(['--engines', 'analytic', '--out', {str(tmp_path)!r}]) == 0\n"
        "assert not {'exudyn', 'pymunk'} & set(sys.modules), 'imported'"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, cwd=ROOT)
    assert (tmp_path / "toggle_press" / "report.html").exists()


class Needed(Protocol):
    """What an engine's module has to have by itself."""

    DEFAULT: Any

    def build(self, scene: Scene, settings: Any, request: Request) -> Simulation: ...


# mypy holds each module to it
ENGINES: tuple[Needed, ...] = (analytic, exudyn, pymunk, casadi, mujoco, pinocchio, multiprecision)
# Constants that are no part of the protocol.
OF_THEIR_OWN = {"CONTACTS", "DRIVES", "JOINTS", "MIN_SPRING_LENGTH", "NEWTON", "NOTE", "RULES"}


def test_every_engine_has_all_of_the_protocol() -> None:
    members = {name for name in (*vars(Engine), *Engine.__annotations__) if not name.startswith("_")}
    assert {"DEFAULT", "at_steps", "build"} < members
    engines = [registry.engine(name) for name, entry in registry.ENTRIES.items() if not entry.outside]
    assert [engine.build for engine in engines] == [module.build for module in ENGINES]
    for engine, module in zip(engines, ENGINES, strict=True):
        assert members <= vars(engine).keys()
        assert {name for name in vars(module) if name.isupper()} - OF_THEIR_OWN <= members  # none is misspelt


@pytest.mark.parametrize("words", ["list", "--engines analytic --no-speed --samples 36"])
def test_what_a_report_needs_none_of_is_not_imported(words: str, tmp_path: Path) -> None:
    """Each of these takes longer to import than to find; a first run that is right meets none of them."""
    late = {
        *("analytic.proven.assemblies", "analytic.recorded.derivatives", "analytic.recorded.many"),
        *("analytic.recorded.streams", "compare.ci.baseline", "compare.judge.causes.evidence"),
        *("compare.judge.foreign", "compare.judge.triage", "numpy.ma", "pandas", "scipy"),
    }
    words = words.replace("--engines", f"--out {tmp_path} --engines")
    code = f"import sys; from compare.run import main; main({words.split()}); print({late} & {{*sys.modules}})"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert ran.stdout.splitlines()[-1] == "set()"

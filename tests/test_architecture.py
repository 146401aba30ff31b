"""The arrows between the packages, and the protocol by which engines are reached: CI keeps both."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import analytic.engine
import sim_models.casadi.engine
import sim_models.exudyn.engine
import sim_models.mujoco.engine
import sim_models.multiprecision.engine
import sim_models.pinocchio.engine
import sim_models.pymunk.engine
from compare.engines import registry
from scenes import Engine
from scenes.model.engine import Module

ROOT = Path(__file__).parents[1]
PACKAGES = ("analytic", "compare", "linkage_crosscheck", "papers", "scenes", "sim_models")


FORBIDDEN = {
    ("sim_models.exudyn.poses", "analytic.core.dyads"): "from analytic.core.dyads import dot",
    ("sim_models.exudyn.poses", "sim_models.pymunk.constraints"): "from ..pymunk import constraints",
    ("sim_models.pymunk.engine", "compare.engines.registry"): "import compare.engines.registry",
    ("analytic.core.dyads", "sim_models.pymunk.engine"): "import sim_models.pymunk.engine",
    ("analytic.core.dyads", "analytic.way.slider"): "from ..way import slider",
    ("analytic.core.dyads", "analytic.recorded.program"): "from ..recorded import program",
    ("scenes.model.motion", "analytic"): "import analytic",
    ("scenes.scene", "compare.run"): "import compare.run",
    ("compare.engines.registry", "sim_models.pymunk.settings"): "import sim_models.pymunk.settings",
    ("compare.run", "papers.page"): "import papers.page",
    ("compare.judge.checks", "analytic.solve"): "from analytic import solve",
    ("compare.engines.runner", "compare.judge.gates"): "from ..judge import gates",
    ("compare.judge.checks", "compare.measure.speed.timing"): "from ..measure.speed import timing",
    ("compare.judge.checks", "compare.measure.hard.case"): "from ..measure.hard import case",
    ("compare.judge.checks", "compare.measure.many.grid"): "from ..measure.many import grid",
    ("compare.measure.speed.timing", "compare.measure.hard.case"): "from ..hard import case",
    ("compare.measure.hard.case", "compare.measure.many.grid"): "from ..many import grid",
    ("compare.measure.many.grid", "compare.measure.speed.timing"): "from ..speed import timing",
    ("compare.engines.runner", "compare.mechanics.reference"): "from ..mechanics import reference",
    ("compare.mechanics.reference", "compare.judge.checks"): "from ..judge import checks",
    ("compare.judge.checks", "compare.judge.canaries.canaries"): "from .canaries import canaries",
    ("compare.judge.checks", "compare.contract.asked"): "from ..contract import asked",
    ("compare.judge.canaries.canaries", "compare.measure.speed.timing"): "from ...measure.speed import timing",
    ("compare.measure.hard.case", "compare.judge.canaries.canaries"): "from ...judge.canaries import canaries",
    ("compare.measure.speed.timing", "compare.study"): "from ... import study",
    ("compare.measure.many.grid", "compare.report.pages.html"): "from ...report.pages import html",
    ("compare.study", "compare.report.pages.html"): "from .report.pages import html",
    ("compare.report.pages.html", "compare.run"): "from ... import run",
    ("compare.report.numbers", "compare.cli.printing"): "from ..cli import printing",
    ("compare.report.numbers", "compare.ci.github"): "from ..ci import github",
    ("compare.ci.github", "compare.cli.printing"): "from ..cli import printing",
    ("compare.cli.printing", "compare.run"): "from .. import run",
    ("compare.run", "linkage_crosscheck.pytest_plugin"): "import linkage_crosscheck.pytest_plugin",
    ("compare.report.pages.report", "papers.page"): "import papers.page",
}  # importing and imported module -> line


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
    for (module, _), line in FORBIDDEN.items():
        file = folder / f"{module.replace('.', '/')}.py"
        file.write_text(f"{line}\n{file.read_text(encoding='utf-8')}", encoding="utf-8")
    result = lint_imports(folder)
    assert result.returncode == 1
    return " ".join(result.stdout.split())


@pytest.mark.parametrize(("module", "imported"), FORBIDDEN)
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


# --- the engines' protocol --------------------------------------------------------------------------------------------

ENGINES: tuple[Engine[Any], ...] = (  # mypy holds each module to the protocol
    analytic.engine,
    sim_models.exudyn.engine,
    sim_models.pymunk.engine,
    sim_models.casadi.engine,
    sim_models.mujoco.engine,
    sim_models.pinocchio.engine,
    sim_models.multiprecision.engine,
)


def test_every_engine_has_all_of_the_protocol() -> None:
    parts = (part for each in (Module, Engine) for part in (vars(each), each.__annotations__))
    members = {name for part in parts for name in part if not name.startswith("_")}
    assert {"DEFAULT", "at_steps", "build"} < members
    assert [registry.engine(name) for name, entry in registry.ENTRIES.items() if not entry.outside] == [*ENGINES]
    for engine in ENGINES:
        assert members <= vars(engine).keys()

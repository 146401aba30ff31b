"""The arrows between the packages: the models share nothing but the scene, and CI keeps it so."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("analytic", "compare", "papers", "scenes", "sim_models")


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


@pytest.mark.parametrize(
    ("module", "line"),
    [
        ("sim_models/exudyn/poses.py", "from analytic.dyads import dot"),
        ("sim_models/exudyn/poses.py", "from sim_models.pymunk import constraints"),
        ("analytic/dyads.py", "import sim_models.pymunk.engine"),
        ("scenes/motion.py", "import analytic"),
        ("compare/judge/checks.py", "from analytic import solve"),
        ("sim_models/pymunk/engine.py", "import compare.engines.registry"),
        ("compare/report/page.py", "import papers.page"),
    ],
)
def test_a_forbidden_import_is_caught(module: str, line: str, tmp_path: Path) -> None:
    copy_sources(tmp_path)
    file = tmp_path / module
    file.write_text(f"{line}\n{file.read_text(encoding='utf-8')}", encoding="utf-8")
    result = lint_imports(tmp_path)
    assert result.returncode == 1
    assert "BROKEN" in result.stdout


def test_the_analytic_run_imports_no_other_engine(tmp_path: Path) -> None:
    code = (
        "import sys; from compare.run import main; "
        f"assert main(['--engines', 'analytic', '--out', {str(tmp_path)!r}]) == 0; "
        "assert not {'exudyn', 'pymunk'} & set(sys.modules), 'imported'"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, cwd=tmp_path)
    assert (tmp_path / "toggle_press" / "report.html").exists()

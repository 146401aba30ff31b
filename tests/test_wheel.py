"""The wheel as users have it: what is in it, and the command beside files with the names of our packages."""

import os
import subprocess
import sys
import sysconfig
import tarfile
import tomllib
import venv
from collections.abc import Sequence
from pathlib import Path
from shutil import copy2
from zipfile import ZipFile

import numpy as np
import pytest

from tests.comparisons import SLOW, sampled

pytestmark = SLOW
ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
PACKAGES = PROJECT["tool"]["importlinter"]["root_packages"]
FOUR_BAR = ("four_bar", "--engines", "analytic,pymunk", "--samples", "36")


def run(command: Sequence[str | Path], folder: Path) -> str:
    """Return what a command prints, with the environment of a user who has set nothing for Python."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "COV"))}
    found = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
    return found.stdout


def built(what: str, source: Path, folder: Path) -> Path:
    """Return the file that `build_sdist` or `build_wheel` makes of a folder, with the setuptools that is installed."""
    run([sys.executable, "-c", f"from setuptools import build_meta as b; b.{what}({str(folder)!r})"], source)
    (file,) = folder.iterdir()
    return file


@pytest.fixture(scope="module")
def ours() -> set[str]:
    """Return the files of the checkout that git does not ignore."""
    listed = run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], ROOT)
    return {name for name in listed.split("\0") if (ROOT / name).is_file()}


@pytest.fixture(scope="module")
def checkout(ours: set[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a copy, since a checkout can have remains of earlier ones."""
    copied = tmp_path_factory.mktemp("checkout")
    for name in ours:
        (copied / name).parent.mkdir(parents=True, exist_ok=True)
        copy2(ROOT / name, copied / name)
    return copied


@pytest.fixture(scope="module")
def sdist(checkout: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built("build_sdist", checkout, tmp_path_factory.mktemp("sdist"))


@pytest.fixture(scope="module")
def wheel(sdist: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the wheel of the unpacked source distribution, as package indexes have it."""
    unpacked = tmp_path_factory.mktemp("unpacked")
    with tarfile.open(sdist) as archive:
        archive.extractall(unpacked, filter="data")
    (source,) = unpacked.iterdir()
    return built("build_wheel", source, tmp_path_factory.mktemp("wheel"))


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return an environment with the wheel, which sees the other packages of this one; nothing can be written there."""
    folder = tmp_path_factory.mktemp("environment")
    site = environment_with(wheel, folder)
    for path in [site, *site.rglob("*")]:
        path.chmod(0o555 if path.is_dir() else 0o444)
    return folder


def environment_with(wheel: Path, folder: Path) -> Path:
    """Return where packages are in a new environment with a wheel, which sees the other packages of this one."""
    venv.create(folder, symlinks=True)
    pip = f"{sys.executable} -m pip --python {folder} install --compile --no-deps --no-index {wheel}"
    run(pip.split(), folder)
    site = Path(sysconfig.get_path("purelib", "venv", {"base": str(folder)}))
    (site / "others.pth").write_text(str(Path(np.__file__).parents[1]), encoding="utf-8")
    return site


@pytest.fixture
def beside_hostile_files(tmp_path: Path) -> Path:
    for name in PACKAGES:
        (tmp_path / f"{name}.py").write_text("raise SystemExit('imported by mistake')", encoding="utf-8")
    return tmp_path


def files_of(environment: Path) -> dict[Path, float]:
    """Return when each file was last changed, but byte code, which nobody but root can write there."""
    return {path: path.stat().st_mtime for path in environment.rglob("*") if "__pycache__" not in path.parts}


def in_packages(names: set[str]) -> set[str]:
    return {name for name in names if name.split("/")[0] in PACKAGES}


def test_the_wheel_is_the_packages_and_nothing_else(wheel: Path, ours: set[str]) -> None:
    names = {name for name in ZipFile(wheel).namelist() if ".dist-info/" not in name}
    assert names == in_packages(ours)
    assert {f"{package}/py.typed" for package in PACKAGES} <= names


def test_the_source_distribution_has_the_packages_and_what_builds_them(sdist: Path, ours: set[str]) -> None:
    with tarfile.open(sdist) as archive:
        names = {file.name.split("/", 1)[1] for file in archive if file.isfile()}
    made = {"PKG-INFO", "setup.cfg"}
    names = {name for name in names if ".egg-info/" not in name} - made
    assert names == in_packages(ours) | {"LICENSE", "MANIFEST.in", "README.md", "pyproject.toml"}


def test_an_install_of_the_checkout_keeps_its_types(checkout: Path, tmp_path: Path) -> None:
    """What `pip install -e` makes is a path that mypy and editors follow, and no hook of the import system."""
    own = tmp_path / "own"
    own.mkdir()
    (tmp_path / "wheel").mkdir()
    environment_with(built("build_editable", checkout, tmp_path / "wheel"), tmp_path / "environment")
    lines = ["import analytic, compare, papers, scenes", 'scene = scenes.load("four_bar")', "reveal_type(scene)"]
    lines += ["reveal_type(analytic.solve(scene, [0.5]))", "reveal_type(compare.check(scene).ok)"]
    (own / "mine.py").write_text("\n".join(lines), encoding="utf-8")
    python = tmp_path / "environment" / "bin" / "python"
    mypy = f"{sys.executable} -m mypy --follow-imports=silent --cache-dir {tmp_path / 'cache'}"
    told = run([*mypy.split(), "--python-executable", python, "mine.py"], own)
    revealed = [line.split('"')[1] for line in told.splitlines() if "Revealed" in line]
    assert revealed == ["scenes.scene.Scene", "scenes.model.motion.Motion", "bool"]
    assert "Success" in told


@sampled(2)
@pytest.mark.parametrize(
    ("written", "options"),
    [("summary.json", ()), ("family.json", ("--vary", "bodies.rocker.lengths.C-B=245:250:2", "--workers", "2"))],
)
def test_the_command_beside_hostile_files(
    written: str, options: tuple[str, ...], installed: Path, beside_hostile_files: Path
) -> None:
    before = files_of(installed)
    run([installed / "bin" / "linkage-crosscheck", *FOUR_BAR, *options], beside_hostile_files)
    assert (beside_hostile_files / "results" / "four_bar" / written).stat().st_size
    assert files_of(installed) == before

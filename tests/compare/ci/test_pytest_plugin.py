"""The pytest plug-in in projects of their own, where it is installed by its entry point."""

import os
import subprocess
import sys
import tomllib
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import pytest

from compare.judge.measure import Gate, Miss
from linkage_crosscheck.pytest_plugin import ChannelGroup
from tests import scene_files
from tests.sites import install

ROOT = Path(__file__).parents[3]
GATES = {"tolerances": {"pymunk": {"position": 1e-15, "velocity": 1.0}}}
OFF = "pymunk position: "  # of its gate
OWN_NAMES = """import sys, compare, scenes
def test_own():
    assert compare.own and scenes.own
    assert not {'numpy', 'pandas', 'pydantic', 'analytic'} & sys.modules.keys()
def test_fixture(linkage_check):
    linkage_check('four_bar')
"""
CHECKS = """def test_fixture(linkage_check):
    result = linkage_check('others/slider_crank.toml', engines=('analytic',))
    assert result.ok and list(result.motions) == ['analytic']
def test_missing(linkage_check):
    linkage_check('missing.toml')
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """Return the folder of a project, beside one where the plug-in is installed."""
    points = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["entry-points"]["pytest11"]
    install(tmp_path / "site", "plugged", points, group="pytest11")
    (folder := tmp_path / "project").mkdir()
    (folder / "pyproject.toml").touch()
    return folder


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run pytest there, with warnings as errors, and with cheap engines."""
    known = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    cheap = ["--linkage-engines=analytic,pymunk", "--linkage-samples=8"]
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-W", "error", "-p", "no:cacheprovider", "-rA", *cheap, *arguments],
        cwd=folder,
        env={**known, "PYTHONPATH": os.pathsep.join((str(ROOT), str(folder.parent / "site")))},
        capture_output=True,
        text=True,
        check=False,
    )


def ended(printed: str, how: str) -> set[str]:
    return {line.split()[1] for line in printed.splitlines() if line.startswith(f"{how} ")}


def test_a_project_with_modules_of_the_same_names_is_undisturbed(project: Path) -> None:
    for name in ("analytic", "compare", "scenes", "sim_models"):
        (project / f"{name}.py").write_text("own = True\n", encoding="utf-8")
    (project / "test_own.py").write_text(OWN_NAMES, encoding="utf-8")
    scene_files.write(project, "slider_crank")
    result = run(project)
    assert ended(result.stdout, "PASSED") == {"test_own.py::test_own"}, result.stdout
    taken = f"linkage-crosscheck: 'analytic' is expected to be its own, found {project / 'analytic.py'}"
    assert taken in result.stdout.splitlines()


def test_a_scene_is_a_test_an_engine_and_group(project: Path) -> None:
    scene_files.write(project, "slider_crank", GATES)
    broken = scene_files.text("slider_crank").replace('"crank"', '"crnk"')
    (project / "broken.toml").write_text(broken, encoding="utf-8")
    more = ("-k", "not torque", "--continue-on-collection-errors", "--junitxml", "junit.xml")
    result = run(project, "slider_crank.toml", "broken.toml", *more)
    groups = ("position", "velocity", "acceleration", "reaction", "drive")
    tests = {f"slider_crank.toml::{engine}[{group}]" for engine in ("analytic", "pymunk") for group in groups}
    failed = "slider_crank.toml::pymunk[position]"
    assert ended(result.stdout, "PASSED") == tests - {failed} | {"slider_crank.toml::comparison"}, result.stdout
    assert ended(result.stdout, "FAILED") == {failed}
    lines = result.stdout.splitlines()
    at = lines.index(next(line for line in lines if line.startswith(OFF)))
    assert lines[at - 1].strip("_ ") == "slider_crank.toml pymunk[position]"
    assert lines[at + 1].startswith("likely cause: pymunk: ")
    assert f"{project / 'broken.toml'}: drive.body: no body 'crnk'; did you mean 'crank'?" in lines
    assert "Traceback" not in result.stdout
    assert ".py:" not in result.stdout
    failure = ElementTree.parse(project / "junit.xml").find(".//failure")
    assert failure is not None
    assert OFF in (failure.text or "")


JUDGEMENT = SimpleNamespace(
    verdicts={"exudyn": ("ok", ""), "pymunk": ("diverged", "it ran away"), "mine": ("crashed", "a bug")},
    misses=[
        Miss("pymunk", "position", "pymunk's gate"),
        Miss("exudyn", "reaction", "exudyn's gate"),
        Miss("mine", "", "mine: crashed: a bug"),
        Miss("analytic", "", "a doubt"),
        Miss("", "", "a canary"),
    ],
    causes={"pymunk": "the drive lags"},
)


@pytest.mark.parametrize(
    ("names", "lines"),
    [
        (("pymunk", "position"), ["pymunk's gate", "likely cause: the drive lags"]),
        (("pymunk", "reaction"), ["pymunk: diverged: it ran away", "likely cause: the drive lags"]),
        (("exudyn", "position"), []),
        (("exudyn", "reaction"), ["exudyn's gate"]),
        (("mine", "drive"), ["mine: crashed: a bug"]),
        (("comparison", ""), ["a doubt", "a canary"]),
    ],
)
def test_every_miss_fails_a_test(names: tuple[str, str], lines: list[str]) -> None:
    item = SimpleNamespace(_names=names)
    assert [*ChannelGroup._trouble(item, JUDGEMENT)] == lines  # type: ignore[arg-type]


def test_a_tolerance_that_is_not_held_is_skipped() -> None:
    gate = Gate("exudyn", "position", 1e-3, np.nan, "the reference is in doubt", held=False)
    judgement = SimpleNamespace(verdicts={"exudyn": ("ok", "")}, misses=[], causes={}, held=[gate])
    for group, skipped in (("position", True), ("velocity", False)):
        item = SimpleNamespace(_names=("exudyn", group), parent=SimpleNamespace(judgement=judgement))
        item._trouble = partial(ChannelGroup._trouble, item)  # type: ignore[arg-type]
        with pytest.raises(pytest.skip.Exception) if skipped else nullcontext() as why:
            ChannelGroup.runtest(item)  # type: ignore[arg-type]
        assert not why or str(why.value) == "not held: exudyn position: a tolerance of 1e-03; the reference is in doubt"


@pytest.mark.slow
def test_in_parallel_by_pattern_and_name(project: Path) -> None:
    patterns = "[tool.pytest.ini_options]\nlinkage_scenes = 'machines/*.toml pyproject.toml'\n"
    (project / "pyproject.toml").write_text(patterns, encoding="utf-8")
    for folder in ("machines", "others"):
        (project / folder).mkdir()
        scene_files.write(project / folder, "slider_crank", GATES)
    (project / "test_own.py").write_text(CHECKS, encoding="utf-8")
    result = run(project, "-n", "2", "--dist", "loadfile", "--strict-markers")
    failed = {"machines/slider_crank.toml::pymunk[position]", "test_own.py::test_missing"}
    assert ended(result.stdout, "FAILED") == failed, result.stdout
    assert len(ended(result.stdout, "PASSED")) == 13 - 1 + 1
    assert "missing.toml: no such scene or file" in result.stdout
    assert not result.stdout.count("pyproject.toml:")
    named = run(project, ".", "others/slider_crank.toml", "-m", "linkage", "-k", "comparison or pymunk and position")
    both = [f"{folder}/slider_crank.toml" for folder in ("machines", "others")]
    assert ended(named.stdout, "FAILED") == {f"{scene}::pymunk[position]" for scene in both}
    assert ended(named.stdout, "PASSED") == {f"{scene}::comparison" for scene in both}


@pytest.mark.slow
def test_a_bad_option_and_what_cannot_be_solved_are_named_in_a_line(project: Path) -> None:
    scene_files.write(project, "slider_crank", {"bodies.rod.lengths.A-B": 0.5})
    result = run(project, "slider_crank.toml", "--linkage-samples=3")
    assert "expected a whole number from 8 to 100000, found '3'\n" in result.stdout
    assert "usage" not in result.stdout
    assert result.returncode == 2
    result = run(project, "slider_crank.toml")
    assert not ended(result.stdout, "PASSED")
    assert len(ended(result.stdout, "FAILED")) == 13
    assert "Traceback" not in result.stdout
    assert ".py:" not in result.stdout

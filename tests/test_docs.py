"""README and docs/: what they show runs, in the order of the page, and what is made from the code is as the code is."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

import scenes
from benchmarks.publishing.reference import PAGE, page
from compare.run import main
from scenes.elements import PLAIN_KINDS
from tests import scene_files
from tests.comparisons import SLOW

ROOT = Path(__file__).parents[1]
BLOCK = re.compile(r"^```(console|python)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
COMMAND = re.compile(r"^\$ (.*?)(?:  # exit (\d+))?$", re.MULTILINE)
RUN = re.compile(r"(linkage-crosscheck|python -m compare\.run)\b")
SHOWN = {path.name: BLOCK.findall(path.read_text("utf-8")) for path in [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md")]}
QUICK = {"README.md"}  # the pages that are run by default


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in QUICK else SLOW) for n, blocks in SHOWN.items() if blocks]
)
@pytest.mark.usefixtures("few_settings")
def test_what_a_page_shows_runs(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    names: dict[str, Any] = {}
    for kind, text in SHOWN[name]:
        if kind == "python":
            exec(compile(text, name, "exec"), names)
        for command, status in COMMAND.findall(text):
            assert ended(command) == int(status or 0), command


def ended(command: str) -> int:
    """Return the exit status of a command; the product's own runs here, with few settings and no further imports."""
    own = RUN.match(command)
    return main(shlex.split(command[own.end() :])) if own else subprocess.run(command, shell=True).returncode


def test_the_reference_is_as_the_code() -> None:
    assert PAGE.read_text("utf-8") == page(), "python -m benchmarks.publishing.reference"


@SLOW
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    built = f"{sys.executable} -m mkdocs build --config-file {ROOT / 'mkdocs.yml'} --site-dir {tmp_path}"
    environment = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
    found = subprocess.run(built.split(), capture_output=True, text=True, env=environment)
    assert found.returncode == 0, found.stderr
    theory = (tmp_path / "theory" / "index.html").read_text("utf-8")
    assert "<math" in theory
    assert "arithmatex" not in theory
    assert (tmp_path / "published" / "first_screen.svg").exists()


def test_the_friction_of_the_tutorial_is_a_toggle_press(tmp_path: Path) -> None:
    tutorial = (ROOT / "docs" / "tutorial.md").read_text("utf-8")
    (block,) = re.findall(r"^```toml\n(\[\[friction\]\]\n.*?)^```$", tutorial, re.MULTILINE | re.DOTALL)
    file = tmp_path / "rubbing.toml"
    file.write_text(scene_files.text("toggle_press").replace("[sketch]", f"{block}\n[sketch]", 1), encoding="utf-8")
    assert [one.channel(scene) for scene in (scenes.load(file),) for one in scene.friction] == [
        "P3.friction_moment",
        "slider.friction_force",
    ]


def test_the_optional_engines_solve_what_the_page_promises() -> None:
    """Of each shipped scene the published table has a row of each engine that is ok, or the engine does not know it."""
    table = (ROOT / "results" / "published" / "formulations.md").read_text("utf-8").partition("## Speed")[0]
    rows = {(engine, scene) for engine, scene in re.findall(r"^\| (\w+) +\| (\w+) +\| ok ", table, re.MULTILINE)}
    known = [name for name in scenes.shipped() if scenes.load(name).kinds <= PLAIN_KINDS]
    assert rows == {(engine, name) for engine in ("casadi", "mujoco", "pinocchio") for name in known}


def test_every_shipped_scene_is_on_the_page_of_scenes() -> None:
    page = (ROOT / "docs" / "scenes.md").read_text("utf-8").partition("`scenes/library/hard/`")[0]
    assert {*scenes.shipped()} == {*re.findall(r"`(\w+)`", "".join(re.findall(r"^\| (`.*?) \|", page, re.MULTILINE)))}

"""Scenes that cannot run: each has a page, and the others of a batch go on."""

import json
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from math import radians
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import analytic
from compare.mechanics.reference import uncertified
from compare.report.linkage.still import sketched, stopped
from compare.run import main
from scenes import Failure, Scene
from scenes.model.enclosures import MotionRange
from tests import scene_files
from tests.comparisons import sampled

SHORT = {"bodies.rocker.lengths.O-P3": 30}  # the press goes only part of a turn
LOOSE = {"bodies.crank.lengths.O-A": 1000}  # the four-bar never assembles
MARK = ".//{*}circle[@class='sign mark']"


def way_of(scene: Scene) -> MotionRange | None:
    with pytest.raises(Failure) as caught:
        uncertified(scene)
    return analytic.stopped(scene, caught.value.at)


def test_the_pose_where_it_stops_is_singular() -> None:
    """The rocker and the toggle are in line: O-P3 + P3-P2 is the distance of O and P2."""
    way = way_of(scene_files.load("toggle_press", SHORT))
    assert way is not None
    assert way.joint == "P3"
    assert np.degrees(way.ways) == pytest.approx(np.array([[12.8552, 66.1809]]), abs=1e-4)
    at = {point: way.motion[f"{point}.x"] + 1j * way.motion[f"{point}.y"] for point in ("P2", "P3")}
    assert abs(at["P2"][0]) == pytest.approx(0.03 + 0.49, abs=1e-8)
    assert np.abs(at["P3"]) == pytest.approx(0.03, abs=1e-12)
    assert np.degrees(way.motion["crank_angle"][[0, -1]]) == pytest.approx([12.8552, 66.1809], abs=1e-4)


@sampled(2)
@pytest.mark.parametrize(
    ("name", "joint", "ends"),
    [
        ("parallelogram", "C", (1.0, np.pi)),
        ("slotted_crank", "P", (0.197396, 3.338988)),
        ("jumps", "B", (radians(-109.0897), radians(72.0069))),
    ],
)
def test_how_far_it_goes(name: str, joint: str, ends: tuple[float, float]) -> None:
    """At a change point it goes from the drive's start; guides become parallel; a larger group ends."""
    way = way_of(scene_files.load(name))
    assert way is not None
    assert way.joint == joint
    assert np.array(way.ways) == pytest.approx(np.array([ends]), abs=1e-6)
    assert all(np.isfinite(samples).all() for samples in way.motion.samples.values())


def test_what_jams_at_its_start_goes_nowhere_and_has_a_pose() -> None:
    way = way_of(scene_files.load("drawer", {"friction.0.length": 0.05}))
    assert way is not None
    assert (way.joint, way.ways) == ("", [])
    assert way.motion["drive.displacement"][0] == pytest.approx(0.7)


@pytest.mark.parametrize(("name", "changes"), [("held_twice", {}), ("parallel_bars", {}), ("four_bar", LOOSE)])
def test_without_a_pose_there_is_the_sketch(name: str, changes: scene_files.Changes) -> None:
    scene = scene_files.load(name, changes)
    assert way_of(scene) is None
    svg = ElementTree.fromstring(sketched(scene, "B"))
    assert {text.text for text in svg.iterfind(".//{*}text")} == {*scene.drawn}
    assert len(svg.findall(MARK)) == 1
    bars = [path.get("d", "").count("L") for path in svg.iterfind(".//{*}path[@class='sketch']")]
    assert min(bars) == 1, "a bar that is drawn to and fro is not dashed"


@pytest.mark.usefixtures("few_settings")
def test_the_sketch_has_its_ring_in_words(tmp_path: Path) -> None:
    file = scene_files.write(tmp_path, "four_bar", LOOSE)
    assert main([str(file), "--engines", "analytic", "--out", str(tmp_path)]) == 2
    page = (tmp_path / "four_bar" / "report.html").read_text(encoding="utf-8")
    assert "this is the sketch alone; ringed: the joint that does not close, B." in page


@pytest.mark.usefixtures("few_settings")
def test_a_joint_where_assemblies_meet_is_not_called_open(tmp_path: Path) -> None:
    file = scene_files.write(tmp_path, "parallelogram", {"drive.start": 0})
    assert main([str(file), "--engines", "analytic", "--out", str(tmp_path)]) == 2
    page = (tmp_path / "parallelogram" / "report.html").read_text(encoding="utf-8")
    assert "ringed: where another way of assembling the bodies meets this one, C." in page
    assert "does not close" not in page


def test_what_is_refused_is_printed_before_its_report(tmp_path: Path) -> None:
    file = scene_files.write(tmp_path, "parallelogram", {"drive.start": 0})
    printed = StringIO()
    with redirect_stdout(printed), redirect_stderr(printed):
        assert main([str(file), "--engines", "analytic", "--out", str(tmp_path)]) == 2
    refused, *files = printed.getvalue().splitlines()[-3:]
    assert refused.startswith(f"{file}: bodies: cannot_assemble: two ways of assembling")
    assert [line.partition(":")[0] for line in files] == ["report", "index"]


def test_the_joint_is_marked_where_it_is_drawn() -> None:
    """That of a guide at its slider's first point."""
    for name, changes, point in (("toggle_press", SHORT, "P3"), ("slotted_lever", {}, "A")):
        scene = scene_files.load(name, changes)
        way = way_of(scene)
        assert way is not None
        svg = ElementTree.fromstring(stopped(scene, way))
        (group,) = [group for group in svg.iter() if group.find("{*}circle[@class='sign mark']") is not None]
        assert group.get("transform") in {of.get("transform") for of in svg.iterfind(f".//*[@data-point='{point}']")}
        ghost = svg.find(".//*[@class='ghost']")
        assert ghost is not None
        assert "visibility" not in ghost.attrib


@sampled(1)
@pytest.mark.usefixtures("few_settings")
@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 1, 2, 0)], ids=["bad ones first", "bad ones last"])
def test_the_others_of_a_batch_go_on(
    order: tuple[int, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The status is 2 with a tolerance missed too."""
    (tmp_path / "broken.toml").write_text("format = \n", encoding="utf-8")
    held = {"name": "strict", "tolerances": {"analytic": {"position": 1e-99}}}
    files = [
        str(tmp_path / "broken.toml"),
        str(scene_files.write(tmp_path, "toggle_press", SHORT)),
        "four_bar",
        str(scene_files.write(tmp_path, "slider_crank", held)),
    ]
    asked = [
        "--engines",
        "analytic",
        "--samples",
        "24",
        "--check",
        "--format",
        "github",
        "--out",
        str(tmp_path / "out"),
    ]
    assert main([*(files[number] for number in order), *asked]) == 2
    out, err = capsys.readouterr()
    assert [line.partition(": ")[0] for line in err.splitlines()] == files[:2]
    assert "strict  missed: analytic position" in out
    assert sum(line.startswith("::error ") for line in out.splitlines()) == 3
    made = {name: {path.name for path in (tmp_path / "out" / name).iterdir()} for name in ("toggle_press", "four_bar")}
    assert made["toggle_press"] == {"report.html", "summary.json"}
    assert "motion.analytic.csv" in made["four_bar"]


@pytest.mark.usefixtures("few_settings")
def test_it_takes_the_place_of_a_report_and_names_what_changed(tmp_path: Path) -> None:
    asked = ["--engines", "analytic", "--samples", "24", "--out", str(tmp_path / "out")]
    folder, file = tmp_path / "out" / "toggle_press", str(scene_files.path("toggle_press"))
    assert main([file, *asked]) == 0
    file = str(scene_files.write(tmp_path, "toggle_press", SHORT))
    (folder / "notes.txt").write_text("the user's own", encoding="utf-8")
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    summary["made_from"] = str(tmp_path / "gone.toml")
    (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
    assert main([file, *asked]) == 2
    assert {path.name for path in folder.iterdir()} == {"report.html", "summary.json", "notes.txt"}
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    worse, given = summary["since_last_run"]
    assert worse == {"text": "it does not run", "worse": True}
    assert given["text"].startswith("scene.bodies.rocker.lengths.O-P3 30 mm, was 300 mm")
    assert summary["verdict"]["word"] == "not_solved"
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "rocker and toggle in line at P3" in page
    assert summary["verdict"]["sentence"].startswith("The bodies cannot be put together at some position of the drive:")
    for machine_words in ("cannot_assemble", "toggle_press.toml: "):
        assert machine_words not in page
    assert "lengths.O-P3 30 mm, was 300 mm" in page


@pytest.mark.parametrize("name", ["redundant", "parallel_bars"])
def test_no_assemblies_are_a_line_too(name: str, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main([str(scene_files.path(name)), "four_bar", "--assemblies", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert (tmp_path / "four_bar" / "assemblies.html").exists()

"""An earlier run beside a later one in its page: the numbers before, and the curves and the picture as a ghost."""

import json
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from compare.judge.peaks.peaks import Peak
from compare.report.output.earlier import SummaryPeak, at_positions, before, summary_of
from compare.report.tables.first_screen import answers
from compare.run import main
from scenes import Motion, load
from tests import scene_files
from tests.comparisons import Studies, only_few_settings
from tests.pages import unpacked

LONGER = {"bodies.rocker.lengths.C-B": 260, "ground.points.C": [210, 0]}


def ran(out: Path, changes: scene_files.Changes, *more: str, engines: str = "analytic", samples: int = 48) -> Path:
    """The folder of a report of the four-bar with changes."""
    out.mkdir(exist_ok=True)
    file = scene_files.write(out, "four_bar", changes)
    with only_few_settings():
        assert main([str(file), "--engines", engines, "--samples", f"{samples}", "--out", str(out), *more]) == 0
    return out / "four_bar"


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The folders of an earlier run and of one against it, of other lengths and fewer samples."""
    place = tmp_path_factory.mktemp("against")
    old = ran(place / "old", {})
    return old, ran(place / "new", LONGER, "--against", str(place / "old"), engines="analytic,pymunk", samples=36)


def test_the_numbers_before(both: tuple[Path, Path]) -> None:
    old, new = (json.loads((folder / "summary.json").read_text(encoding="utf-8")) for folder in both)
    was, now = (next(p["value"] for p in s["peaks"] if p["name"] == "stroke") for s in (old, new))
    page = (both[1] / "report.html").read_text(encoding="utf-8")
    change = f"{100 * (now / was - 1):+.3g}".replace("-", "−")
    assert f"<td>{1e3 * was:.1f} mm ({change}\u00a0%)</td>" in page
    assert page.count('<th scope="col">before</th>') == 2, "of the whole linkage and of every joint"
    assert any("lengths.B-C 260 mm, was 250 mm" in change["text"] for change in new["since_baseline"])
    assert "before</th>" not in (both[0] / "report.html").read_text(encoding="utf-8")


def summary_peak(name: str, of: str, value: float) -> SummaryPeak:
    return SummaryPeak(name=name, of=of, channel=f"{of}.fx", value=value, unit="N", differs={})


@pytest.mark.parametrize(
    ("was", "shown"),
    [
        ([("A", 50.0), ("B", 80.0)], ["80.00 N (+25\u00a0%)", "50.00 N (+100\u00a0%)", "80.00 N (+25\u00a0%)"]),
        ([("A", 200.0)], ["200.0 N (−50\u00a0%)", "200.0 N (−50\u00a0%)", ""]),
        ([("B", 100.0 * (1 + 1e-12))], ["same", "", "same"]),
        ([("B", 0.0)], ["0", "", "0"]),
        ([], ["", "", ""]),
    ],
)
def test_the_largest_pin_force_is_beside_the_largest_then(was: list[tuple[str, float]], shown: list[str]) -> None:
    """Which was at another pin."""
    peaks = [Peak("force", of, f"{of}.fx", 100.0 - (of == "A") * 1e-9, "N", 0.0, 0.0, {}) for of in "AB"]
    earlier = [summary_peak("force", of, value) for of, value in was]
    (largest,), joints = answers(load("four_bar"), peaks, {}, earlier)
    assert [largest.before, *(joint.before for joint in joints)] == shown


def test_the_curves_before(both: tuple[Path, Path]) -> None:
    """Dashed in every panel, each sample of the earlier run."""
    _, *figures = unpacked((both[1] / "report.html").read_text(encoding="utf-8"))
    ghosts = [[trace for trace in json.loads(figure)["data"] if trace["name"] == "before"] for figure in figures]
    assert sum(map(bool, ghosts)) == 8
    assert all(trace["line"]["dash"] == "dash" for some in ghosts for trace in some)


def test_samples_at_other_positions() -> None:
    """Straight between, in whatever order the positions come; nothing beyond the ends; of a time of the later run."""
    earlier = Motion({"crank_angle": np.array([2.0, 1.0, 0.0]), "B.x": np.array([20.0, 10.0, 0.0])})
    later = Motion({"crank_angle": np.array([0.5, 1.5, 3.0]), "time": np.array([1.0, 2.0, 3.0])})
    at = at_positions(load("four_bar"), earlier, later)
    assert at["B.x"] == pytest.approx([5.0, 15.0, np.nan], nan_ok=True)
    assert at["time"] is later["time"]


def test_a_turn_that_began_elsewhere_goes_on() -> None:
    """Of a crank that began a third of a turn further: no gap, no jump, and its angle is of the later turn."""
    scene = load("four_bar")
    begun = np.linspace(2.0, 2.0 + 2 * np.pi, 721)
    earlier = Motion({"crank_angle": begun, "B.x": np.cos(begun), "crank.angle": begun, "time": begun - 2.0})
    position = np.linspace(0.0, 2 * np.pi, 91)
    at = at_positions(scene, earlier, Motion({"crank_angle": position, "time": position}))
    assert at["B.x"] == pytest.approx(np.cos(position), abs=1e-4)  # straight between: (2 pi / 720)^2 / 8
    assert at["crank.angle"] == pytest.approx(position, abs=1e-12)
    part = Motion({name: values[:700] for name, values in earlier.samples.items()})
    assert np.isnan(at_positions(scene, part, Motion({"crank_angle": position, "time": position}))["B.x"]).any()


@pytest.mark.parametrize(
    "text", [None, "", "time [s]\n", "time [s],crank_angle [rad]\n1,2,3\n", "a\nb\n", "\0", "time [s]\n1\n2,3\n"]
)
def test_without_a_motion_the_numbers_are_shown(text: str | None, both: tuple[Path, Path], tmp_path: Path) -> None:
    scene = load("four_bar")
    (folder := tmp_path / "four_bar").mkdir()
    shutil.copy(both[0] / "summary.json", folder)
    if text is not None:
        (folder / "motion.analytic.csv").write_text(text, encoding="utf-8")
    for path in (tmp_path, folder / "summary.json"):
        found = before(summary_of(folder / "summary.json"), path, scene)
        assert found.ground == {"O": (0.0, 0.0), "C": (0.2, 0.0)}
        assert len(found.peaks) > 5
        assert not found.motion.samples


@pytest.mark.parametrize("ground", [None, [], {"O": 1}, {"O": [1, 2, 3]}, {"O": ["x", 1]}])
def test_a_summary_whose_scene_is_no_scene(ground: Any, both: tuple[Path, Path]) -> None:
    known = summary_of(both[0] / "summary.json")
    known.scene["ground"] = ground
    assert before(known, both[0].parent, load("four_bar")).ground == {}


def test_the_page_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old = ran(tmp_path, {})
    (old / "motion.analytic.csv").unlink()
    page = (ran(tmp_path, {}, "--against", str(old / "summary.json")) / "report.html").read_text(encoding="utf-8")
    assert "of the run before no motion is at hand" in capsys.readouterr().out
    assert "<td>same</td>" in page


def test_bad_arguments(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for words, expected in (
        (["--against", "old.json"], "--against: old.json: cannot be read"),
        (["--against", "a", "--baseline", "b"], "not allowed with argument"),
        (["--against", "a", "--vary", "drive.speed=1:2:3"], "--against: expected it without --vary"),
    ):
        assert main(["four_bar", *words, "--out", str(tmp_path / "out")]) == 2
        assert expected in capsys.readouterr().err


def test_a_report_alone_has_no_ghost(studies: Studies) -> None:
    from compare.report.pages.report import page

    assert "dashed: before" not in page(studies("toggle_press"))

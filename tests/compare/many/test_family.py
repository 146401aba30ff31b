"""A family by the command line: its files, its exit status, and what a stop leaves."""

import json
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import scenes
from compare.measure.many import family
from compare.measure.many.grid import variation
from compare.report.figures.many import curves, over_number
from compare.report.tables import family as family_tables
from compare.run import main
from tests import scene_files
from tests.comparisons import SLOW
from tests.pages import unpacked, without_scripts

from .runs import CRANK_SLIDER, run

pytestmark = pytest.mark.usefixtures("few_settings")


def test_the_files_of_a_family(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rod, offset = "bodies.rod.lengths.A-B", "bodies.slider.slides.through.1"
    arguments = [str(CRANK_SLIDER), "--vary", f"{rod}=130:250:2", "--vary", f"{offset}=0:40:2", "--engines", "analytic"]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 0
    folder = tmp_path / "out" / "offset_slider_crank"
    assert sorted(path.name for path in folder.iterdir()) == ["family.csv", "family.html", "family.json"]
    table = pd.read_csv(folder / "family.csv")
    assert table[[rod, offset]].to_numpy().tolist() == [[130, 0], [130, 40], [250, 0], [250, 40]]
    assert list(table["status"]) == ["ok", "cannot_assemble", "ok", "ok"]
    assert table["stroke [m]"].tolist() == pytest.approx([0.2, np.nan, 0.2, 0.2031], abs=1e-4, nan_ok=True)
    assert (table["analytic error"].dropna() < 1e-12).all()
    page = (folder / "family.html").read_text(encoding="utf-8")
    assert '<script src="' not in page
    assert "<link" not in page.split("</script>")[-1]
    assert "{{" not in without_scripts(page), "a piece of the template is left"
    for said in ("A-B = 130, slider.slides.through.1 = 40", "cannot_assemble", "stroke [mm]", "203.14", "kN"):
        assert said in page
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 6
    assert lines[0].startswith("offset_slider_crank  A-B = 130, slider.slides.through.1 = 0  ok  stroke 200.00 mm")
    assert "cannot_assemble" in lines[1]
    summed_up = "Members that do not run: 1 of 4, first A-B = 130, slider.slides.through.1 = 40 (cannot_assemble)."
    assert lines[-2].startswith(f"offset_slider_crank  agrees in part: {summed_up} ")
    assert summed_up in without_scripts(page).partition("Members</h2>")[0], "not first on the page"
    assert lines[-1] == f"family: {folder / 'family.html'}"


def test_check_names_the_member_that_misses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rod = "bodies.rod.lengths.A-B"
    arguments = ["--engines", "exudyn", "--samples", "36", "--out", str(tmp_path / "out"), "--check"]
    fine = [str(CRANK_SLIDER), *arguments, "--vary", f"{rod}=100:300:2"]
    assert main(fine) == 0, "a member that cannot run misses nothing"
    capsys.readouterr()
    strict = scene_files.write(tmp_path, "offset_slider_crank", {"tolerances.exudyn.position": 1e-19})
    arguments = [str(strict), *arguments[:-2], str(tmp_path / "of another file"), "--check"]
    assert main([*arguments, "--vary", f"{rod}=100:300:2"]) == 1
    (missed,) = [line for line in capsys.readouterr().out.splitlines() if "missed" in line]
    assert missed.startswith("offset_slider_crank  A-B = 300  missed: exudyn position")
    assert main([*arguments, "--vary", f"{rod}=80:100:2"]) == 1
    assert "no member runs" in capsys.readouterr().out


def test_a_stopped_family_keeps_what_is_done_and_does_not_replace_a_complete_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stopping(*arguments: object) -> object:
        if next(left, None) is None:
            raise KeyboardInterrupt
        return solve_member(*arguments)  # type: ignore[arg-type]

    solve_member = family._member
    monkeypatch.setattr(family, "_member", stopping)
    arguments = [str(CRANK_SLIDER), "--vary", "drive.speed=10:50:2", "--engines", "analytic", "--out", str(tmp_path)]
    place, partial = tmp_path / "offset_slider_crank", tmp_path / "offset_slider_crank.partial"
    for members, status in ((2, 0), (1, 130)):
        left = iter(range(members))
        assert main(arguments) == status
        assert json.loads((place / "family.json").read_text(encoding="utf-8"))["complete"]
    assert not json.loads((partial / "family.json").read_text(encoding="utf-8"))["complete"]
    assert len(pd.read_csv(place / "family.csv")) == 2
    assert len(pd.read_csv(partial / "family.csv")) == 1
    assert f"stopped; {partial / 'family.html'} has the 1 of 2 members" in capsys.readouterr().err
    assert "Stopped after 1 of 2 members" in (partial / "family.html").read_text(encoding="utf-8")
    left = iter(range(2))
    assert main(arguments) == 0
    assert list(tmp_path.iterdir()) == [place]


def page_of(folder: Path, vary: str) -> str:
    arguments = [str(CRANK_SLIDER), "--engines", "analytic", "--out", str(folder / "out"), "--vary", vary]
    assert main(arguments) == 0
    return (folder / "out" / "offset_slider_crank" / "family.html").read_text(encoding="utf-8")


def test_a_family_without_any_member_that_runs(tmp_path: Path) -> None:
    page = page_of(tmp_path, "bodies.rod.lengths.A-B=20:30:2")
    assert "Members that do not run: 2 of 2, first A-B = 20 (cannot_assemble)." in page
    assert "cannot_assemble" in page


@SLOW
def test_many_members_are_drawn_in_part(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("figures.many", "pages.many"):
        monkeypatch.setattr(f"compare.report.{module}.MAX_LINES", 5)
    page = page_of(tmp_path, "drive.speed=10:17:8")
    assert "5 of the 8 members that run" in page
    curves = unpacked(page)[1]
    drawn = {value for value in range(10, 18) if f'"name":"drive.speed = {value}"' in curves}
    assert len(drawn) == 5
    assert {10, 17} <= drawn
    assert all(b - a <= 2 for a, b in pairwise(sorted(drawn)))


def test_numbers_over_what_varies() -> None:
    """A line for each value of what else varies, of the file's numbers; a gap where a member does not run."""
    varied = [variation("bodies.rocker.lengths.O-P3=250:310:4"), variation("drive.speed=30:60:2")]
    press = scenes.load("toggle_press")
    of = family.Family(press, varied, ["analytic"])
    of.members.extend(run(press.file, [f"{v.path}={v.values[0]:g}:{v.values[-1]:g}:{len(v.values)}" for v in varied]))
    traces = over_number(of).traces
    assert [trace["name"] for trace in traces] == 4 * ["drive.speed = 30", "drive.speed = 60"]
    stroke, *_ = traces
    assert list(stroke["x"]) == [250, 270, 290, 310]
    assert np.isnan(stroke["y"]).tolist() == [True, False, False, False]
    for trace, kind in zip(
        traces[::2], ("stroke", "largest force", "peak driving torque", "peak braking torque"), strict=True
    ):
        values = [m.numbers[kind].value for m in of.members if m.cycle and m.changes["drive.speed"] == 30]
        assert trace["y"][1:] / trace["y"][1] == pytest.approx(np.array(values) / values[0])
    assert stroke["y"][-1] == pytest.approx(163.6, abs=0.5), "mm"


def test_one_unit_a_quantity_in_tables_and_figures() -> None:
    """At 55 rpm the press drives with 9.6 kN m and brakes with 11.7: each alone would have another unit."""
    varied, press = [variation("drive.speed=50:55:2")], scenes.load("toggle_press")
    of = family.Family(press, varied, ["analytic"])
    of.members.extend(run(press.file, ["drive.speed=50:55:2"]))
    shown = [*next(iter(family_tables.overview(of)))]
    for figure in (curves(of), over_number(of)):
        shown += [axis["title"]["text"] for name, axis in figure.layout.items() if name.startswith("yaxis")]
    units = [text.partition("[")[2].rstrip("]") for text in shown]
    assert {unit for unit in units if unit.endswith("N m")} == {"kN m"}
    assert {unit for unit in units if unit.endswith("m/s²")} == {"mm/s²"}


def test_a_drive_that_only_drives_brakes_by_zero() -> None:
    """Which is `0`, in the unit of the torque that there is."""
    of = family.Family(scenes.load("four_bar"), [variation("drive.speed=-60:-50:2")], ["analytic"])
    of.members.extend(run("four_bar", ["drive.speed=-60:-50:2"]))
    for member in of.members:
        assert member.judgement is not None
        numbers = member.judgement.peaks
        member.judgement.peaks[:] = [replace(p, value=0.0) if "braking" in p.name else p for p in numbers]
    assert {row["peak braking torque [N m]"] for row in family_tables.overview(of)} == {"0"}

"""A result says which scene file it is of, and another file of the same name does not take its place."""

import json
import os
from pathlib import Path

import pytest

import scenes
from compare.report.output.files import REPORT, _may_be_complete, check_origin, origin
from compare.run import main
from scenes import InputError
from tests import scene_files

ASKED = ["--engines", "analytic", "--samples", "8", "--channels", "A.x", "--out", "out"]


@pytest.mark.usefixtures("few_settings")
def test_another_file_of_the_same_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    for folder, units in (("one", "m"), ("other", "mm")):
        Path(folder).mkdir()
        scene_files.write(Path(folder), "slider_crank", {"units": {"length": units}})
    assert main(["one/slider_crank", *ASKED]) == 0
    summary = Path("out/slider_crank/summary.json")
    written = summary.read_bytes()
    assert json.loads(written)["made_from"] == "../../one/slider_crank.toml"
    capsys.readouterr()
    varied = ["--vary", "drive.speed=1:2:2", "--engines", "analytic", "--out", "out"]
    for arguments in (ASKED, varied):  # a family's results go to the same folder
        assert main(["other/slider_crank.toml", *arguments]) == 2
        assert capsys.readouterr().err == (
            f"other/slider_crank.toml: name: 'slider_crank' is that of {tmp_path.resolve()}/one/slider_crank.toml too,"
            " whose result is in out/slider_crank; expected another name, or another --out\n"
        )
    assert summary.read_bytes() == written
    check_origin(scenes.load("one/slider_crank"), Path("out/slider_crank"))
    Path("one").rename("moved")  # nobody's any more
    check_origin(scenes.load("other/slider_crank"), Path("out/slider_crank"))


def test_a_shipped_scene_and_a_copy_of_it(tmp_path: Path) -> None:
    shipped, place = scenes.load("four_bar"), tmp_path / "four_bar"
    place.mkdir()
    (place / "family.json").write_text(json.dumps({"made_from": origin(shipped, place)}), encoding="utf-8")
    check_origin(scenes.load(scenes.shipped()["four_bar"]), place)
    with pytest.raises(InputError, match="'four_bar' is that of four_bar too, whose result is in"):
        check_origin(scenes.load(scene_files.write(tmp_path, "four_bar")), place)


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"made_from": 3}', "[" * 100_000])
def test_a_result_of_unknown_origin_is_replaced_as_ever(text: str, tmp_path: Path) -> None:
    (tmp_path / "summary.json").write_text(text, encoding="utf-8")
    check_origin(scenes.load("four_bar"), tmp_path)


def test_a_pipe_in_place_of_an_older_result_is_of_unknown_origin(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "summary.json")
    check_origin(scenes.load("four_bar"), tmp_path)
    assert _may_be_complete(tmp_path, REPORT)

"""Several files of one result: joined by their instants, refused where these differ."""

import re
from pathlib import Path

import numpy as np
import pytest

from compare.judge.foreign import assess_result
from compare.results.proposal import proposed
from compare.results.result import read_result
from scenes import InputError, Status
from scenes.model.motion import Samples
from tests import scene_files
from tests.comparisons import References
from tests.foreign import Writer, instants

SCENE = "offset_slider_crank"
PINS = ("A", "B")
MAPPING = (
    '[columns]\ntime = "t"\n'
    '"A.fx" = "A:fx"\n"A.fy" = "A:fy"\n"B.fx" = "B:fx"\n"B.fy" = { column = "B:fy", sign = 1 }\n"rod.omega" = "w"\n'
)


def _written(folder: Path, decimals: str = ".12g") -> tuple[str, list[Path], dict[str, Samples]]:
    """Write a file a pin, with columns of the same names, and return the argument, the files and the motion."""
    scene = scene_files.load(SCENE)
    names = [f"{pin}.f{q}" for pin in PINS for q in "xy"]
    columns = Writer().columns(scene, instants(scene, 30), [*names, "rod.omega"])
    files = []
    for pin in PINS:
        own = {"t": columns["time"], "fx": columns[f"{pin}.fx"], "fy": columns[f"{pin}.fy"]}
        own |= {"w": columns["rod.omega"]} if pin == "B" else {}
        rows = [",".join(own), *(",".join(format(v, decimals) for v in row) for row in zip(*own.values(), strict=True))]
        (file := folder / f"{pin}.csv").write_text("\n".join(rows), encoding="utf-8")
        files.append(file)
    return f"theirs={files[0]},{files[1]}", files, columns


def test_columns_of_two_files_are_one_result(tmp_path: Path, references: References) -> None:
    text, files, columns = _written(tmp_path)
    files[0].with_suffix(".toml").write_text(MAPPING, encoding="utf-8")
    scene = scene_files.load(SCENE)
    result = read_result(scene, text)
    assert result.run.motion is not None
    for channel in ("time", "A.fx", "A.fy", "B.fx", "B.fy", "rod.omega"):
        # twelve digits are written
        assert np.allclose(result.run.motion[channel], columns[channel], rtol=1e-11, atol=0), channel
    found = assess_result(references(SCENE), result)
    assert found.run.status is Status.ok, found.run.reason
    assert getattr(result.run.settings, "file", "") == f"{files[0]}, {files[1]}"


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (lambda rows: [*rows[:4], "9" + rows[4], *rows[5:]], "B.csv: row 5, column 't': expected '0."),
        (lambda rows: rows[:-1], "B.csv: row 31, column 't': expected '"),
        (lambda rows: ["time" + rows[0][1:], *rows[1:]], "expected a column that all of them have, of their instants"),
        (lambda rows: [*rows[:4], rows[4] + ",1", *rows[5:]], "B.csv: not a table: "),
    ],
)
def test_other_instants_are_named(change: object, line: str, tmp_path: Path) -> None:
    assert callable(change)
    text, files, _ = _written(tmp_path)
    files[0].with_suffix(".toml").write_text(MAPPING, encoding="utf-8")
    files[1].write_text("\n".join(change(files[1].read_text().splitlines())), encoding="utf-8")
    with pytest.raises(InputError, match=re.escape(line)):
        read_result(scene_files.load(SCENE), text)


def test_instants_at_other_decimals_are_the_same(tmp_path: Path) -> None:
    """The instants of one file are rounded to four digits."""
    text, files, _ = _written(tmp_path)
    files[0].with_suffix(".toml").write_text(MAPPING, encoding="utf-8")
    names, *rows = files[1].read_text().splitlines()
    rounded = [f"{float(row.split(',')[0]):.4f},{row.split(',', 1)[1]}" for row in rows]
    files[1].write_text("\n".join([names, *rounded]), encoding="utf-8")
    assert read_result(scene_files.load(SCENE), text).request.count == 30


def test_rows_may_be_told_by_a_name_and_a_mapping_is_proposed(tmp_path: Path) -> None:
    """The first file has the instants, the second one only the names of the rows, as a simulation's samples have."""
    _, files, columns = _written(tmp_path)
    (first := tmp_path / "samples.csv").write_text(
        "\n".join(["id,t", *(f"row_{k},{t:.12g}" for k, t in enumerate(columns["time"]))]), encoding="utf-8"
    )
    names, *rows = files[1].read_text().splitlines()
    numbered = [f"id,{names.split(',', 1)[1]}", *(f"row_{k},{row.split(',', 1)[1]}" for k, row in enumerate(rows))]
    files[1].write_text("\n".join(numbered), encoding="utf-8")
    text = f"theirs={first},{files[1]}"
    lines = proposed(scene_files.load(SCENE), text)
    assert '"rod.omega" = "w"  # sure' in lines
    first.with_suffix(".toml").write_text(lines, encoding="utf-8")
    assert read_result(scene_files.load(SCENE), text).request.count == 30


def test_a_file_whose_name_has_a_comma_is_one(tmp_path: Path) -> None:
    (file := tmp_path / "a,b.csv").write_text("time [s],rod.omega\n0,1\n0.1,1\n", encoding="utf-8")
    assert read_result(scene_files.load(SCENE), f"theirs={file}").request.count == 2
    with pytest.raises(InputError, match=r"expected NAME=FILE\.csv"):
        read_result(scene_files.load(SCENE), "theirs=,")

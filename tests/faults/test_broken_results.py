"""Tables and mappings that are broken: one line each, exit status 2, and no traceback."""

from pathlib import Path

import numpy as np
import pytest

from compare.results import table
from compare.run import main
from scenes import Scene
from tests import scene_files
from tests.foreign import Writer, instants, write

CHANNELS = ["B.x", "B.y", "rod.omega", "B.fx"]
WORDS = ("e5", "inf", "NULL", "0x1", "1_0", "--", "1.2.3", "''", "+")
Broken = tuple[bytes, str]  # a table, and its mapping


@pytest.fixture(scope="module")
def scene() -> Scene:
    return scene_files.load("offset_slider_crank")


@pytest.fixture(scope="module")
def good(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Broken:
    """Return a table and its mapping with nothing wrong."""
    columns = Writer().columns(scene, instants(scene, 12), CHANNELS)
    file = write(tmp_path_factory.mktemp("good"), Writer(decimals=".6f").texts(columns), "", sep=";")
    return file.read_bytes(), file.with_suffix(".toml").read_text()


def refused(folder: Path, broken: Broken, capsys: pytest.CaptureFixture[str]) -> str:
    """Return the line by which a table is refused."""
    file = folder / "theirs.csv"
    file.write_bytes(broken[0])
    file.with_suffix(".toml").write_text(broken[1], encoding="utf-8")
    path = str(scene_files.path("offset_slider_crank"))
    status = main([path, "--engines", "analytic", "--result", f"theirs={file}", "--out", str(folder / "out")])
    printed = capsys.readouterr()
    assert status == 2, printed
    assert printed.out == ""
    assert not (folder / "out").exists()
    (line,) = printed.err.splitlines()
    assert "internal error" not in line
    return line


def test_what_is_wrong_is_named(good: Broken, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text, mapping = good[0].decode(), good[1]
    rows = text.splitlines()
    cells = [row.split(";") for row in rows]

    def joined(rows: list[list[str]]) -> bytes:
        return "\n".join(";".join(row) for row in rows).encode()

    def without(first: int, end: int, cell: str) -> bytes:
        some = [[*row[:2], cell, *row[3:]] for row in cells[first:end]]
        return joined([*cells[:first], *some, *cells[end:]])

    def with_cell(cell: str) -> bytes:
        return without(4, 5, cell)

    cases: list[tuple[bytes, str, str]] = [
        (b"", mapping, "expected either commas, semicolons or tabs between the column names, found none"),
        (rows[0].encode(), mapping, "expected a row of numbers below the names, found none"),
        (text.encode("utf-16"), mapping, "expected a text file in UTF-8, and byte 0 is none"),
        (text.replace("c0", "größe").encode("latin-1"), mapping, "expected a text file in UTF-8, and byte 2 is none"),
        (text.replace(";", "|").encode(), mapping, "column names, found none in the first line, 'c0|c1|c2|c3|c4"),
        (f"Model: press\n{text}".encode(), mapping, "column names, found none in the first line, 'Model: press'"),
        (text.replace("c0;c1", "c0;c,1").encode(), mapping, "found commas and semicolons; 'separator' in the mapping"),
        (text.replace("c1", "d1").encode(), mapping, "no column 'c1'; one of c0, c2, c3, c4, d1"),
        (text.replace("c1", "c2").encode(), mapping, "no column 'c1'"),
        (text.replace("c1", "c0").encode(), mapping, "column 'c0' is there 2 times"),
        (without(4, 6, ""), mapping, "row 5, column 'c2': expected a number up to 1e+30, found nothing"),
        (without(4, 6, "nan"), mapping, "row 5, column 'c2': expected a number up to 1e+30, found 'nan'"),
        *((with_cell(word), mapping, f"found '{word}'") for word in WORDS),
        (with_cell("1.5\0"), mapping, "expected a text file, found zero bytes"),
        (with_cell("1" * 20_000), mapping, "row 5, column 'c2': expected a number up to 1e+30, found '11"),
        (with_cell('"1'), mapping, "not a table: EOF inside string starting at row 4"),
        (joined([*cells[:4], *(row[:-1] for row in cells[4:])]), mapping, "row 5, column 'c4': expected a number"),
        (with_cell("1e99"), mapping, "row 5, column 'c2': expected a number up to 1e+30, found '1e99'"),
        (with_cell("12 mm"), mapping, "found '12 mm'"),
        (with_cell("1.234,5"), mapping, "expected decimal points or decimal commas, found both"),
        (joined([cells[0], *cells[:0:-1]]), mapping, "row 3: expected a later instant than in the row before; 'backw"),
        (joined([*cells[:3], *cells[2:]]), mapping, "row 4: expected a later instant than in the row before"),
        (joined([*cells, [*cells[-1], "1"]]), mapping, "not a table: Expected 5 fields in line 14, saw 6"),
        (text.encode(), mapping + '"B.z" = "c1"', "columns.B.z: no such channel of the scene; did you mean 'B.y'?"),
        (text.encode(), 'columns = {"time" = "c0"}', "expected one channel more than the time and crank_angle"),
        (text.encode(), 'columns = {"B.x" = "c1"}', "columns: expected time, or crank_angle"),
        (text.encode(), f'units = {{length = "mmm"}}\n{mapping}', "units.length: 'mmm' is not a known unit of length"),
        (text.encode(), f'unit = "mm"\n{mapping}', "unit: unknown key; did you mean 'units'?"),
        (text.encode(), f'other_side = ["rodd"]\n{mapping}', "other_side: no joint, slider or drive 'rodd'"),
        (text.encode(), f"promise = 0\n{mapping}", "promise: expected greater than 0, found 0"),
        (text.encode(), "", "expected a mapping beside it, or columns named as channels"),
    ]
    for number, (table_text, own, words) in enumerate(cases):
        folder = tmp_path / str(number)
        folder.mkdir()
        assert words in refused(folder, (table_text, own), capsys), words


def test_a_file_that_is_too_large(
    good: Broken, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(table, "MAX_BYTES", 500)
    assert "expected a file of 500 bytes at most, found one of more" in refused(tmp_path, good, capsys)


def test_random_text_is_no_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    random = np.random.default_rng(5)
    for number in range(20):
        folder = tmp_path / str(number)
        folder.mkdir()
        refused(folder, (random.integers(1, 127, 2000).astype(np.uint8).tobytes(), 'columns = {"time" = "a"}'), capsys)

"""Tables as other programs write them: lines above the names, a row of units, blanks between columns."""

import re
from pathlib import Path

import numpy as np
import pytest

from compare.results.result import read_result
from compare.results.table import read_table
from scenes import InputError
from tests import scene_files

FORMS = {
    "as it is": "t,x\n0,1.5\n1,2.5\n",
    "lines above": "# made by a program\n# 2 columns, a date\n\nt,x\n0,1.5\n1,2.5\n",
    "units": "t,x\n(s),mm\n0,1.5\n1,2.5\n",
    "units of one": "t,x\n,[mm]\n0,1.5\n1,2.5\n",
    "blanks": "t x\n0 1.5\n1 2.5\n",
    "columns of one width": "      t        x\n    0.0      1.5\n    1.0      2.5\n",
    "all of it": "# a b c\n  t   x\n  s   mm\n  0   1.5\n  1   2.5\n\n",
    "semicolons": "# a\nt;x\ns;mm\n0;1,5\n1;2,5\n",
}


@pytest.mark.parametrize("form", FORMS)
def test_the_same_numbers(form: str, tmp_path: Path) -> None:
    (file := tmp_path / "a.csv").write_text(FORMS[form], encoding="utf-8")
    table = read_table(file, None, None)
    assert table.columns == ("t", "x")
    assert [table.numbers(name)[0].tolist() for name in table.columns] == [[0.0, 1.0], [1.5, 2.5]]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("# a\nt,x\ns,mm\n0,1\n1,-\n", "row 5, column 'x': expected a number"),
        ("t,x\ns,mm\n", "row 2, column 't': expected a number"),
        ("t,x\ns,mm\nmin,N\n0,1\n", "row 2, column 't': expected a number"),
        ("t x\n0 1 2\n", "between the column names, found none in the first line, 't x'"),
        ("# t,x\n", "expected a row of numbers below the names, found none"),
    ],
)
def test_what_is_no_table_is_named(text: str, line: str, tmp_path: Path) -> None:
    (file := tmp_path / "a.csv").write_text(text, encoding="utf-8")

    def read() -> None:
        table = read_table(file, None, None)
        for column in table.columns:
            table.numbers(column)

    with pytest.raises(InputError, match=re.escape(line)):
        read()


@pytest.mark.parametrize("cell", ["", "nan", "NaN", "-nan(ind)"])
def test_a_row_without_a_number_is_left_out(cell: str, tmp_path: Path) -> None:
    """It is named and counted, and only where its column is read; many of them are refused."""
    scene, lines = scene_files.load("offset_slider_crank"), [f"{0.01 * row:.2f},1.5,2.5" for row in range(40)]
    (file := tmp_path / "a.csv").write_text("# made\ntime [s],rod.omega [rad/s],rod.alpha\n" + "\n".join(lines))
    whole = read_result(scene, f"a={file}")
    lines[6] = f"0.06,1.5,{cell}"
    file.write_text("# made\ntime [s],rod.omega [rad/s],rod.alpha\n" + "\n".join(lines), encoding="utf-8")
    result = read_result(scene, f"a={file}")
    assert result.request.instants == tuple(t for t in whole.request.instants if t != 0.06)
    assert np.isfinite([*result.run.motion.samples.values()] if result.run.motion else np.nan).all()
    shown = f"'{cell}'" if cell else "nothing"
    note = f"a: row 9 is left out, 1 of 40: in row 9 column 'rod.alpha' has {shown}"
    assert note in result.notes
    assert not result.half_decimals["time"].any(), "the steps are equal but for the row that is left out"
    file.with_suffix(".toml").write_text('columns = { time = "time [s]", "rod.omega" = "rod.omega [rad/s]" }')
    assert not [note for note in read_result(scene, f"a={file}").notes if "left out" in note]
    file.with_suffix(".toml").unlink()
    lines[8:10] = [f"{0.01 * row:.2f},{cell},2.5" for row in (8, 9)]
    file.write_text("time [s],rod.omega [rad/s],rod.alpha\n" + "\n".join(lines), encoding="utf-8")
    with pytest.raises(
        InputError, match=re.escape(f"column 'rod.omega [rad/s]': expected a number up to 1e+30, found {shown}")
    ):
        read_result(scene, f"a={file}")


def test_a_row_of_nothing_but_gaps_is_none_of_units(tmp_path: Path) -> None:
    (file := tmp_path / "a.csv").write_text("t,x\nnan,nan\n0,1.5\n1,2.5\n", encoding="utf-8")
    table, why = read_table(file, None, None).complete(["t", "x"])
    assert table.numbers("x")[0].tolist() == [1.5, 2.5]
    assert why == "row 2 is left out, 1 of 3: in row 2 column 't' has 'nan'"


def test_a_last_instant_that_is_there_twice(tmp_path: Path) -> None:
    """Its second row is left out, which is a note; any other repeated instant is refused."""
    scene = scene_files.load("offset_slider_crank")
    rows = ["time [s],rod.omega [rad/s]", *(f"{0.01 * row},1.5" for row in range(4))]
    (file := tmp_path / "a.csv").write_text("\n".join([*rows, rows[-1]]), encoding="utf-8")
    result = read_result(scene, f"a={file}")
    assert len(result.request.instants) == 4
    assert "a has its last instant twice; the second row of it is left out" in result.notes
    file.write_text("\n".join([*rows[:3], *rows[2:]]), encoding="utf-8")
    with pytest.raises(InputError, match="row 4: expected a later instant"):
        read_result(scene, f"a={file}")

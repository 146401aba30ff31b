"""Tables as other programs write them: lines above the names, a row of units, blanks between columns."""

import re
from pathlib import Path

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

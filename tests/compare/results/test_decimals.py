"""What the last decimal of a column is, deduced from its texts."""

from pathlib import Path

import pytest

from compare.results.table import read_table


@pytest.mark.parametrize(
    ("texts", "halves"),
    [
        (["1.250", "-0.125", "12.000"], [5e-4] * 3),
        (["1.25", "-0.125", "12", "0.333", "10.001"], [5e-4] * 5),  # zeros at the end left out
        (["1.25000e+02", "2.50000e-03", "0.00000e+00"], [5e-4, 5e-9, 0.0]),
        (["123.456", "0.00123456", "12.3456", "0"], [5e-4, 5e-9, 5e-5, 0.0]),  # six digits
        (["0.1234567890123456", "12.34567890123456", "1.234567890123456"], [5e-17, 5e-15, 5e-16]),
        (["1", "2", "17"], [0.5] * 3),
        (["3.25D-04", "-1.5d2", "1.25d2"], [5e-7, 0.5, 0.5]),
        (["1.23e+05", "9.88e+04", "1.00e+03"], [500.0, 50.0, 5.0]),
    ],
)
def test_the_last_decimal(tmp_path: Path, texts: list[str], halves: list[float]) -> None:
    file = tmp_path / "table.csv"
    file.write_text("a;b\n" + "".join(f"{text};0\n" for text in texts))
    _, found = read_table(file, None, None).numbers("a")
    assert found == pytest.approx(halves, rel=1e-12)


def test_a_column_of_one_number_is_written_as_the_file_is(tmp_path: Path) -> None:
    """A guide's height of `4.0` in a file of full digits is no height to half a decimetre."""
    file = tmp_path / "table.csv"
    file.write_text("a,b,c\n4.0,0.1234567890123456,0\n4.0,1.234567890123456,0\n")
    table = read_table(file, None, None)
    assert table.numbers("a")[1].max() < 1e-14
    assert table.numbers("c")[1].max() < 1e-14


@pytest.mark.parametrize("ending", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(("separator", "decimal"), [(",", "."), (";", "."), ("\t", "."), (";", ","), ("\t", ",")])
def test_separators_and_decimal_commas(tmp_path: Path, separator: str, decimal: str, ending: str) -> None:
    file = tmp_path / "table.csv"
    rows = [["a [mm]", '"b, c"'], ["1.5", "-2e-3"], ["2.25", "0.125"]]
    text = "".join(separator.join(row) + ending for row in rows)
    file.write_bytes(b"\xef\xbb\xbf" + text.replace(".", decimal).encode())
    table = read_table(file, None, None)
    assert table.columns == ("a [mm]", "b, c")
    assert table.numbers("a [mm]")[0].tolist() == [1.5, 2.25]
    assert table.numbers("b, c")[0].tolist() == [-2e-3, 0.125]

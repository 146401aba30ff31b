"""Several files of one result as one table: their columns side by side, row by row.

Method: a column that all files have, that runs one way (or is of words, as a row's name) and says the same in each is
there once: the instants, or a count of the rows. Any other column that several files have gets its file's name before
its own, `pins:fx`. Rows are never matched or interpolated: files whose instants differ are refused.
"""

from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from scenes import InputError
from scenes.errors import at_place, one_line
from scenes.model.motion import Samples

from .table import Table, read_table

ROUNDING_FACTOR = 1 + 1e-9  # of two halves of last decimals, by which a number that is rounded twice may differ


def read_tables(
    files: Sequence[Path], separator: str | None, decimal: str | None, instants: Collection[str] = ()
) -> Table:
    """Return the table in files of one result, see `read_table`; InputError where their rows are not the same ones.

    `instants` are the columns, of those in several files, that have to be the same in each.
    """
    tables = []
    for file in files:
        with at_place(one_line(str(file))):
            tables.append(read_table(file, separator, decimal))
    if len(tables) == 1:
        return tables[0]
    common = [column for column in tables[0].columns if all(column in table.columns for table in tables)]
    differing = {column: text for column in common if (text := _apart(files, tables, column))}
    for column in common:
        if column in differing and column in instants:
            raise InputError(differing[column])
    once = [column for column in common if column not in differing and _runs(tables[0], column)]
    if not once:
        expected = f"{_shown(files)}: expected a column that all of them have, of their instants"
        raise InputError(next(iter(differing.values()), f"{expected}, found none"))
    columns: dict[str, Sequence[str]] = {}
    for file, table in zip(files, tables, strict=True):
        for column, texts in zip(table.columns, table.texts, strict=True):
            shared = sum(column in other.columns for other in tables) > 1 and column not in once
            columns.setdefault(f"{file.stem}:{column}" if shared else column, texts)
    sha256 = ", ".join(table.sha256 for table in tables)
    return Table(sha256, tuple(columns), [*columns.values()], tables[0].rows)


def _apart(files: Sequence[Path], tables: Sequence[Table], column: str) -> str:
    """Return in one line where a column of a file differs first from that of the first file; empty where none does."""
    first, known = tables[0], _numbers(tables[0], column)
    for file, table in zip(files[1:], tables[1:], strict=True):
        texts, others = (each.texts[each.columns.index(column)] for each in (first, table))
        count, numbers = min(len(texts), len(others)), _numbers(table, column)
        if known is None or numbers is None:
            same: NDArray[np.bool_] = np.array(texts[:count]) == np.array(others[:count])
        else:
            (a, half), (b, other) = known, numbers
            # Two programs may round one instant to different decimals: numbers agree if their rounding intervals touch.
            same = np.abs(a[:count] - b[:count]) <= ROUNDING_FACTOR * (half[:count] + other[:count])
        if not same.all() or len(texts) != len(others):
            row = count if same.all() else int((~same).argmax())
            wanted, found = (f"'{one_line(t[row], 30)}'" if row < len(t) else "no row" for t in (texts, others))
            number = (table if row < len(others) else first).rows[row]
            where = f"{one_line(str(file))}: row {number}, column '{one_line(column, 60)}'"
            return f"{where}: expected {wanted} as in {one_line(files[0].name, 60)}, found {found}"
    return ""


def _numbers(table: Table, column: str) -> tuple[Samples, Samples] | None:
    try:
        return table.numbers(column)
    except InputError:
        return None


def _runs(table: Table, column: str) -> bool:
    """Whether a column tells the rows apart: it rises or falls all along, but for an end that is there twice."""
    if (numbers := _numbers(table, column)) is None:
        texts = table.texts[table.columns.index(column)]
        return len(set(texts)) >= len(texts) - 1
    steps = np.diff(numbers[0])[:-1]
    return bool((steps > 0).all() or (steps < 0).all())


def _shown(files: Sequence[Path]) -> str:
    return one_line(", ".join(map(str, files)))

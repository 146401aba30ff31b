"""A text table of numbers, and by how much each may be off since it is written at decimals."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from hashlib import sha256
from io import StringIO
from pathlib import Path

import numpy as np

from scenes import InputError
from scenes.errors import nearest, one_line
from scenes.file.toml import read_text
from scenes.model.motion import Samples

from ..engines.runner import MAX_NUMBER

MAX_BYTES = 50_000_000  # reading a table takes 3 s for every ten megabytes
SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs"}
BLANKS = r"\s+"  # one or more of them between columns, where no name has any
TO_E = str.maketrans("dD", "ee")  # of powers of ten as Fortran writes them
NUMBER = re.compile(r"[+-]?(?=\.?\d)\d*(?:\.\d*)?(?:[eEdD][+-]?\d{1,3})?")
MISSING = re.compile(r"([+-]?nan(\([a-z]*\))?)?", re.IGNORECASE)  # a cell without a number, as programs write it
MAX_LEFT_OUT = 0.03  # of the rows, or one: where more lack a number, the table is not what the mapping says


@dataclass(frozen=True)
class Table:
    """The texts of a file, by column."""

    sha256: str
    columns: tuple[str, ...]
    texts: Sequence[Sequence[str]]  # by column
    rows: Sequence[int]  # the number of each row's line in the file, counted from 1

    def numbers(self, column: str) -> tuple[Samples, Samples]:
        """Return a column of numbers, and half of the last decimal of each, both of shape (n,); or InputError."""
        texts = self._texts(column)
        values = [float(text.translate(TO_E)) if NUMBER.fullmatch(text) else np.inf for text in texts]
        for row, text in enumerate(texts):
            if not abs(values[row]) <= MAX_NUMBER:
                where = f"row {self.rows[row]}, column '{one_line(column, 60)}'"
                raise InputError(f"{where}: expected a number up to {MAX_NUMBER:g}, found {_shown(text)}")
        likes = texts  # of a column of one number, whose own digits show nothing, all that are in the file
        if len(set(texts)) == 1:
            likes = [each[row] for each in self.texts for row in (0, -1) if NUMBER.fullmatch(each[row])]
        # Programs write fixed decimals (%.6f) or significant digits (%.9g), and drop zeros at the end. The column's
        # most decimals, or most digits, occur in many of its numbers, and the more frequent of the two is how it was
        # written. The first gives one last decimal for all, the second one for each number's size.
        decimals, digits, _ = map(np.array, zip(*map(_written, likes), strict=True))
        last = np.full(len(texts), -float(decimals.max()))
        if (digits == digits.max()).sum() > (decimals == decimals.max()).sum():  # more are to the full in their digits
            last = np.array([_written(text)[2] for text in texts]) - digits.max() + 1
        return np.array(values), 0.5 * 10.0**last

    def complete(self, columns: Iterable[str]) -> tuple["Table", str]:
        """Return the rows that lack a number in none of some columns, and in a sentence which others there are.

        The table is returned as it is where too many rows lack one: `numbers` names the first of them.
        """
        lack: dict[int, str] = {}  # by row: where, and what is there
        for column in columns:
            for row, text in enumerate(self._texts(column)):
                if MISSING.fullmatch(text):
                    lack.setdefault(row, f"column '{one_line(column, 60)}' has {_shown(text)}")
        if not lack or len(lack) > max(1, MAX_LEFT_OUT * len(self.rows)) or len(lack) == len(self.rows):
            return self, ""
        kept = [row for row in range(len(self.rows)) if row not in lack]
        texts = [[column[row] for row in kept] for column in self.texts]
        first = min(lack)
        numbers = ", ".join(str(self.rows[row]) for row in sorted(lack))
        listed = f"row {numbers} is" if len(lack) == 1 else f"rows {one_line(numbers, 60)} are"
        why = f"{listed} left out, {len(lack)} of {len(self.rows)}: in row {self.rows[first]} {lack[first]}"
        return replace(self, texts=texts, rows=[self.rows[row] for row in kept]), why

    def _texts(self, column: str) -> Sequence[str]:
        shown = one_line(column, 60)
        if self.columns.count(column) != 1:
            if column in self.columns:
                raise InputError(f"column '{shown}' is there {self.columns.count(column)} times; expected it once")
            raise InputError(f"no column '{shown}'{nearest(column, self.columns)}")
        return self.texts[self.columns.index(column)]


def _shown(text: str) -> str:
    return f"'{one_line(text, 30)}'" if text else "nothing"


def _written(text: str) -> tuple[int, int, float]:
    """A number's decimals, its digits but for zeros in front, and the power of ten of the first; -inf of zero."""
    number = Decimal(text.translate(TO_E))
    _, digits, power = number.as_tuple()  # of the last digit
    return (-int(power), len(digits), number.adjusted()) if number else (-int(power), 0, -np.inf)


def read_table(path: Path, separator: str | None, decimal: str | None) -> Table:
    """Return the table in a file, text in UTF-8: a line of column names, then a line a row; or InputError.

    Where separator and decimal mark are None, the names and the numbers show them. Lines above the names that begin
    with `#` are read past, and below them one line without a number, of units.
    """
    import pandas as pd  # late: most runs read no table

    try:
        text = read_text(path, MAX_BYTES).replace("\r\n", "\n").replace("\r", "\n")
    except FileNotFoundError:
        raise InputError("no such file") from None
    if "\0" in text:
        raise InputError("expected a text file, found zero bytes")
    lines = text.split("\n")
    above = next((row for row, line in enumerate(lines) if line.strip() and not line.startswith("#")), 0)
    lines = lines[above:]
    separator = separator or _separator(lines)
    try:
        cells = pd.read_csv(
            StringIO("\n".join(lines)),
            sep=BLANKS if separator == " " else separator,
            header=None,
            dtype=str,
            keep_default_na=False,
        )
    except ValueError as error:  # of which pandas has its own kinds
        why = one_line(str(error)).removeprefix("Error tokenizing data. C error: ")
        raise InputError(f"not a table: {why}") from None
    if len(cells) < 2:
        raise InputError("expected a row of numbers below the names, found none")
    names, *rows = ([str(text).strip() for text in row] for row in cells.itertuples(index=False))
    if len(rows) > 1 and _of_units(rows[0]) and not _of_units(rows[1]):
        rows, above = rows[1:], above + 1
    texts = [list(column) for column in zip(*rows, strict=True)]
    if (decimal or _decimal(texts, separator)) == ",":
        texts = [[text.replace(",", ".") for text in column] for column in texts]
    return Table(sha256(path.read_bytes()).hexdigest(), tuple(names), texts, range(above + 2, above + 2 + len(rows)))


def _of_units(row: Sequence[str]) -> bool:
    """Whether no cell of a row has a number, nor lack all of them one."""
    return not all(map(MISSING.fullmatch, row)) and not any(re.match(r"[+-]?[.,]?\d", text) for text in row)


def _separator(lines: Sequence[str]) -> str:
    head = lines[0]
    # The names decide, as they hold no decimal commas; text in quotes is left out.
    separators = [separator for separator in SEPARATORS if separator in re.sub(r'"[^"]*"', "", head)]
    if len(separators) == 1:
        return separators[0]
    fields = [len(line.split()) for line in lines if line.strip()]
    if not separators and len(fields) > 1 and fields[0] > 1 and len(set(fields)) == 1:
        return " "
    names = " and ".join(SEPARATORS[each] for each in separators)
    none = f"none in the first line, '{one_line(head, 40)}'"
    instead = f"{names}; 'separator' in the mapping sets it" if names else none
    raise InputError(f"expected either commas, semicolons or tabs between the column names, found {instead}")


def _decimal(texts: Sequence[Sequence[str]], separator: str) -> str:
    if separator == ",":
        return "."
    comma, point = (any(mark in text for column in texts for text in column) for mark in ",.")
    if comma and point:
        raise InputError("expected decimal points or decimal commas, found both; 'decimal' in the mapping sets it")
    return "," if comma else "."

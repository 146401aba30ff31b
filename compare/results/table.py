"""A text table of numbers, and by how much each may be off since it is written at decimals."""

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import numpy as np

from scenes import InputError
from scenes.errors import nearest, one_line
from scenes.file.toml import read_text
from scenes.model.motion import Samples

from ..engines.runner import LARGEST

BYTES = 50_000_000  # reading a table takes 3 s for every ten megabytes
SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs"}
NUMBER = re.compile(r"[+-]?(?=\.?\d)(\d*)(?:\.(\d*))?(?:[eEdD]([+-]?\d{1,3}))?")


@dataclass(frozen=True)
class Table:
    """The texts of a file, by column."""

    sha256: str
    columns: tuple[str, ...]
    texts: Sequence[Sequence[str]]  # by column

    def numbers(self, column: str) -> tuple[Samples, Samples]:
        """Return a column, and half of the last decimal of each of its numbers, both of shape (n,).

        Raises:
            InputError: there is no such column, there are several, or not all of it are numbers.
        """
        shown = one_line(column, 60)
        if self.columns.count(column) != 1:
            if column in self.columns:
                raise InputError(f"column '{shown}' is there {self.columns.count(column)} times; expected it once")
            raise InputError(f"no column '{shown}'{nearest(column, self.columns)}")
        texts = self.texts[self.columns.index(column)]
        for row, text in enumerate(texts):
            if not (NUMBER.fullmatch(text) and abs(_float(text)) <= LARGEST):
                cell = f"'{one_line(text, 30)}'" if text else "nothing"
                raise InputError(f"row {row + 2}, column '{shown}': expected a number up to {LARGEST:g}, found {cell}")
        own = [_digits(text) for text in texts]
        form = _form(own) if len(set(texts)) > 1 else self._form
        return np.array([_float(text) for text in texts]), _halves(own, form)

    @property
    def _form(self) -> "Form":
        """How the numbers of the file are written, for columns of one number, whose own digits show nothing."""
        texts = [column[row] for column in self.texts for row in (0, -1) if NUMBER.fullmatch(column[row])]
        return _form([_digits(text) for text in texts])


def _float(text: str) -> float:
    return float(text.replace("d", "e").replace("D", "e"))


class Digits(NamedTuple):
    """How a number is written."""

    decimals: int  # negative where the power of ten is larger
    digits: int  # but for zeros in front
    power: float  # of ten, of the first digit; of zero without end


class Form(NamedTuple):
    """How a column is written: all at so many decimals, or all at so many digits; zeros at the end may be left out."""

    decimals: int
    digits: int | None  # None where decimals count


def _digits(text: str) -> Digits:
    number = NUMBER.fullmatch(text)
    assert number
    whole, part, power = number[1] or "", number[2] or "", int(number[3] or 0)
    digits = (whole + part).lstrip("0")
    first = len(digits) - len(part) - 1 + power
    return Digits(len(part) - power, len(digits), first if digits else -np.inf)


def _form(numbers: Sequence[Digits]) -> Form:
    """Return the form that more of the numbers have to the full."""
    decimals, digits, _ = np.array(numbers).T
    by_digits = (digits == digits.max()).sum() > (decimals == decimals.max()).sum()
    return Form(int(decimals.max()), int(digits.max()) if by_digits else None)


def _halves(numbers: Sequence[Digits], form: Form) -> Samples:
    """Return half of the last decimal of each number, shape (n,)."""
    power = np.array([number.power for number in numbers])
    last = np.full(power.shape, -1.0 * form.decimals) if form.digits is None else power - form.digits + 1
    half: Samples = 0.5 * 10.0**last
    return half


def read_table(path: Path, separator: str | None, decimal: str | None) -> Table:
    """Return the table in a file: a line of column names, then a line a row.

    Args:
        path: of the file, text in UTF-8.
        separator: between columns; None where the names show it.
        decimal: point or comma; None where the numbers show it.

    Raises:
        InputError: it cannot be read, or is no table, or not known to be one of this kind.
    """
    import pandas as pd  # late: most runs read no table

    try:
        text = read_text(path, BYTES).replace("\r\n", "\n").replace("\r", "\n")
    except FileNotFoundError:
        raise InputError("no such file") from None
    if "\0" in text:
        raise InputError("expected a text file, found zero bytes")
    head = text.lstrip("\n").partition("\n")[0]
    separator = separator or _separator(head)
    try:
        names = [name.strip() for name in next(csv.reader([head], delimiter=separator, strict=True), [])]
        cells = pd.read_csv(StringIO(text), sep=separator, header=None, dtype=str, keep_default_na=False)
    except (csv.Error, ValueError) as error:  # of which pandas has its own kinds
        why = one_line(str(error)).removeprefix("Error tokenizing data. C error: ")
        raise InputError(f"not a table: {why}") from None
    if cells.shape[1] != len(names):
        raise InputError(f"expected {len(names)} columns in every row, as the names have, found {cells.shape[1]}")
    if len(cells) < 2:
        raise InputError("expected a row of numbers below the names, found none")
    texts = [[str(text).strip() for text in cells[number][1:]] for number in cells]
    if (decimal or _decimal(texts, separator)) == ",":
        texts = [[text.replace(",", ".") for text in column] for column in texts]
    return Table(sha256(path.read_bytes()).hexdigest(), tuple(names), texts)


def _separator(head: str) -> str:
    separators = [separator for separator in SEPARATORS if separator in re.sub(r'"[^"]*"', "", head)]
    if len(separators) == 1:
        return separators[0]
    expected = "expected either commas, semicolons or tabs between the column names"
    if not separators:
        raise InputError(f"{expected}, found none in the first line, '{one_line(head, 40)}'")
    names = " and ".join(SEPARATORS[each] for each in separators)
    raise InputError(f"{expected}, found {names}; 'separator' in the mapping sets it")


def _decimal(texts: Sequence[Sequence[str]], separator: str) -> str:
    """Return the mark before the decimals of numbers."""
    if separator == ",":
        return "."
    comma, point = (any(mark in text for column in texts for text in column) for mark in ",.")
    if comma and point:
        raise InputError("expected decimal points or decimal commas, found both; 'decimal' in the mapping sets it")
    return "," if comma else "."

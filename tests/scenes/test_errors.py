"""Texts of others in messages: whatever they hold, one harmless line is left."""

import pickle
import unicodedata

import pytest

from scenes import InputError
from scenes.errors import LONGEST, one_line

HARMFUL = {"Cc", "Cf", "Cs", "Zl", "Zp"}  # controls, writing directions, surrogates, breaks of lines and paragraphs


@pytest.mark.parametrize(
    ("text", "line"),
    [
        *(("two\nlines", "two lines"), ("\r\n one\t\x0b\u2028two \x85", "one two"), ("\n" * 1000 + "late", "late")),
        *(("\n", ""), ("\x1b[31mred\x07\x00", r"\x1b[31mred\x07\x00"), ("right\u202eto left", r"right\u202eto left")),
        *(("half \ud800", r"half \ud800"), ("\ufeffmark", r"\ufeffmark"), ("a \\ b", "a \\ b")),
        ("größer, 12 µm, 長", "größer, 12 µm, 長"),
    ],
)
def test_what_is_left_of_a_text(text: str, line: str) -> None:
    assert one_line(text) == line
    assert one_line(line) == line


def test_a_long_text_is_cut() -> None:
    assert one_line("a b " * 250_000, 20) == "a b a b a b a b a b…"
    assert one_line("x" * 20, 20) == "x" * 20
    assert one_line("x" * 21, 20) == "x" * 19 + "…"
    assert len(one_line("\x1b" * 1000, 20)) == 20


def test_no_character_does_harm() -> None:
    every = "".join(map(chr, (*range(0x20000), *range(0xE0000, 0xE0200))))
    line = one_line(every, 10 * len(every))
    assert not {c for c in line if unicodedata.category(c) in HARMFUL}
    line.encode("utf-8")


def test_bad_input_is_one_line() -> None:
    error = InputError("a.toml: \x1b[2J\n" + "x" * 10_000)
    assert str(error).startswith(r"a.toml: \x1b[2J xxx")
    assert len(str(error)) == LONGEST
    assert str(pickle.loads(pickle.dumps(error))) == str(error)

"""Scene files as slips and accidents leave them: texts of scenes with numbers, texts, lines or bytes changed."""

import re
from collections.abc import Callable, Sequence
from functools import partial
from random import Random

import scenes
from tests.scene_files import FOLDER

TEXTS = {path.stem: path.read_text(encoding="utf-8") for path in (*FOLDER.glob("*.toml"), *scenes.shipped().values())}
NUMBER = re.compile(r"(?<![\w.+-])[+-]?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?![\w.])")
QUOTED = re.compile(r'"[^"\n]*"')
WORD = re.compile(r"[A-Za-z]\w*")
VALUE = re.compile(r"(?<== )\S[^,\n#]*")
ODD = (
    *("nan", "inf", "-inf", "0", "-0.0", "-1", "1e308", "-1e308", "1e-308", "5e-324", "1e999", "1e15", "1e-15", "1e16"),
    *("9" * 20, "9" * 5000, "0x" + "f" * 1000, "1_0", "1.", "1979-05-27", "1979-05-27T07:32:00Z", "07:32:00", "true"),
    *("[]", "{}", "[[]]", "[1]", "[1, 2]", "[1, 2, 3]", "{ a = 1 }", "{ a.b.c = [1] }", "[" * 400, "[" * 40 + "]" * 40),
    *('""', '"1"', '"ground"', '"drive"', '"\\u0000"', '"\\u001b[2J"', '"\\u202e"', '"é"', '"two\\nlines"', "'''"),
    *(f'"{"x" * 70}"', f'"{"x" * 5000}"', "a." * 100 + "a", "= 1", '"""', "#", "\\", "\0", "\ufeff", "\ud800", ""),
    *('"m**9"', '"9**9**9**9*m"', '"m!"', '"Ym"', '"rpm"', '"mm/s"', '"dBm/degC"', '"(((m"', f'"{"m*" * 2000}m"'),
)
CHARACTERS = "\0\x1b\x85\t\n\r \"'#=+-.,_[]{}()*/019aeZé\u202e\u2028\ufeff\ud800😀"
Change = Callable[[Random, str], str]


def mutated(random: Random) -> bytes:
    """The content of a file after one to three changes of any kind, now and then with odd bytes."""
    content = _changed(random, CHANGES).encode("utf-8", "surrogatepass")
    if random.random() < 0.1:
        start = random.randint(0, len(content))
        content = content[:start] + random.randbytes(random.randint(0, 4)) + content[start + random.randint(0, 4) :]
    return content


def slightly_mutated(random: Random) -> bytes:
    """The content of a file after one to three changes that may well leave a scene."""
    return _changed(random, (_other_number, _other_number, _other_number, _other_name, _other_lines)).encode()


def _changed(random: Random, changes: Sequence[Change]) -> str:
    text = TEXTS[random.choice(sorted(TEXTS))]
    for change in random.choices(changes, k=random.randint(1, 3)):
        text = change(random, text)
    return text


def _place(random: Random, text: str, pattern: re.Pattern[str]) -> tuple[int, int]:
    return random.choice([match.span() for match in pattern.finditer(text)] or [(0, 0)])


def _odd(random: Random, text: str, pattern: re.Pattern[str]) -> str:
    start, end = _place(random, text, pattern)
    return text[:start] + random.choice(ODD) + text[end:]


def _other_number(random: Random, text: str) -> str:
    start, end = _place(random, text, NUMBER)
    factor = random.choice((0.5, 0.9, 0.99, 1.01, 1.1, 2.0, -1.0, 0.0, 10.0, 10 ** random.uniform(-20, 20)))
    return f"{text[:start]}{float(text[start:end] or 0) * factor!r}{text[end:]}"


def _other_name(random: Random, text: str) -> str:
    """Put one word of the file in the place of another."""
    (start, end), (first, last) = _place(random, text, WORD), _place(random, text, WORD)
    return text[:start] + text[first:last] + text[end:]


def _other_lines(random: Random, text: str) -> str:
    """Remove, repeat or move some lines."""
    lines = text.splitlines(keepends=True)
    start, length, to = random.randint(0, len(lines)), random.randint(0, 8), random.randint(0, len(lines))
    some, others = lines[start : start + length], lines[:start] + lines[start + length :]
    return "".join([*others[:to], *some * random.choice((0, 0, 1, 1, 2, 300)), *others[to:]])


def _another_file(random: Random, text: str) -> str:
    """Go on as another file from some line on."""
    lines, others = (one.splitlines(keepends=True) for one in (text, TEXTS[random.choice(sorted(TEXTS))]))
    return "".join(lines[: random.randint(0, len(lines))] + others[random.randint(0, len(others)) :])


def _other_characters(random: Random, text: str) -> str:
    start = random.randint(0, len(text))
    some = random.choices(CHARACTERS, k=random.randint(0, 5))
    return f"{text[:start]}{''.join(some)}{text[start + random.randint(0, 5) :]}"


CHANGES: Sequence[Change] = (
    *(_other_number, _other_name, _other_lines, _another_file, _other_characters),
    *(partial(_odd, pattern=pattern) for pattern in (NUMBER, QUOTED, VALUE)),
)

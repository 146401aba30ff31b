"""Bad input from the user: one line that names the place, the expectation and the nearest valid name."""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches

LONGEST = 1000  # characters of a message: all the keys of a table, and a path, fit in


class InputError(Exception):
    """Bad input from the user: a scene file, an argument, an output folder. Its text is one harmless line."""

    def __init__(self, text: str) -> None:
        super().__init__(one_line(text, LONGEST))


@contextmanager
def at_place(place: str) -> Iterator[None]:
    """Put where it was before every message from within."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{place}: {error}") from None


def one_line(text: str, most: int = 300) -> str:
    """A text as one line of `most` characters for a terminal, a page or a file, whoever wrote it.

    Its words have single spaces between them, what cannot be printed is its escape, and '…' is where it was cut.
    """
    line = " ".join(text.split(maxsplit=most))
    line = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line[: most + 1])
    return line if len(line) <= most else line[: most - 1] + "…"


def path_in_file(parts: Iterable[object]) -> str:
    """The path in a file as messages name it: `bodies.rod.mass`."""
    return one_line(".".join(map(str, parts)), 200)


def nearest(name: str, known: Iterable[str], *, or_all: bool = True) -> str:
    """`; did you mean 'x'?` for the closest of the `known` names, or the whole list when none is close."""
    choices = sorted(set(known))
    by_letters = {choice.casefold(): choice for choice in choices}  # capital or small
    close = get_close_matches(name.casefold(), by_letters, n=1, cutoff=0.6)
    if close:
        return f"; did you mean '{by_letters[close[0]]}'?"
    return f"; one of {', '.join(choices)}" if choices and or_all else ""

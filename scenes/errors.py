"""Bad input from the user: one line that names the place, the expectation and the nearest valid name."""

from collections.abc import Iterable
from difflib import get_close_matches


class InputError(Exception):
    """Bad input from the user: a scene file, an argument, an output folder. Its text is one line."""


def nearest(name: str, known: Iterable[str]) -> str:
    """Return `; did you mean 'x'?` for the closest of the `known` names, or the whole list when none is close."""
    choices = sorted(set(known))
    close = get_close_matches(name, choices, n=1, cutoff=0.6)
    if close:
        return f"; did you mean '{close[0]}'?"
    return f"; one of {', '.join(choices)}" if choices else ""

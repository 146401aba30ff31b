"""What engines give as text, whatever it is, as one clean line."""

import os
from contextlib import suppress
from pathlib import Path
from traceback import print_exception, walk_tb

from scenes.errors import one_line

from . import TRACEBACK

CALLERS = ("compare", "importlib")  # packages from which an engine is called


def text_of(value: object) -> str:
    """Return the text of anything as one clean line, none where that itself fails."""
    with suppress(BaseException):  # an engine's own class can do anything here
        return one_line(str(value))
    return ""


def described(error: BaseException) -> str:
    """Return the name, message and place of an exception as one clean line; its traceback is printed on request."""
    if os.environ.get(TRACEBACK):
        with suppress(Exception):  # whatever is raised
            print_exception(error)
    place = _place(error)
    return f"{text_of(type(error).__name__)}: {text_of(error) or 'no message'}{place and f' ({place})'}"


def _place(error: BaseException) -> str:
    """Return file and line where the package that was called first raised it, or called the library that did."""
    frames = [(str(frame.f_globals.get("__name__")), frame, line) for frame, line in walk_tb(error.__traceback__)]
    called = [each for each in frames if each[0].partition(".")[0] not in CALLERS]
    if not called:
        return ""
    package = called[0][0].partition(".")[0]
    name, frame, line = [each for each in called if each[0].partition(".")[0] == package][-1]
    file = Path(frame.f_code.co_filename)
    depth = name.count(".") + 1 + (file.stem == "__init__")
    return f"{text_of('/'.join(file.parts[-depth:]))}, line {line}"

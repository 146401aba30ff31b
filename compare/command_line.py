"""What every command shares: bad input named in one line, and the exit status of what stops it."""

import argparse
import os
import sys
from collections.abc import Callable
from functools import wraps
from typing import NoReturn, ParamSpec

from scenes import InputError

P = ParamSpec("P")


class Parser(argparse.ArgumentParser):
    """A parser that raises InputError for bad arguments, so that they are named in one line like all bad input."""

    def error(self, message: str) -> NoReturn:
        """Raise InputError with the message and the usage."""
        raise InputError(f"arguments: {message}; usage: {self.usage}")


def command(run: Callable[P, int]) -> Callable[P, int]:
    """Return a command that ends with an exit status whatever stops it.

    Args:
        run: the command; its exit status stands where nothing stops it.

    Returns:
        The command, with status 2 for bad input, 130 for Ctrl-C, and 0 where the reader of its output has gone.
    """

    @wraps(run)
    def ended(*arguments: P.args, **options: P.kwargs) -> int:
        try:
            return run(*arguments, **options)
        except InputError as error:
            print(error, file=sys.stderr)
            return 2
        except BrokenPipeError:  # what is still to be flushed goes nowhere
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 0
        except KeyboardInterrupt as stop:
            print(str(stop) or "stopped; nothing more was written", file=sys.stderr)
            return 130

    return ended

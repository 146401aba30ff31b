"""What every command shares: how it starts, and the one line and the exit status of what ends it.

| status | what ended the command |
|---|---|
| 0 | nothing |
| 1 | a tolerance that was missed, or what else the command looks for |
| 2 | bad input, a scene that cannot run, a folder that cannot be written, too little memory, a package not installed |
| 70 | an error of the program itself; the environment variable `LINKAGE_TRACEBACK=1` shows where |
| 130, 143 | Ctrl-C, SIGTERM |
"""

# Nothing heavy is imported here, so that all of this holds from the first moment on.
import argparse
import atexit
import gc
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, redirect_stdout, suppress
from errno import ENOMEM
from functools import wraps
from pathlib import Path
from signal import SIG_IGN, SIGINT, SIGTERM, getsignal, signal
from typing import Any, NoReturn, ParamSpec, TextIO, cast

from ..engines import TRACEBACK

P = ParamSpec("P")

CONSOLE = "linkage-crosscheck"
OBJECTS = 100_000  # that are new before unused ones are looked for: nearly all that imports make stay
MIN_MEGABYTES = 512  # of address space: the main job takes 464; with less, libraries end the process as they like


class Terminated(BaseException):
    """The process is to end, by SIGTERM: what is begun is cleaned up on the way out."""


class Parser(argparse.ArgumentParser):
    """A parser that raises InputError for bad arguments, so that they are named in one line like all bad input."""

    def add_out(self, what: str) -> None:
        """Take the folder that is written to."""
        self.add_argument("--out", type=_folder, default=Path("results"), help=f"folder for {what} (results)")

    def parse_args(self, args: Iterable[str] | None = None, namespace: Any = None) -> Any:
        """The options; one that is unknown raises InputError with the nearest."""
        from scenes.errors import InputError, nearest

        options, unknown = self.parse_known_args(None if args is None else [*args], namespace)
        for name in (word.partition("=")[0] for word in unknown if word.startswith("-")):
            raise InputError(f"arguments: no option '{name}'{nearest(name, self._option_string_actions)}")
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}")
        return options

    def error(self, message: str) -> NoReturn:
        """Raise InputError with the message and the usage."""
        from scenes import InputError

        raise InputError(f"arguments: {message}{f'; usage: {self.usage}' if self.usage else ''}")


def _folder(text: str) -> Path:
    """The folder that an argument names, also one below `~`, which no shell replaces after `=`."""
    if not text or any(ord(c) < ord(" ") or c == "\x7f" for c in text):
        raise argparse.ArgumentTypeError(f"expected the path of a folder, found {text!r}")
    try:
        return Path(text).expanduser()
    except RuntimeError:
        why = f"expected the path of a folder, and the home of '{text}' is unknown"
        raise argparse.ArgumentTypeError(why) from None


def called() -> str:
    """How the main job was called, for its help and its messages."""
    return CONSOLE if CONSOLE in (Path(word).stem for word in sys.orig_argv[:2]) else "python -m compare.run"


def console() -> None:
    """Do what `python -m compare.run` does, in the same way, as the console command."""
    from runpy import run_module

    run_module("compare.run", run_name="__main__", alter_sys=True)


@contextmanager
def starting(name: str) -> Iterator[None]:
    """End a main program (its `__name__` is `__main__`) that is stopped during its imports as it is ended later."""
    if name != "__main__":
        yield
        return
    try:
        for number in (SIGINT, SIGTERM):
            signal(number, _stop)
        _prepare()
        yield
        if _stops:
            raise _stops[0]
    except BaseException as error:
        sys.exit(_end(error))


# An exception raised by a signal handler may surface inside C code, which drops it or turns it into another one. The
# handler therefore also records it, and what is recorded decides on the exit status.
_stops: list[BaseException] = []  # what signals raised: C code can make another error of it, or drop it


def _stop(number: int, _: object) -> None:
    _stops.append(KeyboardInterrupt() if number == SIGINT else Terminated())
    raise _stops[-1]


def _be_deaf() -> None:
    """Ignore further stop signals while a main program ends: Python would end by the signal."""
    for number in (SIGINT, SIGTERM):
        if getsignal(number) is _stop:
            signal(number, SIG_IGN)


def _prepare() -> None:
    """Prepare the process: streams that are closed or cannot encode every letter, threads, memory."""
    gc.set_threshold(OBJECTS)
    # Python collects garbage once more when it ends, over all that was imported: objects that are frozen are passed
    # over.
    atexit.register(gc.freeze)  # what is left goes with the process
    for descriptor in range(3):  # or the next file that is opened is what engines print to
        try:
            os.fstat(descriptor)
        except OSError:
            os.open(os.devnull, os.O_RDWR)
    if sys.stdout is not None:
        cast("Any", sys.stdout).reconfigure(errors="backslashreplace")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices are small; each thread reserves address space
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")  # it looks for some in all that is installed
    with suppress(ImportError):  # on Windows
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        if 0 <= limit < MIN_MEGABYTES * 2**20:
            raise MemoryError(
                f"the limit is {limit / 2**20:.0f} MB, and {MIN_MEGABYTES} MB of address space are needed"
            )


def command(run: Callable[P, int]) -> Callable[P, int]:
    """A command that ends with one line and an exit status as in the table above, whatever stops it."""

    @wraps(run)
    def ended(*arguments: P.args, **options: P.kwargs) -> int:
        output = _Output(sys.stdout)
        try:
            with redirect_stdout(cast("TextIO", output)):
                status = run(*arguments, **options)
        except BaseException as error:
            try:
                status = _end(error)
            except (KeyboardInterrupt, Terminated) as again:  # in the moment before it is deaf
                status = _end(again)
        _be_deaf()
        output.flush()
        # A reader that closes the pipe (`| head`) is no failure. Standard output is redirected to nowhere so that the
        # interpreter's own flush at exit does not fail again, with a traceback.
        if output.trouble:
            _to_nowhere(sys.stdout)
            if not isinstance(output.trouble, BrokenPipeError):
                print_line(f"standard output: {output.trouble.strerror}; what was to be printed is lost")
                status = status or 2
        return status

    return ended


@contextmanager
def shown_progress(doing: str = "") -> Iterator[Callable[..., None]]:
    """A function that shows what is being done on a line of the terminal; elsewhere nothing is shown or imported.

    It takes one text or more. Lines that are printed meanwhile stay whole, and go where standard output goes.
    """
    if sys.stderr is None or not sys.stderr.isatty():
        yield lambda *_: None
        return
    from rich.console import Console
    from rich.live import Live
    from rich.spinner import Spinner
    from rich.text import Text

    def show(*doing: str) -> None:
        spinner.update(text=Text(": ".join(doing), no_wrap=True, overflow="ellipsis"))

    spinner = Spinner("line", Text(doing))
    together = sys.stdout is not None and sys.stdout.isatty()
    with Live(spinner, console=Console(stderr=True, soft_wrap=True), transient=True, redirect_stdout=together):
        yield show


def _end(error: BaseException) -> int:
    """Report what ended a command in one line, and return the exit status."""
    _be_deaf()
    if isinstance(error, SystemExit) and not isinstance(error.code, str):  # of `--help`
        return error.code or 0
    if _stops and not isinstance(error, KeyboardInterrupt):
        error = _stops[-1]
    if os.environ.get(TRACEBACK):
        import traceback

        traceback.print_exception(error)
    status, line = _ending(error)
    print_line(line)
    exec("")  # else CPython ends by SIGINT where that met code from a string, as a named tuple's is
    return status


def _ending(error: BaseException) -> tuple[int, str]:
    scenes = sys.modules.get("scenes.errors")  # which may be what failed to be imported
    if scenes and isinstance(error, scenes.InputError):
        return 2, str(error)
    if isinstance(error, KeyboardInterrupt):
        return 130, str(error) or "stopped; nothing more was written"
    if isinstance(error, Terminated):
        return 143, "terminated; nothing more was written"
    while error.__cause__ is not None:
        error = error.__cause__
    text = " ".join(str(error).split())[:300]
    if isinstance(error, MemoryError) or getattr(error, "errno", None) == ENOMEM:
        return 2, f"not enough memory: {text or 'ask for fewer samples or turns, or raise the limit'}"
    if isinstance(error, ImportError):
        return 2, f"cannot be imported: {text}"
    return 70, f"internal error: {type(error).__name__}: {text}; {TRACEBACK}=1 shows where"


def print_line(line: str) -> None:
    """Print a line for the user, if there is a place for it."""
    if sys.stderr is not None:
        try:
            print(line, file=sys.stderr, flush=True)
        except OSError:
            _to_nowhere(sys.stderr)


def _to_nowhere(stream: TextIO) -> None:
    """Have what is still to be flushed at the exit go nowhere."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


class _Output:
    """Standard output that no run depends on: where it cannot be written any more, the rest is dropped."""

    def __init__(self, stream: TextIO | None) -> None:
        self.trouble: OSError | None = None
        self._stream = stream

    def write(self, text: str) -> int:
        return self._do(lambda stream: stream.write(text)) or len(text)

    def flush(self) -> None:
        self._do(lambda stream: stream.flush())

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    def _do(self, what: Callable[[TextIO], Any]) -> Any:
        try:
            return what(self._stream) if self._stream and not self.trouble else None
        except OSError as error:
            self.trouble = error
            return None

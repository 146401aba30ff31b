"""How a command ends, whatever ends it: one line, the documented exit status, nothing left behind."""

import os
import resource
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from signal import SIGINT, SIGTERM
from time import sleep
from typing import Any

import pytest

from compare.command_line import TRACEBACK, Parser, command
from scenes import InputError
from tests.comparisons import SLOW

COMMANDS = ("compare.run", "benchmarks.faults", "papers.audit", "papers.optimise")
START = "import os, signal, sys; from compare.command_line import command, shown_progress, starting\n"
IMPORTING = START + "with starting('__main__'):\n    {}\n"
RUNNING = IMPORTING.format("pass") + "def run():\n    {}\n    return 0\nsys.exit(command(run)())"


STOPPED, ENDED = "stopped; nothing more was written", "terminated; nothing more was written"


def ended(code: str, settings: Mapping[str, str] | None = None, **options: Any) -> tuple[int, str | None, str]:
    """Return exit status, output and errors of a program."""
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    environment = {**os.environ, "PYTHONUNBUFFERED": "", **(settings or {})}  # a buffer is flushed at the exit
    done = subprocess.run([sys.executable, "-c", code], encoding="utf-8", env=environment, check=False, **streams)
    return done.returncode, done.stdout, done.stderr


# --- what ends a program, while it imports and later ------------------------------------------------------------------


@pytest.mark.parametrize("program", [IMPORTING, RUNNING])
@pytest.mark.parametrize(
    ("stop", "status", "line"),
    [
        ("os.kill(os.getpid(), signal.SIGINT)", 130, STOPPED),
        ("os.kill(os.getpid(), signal.SIGTERM)", 143, ENDED),
        ("import no_such_package", 2, "cannot be imported: No module named 'no_such_package'"),
        (
            "try: os.kill(os.getpid(), signal.SIGINT)\n    except BaseException: raise ImportError from None",
            130,
            STOPPED,
        ),
        (
            "try: os.kill(os.getpid(), signal.SIGTERM)\n    except BaseException: raise ImportError from None",
            143,
            ENDED,
        ),
        ("raise MemoryError", 2, "not enough memory: ask for fewer samples or turns, or raise the limit"),
        ("bytearray(10**18)", 2, "not enough memory: ask for fewer samples or turns, or raise the limit"),
        ("raise OSError(12, 'Cannot allocate memory')", 2, "not enough memory: [Errno 12] Cannot allocate memory"),
        ("raise KeyError('a\\nb')", 70, f"internal error: KeyError: 'a\\nb'; {TRACEBACK}=1 shows where"),
        ("raise ValueError('a\\nb')", 70, f"internal error: ValueError: a b; {TRACEBACK}=1 shows where"),
    ],
)
def test_one_line_and_a_status(program: str, stop: str, status: int, line: str) -> None:
    assert ended(program.format(stop)) == (status, "", f"{line}\n")


def test_a_stop_of_code_from_a_string_ends_a_module_that_is_run_with_the_same_status(tmp_path: Path) -> None:
    """As what makes named tuples, of which there are many in imports."""
    program = IMPORTING.format("exec('os.kill(os.getpid(), signal.SIGINT)')")
    (tmp_path / "program.py").write_text(program, encoding="utf-8")
    done = subprocess.run([sys.executable, "-m", "program"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, f"{STOPPED}\n")


def test_a_stop_that_a_library_drops_while_it_is_imported_still_stops() -> None:
    drops = "try: os.kill(os.getpid(), signal.SIGINT)\n    except KeyboardInterrupt: pass"
    assert ended(IMPORTING.format(drops) + "print('goes on')") == (130, "", f"{STOPPED}\n")


@pytest.mark.parametrize("program", [IMPORTING, RUNNING])
def test_a_second_stop_while_the_first_ends_the_program_does_nothing(program: str) -> None:
    """At the exit, where Python would end by the signal; and while the line is printed."""
    twice = (
        "import atexit; atexit.register(lambda: os.kill(os.getpid(), signal.SIGINT))\n"
        "    flush = sys.stderr.flush\n"
        "    sys.stderr.flush = lambda: (os.kill(os.getpid(), signal.SIGINT), flush())\n"
        "    os.kill(os.getpid(), signal.SIGINT)"
    )
    assert ended(program.format(twice)) == (130, "", f"{STOPPED}\n")


def test_what_terminates_a_program_lets_it_clean_up() -> None:
    code = "try: os.kill(os.getpid(), signal.SIGTERM)\n    finally: print('clean')"
    assert ended(RUNNING.format(code)) == (143, "clean\n", "terminated; nothing more was written\n")


def test_the_place_of_an_internal_error_is_shown_on_request() -> None:
    status, _, err = ended(RUNNING.format("raise ValueError('a slip')"), {TRACEBACK: "1"})
    assert status == 70
    assert "Traceback" in err
    assert "in run" in err
    assert err.splitlines()[-1].startswith("internal error: ValueError: a slip")


def test_nothing_heavy_is_imported_before_a_stop_is_reported() -> None:
    code = START + "print({'numpy', 'scenes', 'rich', 'pandas'} & {*sys.modules})"
    assert ended(code) == (0, "set()\n", "")


def test_too_little_memory_is_found_at_once() -> None:
    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (400 * 2**20, 400 * 2**20))

    line = "not enough memory: the limit is 400 MB, and 512 MB of address space are needed\n"
    assert ended(IMPORTING.format("print('imported')"), preexec_fn=limit) == (2, "", line)


# --- streams ----------------------------------------------------------------------------------------------------------


def test_output_that_cannot_be_written_costs_no_work() -> None:
    """The rest is still done, in which much or little is printed."""
    for size in (1, 10**6):
        with Path("/dev/full").open("w") as full:
            code = RUNNING.format(f"print('x' * {size}); print('x' * {size}); print('done', file=sys.stderr)")
            status, _, err = ended(code, stdout=full)
        assert status == 2
        assert err == "done\nstandard output: No space left on device; what was to be printed is lost\n"


def test_the_status_of_a_check_outlives_its_output() -> None:
    code = RUNNING.format("print('x' * 10**6); return 1")
    with Path("/dev/full").open("w") as full:
        assert ended(code, stdout=full)[0] == 1
    reader, writer = os.pipe()
    os.close(reader)
    for size in (1, 10**6):
        code = RUNNING.format(f"print('x' * {size}); return 1")
        assert ended(code, stdout=writer) == (1, None, "")
    os.close(writer)


@pytest.mark.parametrize("closed", [(2,), (1, 2), (0, 1, 2)])
def test_streams_that_are_closed(closed: tuple[int, ...], tmp_path: Path) -> None:
    """A file that is opened then does not get what is printed, by whoever prints to the descriptors."""

    def close() -> None:
        for descriptor in closed:
            os.close(descriptor)

    file = tmp_path / "file"
    work = f"f = open({str(file)!r}, 'w'); os.write(2, b'stray'); os.write(1, b''); f.write('whole'); raise ValueError"
    code = RUNNING.format(work)
    assert ended(code, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=close)[0] == 70
    assert file.read_text(encoding="utf-8") == "whole"


def test_an_error_that_cannot_be_printed_keeps_its_status() -> None:
    with Path("/dev/full").open("w") as full:
        assert ended(RUNNING.format("raise ValueError"), stderr=full)[0] == 70


def test_letters_that_an_output_does_not_have() -> None:
    code = RUNNING.format("print('\\u03b8 is an angle')")
    assert ended(code, {"PYTHONIOENCODING": "ascii"}) == (0, "\\u03b8 is an angle\n", "")


def test_lines_stay_whole_beside_progress_on_a_terminal_and_go_where_output_goes(tmp_path: Path) -> None:
    """On a terminal of 20 columns; standard output is that, or a file."""
    import pty
    import termios

    code = RUNNING.format(f"with shown_progress('busy [b]') as show: show('busier'); print('{'x' * 100}')")
    for file in (None, tmp_path / "printed"):
        master, slave = pty.openpty()
        termios.tcsetwinsize(slave, (24, 20))
        stdout = slave if file is None else os.open(file, os.O_WRONLY | os.O_CREAT)
        status, _, _ = ended(code, {"TERM": "xterm", "PYTHONIOENCODING": "ascii"}, stdout=stdout, stderr=slave)
        shown = os.read(master, 10_000).decode()
        assert status == 0
        assert ("x" * 100 in shown) is (file is None)
        assert "busier" in shown
        assert file is None or file.read_text(encoding="utf-8") == "x" * 100 + "\n"


# --- the folder of the results ----------------------------------------------------------------------------------------


def out(text: str) -> Path:
    parser = Parser("run", "run [--out DIR]")
    parser.add_out("the reports")
    path = parser.parse_args([f"--out={text}"]).out
    assert isinstance(path, Path)
    return path


def test_a_folder_at_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert out("~/x") == tmp_path / "x"
    assert out("a/~/x") == Path("a/~/x")


@pytest.mark.parametrize("text", ["", "a\nb", "a\x00b", "\x1b[2J", "~nobody-of-that-name/x"])
def test_what_is_no_folder(text: str) -> None:
    with pytest.raises(InputError, match="argument --out: expected the path of a folder, ") as refused:
        out(text)
    assert str(refused.value).isprintable()


def test_an_exit_that_is_asked_for(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(lambda: len(vars(Parser("run", "run").parse_args(["--help"]))))() == 0
    assert "usage" in capsys.readouterr().out


# --- the real ones ----------------------------------------------------------------------------------------------------


@SLOW
@pytest.mark.parametrize("module", COMMANDS)
def test_every_command_ends_in_one_line(module: str, tmp_path: Path) -> None:
    """While it imports, by Ctrl-C and SIGTERM; by a name that no folder can have, and little memory."""
    base = [sys.executable, "-m", module]

    def end(*arguments: str, **options: Any) -> tuple[int, str]:
        done = subprocess.run([*base, *arguments], capture_output=True, text=True, check=False, timeout=60, **options)
        assert done.stdout == ""
        return done.returncode, done.stderr

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (400 * 2**20, 400 * 2**20))

    for (status, err), expected in (
        (end("--out", "x" * 300, cwd=tmp_path), 2),
        (end(preexec_fn=limit, cwd=tmp_path), 2),
        (stopped(base, SIGINT, 0.3, tmp_path), 130),
        (stopped(base, SIGTERM, 0.6, tmp_path), 143),
    ):
        assert status == expected, err
        assert err.count("\n") == 1, err
    assert list(tmp_path.iterdir()) == []


def stopped(arguments: list[str], signal: int, after: float, folder: Path) -> tuple[int, str]:
    """Return how a command ends that gets a signal after some seconds."""
    with subprocess.Popen(arguments, cwd=folder, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        sleep(after)
        os.killpg(process.pid, signal)
        return process.wait(60), process.communicate()[1]

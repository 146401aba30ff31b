"""How a command ends, whatever ends it: one line, the documented exit status, nothing left behind."""

import os
import re
import resource
import select
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from signal import SIGINT, SIGTERM
from time import sleep
from typing import Any

import pytest

from compare.cli.command import Parser, command
from compare.engines import TRACEBACK
from scenes import InputError
from tests.comparisons import SLOW, sampled

COMMANDS = ("compare.run", "benchmarks.faults", "papers.audit", "papers.optimise")
START = "import os, signal, sys; from compare.cli.command import command, shown_progress, starting\n"
IMPORTING = START + "with starting('__main__'):\n    {}\n"
RUNNING = IMPORTING.format("pass") + "def run():\n    {}\n    return 0\nsys.exit(command(run)())"

STOPPED, ENDED = "stopped; nothing more was written", "terminated; nothing more was written"


def ended(code: str, settings: Mapping[str, str] | None = None, **options: Any) -> tuple[int, str | None, str]:
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE} | options
    environment = {**os.environ, "PYTHONUNBUFFERED": "", **(settings or {})}  # a buffer is flushed at the exit
    done = subprocess.run([sys.executable, "-c", code], encoding="utf-8", env=environment, check=False, **streams)
    return done.returncode, done.stdout, done.stderr


MEMORY = "not enough memory: ask for fewer samples or turns, or raise the limit"
KILL = "os.kill(os.getpid(), signal.{})"
TURNED = "try: " + KILL + "\n    except BaseException: raise ImportError from None"
ENDS = {
    KILL.format("SIGINT"): (130, STOPPED),
    KILL.format("SIGTERM"): (143, ENDED),
    TURNED.format("SIGINT"): (130, STOPPED),
    TURNED.format("SIGTERM"): (143, ENDED),
    "import no_such_package": (2, "cannot be imported: No module named 'no_such_package'"),
    "raise MemoryError": (2, MEMORY),
    "bytearray(10**18)": (2, MEMORY),
    "raise OSError(12, 'Cannot allocate memory')": (2, "not enough memory: [Errno 12] Cannot allocate memory"),
    "raise KeyError('a\\nb')": (70, f"internal error: KeyError: 'a\\nb'; {TRACEBACK}=1 shows where"),
    "raise ValueError('a\\nb')": (70, f"internal error: ValueError: a b; {TRACEBACK}=1 shows where"),
}


@sampled(8)
@pytest.mark.parametrize("program", [IMPORTING, RUNNING])
@pytest.mark.parametrize("stop", ENDS)
def test_one_line_and_a_status(program: str, stop: str) -> None:
    status, line = ENDS[stop]
    assert ended(program.format(stop)) == (status, "", f"{line}\n")


@pytest.mark.parametrize(
    ("stop", "status", "line"),
    [
        (InputError("mine.toml: no such file"), 2, "mine.toml: no such file"),
        (KeyboardInterrupt("stopped; half is written"), 130, "stopped; half is written"),
        (SystemExit("usage"), 70, f"internal error: SystemExit: usage; {TRACEBACK}=1 shows where"),
    ],
)
def test_what_stops_a_command(stop: BaseException, status: int, line: str, capsys: pytest.CaptureFixture[str]) -> None:
    @command
    def main() -> int:
        raise stop

    assert main() == status
    assert capsys.readouterr() == ("", f"{line}\n")


def test_a_stop_of_code_from_a_string_ends_a_module_that_is_run_with_the_same_status(tmp_path: Path) -> None:
    """As what makes named tuples, of which there are many in imports."""
    program = IMPORTING.format("exec('os.kill(os.getpid(), signal.SIGINT)')")
    (tmp_path / "program.py").write_text(program, encoding="utf-8")
    done = subprocess.run([sys.executable, "-m", "program"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (130, f"{STOPPED}\n")


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


def test_a_stop_that_is_dropped_while_a_library_is_imported_stops_and_lets_a_program_clean_up() -> None:
    drops = "try: os.kill(os.getpid(), signal.SIGINT)\n    except KeyboardInterrupt: pass"
    assert ended(IMPORTING.format(drops) + "print('goes on')") == (130, "", f"{STOPPED}\n")
    code = f"try: {KILL.format('SIGTERM')}\n    finally: print('clean')"
    assert ended(RUNNING.format(code)) == (143, "clean\n", f"{ENDED}\n")


def test_the_place_of_an_internal_error_is_shown_on_request() -> None:
    status, _, err = ended(RUNNING.format("raise ValueError('a slip')"), {TRACEBACK: "1"})
    assert status == 70
    assert re.match(r"Traceback.*in run\n.*\ninternal error: ValueError: a slip[^\n]*\n$", err, re.DOTALL)


def test_neither_what_is_heavy_nor_what_windows_lacks_is_needed_to_start() -> None:
    """Processes are not begun there in this test, only everything is imported that a run imports."""
    assert ended(START + "print({'numpy', 'scenes', 'rich', 'pandas'} & {*sys.modules})") == (0, "set()\n", "")
    lacking = "del time.clock_gettime; sys.modules |= dict.fromkeys(('fcntl', 'grp', 'pwd', 'resource'))"
    assert ended(f"import sys, time; {lacking}; import compare.run, compare.cli.report") == (0, "", "")


UNUSED = {  # packages, and what is for families, failures and `--check`
    *("IPython", "dask", "exudyn", "flint", "narwhals", "numpy.ma", "pandas", "pint"),
    *("plotly", "pymunk", "rich", "scipy", "uplot"),
    *("compare.measure.many.family", "compare.judge.canaries", "compare.measure.hard.case", "compare.judge.triage"),
}


def test_packages_that_the_main_job_does_without_are_not_imported(tmp_path: Path) -> None:
    """What makes it cheap, without a clock: `python -m benchmarks.main_job` measures."""
    job = f"main('--engines analytic --samples 8 --out {tmp_path}'.split())"
    _, printed, _ = ended(f"import sys; from compare.run import main; {job}; print(*sys.modules)")
    loaded = {*str(printed).splitlines()[-1].split()}
    assert {"numpy", "jinja2", "analytic"} <= loaded
    assert not UNUSED & loaded


def little_memory() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (400 * 2**20, 400 * 2**20))


def test_too_little_memory_is_found_at_once() -> None:
    line = "not enough memory: the limit is 400 MB, and 512 MB of address space are needed\n"
    assert ended(IMPORTING.format("print('imported')"), preexec_fn=little_memory) == (2, "", line)


@pytest.mark.parametrize("size", [1, 10**6])
def test_output_that_cannot_be_written_costs_no_work(size: int) -> None:
    """The rest is still done, in which much or little is printed, and the status is that of the work."""
    code, writes = f"print('x' * {size}); print('done', file=sys.stderr)", f"print('x' * {size}); "
    lost = "standard output: No space left on device; what was to be printed is lost"
    with Path("/dev/full").open("w") as full:
        assert ended(RUNNING.format(writes + code), stdout=full) == (2, None, f"done\n{lost}\n")
        assert ended(RUNNING.format(f"{writes}return 1"), stdout=full)[0] == 1
    reader, writer = os.pipe()
    os.close(reader)
    assert ended(RUNNING.format(f"{writes}return 1"), stdout=writer) == (1, None, "")
    os.close(writer)


@pytest.mark.parametrize("closed", [2, 1, 0])
def test_streams_that_are_closed(closed: int, tmp_path: Path) -> None:
    """That one and all after it: a file that is opened then does not get what is printed to the descriptors."""

    def close() -> None:
        os.closerange(closed, 3)

    file = tmp_path / "file"
    work = f"f = open({str(file)!r}, 'w'); os.write(2, b'stray'); os.write(1, b''); f.write('whole'); raise ValueError"
    code = RUNNING.format(work)
    assert ended(code, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=close)[0] == 70
    assert file.read_text(encoding="utf-8") == "whole"


def test_what_cannot_be_printed() -> None:
    """An error keeps its status, and a letter that the output does not have is spelt."""
    with Path("/dev/full").open("w") as full:
        assert ended(RUNNING.format("raise ValueError"), stderr=full)[0] == 70
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
        shown = ""
        while select.select([master], [], [], 0.5)[0]:  # which comes in parts on a busy machine
            shown += os.read(master, 10_000).decode()
        assert status == 0
        assert ("x" * 100 in shown) is (file is None)
        assert "busier" in shown
        assert file is None or file.read_text(encoding="utf-8") == "x" * 100 + "\n"


def out(text: str) -> Path:
    parser = Parser("run", "run [--out DIR]")
    parser.add_out("the reports")
    path = parser.parse_args([f"--out={text}"]).out
    assert isinstance(path, Path)
    return path


def test_a_folder_at_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    assert (out("~/x"), out("a/~/x")) == (tmp_path / "x", Path("a/~/x"))


@pytest.mark.parametrize("text", ["", "a\nb", "a\x00b", "\x1b[2J", "~nobody-of-that-name/x"])
def test_what_is_no_folder(text: str) -> None:
    with pytest.raises(InputError, match="argument --out: expected the path of a folder, ") as refused:
        out(text)
    assert str(refused.value).isprintable()


def test_help_and_usage(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(lambda: len(vars(Parser("run", "run").parse_args(["--help"]))))() == 0
    assert "usage" in capsys.readouterr().out
    with pytest.raises(InputError, match=r"arguments: unrecognized arguments: x; usage: run \[--out DIR\]"):
        Parser("run", "run [--out DIR]").parse_args(["x"])


@SLOW
@pytest.mark.parametrize("module", COMMANDS)
def test_every_command_ends_in_one_line(module: str, tmp_path: Path) -> None:
    """While it imports, by Ctrl-C and SIGTERM; by a name that no folder can have, and little memory."""

    def end(status: int, *arguments: str, stop: int = 0, **options: Any) -> None:
        command = [sys.executable, "-m", module, *arguments]
        options |= {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "start_new_session": True}
        with subprocess.Popen(command, cwd=tmp_path, **options) as process:
            if stop:
                maps = Path(f"/proc/{process.pid}/maps")
                while "numpy" not in maps.read_text():  # the first of the packages that take long to import
                    sleep(1e-3)
                os.killpg(process.pid, stop)
            out, err = process.communicate(timeout=60)
        assert (process.returncode, out, err.count("\n")) == (status, "", 1), err

    end(2, "--out", "x" * 300)
    end(2, preexec_fn=little_memory)
    end(130, stop=SIGINT)
    end(143, stop=SIGTERM)
    assert list(tmp_path.iterdir()) == []

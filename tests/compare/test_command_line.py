"""The shell of every command: its exit status and what it prints, whatever stops it."""

import subprocess
import sys

import pytest

from compare.command_line import Parser, command
from scenes import InputError


@pytest.mark.parametrize(
    ("stop", "status", "printed"),
    [
        (InputError("mine.toml: no such file"), 2, "mine.toml: no such file\n"),
        (KeyboardInterrupt(), 130, "stopped; nothing more was written\n"),
        (SystemExit("usage"), 70, "internal error: SystemExit: usage; LINKAGE_TRACEBACK=1 shows where\n"),
        (KeyboardInterrupt("stopped; half is written"), 130, "stopped; half is written\n"),
    ],
)
def test_what_stops_a_command(
    stop: BaseException, status: int, printed: str, capsys: pytest.CaptureFixture[str]
) -> None:
    @command
    def main() -> int:
        raise stop

    assert main() == status
    assert capsys.readouterr() == ("", printed)


def test_a_command_that_nothing_stops() -> None:
    assert command(lambda status: status)(1) == 1


def test_bad_arguments_are_named_with_the_usage() -> None:
    with pytest.raises(InputError, match=r"arguments: unrecognized arguments: x; usage: run \[--out DIR\]"):
        Parser("run", "run [--out DIR]").parse_args(["x"])


def test_output_that_nobody_reads_is_no_error() -> None:
    code = "import sys; from compare.command_line import command; sys.exit(command(lambda: print('x' * 10**6) or 0)())"
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 0


def test_what_windows_lacks_is_not_needed_to_start() -> None:
    """Processes are not begun there in this test, only everything is imported that a run imports."""
    lacking = "del time.clock_gettime; sys.modules |= dict.fromkeys(('fcntl', 'grp', 'pwd', 'resource'))"
    code = f"import sys, time; {lacking}; import compare.run, compare.jobs.report"
    subprocess.run([sys.executable, "-c", code], check=True)

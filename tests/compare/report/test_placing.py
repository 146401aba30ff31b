"""Results appear whole or not at all, whatever is in their place, fails, or goes on at the same time."""

import fcntl
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from threading import Timer
from types import ModuleType

import pytest

from compare.report.output import placing
from compare.report.output.placing import OLDER, check_writable, placed, remove
from scenes import InputError

OWN = ("page.html", "motion.*.csv")
LEFT = ".name-0123abcd"


def contents(folder: Path) -> dict[str, str]:
    """All files below a folder."""
    return {str(p.relative_to(folder)): p.read_text(encoding="utf-8") for p in folder.rglob("*") if p.is_file()}


def alone(folder: Path, files: dict[str, str]) -> None:
    """Check that a folder has these files, and nothing is beside it."""
    assert contents(folder) == files
    assert list(folder.parent.iterdir()) == [folder]


def fill(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


OLDER_RESULT = {"page.html": "older", "motion.a.csv": "1", "motion.b.csv": "2"}
NEW = {"page.html": "new", "motion.a.csv": "3"}
OTHERS = {"notes.txt": "the user's", "more/deep/figure.svg": "the user's too", "family.html": "of another kind"}


@pytest.fixture
def older(tmp_path: Path) -> Path:
    """A folder that holds an older result and what else is there."""
    return fill(tmp_path / "name", OLDER_RESULT | OTHERS)


@pytest.fixture(params=[True, False], ids=["in one step", "by renames"])
def either_way(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Have the system exchange two folders, and then not."""
    if not request.param:
        monkeypatch.setattr(placing, "_exchanged", lambda *_: False)


def replace(folder: Path) -> None:
    with placed(folder, "name", OWN) as aside:
        fill(aside, NEW)


def test_a_first_result_makes_its_folders(tmp_path: Path) -> None:
    replace(tmp_path / "new" / "out")
    assert contents(tmp_path) == {f"new/out/name/{name}": text for name, text in NEW.items()}
    beside = tmp_path / "new" / "out" / "beside"
    beside.mkdir()
    assert (tmp_path / "new" / "out" / "name").stat().st_mode == beside.stat().st_mode


def not_permitted(*_: object, **__: object) -> None:
    raise OSError(1, "Operation not permitted")


@pytest.mark.usefixtures("either_way")
@pytest.mark.parametrize("cannot", [None, (os, "link"), (fcntl, "flock")])
def test_the_older_stays_until_the_new_takes_its_place(
    cannot: tuple[ModuleType, str] | None, older: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On file systems that cannot exchange folders, link files, or lock, too."""
    if cannot:
        monkeypatch.setattr(*cannot, not_permitted)
    (older / "link").symlink_to("nowhere")
    older.chmod(0o750)
    with placed(older.parent, "name", OWN) as aside:
        assert aside.parent == older.parent
        fill(aside, NEW)
        assert contents(older) == OLDER_RESULT | OTHERS
    alone(older, NEW | OTHERS)
    assert (older / "link").readlink() == Path("nowhere")
    assert older.stat().st_mode & 0o777 == 0o750


def test_two_folders_are_exchanged_in_one_step(older: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No rename is needed where the system can."""
    monkeypatch.setattr(Path, "rename", not_permitted)
    replace(older.parent)
    assert contents(older) == NEW | OTHERS


@pytest.mark.usefixtures("either_way")
@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError("a slip")])
def test_a_failure_leaves_the_older_one(error: BaseException, older: Path) -> None:
    def fail() -> None:
        with placed(older.parent, "name", OWN) as aside:
            fill(aside, NEW)
            raise error

    expected = InputError if isinstance(error, OSError) else type(error)
    with pytest.raises(expected, match="No space left" if isinstance(error, OSError) else None):
        fail()
    alone(older, OLDER_RESULT | OTHERS)


@pytest.mark.parametrize("error", [OSError(5, "Input/output error"), KeyboardInterrupt()])
def test_a_swap_that_fails_halfway_puts_the_older_one_back(
    error: BaseException, older: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    real = Path.rename

    def second_fails(path: Path, to: Path) -> Path:
        if path.name.startswith(".name-") and not path.name.endswith(OLDER):
            raise error
        return real(path, to)

    monkeypatch.setattr(placing, "_exchanged", lambda *_: False)
    monkeypatch.setattr(Path, "rename", second_fails)
    with pytest.raises(InputError if isinstance(error, OSError) else KeyboardInterrupt):
        replace(older.parent)
    alone(older, OLDER_RESULT | OTHERS)


def test_a_link_to_a_folder_is_followed(tmp_path: Path) -> None:
    real = fill(tmp_path / "real" / "folder", OLDER_RESULT | OTHERS)
    out = tmp_path / "out"
    out.mkdir()
    (out / "name").symlink_to(real)
    check_writable(out, ["name"], OWN)
    replace(out)
    assert (out / "name").readlink() == real
    alone(real, NEW | OTHERS)


def test_what_killed_runs_left_goes_and_what_others_need_stays(older: Path) -> None:
    out = older.parent
    others = {".name-backup", ".name-0123abcd.bak", ".another-0123abcd"}
    for name in (LEFT, ".name-89abcdef", *others):
        fill(out / name, {"page.html": "half"})
    running = os.open(out / ".name-89abcdef", os.O_RDONLY)
    fcntl.flock(running, fcntl.LOCK_EX)
    replace(out)
    os.close(running)
    assert {path.name for path in out.iterdir()} == {".name-89abcdef", "name", *others}
    assert contents(older) == NEW | OTHERS


def test_a_run_killed_between_two_renames_loses_nothing(older: Path) -> None:
    older.rename(older.with_name(f"{LEFT}{OLDER}"))
    fill(older.with_name(LEFT), NEW)
    replace(older.parent)
    alone(older, NEW | OTHERS)


@pytest.mark.usefixtures("either_way")
def test_runs_at_the_same_time_leave_one_whole_result(older: Path) -> None:
    def run(number: int) -> None:
        with placed(older.parent, "name", OWN) as aside:
            for name in ("page.html", "motion.a.csv", f"motion.{number}.csv"):
                fill(aside, {name: str(number)})

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(run, range(40)))
    last = (older / "page.html").read_text(encoding="utf-8")
    alone(older, OTHERS | {"page.html": last, "motion.a.csv": last, f"motion.{last}.csv": last})


def test_a_partial_result_goes_with_its_folder_unless_more_is_there(tmp_path: Path) -> None:
    alone = fill(tmp_path / "alone", OLDER_RESULT)
    remove(alone, OWN)
    assert not alone.exists()
    shared = fill(tmp_path / "shared", OLDER_RESULT | OTHERS)
    remove(shared, OWN)
    assert contents(shared) == OTHERS
    remove(tmp_path / "no such", OWN)


# --- what is in the way is found before -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "out", "words"),
    [
        (Path.touch, ".", "name is a file"),
        (lambda place: (place / "page.html").mkdir(parents=True), ".", "page.html is a folder"),
        (lambda place: (place / "motion.x.csv").mkdir(parents=True), ".", "motion.x.csv is a folder"),
        (lambda place: place.symlink_to(place.parent / "not there"), ".", "name is a link to what is not there"),
        (lambda place: place.symlink_to(place), ".", "name is a link to what is not there"),
        (Path.touch, "name", "name is a file"),
        (Path.touch, "name/below", "name is a file"),
        (lambda place: place.symlink_to("not there"), "name/below", "name is a link to what is not there"),
        (lambda _: None, "x" * 300, "a name has 255 bytes at most there"),
        (lambda _: None, "new/" + "x" * 300, "a name has 255 bytes at most there"),
        (lambda _: None, "new/" + "é" * 130, "a name has 255 bytes at most there"),
    ],
)
def test_what_is_in_the_way(make: Callable[[Path], object], out: str, words: str, tmp_path: Path) -> None:
    make(tmp_path / "name")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(InputError, match=f"^--out {tmp_path / out}: expected a folder .*{words}$"):
        check_writable(tmp_path / out, ["first", "name"], OWN)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_folder_that_cannot_be_written(older: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Neither the place nor what it is in; the superuser can, so that the answer is given here."""
    for locked in (older, older.parent):
        monkeypatch.setattr(os, "access", lambda path, _, locked=locked: path != locked)
        with pytest.raises(InputError, match=f"{locked} cannot$"):
            check_writable(older.parent, ["name"], OWN)
    with pytest.raises(InputError, match=f"{older.parent} cannot$"):
        check_writable(older.parent / "new", ["name"], OWN)


def test_nothing_is_in_the_way(older: Path) -> None:
    before = sorted(older.parent.rglob("*"))
    check_writable(older.parent, ["name", "other"], OWN)
    check_writable(older.parent / "new" / "folder", ["name"], OWN)
    assert sorted(older.parent.rglob("*")) == before


def test_a_working_folder_that_is_gone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    with pytest.raises(InputError, match="the working folder is gone"):
        check_writable(Path("results"), ["name"], OWN)
    check_writable(tmp_path, ["name"], OWN)


def test_a_lock_of_another_process_is_waited_for_and_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing is lost: the result is placed once the other lets go."""
    monkeypatch.setattr("compare.report.output.placing.PATIENCE", 0.2)
    (tmp_path / "name").mkdir()
    other = ExitStack()
    assert other.enter_context(placing._locked(tmp_path))
    Timer(1.0, other.close).start()
    with placed(tmp_path, "name", OWN) as aside:
        (aside / "page.html").touch()
    assert capsys.readouterr().err == f"{tmp_path}: waiting for the lock that another process has on it\n"
    assert (tmp_path / "name" / "page.html").exists()

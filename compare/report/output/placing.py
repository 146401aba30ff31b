"""Results appear whole or not at all: a new folder is written beside the older one and takes its place in one step.

Beside `DIR/<name>/` a run writes `DIR/.<name>-<8 hex digits>/`, under a lock for as long as it lives. What a killed run
left there is removed by the next, and an older result that was away for the moment is put back.
"""

import ctypes
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from fnmatch import fnmatchcase
from pathlib import Path
from secrets import token_hex
from time import sleep

from scenes import InputError

PATIENCE, TRIES = 2.0, 100  # s without a lock until that is told, and how often it is tried until then
OLDER = "-older"  # after the name of a folder aside: the older result, where no exchange in one step is possible
ESCAPED = "backslashreplace"  # of files: what UTF-8 lacks of a name that did not decode, as its escape
AT_FOLDER, EXCHANGE = -100, 2  # AT_FDCWD and RENAME_EXCHANGE of Linux


def check_writable(folder: Path, names: Iterable[str], patterns: Sequence[str]) -> None:
    """Look for what is in the way of results, whose files match `patterns`, before they are computed; create nothing.

    Raises:
        InputError: one of the results is sure not to be written.
    """
    for name in names:
        try:
            trouble = _in_the_way(folder / name, patterns)
        except FileNotFoundError:
            trouble = "the working folder is gone"
        except OSError as error:
            trouble = f"{folder / name}: {error.strerror}"
        if trouble:
            raise InputError(f"--out {folder}: expected a folder that can be written, and {trouble}")


def _in_the_way(place: Path, patterns: Sequence[str]) -> str:
    """What keeps a result from its place, or nothing."""
    existing = next(path for path in (place.absolute(), *place.absolute().parents) if os.path.lexists(path))
    if not os.path.exists(existing):  # noqa: PTH110 - a loop of links is no error to it
        return f"{existing} is a link to what is not there"
    if not existing.is_dir():
        return f"{existing} is a file"
    longest = os.pathconf(existing, "PC_NAME_MAX") if hasattr(os, "pathconf") else 255
    new = (*place.absolute().relative_to(existing).parts, _aside(place).name + OLDER)
    if any(len(os.fsencode(part)) > longest for part in new):
        return f"a name has {longest} bytes at most there"
    place = place.resolve()
    if os.path.ismount(place):
        return f"{place} is where a disk is mounted"
    for needed in {existing, place.parent} if place.exists() else {existing}:
        if not os.access(needed, os.R_OK | os.W_OK | os.X_OK):
            return f"{needed} cannot"
    folders = (path for path in place.iterdir() if _is_own(path, patterns) and path.is_dir()) if place.exists() else ()
    return next((f"{path} is a folder" for path in folders), "")


def _is_own(path: Path, patterns: Sequence[str]) -> bool:
    return any(fnmatchcase(path.name, pattern) for pattern in patterns)


@contextmanager
def placed(folder: Path, name: str, patterns: Sequence[str]) -> Iterator[Path]:
    """Yield an empty folder for a result, which then takes the place of `folder/<name>/` in one step.

    What that holds beside the files that `patterns` matches stays there. It is followed where it is a link.

    Raises:
        InputError: the result cannot be written; the older one is then as it was.
    """
    place = (folder / name).resolve()
    made = not place.parent.exists()
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        # Two locks. That of the parent folder is held only while the folder aside is made and while places are
        # exchanged, so that runs of different scenes do not wait for each other. That of the folder aside is held until
        # the end: it tells a later run's `_clean` that its owner lives. After the exchange the folder aside is the
        # older result, and its removal is last.
        with ExitStack() as held:
            with _locked(place.parent):
                _clean(place)
                aside = _aside(place)
                aside.mkdir()
                held.enter_context(_locked(aside, wait=False))
            held.callback(shutil.rmtree, aside, ignore_errors=True)
            yield aside
            with _locked(place.parent):
                if place.exists():
                    _carry_over(place, aside, patterns)
                _swap(aside, place)
    except OSError as error:
        raise InputError(f"--out {folder}: cannot be written ({error.strerror or error})") from None
    finally:
        if made:
            with suppress(OSError):
                place.parent.rmdir()  # empty, where nothing was written


def replace_file(file: Path, text: Callable[[], str]) -> None:
    """Write a file that takes the place of an older one in one step; OSError where that is impossible.

    Its text is made under the lock of its folder, so that of two runs the later one writes what both have there.
    """
    with _locked(file.parent):
        for left in file.parent.glob(f".{file.name}-????????"):  # by a run that was killed
            left.unlink()
        aside = _aside(file)
        try:
            aside.write_text(text(), encoding="utf-8", errors=ESCAPED)
            aside.replace(file)
        finally:
            aside.unlink(missing_ok=True)


def remove(folder: Path, patterns: Sequence[str]) -> None:
    """Remove the files of a result, and their folder if nothing else is there."""
    with suppress(OSError):
        for path in folder.iterdir():
            if _is_own(path, patterns):
                path.unlink()
        folder.rmdir()


def _aside(place: Path) -> Path:
    return place.with_name(f".{place.name}-{token_hex(4)}")


def _clean(place: Path) -> None:
    """Remove what runs that were killed left beside a place, and put an older result back that one of them had away."""
    for left in place.parent.iterdir():
        if not re.fullmatch(rf"\.{re.escape(place.name)}-[0-9a-f]{{8}}({OLDER})?", left.name):
            continue
        # A run was killed between the two renames of a system that has no exchange: the result is away and is put back.
        if left.name.endswith(OLDER) and not place.exists():
            left.rename(place)
            continue
        with _locked(left, wait=False) as ours:
            if ours:
                shutil.rmtree(left, ignore_errors=True)


def _carry_over(older: Path, new: Path, patterns: Sequence[str]) -> None:
    """Give a new folder what else is in the older one, and its owner and mode."""
    for path in older.iterdir():
        if _is_own(path, patterns):
            continue
        if path.is_dir() and not path.is_symlink():
            shutil.copytree(path, new / path.name, symlinks=True, copy_function=_linked)
        else:
            _linked(path, new / path.name)
    shutil.copymode(older, new)
    with suppress(OSError, AttributeError):
        os.chown(new, older.stat().st_uid, older.stat().st_gid)


def _linked(path: str | Path, target: str | Path) -> None:
    try:
        # Hard links: files that are not of the result may be large, and are only carried from one folder to the next.
        os.link(path, target, follow_symlinks=False)
    except (OSError, NotImplementedError):
        shutil.copy2(path, target, follow_symlinks=False)


def _swap(aside: Path, place: Path) -> None:
    """Put a folder in its place; the older one is then aside."""
    if not place.exists():
        aside.rename(place)
    elif not _exchanged(aside, place):
        older = aside.with_name(aside.name + OLDER)
        place.rename(older)
        try:
            aside.rename(place)
        except BaseException:
            older.rename(place)
            raise
        shutil.rmtree(older, ignore_errors=True)


def _exchanged(first: Path, second: Path) -> bool:
    """Exchange two folders in one step, if the system can."""
    if sys.platform != "linux":
        return False
    # `renameat2` with RENAME_EXCHANGE is one step for every reader: at no moment is there no result. Python has no call
    # of its own for it. A file system that does not know it returns an error, and two renames are made instead.
    rename = getattr(ctypes.CDLL(None), "renameat2", None)
    paths = AT_FOLDER, os.fsencode(first), AT_FOLDER, os.fsencode(second)
    return rename is not None and not rename(*paths, ctypes.c_uint(EXCHANGE))


@contextmanager
def _locked(folder: Path, *, wait: bool = True) -> Iterator[bool]:
    """Have the lock of a folder, which goes with the process that holds it; yield whether it is ours."""
    if sys.platform == "win32":  # there are no such locks
        yield False
        return
    from fcntl import LOCK_EX, LOCK_NB, flock

    with ExitStack() as held:
        ours = False
        with suppress(OSError):  # it is another run's
            # `flock` on an open folder: the kernel frees it when the process ends, however it ends, and no lock file is
            # left behind.
            file = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
            held.callback(os.close, file)
            for _ in range(TRIES if wait else 0):
                with suppress(BlockingIOError):
                    flock(file, LOCK_EX | LOCK_NB)
                    break
                sleep(PATIENCE / TRIES)
            else:
                if wait:
                    print(f"{folder}: waiting for the lock that another process has on it", file=sys.stderr, flush=True)
                flock(file, LOCK_EX | (0 if wait else LOCK_NB))
            ours = True
        yield ours

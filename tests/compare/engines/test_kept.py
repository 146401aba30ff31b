"""Results kept in a file: by the same version, by several runs at a time, whatever else is in the file."""

import json
import os
import re
import tracemalloc
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from compare.engines.kept import Kept

MOST = 2**20
ROWS = [{"x": 1.5, "reason": "é", "none": None, "nan": float("inf")}]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return tmp_path / "out" / "kept.jsonl"


def test_results_are_read_again_by_the_same_version_and_key(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    Kept(file, "key").add("a", ROWS)
    Kept(file, "key").add("b", [])
    assert dict(Kept(file, "key").read()) == {"a": ROWS, "b": []}
    assert Kept(file, "key").trouble == ""
    assert dict(Kept(file, "other key").read()) == {}
    monkeypatch.setattr("compare.engines.kept.version", lambda: "another")
    assert dict(Kept(file, "key").read()) == {}
    Kept(file, "key").add("c", [])
    monkeypatch.undo()
    assert dict(Kept(file, "key").read()) == {"a": ROWS, "b": []}


SPOILT: Mapping[str, Callable[[bytes], bytes]] = {
    "cut": lambda line: line[: len(line) // 2],
    "changed": lambda line: line.replace(b"1.5", b"2.5"),
    "without its digest": lambda line: line.partition(b" ")[2],
    "another digest": bytes.upper,
}


@pytest.mark.parametrize("how", SPOILT)
def test_a_line_that_is_spoilt_takes_no_other_with_it(how: str, file: Path) -> None:
    for name in "abc":
        Kept(file, "key").add(name, ROWS)
    *_, second, third = file.read_bytes().split(b"\n")
    file.write_bytes(file.read_bytes().replace(second, SPOILT[how](second)))
    assert dict(Kept(file, "key").read()).keys() == {"a", "c"}
    file.write_bytes(file.read_bytes().replace(third, SPOILT[how](third)))
    Kept(file, "key").add("d", ROWS)
    assert dict(Kept(file, "key").read()).keys() == {"a", "d"}


@pytest.mark.parametrize(
    "junk",
    [
        *(b"\xff\xfe\x00", b"3.14", b"null", b"[1, 2]", b"{}", b'"text"', b"[[", b"[" * 100_000, b"\x00" * 1000, b""),
        *(b'["a", [{"x": 1}]]', b'["a", {"x": []}]', b" ", b"\xef\xbb\xbf", b"\r", b"9" * 10_000),
        json.dumps({"of": "an earlier version", "key": "key"}).encode() + b'\n["a", [{"x": 1}]]',
    ],
)
def test_junk_in_the_file_does_not_count(junk: bytes, file: Path) -> None:
    file.parent.mkdir()
    file.write_bytes(junk)
    kept = Kept(file, "key")
    assert dict(kept.read()) == {}
    kept.add("a", ROWS)
    assert (dict(Kept(file, "key").read()), kept.trouble) == ({"a": ROWS}, "")


def test_a_line_without_end_is_read_in_parts(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("compare.engines.kept.MAX_BYTES", MOST)
    file.parent.mkdir()
    with file.open("wb") as junk:
        junk.truncate(20 * MOST)  # which takes no room
    Kept(file, "key").add("a", ROWS)
    tracemalloc.start()
    assert dict(Kept(file, "key").read()) == {"a": ROWS}
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 10 * MOST


IN_THE_WAY: Mapping[str, tuple[Callable[[Path], object], str]] = {
    "a folder": (lambda file: file.mkdir(), "not a file"),
    "a pipe": (os.mkfifo, "not a file"),
    "a device": (lambda file: file.symlink_to("/dev/zero"), "not a file"),
    "a loop": (lambda file: file.symlink_to(file), "Too many levels"),
    "a file for its folder": (lambda file: [do(file.parent) for do in (Path.rmdir, Path.touch)], "exists|Not a dir"),
}


@pytest.mark.parametrize("what", IN_THE_WAY)
def test_what_cannot_be_kept_is_named(what: str, file: Path) -> None:
    make, words = IN_THE_WAY[what]
    file.parent.mkdir()
    make(file)
    kept = Kept(file, "key")
    kept.add("a", ROWS)
    assert dict(kept.read()) == {}
    assert re.fullmatch(f"nothing is kept for another run in {file}: .*({words}).*", kept.trouble)


def test_a_full_disk_is_no_loss_for_the_run(file: Path) -> None:
    kept = Kept(file, "key")
    kept.add("a", ROWS)
    file.unlink()
    file.symlink_to("/dev/full")
    kept.add("b", ROWS)
    kept.add("c", ROWS)
    assert kept.trouble.endswith(f"{file}: No space left on device")


def test_runs_at_the_same_time(file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Results of more than a buffer each: none is cut by another's."""
    monkeypatch.setattr("compare.engines.kept.version", lambda: "the same")
    rows = [{"text": "x" * 30_000}]

    def run(number: int) -> None:
        kept = Kept(file, "key")
        for case in range(10):
            kept.add(f"{number} {case}", rows)

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(run, range(8)))
    assert dict(Kept(file, "key").read()) == {f"{number} {case}": rows for number in range(8) for case in range(10)}

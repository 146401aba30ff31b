"""What is kept beside the byte code never changes a page: one that is old or damaged does not count."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from jinja2 import Environment

from compare.report import byte_code, html


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Keep what is made in a folder that is empty at first, and make it anew for each test."""
    monkeypatch.setattr(sys, "pycache_prefix", str(tmp_path / "kept"))
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    html._templates.cache_clear()
    yield
    html._templates.cache_clear()


def kept(tmp_path: Path) -> list[Path]:
    return [path for path in tmp_path.rglob("*") if path.is_file()]


@pytest.mark.parametrize("damage", [b"", b"x" * 100, None])
def test_a_damaged_file_does_not_count(tmp_path: Path, damage: bytes | None) -> None:
    byte_code.write("it", b"source", b"made" * 100)
    assert byte_code.read("it", b"source") == b"made" * 100
    (file,) = kept(tmp_path)
    file.write_bytes(file.read_bytes()[:-1] if damage is None else damage)
    assert byte_code.read("it", b"source") is None


def test_what_was_made_from_anything_else_does_not_count() -> None:
    byte_code.write("it", b"source", b"made")
    assert byte_code.read("it", b"another source") is None
    assert byte_code.read("another", b"source") is None


def test_nothing_is_written_where_python_writes_no_byte_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    byte_code.write("it", b"source", b"made")
    assert not kept(tmp_path)


def test_a_folder_that_cannot_be_written_is_no_trouble(tmp_path: Path) -> None:
    (tmp_path / "kept").write_text("a file in its place")
    byte_code.write("it", b"source", b"made")
    assert byte_code.read("it", b"source") is None


def test_a_page_of_kept_templates_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = Path(html.__file__).with_name("style.css").read_text(encoding="utf-8")
    assert html.render("style.css") == text
    html._templates.cache_clear()
    with monkeypatch.context() as context:
        context.delattr(Environment, "compile")  # it is not needed
        assert html.render("style.css") == text
    for file in kept(tmp_path):
        file.write_bytes(file.read_bytes()[:-9])
    html._templates.cache_clear()
    assert html.render("style.css") == text

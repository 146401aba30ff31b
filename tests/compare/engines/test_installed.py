"""What is installed is what `importlib.metadata` finds."""

from importlib import metadata
from pathlib import Path
from zipfile import ZipFile

import pytest

from compare.engines.installed import may_offer, version
from compare.engines.kept import REPORTED
from compare.engines.registry import OWN


@pytest.mark.parametrize(
    "name", [*REPORTED, *(entry.distribution for entry in OWN.values()), "Python_Flint", "nobody's"]
)
def test_versions(name: str) -> None:
    """Under whatever spelling of its name; one that is not installed is none."""
    try:
        known = metadata.version(name)
    except metadata.PackageNotFoundError:
        with pytest.raises(metadata.PackageNotFoundError):
            version(name)
    else:
        assert version(name) == known


@pytest.mark.parametrize(
    ("folder", "text"),
    [
        ("a_b-2.0.dist-info", "Metadata-Version: 2.1\nName: a.b\nVersion: 2.0+x\n\nVersion: 9\n"),
        ("A_B-2.0.dist-info", "Name: a.b\nSummary: of\n Version: 1\nVERSION-OF: 3\nVersion:   2.0+x\n"),
    ],
)
def test_a_version_is_a_line_of_the_head(
    folder: str, text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / folder).mkdir()
    (tmp_path / folder / "METADATA").write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert version("a-b") == "2.0+x" == metadata.version("a-b")


def test_a_group_that_nobody_offers_needs_no_look(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that is offered is found, as soon as it is there; what the library finds elsewhere is left to it."""
    assert may_offer("pytest11")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert not may_offer("a.group.of.nobody")
    info = tmp_path / "engine-1.dist-info"
    info.mkdir()
    (info / "entry_points.txt").write_text("[a.group.of.nobody]\nmine = mine\n", encoding="utf-8")
    assert may_offer("a.group.of.nobody")
    with ZipFile(tmp_path / "archive.zip", "w"):
        monkeypatch.syspath_prepend(str(tmp_path / "archive.zip"))
    assert may_offer("another group")

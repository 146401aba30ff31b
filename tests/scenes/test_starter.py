"""`new`: a first scene and its schema, both or neither, and nothing of the user's is written over."""

import json
import os
import tomllib
from pathlib import Path
from typing import IO, Any

import pytest

import scenes
from scenes import InputError, write_starter
from scenes.elements import LISTS
from scenes.fields import FileTable
from scenes.file.format import SceneFile
from scenes.hard import LadderFile
from tests import scene_files


def refused(folder: Path, name: str) -> str:
    """Ask for a scene that cannot be written, and return the line."""
    before = sorted(folder.iterdir())
    line = scene_files.refused(lambda: write_starter(folder / name))
    assert sorted(folder.iterdir()) == before
    assert line.startswith("new ")
    return line


@pytest.mark.parametrize(
    ("name", "why"),
    [
        *((name, f"'{name}' is not a name") for name in ("two words", "1st", "mine.v2")),
        *((name, "is not a name") for name in ("mine\n", "x" * 300, "\x1b[31m", "\0")),
        ("four_bar", "'four_bar' is a scene that ships"),
        ("x" * 65, "is not a name: expected letters, digits and '_', a letter first, 64 at most"),
        ("no/such/folder/mine", "cannot be written (No such file or directory)"),
        ("x" * 300 + "/mine", "cannot be written (File name too long)"),
        ("\0/mine", "cannot be written (embedded null byte)"),
    ],
)
def test_names_that_cannot_be(name: str, why: str, tmp_path: Path) -> None:
    assert why in refused(tmp_path, name)


@pytest.mark.parametrize("name", ["", ".", "..", "/"])
def test_no_name(name: str) -> None:
    with pytest.raises(InputError, match="is not a name"):
        write_starter(Path(name))


def test_a_scene_is_not_written_over(tmp_path: Path) -> None:
    scene, schema = write_starter(tmp_path / "mine")
    scene.write_text("changed by its user", encoding="utf-8")
    for name in ("mine", "mine.toml"):
        assert "the file exists; expected a new name" in refused(tmp_path, name)
    assert scene.read_text(encoding="utf-8") == "changed by its user"
    longest = "x" * 64
    assert write_starter(tmp_path / longest) == [tmp_path / f"{longest}.toml", schema]


def test_a_schema_is_not_written_over(tmp_path: Path) -> None:
    schema = tmp_path / "scene.schema.json"
    schema.write_text("{}", encoding="utf-8")
    assert "another scene.schema.json is beside it" in refused(tmp_path, "mine")
    assert schema.read_text(encoding="utf-8") == "{}"
    schema.unlink()
    os.mkfifo(schema)  # which no one may read from
    assert "another scene.schema.json is beside it" in refused(tmp_path, "mine")


def test_a_full_disk_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second file no longer fits."""
    written, open_file = list[Path](), Path.open

    def full(path: Path, mode: str = "r", *arguments: Any, **options: Any) -> IO[Any]:
        if mode == "xb" and written:
            raise OSError(28, "No space left on device")
        written.extend([path] * (mode == "xb"))
        return open_file(path, mode, *arguments, **options)

    monkeypatch.setattr(Path, "open", full)
    assert "cannot be written (No space left on device)" in refused(tmp_path, "mine")
    assert written == [tmp_path / "mine.toml"]


def test_a_scene_is_found_without_its_ending(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    write_starter(Path("mine"))
    (tmp_path / "mine").mkdir()  # as of results in the same folder
    assert scenes.load("mine").file == "mine.toml"
    assert scenes.numbers_in("mine", ["drive.speed"]) == [300.0]
    for name in ("toggle_press", "other"):  # a shipped scene, and a file without an ending, are what they are
        (tmp_path / f"{name}.toml").write_text("format = 3", encoding="utf-8")
    assert scenes.load("toggle_press").title == "Six-bar toggle press"
    (tmp_path / "other").write_text((tmp_path / "mine.toml").read_text(encoding="utf-8"), encoding="utf-8")
    assert scenes.load("other").name == "mine"
    with pytest.raises(InputError, match=r"^mine\.toml, drive\.body = 3: drive\.body: "):
        scenes.load("mine", {"drive.body": "3"})


@pytest.mark.parametrize("file", [SceneFile, LadderFile])
def test_editors_show_what_every_key_is(file: type[FileTable]) -> None:
    schema = file.model_json_schema()
    tables = {file.__name__: schema, **schema.get("$defs", {})}
    assert len(tables) == (12 + len(LISTS) if file is SceneFile else 1)
    for name, table in tables.items():
        for key, shown in table["properties"].items():
            table_of = tables.get(shown.get("$ref", "").removeprefix("#/$defs/"), {})
            assert (shown | table_of).get("description", "").endswith("."), f"{name}.{key}"


def test_the_schema_describes_the_format(tmp_path: Path) -> None:
    """The schema that editors get knows the shipped scene's keys, and that there are no others."""
    scene, schema = write_starter(tmp_path / "mine")
    assert scenes.load(scene).name == "mine"
    tables = json.loads(schema.read_text(encoding="utf-8"))
    assert set(tomllib.loads(scene_files.text("toggle_press"))) <= set(tables["properties"])
    assert tables["additionalProperties"] is False
    assert "mass" in tables["$defs"]["BodyTable"]["properties"]

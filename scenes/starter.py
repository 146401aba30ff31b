"""A first scene file to change, and the schema by which editors complete and check it."""

import json
import re
from importlib.resources import files
from pathlib import Path

from .errors import InputError
from .format import NAME, SceneFile

SCHEMA = "scene.schema.json"


def write_starter(path: Path) -> list[Path]:
    """Write a commented scene, and the schema beside it.

    Args:
        path: the scene's name, and the folder to write to; the file gets the ending .toml.

    Returns:
        Both files.

    Raises:
        InputError: the name cannot be a scene's, the file is there already, or the folder cannot be written.
    """
    path = path.with_suffix(".toml")
    if not re.match(NAME, path.stem):
        raise InputError(f"--new {path}: '{path.stem}' is not a name: expected letters, digits and '_', a letter first")
    text = (files("scenes") / "starter.toml").read_text(encoding="utf-8").replace('"NAME"', f'"{path.stem}"')
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
        schema = path.with_name(SCHEMA)
        schema.write_text(json.dumps(SceneFile.model_json_schema(), indent=1) + "\n", encoding="utf-8")
    except FileExistsError:
        raise InputError(f"--new {path}: the file exists; expected a new name") from None
    except OSError as error:
        raise InputError(f"--new {path}: cannot be written ({error.strerror})") from None
    return [path, schema]

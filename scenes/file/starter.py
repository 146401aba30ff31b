"""A first scene file to change, and the schema by which editors complete and check it."""

import json
import re
from contextlib import ExitStack
from importlib.resources import files
from pathlib import Path

from ..errors import InputError, one_line
from ..fields import NAME
from ..limits import NAME as LONGEST_NAME
from .format import SceneFile
from .reader import shipped

SCHEMA = "scene.schema.json"


def write_starter(path: Path) -> list[Path]:
    """Write a commented scene, its file named by the path and .toml, and its schema beside it; return both files.

    Raises:
        InputError: the name cannot be a scene's, the file is there already, another schema is in its place, or the
            folder cannot be written. Then nothing is left of either file.
    """
    place, name = f"new {one_line(str(path))}", path.name.removesuffix(".toml")
    if not (re.fullmatch(NAME, name) and len(name) <= LONGEST_NAME):
        raise InputError(
            f"{place}: '{one_line(name, 40)}' is not a name: expected letters, digits and '_', a letter first,"
            f" {LONGEST_NAME} at most"
        )
    if name in shipped():
        raise InputError(f"{place}: '{name}' is a scene that ships, which its name stands for; expected another name")
    scene, schema = (path.with_name(file) for file in (f"{name}.toml", SCHEMA))
    texts = {
        scene: (files("scenes") / "starter.toml").read_text(encoding="utf-8").replace('"NAME"', f'"{name}"'),
        schema: json.dumps(SceneFile.model_json_schema(), indent=1) + "\n",
    }
    try:
        with ExitStack() as undo:
            for file, text in texts.items():
                if file == schema and _holds(file, text):
                    continue
                with file.open("x", encoding="utf-8") as stream:
                    undo.callback(file.unlink)
                    stream.write(text)
            undo.pop_all()
    except FileExistsError as error:
        if error.filename == str(scene):
            raise InputError(f"{place}: the file exists; expected a new name") from None
        raise InputError(f"{place}: another {SCHEMA} is beside it; expected none, or the one of this version") from None
    except (OSError, ValueError) as error:  # the latter of a zero in the path
        raise InputError(f"{place}: cannot be written ({getattr(error, 'strerror', error)})") from None
    return [scene, schema]


def _holds(file: Path, text: str) -> bool:
    return file.is_file() and file.stat().st_size == len(text.encode()) and file.read_text(encoding="utf-8") == text

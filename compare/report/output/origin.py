"""Which scene file a result is of, so that no file of the same name takes its place without a word."""

import json
from contextlib import suppress
from os.path import relpath
from pathlib import Path

from scenes import InputError, Scene, shipped
from scenes.file.toml import SUMMARY_BYTES, read_text

SUMMARIES = ("summary.json", "family.json", "monte_carlo.json")


def origin(scene: Scene, place: Path) -> str:
    """The name of a shipped scene, or its file as seen from the folder of its results."""
    if scene.file in shipped():
        return scene.file
    file = Path(scene.file).resolve()
    with suppress(ValueError):  # on another drive of Windows
        return relpath(file, place.resolve())
    return str(file)


def check_origin(scene: Scene, place: Path) -> None:
    """Raise an InputError where a folder has the result of another scene file that is still there."""
    own = shipped().get(scene.file, Path(scene.file)).resolve()
    for summary in SUMMARIES:
        other, file = own, ""
        with suppress(InputError, OSError, ValueError, LookupError, TypeError, RecursionError):  # of an unknown origin
            file = json.loads(read_text(place / summary, SUMMARY_BYTES))["made_from"]
            other = shipped().get(file, place.resolve() / file).resolve()
        if other != own and other.is_file():
            shown = file if file in shipped() else other
            raise InputError(
                f"{scene.file}: name: '{scene.name}' is that of {shown} too, whose result is in {place};"
                " expected another name, or another --out"
            )

"""What a process sees of the engine: one in an empty folder, which imports, builds, solves and reads."""

import json
import os
import subprocess
import sys
from hashlib import sha256
from types import SimpleNamespace as Seen

import pytest

from scenes import Motion, Scene

from .asked import plain_run

CODE = """
import json, locale, os, random, sys
from importlib import import_module
from pathlib import Path
import numpy as np
from compare.engines import registry
def state():
    numbers = repr((random.getstate(), np.random.get_state()))
    return {
        "folder": os.getcwd(), "environment": {**os.environ}, "locale": locale.setlocale(locale.LC_ALL),
        "floating-point errors": np.geterr(), "random numbers": numbers,
    }
name, scene, answer = sys.argv[1:]
entry = registry.ENTRIES[name]
_ = entry.missing, entry.version
imported = entry.module in sys.modules
from compare.contract.asked import plain_run
from compare.contract.test_process import digest
before = state()
import_module(entry.module)
ended = plain_run(name, scene)
changed = [of for of, was in before.items() if state()[of] != was]
known = {"imported": imported, "changed": changed, "digest": digest(ended.motion)}
Path(answer).write_text(json.dumps(known), encoding="utf-8")
"""


def digest(motion: Motion | None) -> str:
    """A text that tells a motion from another in any bit."""
    samples = {} if motion is None else motion.samples
    return sha256(b"".join(channel.encode() + samples[channel].tobytes() for channel in sorted(samples))).hexdigest()


@pytest.fixture(scope="module")
def seen(name: str, solved: Scene, tmp_path_factory: pytest.TempPathFactory) -> Seen:
    """All that is seen of a run on a scene that the engine solves."""
    folder, answer = tmp_path_factory.mktemp("empty"), tmp_path_factory.mktemp("answer") / "answer.json"
    path = os.pathsep.join(os.path.abspath(place) for place in sys.path)  # noqa: PTH100 - not resolved
    environment = {"PYTHONPATH": path, "PYTHONDONTWRITEBYTECODE": "1", "PYTHONHASHSEED": "1"}
    environment |= dict.fromkeys(("TMPDIR", "TEMP", "TMP", "HOME"), str(folder))
    command = [sys.executable, "-c", CODE, name, solved.name, str(answer)]
    done = subprocess.run(
        command, cwd=folder, env={**os.environ, **environment}, capture_output=True, text=True, check=False
    )
    known = json.loads(answer.read_text(encoding="utf-8")) if answer.exists() else {}
    left = sorted(str(left.relative_to(folder)) for left in folder.rglob("*"))
    return Seen(answer=known, printed=done.stdout + done.stderr, left=left)


def test_nothing_is_imported_at_registration(seen: Seen) -> None:
    """What is installed, and what is missing, is known without an import of the engine's module."""
    assert seen.answer.get("imported") is False


def test_nothing_is_printed(seen: Seen) -> None:
    """Not to standard output, nor to standard error, warnings included."""
    assert seen.printed == ""


def test_the_process_is_left_as_it_was(seen: Seen) -> None:
    """Its working folder, environment, locale, random numbers, and NumPy's handling of floating-point errors."""
    assert seen.answer.get("changed") == []


def test_no_file_is_left(seen: Seen) -> None:
    """Not in the working folder, the temporary one, or the user's."""
    assert seen.left == []


def test_another_process_finds_the_same(seen: Seen, name: str, solved: Scene) -> None:
    """The same bits: nothing random, and nothing that follows the order of a set."""
    assert seen.answer.get("digest") == digest(plain_run(name, solved.name).motion)

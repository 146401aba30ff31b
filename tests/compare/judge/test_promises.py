"""Every ok is a promise, and no clean run is refused: a sample of `benchmarks/promises.py`."""

from collections.abc import Iterable
from pathlib import Path

import pytest

from scenes import Sampling, Scene
from scenes.laws import LAWS
from tests import scene_files
from tests.clean_scenes import clean_scenes
from tests.comparisons import SLOW
from tests.promises import PromiseRecord, judged_runs, record
from tests.true_errors import Truth

SAMPLING = Sampling(36)
LEAST = {"exudyn": 8, "pymunk": 5}  # of 10 scenes, to be ok or truly jammed: refusing all would keep every promise


def _records(scenes: Iterable[Scene], sampling: Sampling = SAMPLING) -> list[PromiseRecord]:
    each = ((Truth(scene), judged_runs(scene, LEAST, sampling)) for scene in scenes)
    return [record(truth, run, sampling) for truth, runs in each for run in runs]


@pytest.mark.parametrize(
    ("count", "elements"),
    [
        (2, False),
        (1, True),
        pytest.param(6, True, marks=SLOW),
        pytest.param(60, True, marks=pytest.mark.study),
    ],
)
def test_verdicts_keep_their_word(tmp_path: Path, count: int, *, elements: bool) -> None:
    """With elements nearly all have friction, which jams some."""
    records = _records(clean_scenes(tmp_path, count, elements=elements, rough=True))
    assert not [of for of in records if of.broken]
    assert not [of for of in records if of.false_alarm]
    for engine, least in LEAST.items():
        right = [of.status in ("ok", *of.fate.split()) for of in records if of.engine == engine]
        assert sum(right) >= least * count / 10


@SLOW
@pytest.mark.parametrize("periodic", [False, True])
def test_rows_on_the_boundaries_of_segments(periodic: bool) -> None:
    """Every law up and down, and dwells: every third row is where accelerations or jerks jump.

    To one segment pymunk has 51 steps, which may or may not do for its promise.
    """
    ways = [{"to": to, "within": 0.1, "law": law} for law in LAWS for to in (320, 200)]
    parts = [*ways[:6], {"within": 0.1}, *ways[6:], {"within": 0.1}]
    drive = {"body": "crank", "start": 200, "segments": parts, "periodic": periodic}
    records = _records([scene_files.load("swinging_law", {"drive": drive})], Sampling(3 * len(parts)))
    assert not [of for of in records if of.broken or of.false_alarm or (of.engine == "exudyn" and of.status != "ok")]

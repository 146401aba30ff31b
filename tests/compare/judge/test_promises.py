"""Every ok is a promise, and no clean run is refused: a sample of `benchmarks/promises.py`."""

from pathlib import Path

from compare.judge.measure import measure
from compare.mechanics.reference import uncertified
from scenes import Sampling
from tests.clean_scenes import clean_scenes
from tests.promises import record
from tests.true_errors import Truth

SAMPLING = Sampling(36)
LEAST = {"exudyn": 8, "pymunk": 5}  # of 10 scenes, to be ok: refusing all would keep every promise


def test_verdicts_keep_their_word(tmp_path: Path) -> None:
    records = [
        record(Truth(scene), measure(uncertified(scene), engine, SAMPLING).run, SAMPLING)
        for scene in clean_scenes(tmp_path, 10)
        for engine in LEAST
    ]
    assert not [of for of in records if of.broken]
    assert not [of for of in records if of.false_alarm]
    for engine, least in LEAST.items():
        assert sum(of.status == "ok" for of in records if of.engine == engine) >= least

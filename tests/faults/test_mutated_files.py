"""Thousands of mutated scene files: each is a scene or is refused in one line, at once, whatever was changed."""

from collections import Counter
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import process_time

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import scenes
from scenes import InputError
from tests.comparisons import SLOW
from tests.faults.mutated_scenes import mutated, slightly_mutated

AT_ONCE = 2.0  # s of the processor; most take 3 ms, and the largest of 300 times as many lines a second


@pytest.mark.parametrize("count", [300, pytest.param(1_000, marks=SLOW)])
def test_a_scene_or_one_line(count: int) -> None:
    ends: Counter[str] = Counter()

    @settings(max_examples=count, deadline=None, derandomize=True, phases=[Phase.generate])
    @given(st.randoms(use_true_random=True))
    def load(random: Random) -> None:
        file.write_bytes(random.choice((mutated, slightly_mutated))(random))
        started = process_time()
        try:
            scene = scenes.load(file)
        except InputError as error:
            line = str(error)
            assert line.startswith(f"{file}: ")
            assert line.isprintable()
            assert len(line) < len(f"{file}: ") + 500
            ends["refused"] += 1
        else:
            assert "time" in scene.channels.names()
            ends["loaded"] += 1
        assert process_time() - started < AT_ONCE

    with TemporaryDirectory() as folder:
        file = Path(folder) / "a.toml"
        load()
    assert ends["loaded"] > count / 20  # or little past the reading of TOML would be tried
    assert ends["refused"] > count / 5

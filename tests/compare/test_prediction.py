"""What a run will cost is shown before a large one, and one that no memory holds is refused."""

import re
from pathlib import Path

import pytest

from compare.cli import cost as prediction
from compare.cli.cost import announce, predicted
from compare.run import main
from scenes import Sampling, load
from tests.chain import chain

ENGINES = ("analytic", "exudyn", "pymunk")


@pytest.mark.parametrize(
    ("sampling", "dyads", "seconds", "memory"),
    [
        (Sampling(360), 0, 4, 0.115e9),
        (Sampling(36_000), 0, 36, 0.424e9),
        (Sampling(360, turns=100), 0, 33, 0.424e9),
        (Sampling(360), 10, 8, 0.143e9),
        (Sampling(360), 25, 22, 0.532e9),
    ],
)
def test_the_cost_is_near_what_was_measured(
    sampling: Sampling, dyads: int, seconds: float, memory: float, tmp_path: Path
) -> None:
    """By `python -m benchmarks.sizes`, within a factor of two."""
    cost = predicted(load(chain(dyads, tmp_path) if dyads else "toggle_press"), sampling, ENGINES)
    assert all(measured / 2 < each < 2 * measured for each, measured in zip(cost, (seconds, memory), strict=True))


@pytest.mark.parametrize(
    ("turns", "members", "lines"),
    [
        (1, 0, ""),
        (
            1000,
            0,
            r"toggle_press: about \d+ min and .* GB expected for 360\u202f001 samples of 5 bodies by 3 engines\n",
        ),
        (1, 500, "toggle_press: about .* by 3 engines and 500 members\n"),
    ],
)
def test_a_large_run_is_announced_in_a_line(
    turns: int, members: int, lines: str, capsys: pytest.CaptureFixture[str]
) -> None:
    announce(load("toggle_press"), Sampling(360, turns=turns), ENGINES, members)
    assert re.fullmatch(lines, capsys.readouterr().err)


def test_what_no_memory_holds_is_refused_before_any_work(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(prediction, "_memory", lambda: 0.4e9)
    announce(load("toggle_press"), Sampling(360), ENGINES)
    assert main(["toggle_press", "--samples", "36000", "--out", str(tmp_path / "out")]) == 2
    line = r".*fits into the 0.4 GB of memory here; 36 001 samples .* need about \d.*\n"
    assert re.fullmatch(line, capsys.readouterr().err)
    assert not (tmp_path / "out").exists()

"""Every death in the main run, a family and the hard cases, there of every engine: a row, and the rest goes on."""

import json
from pathlib import Path

import pandas as pd
import pytest

from compare.engines.processes.inside import Limits
from compare.engines.registry import DEFAULT_ENGINES, ENTRIES, ORACLE, REFERENCE
from compare.measure.hard.case import hard_cases
from compare.run import main
from tests import scene_files
from tests.comparisons import SLOW
from tests.deaths import MEMORY, TWELVE, doomed

ENGINES = [*ENTRIES]
STAGES = ("build", "solve", "read")
ALL = [
    0,
    *(pytest.param(number, marks=SLOW if number % 3 == 2 else pytest.mark.study) for number in range(1, len(TWELVE))),
]
SOME = ALL[: len(STAGES)]  # in which every death and every stage is
CRANK_SLIDER, ROD = str(scene_files.path("offset_slider_crank")), "bodies.rod.lengths.A-B"


def deaths(number: int) -> dict[str, str]:
    """Return a death of each engine; over all numbers each engine dies each of the twelve."""
    names = [*TWELVE]
    return {engine: names[(number + 3 * place) % len(names)] for place, engine in enumerate(ENGINES)}


def test_each_engine_dies_each_death() -> None:
    assert {death for number in range(len(SOME)) for death in deaths(number).values()} == {*TWELVE}
    assert {pair for number in range(len(TWELVE)) for pair in deaths(number).items()} == {
        (engine, death) for engine in ENGINES for death in TWELVE
    }


@pytest.mark.usefixtures("few_settings")
@pytest.mark.parametrize("number", SOME)
def test_in_the_main_run(number: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dying = deaths(number)
    with doomed(dying, STAGES[number % 3]):
        arguments = ["four_bar", "--samples", "24", "--engines", ",".join(ENGINES), "--out", str(tmp_path)]
        assert main([*arguments, "--check"]) == 1
    folder = tmp_path / "four_bar"
    assert (folder / "report.html").stat().st_size > 0
    rows = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["engines"]
    assert {engine: row["status"] for engine, row in rows.items()} == {e: TWELVE[d][1].name for e, d in dying.items()}
    for engine, death in dying.items():
        assert TWELVE[death][2] in rows[engine]["reason"]
    speed = pd.read_csv(folder / "speed.csv")
    assert set(speed["engine"]) == set(ENGINES)
    assert "ok" not in set(speed["status"])
    said = capsys.readouterr()
    assert said.err == ""
    assert all(line.isprintable() for line in said.out.splitlines())
    assert sum("missed" in line for line in said.out.splitlines()) >= len(ENGINES)


@SLOW
@pytest.mark.parametrize("number", SOME)
def test_in_a_family(number: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    dying, living = deaths(number), DEFAULT_ENGINES[-1 - number]
    del dying[living]
    arguments = [CRANK_SLIDER, "--vary", f"{ROD}=200:250:2", "--engines", ",".join(ENGINES), "--samples", "36"]
    with doomed(dying, STAGES[number % 3]):
        assert main([*arguments, "--check", "--out", str(tmp_path)]) == 1
    table = pd.read_csv(tmp_path / "offset_slider_crank" / "family.csv")
    assert list(table["status"]) == list(table[f"{living} status"]) == ["ok", "ok"]
    for engine, death in dying.items():
        assert list(table[f"{engine} status"]) == [TWELVE[death][1].name] * 2
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("number", ALL)
def test_in_the_hard_cases(number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The row of the analytic core is that of the arbitrary precision that certifies it."""
    monkeypatch.setattr("compare.measure.hard.case.Limits", lambda: Limits(seconds=1.0, memory=MEMORY, workers=2))
    ladder = tmp_path / "rod.toml"
    rungs = (scene_files.FOLDER / "ladders" / "rod.toml").read_text(encoding="utf-8")
    ladder.write_text(rungs.partition("[steps]")[0] + "[steps]\nas_is = 300\n", encoding="utf-8")
    dying = deaths(number)
    with doomed(dying, STAGES[number % 3]):
        table = hard_cases([str(ladder)], ENGINES, tmp_path / "out", print, print)
    for engine, death in dying.items():
        rows = table[table["engine"] == engine]
        _, status, reason = TWELVE[dying[ORACLE] if engine == REFERENCE else death]
        if engine == REFERENCE:
            assert "right" not in set(rows["outcome"])
            continue
        assert set(rows["status"]) == {status.name}
        assert rows["reason"].str.contains(reason, regex=False).all()
        assert set(rows["outcome"]) == {"refused"}

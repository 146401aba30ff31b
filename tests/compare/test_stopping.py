"""Ctrl-C: what is done is kept, and a second one is not asked twice."""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from signal import SIGINT, default_int_handler, getsignal, raise_signal

import pytest

import scenes
from compare.engines import registry
from compare.engines.processes.stopping import Stopped, stoppable
from compare.engines.registry import DEFAULT_ENGINES
from compare.measure.speed.speed_table import Budget
from compare.report.output.files import REPORT, _may_be_complete
from compare.run import main
from compare.study import study
from scenes import Motion, Sampling
from tests.comparisons import Plug, only_few_settings


def test_the_first_asks_and_the_second_stops() -> None:
    with stoppable() as stopping:
        assert not stopping()
        raise_signal(SIGINT)
        assert stopping()
        with pytest.raises(KeyboardInterrupt):
            raise_signal(SIGINT)
    assert getsignal(SIGINT) is default_int_handler


def stopped_after(words: str) -> list[str]:
    """Return the engines and the number of settings that a study has that was stopped when it said this."""

    def progress(doing: str) -> None:
        if doing not in said:  # and not again while a run is waited for
            said.append(doing)
        if any(words in done for done in said[:-1]):
            raise Stopped

    said: list[str] = []
    with only_few_settings():
        result = study(scenes.load("four_bar"), DEFAULT_ENGINES, Sampling(24), Budget(1, 0.0), progress)
    assert all(len(m.errors) for m in result.measurements)
    return [*(m.run.engine for m in result.measurements), str(len(result.speed)), *result.reasons]


def test_a_study_that_is_stopped_says_what_is_left_out() -> None:
    engines, of = [*DEFAULT_ENGINES], 4 * len(DEFAULT_ENGINES)
    none, three = (f"stopped when {n} of {of} settings had been measured, and none timed" for n in (0, 3))
    third = registry.engine("analytic").WORK_PRECISION[2].label
    assert stopped_after("running analytic") == ["analytic", "0", "stopped before running exudyn, pymunk", none]
    assert stopped_after("running pymunk") == [*engines, "0", none]
    assert stopped_after(f"analytic, {third}") == [*engines, "3", three]
    assert stopped_after("timing") == [*engines, str(of)]


@pytest.mark.usefixtures("few_settings")
def test_a_stopped_run_leaves_a_report(
    tmp_path: Path, plug: Plug, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The engine itself presses Ctrl-C, for the process that waits for it; that run is still finished."""
    scene = scenes.load("toggle_press")
    motion = registry.reference(scene)(Sampling(72).inputs(scene))

    own = os.getpid()

    def read(_: object) -> Motion:
        os.kill(own, SIGINT)
        return motion

    plug(motion)
    stub = registry.engine("stub")
    monkeypatch.setattr(type(stub), "read", read)
    arguments = ["toggle_press", "--samples", "72", "--out", str(tmp_path), "--engines"]
    place, partial = tmp_path / "toggle_press", tmp_path / "toggle_press.partial"
    assert main([*arguments, "analytic,stub"]) == 130
    page = place / "report.html"
    assert f"stopped; {page} has what was done" in capsys.readouterr().err
    assert "had been measured, and none timed" in page.read_text(encoding="utf-8")
    assert not is_complete(place)

    page.write_text("the complete one", encoding="utf-8")
    (place / "summary.json").write_text('{"complete": true}', encoding="utf-8")
    assert main([*arguments, "analytic,stub"]) == 130
    assert page.read_text(encoding="utf-8") == "the complete one"
    assert f"stopped; {partial / 'report.html'} has what was done" in capsys.readouterr().err
    assert not is_complete(partial)
    assert main([*arguments, "analytic"]) == 0
    assert is_complete(place)
    assert {*tmp_path.iterdir()} == {place, tmp_path / "index.html"}


def is_complete(place: Path) -> bool:
    return bool(json.loads((place / "summary.json").read_text(encoding="utf-8"))["complete"])


SUMMARIES = ("{}", '{"complete": true}', "[" * 10**5, "null", "\udcff")
NOT_COMPLETE = [{}, {"notes.txt": ""}, {"summary.json": '{"complete": false}', "report.html": ""}]
MAY_BE = [{"report.html": ""}, *({"summary.json": text} for text in SUMMARIES)]  # also by another version or program


@pytest.mark.parametrize("files", [*NOT_COMPLETE, *MAY_BE])
def test_what_may_be_complete_is_not_replaced(files: Mapping[str, str], tmp_path: Path) -> None:
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8", errors="surrogateescape")
    assert _may_be_complete(tmp_path, REPORT) is (files in MAY_BE)

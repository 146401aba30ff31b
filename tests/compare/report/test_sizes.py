"""Pages of long runs and of many joints: of a size to open, with every extreme drawn and what is left out named."""

import gzip
import json
import re
from base64 import b64decode
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from compare.report.figures import curves
from compare.report.figures.figure import MAX_POINTS, extremes
from compare.report.figures.speed import work_precision
from compare.report.linkage.moving import MAX_SAMPLES, MovingPicture
from compare.report.pages.html import MAX_ROWS, first, packed, shortened
from compare.report.pages.report import page
from compare.study import Study
from scenes import Motion, Sampling, load
from scenes.model.motion import Samples
from tests.comparisons import SLOW, sampled, studied
from tests.pages import unpacked, without_scripts

LIMIT = 1.1e6  # bytes
TIMES = 200  # as many samples as there are


@pytest.fixture(scope="module")
def result() -> Study:
    return studied(load("toggle_press"), ["analytic", "pymunk"])


def longer(result: Study) -> Study:
    """A study of many more samples, with noise so that nothing can be packed, and one error far above all."""
    noise, count = np.random.default_rng(1), TIMES * result.sampling.samples + 1

    def of(samples: Samples) -> Samples:
        return np.resize(samples, count) * (1 + 1e-3 * noise.random(count))

    def motion(short: Motion) -> Motion:
        return Motion({channel: of(samples) for channel, samples in short.samples.items()}, short.unsupported)

    measurements = []
    for m in result.measurements:
        assert m.comparison is not None
        assert m.run.motion is not None
        actual = {channel: of(error) for channel, error in m.comparison.actual.items()}
        actual["P3.fx"][11_111] = 12.5
        comparison = replace(m.comparison, actual=actual)
        measurements.append(replace(m, run=replace(m.run, motion=motion(m.run.motion)), comparison=comparison))
    explained = replace(
        result.explained,
        condition=of(result.explained.condition),
        sensitivity={channel: of(moved) for channel, moved in result.explained.sensitivity.items()},
        terms={channel: of(over) for channel, over in result.explained.terms.items()},
    )
    sampling = replace(result.sampling, samples=count - 1)
    return replace(
        result, sampling=sampling, motion=motion(result.motion), measurements=measurements, explained=explained
    )


def values(figure: str, kind: str) -> Samples:
    """All numbers in the typed arrays of a figure."""
    arrays = re.findall(rf'"dtype":"{kind}","bdata":"([^"]*)"', figure)
    return np.concatenate([np.frombuffer(b64decode(data.replace("\\u002f", "/")), kind) for data in arrays])


@pytest.fixture(scope="module")
def long_page(result: Study) -> str:
    return page(longer(result))


@SLOW
def test_a_long_run_has_a_page_that_opens_and_shows_its_worst_sample(long_page: str) -> None:
    assert len(long_page.encode()) < LIMIT
    library, *figures = unpacked(long_page)
    assert "uPlot.js" in library[:200]
    with_errors = [values(figure, "f4") for figure in figures if '"name":"pymunk error"' in figure]
    assert any((drawn == 12.5).any() for drawn in with_errors)
    text = without_scripts(long_page)
    assert re.search(r"Drawn: at most \d+ of 14\u202f401 samples a curve", text)
    assert "<table>" in text, "tables need no script"
    assert long_page.index('id="figures"') > long_page.index("</main>"), "the text is there before what is packed"


def test_a_long_run_moves_through_some_samples_with_the_extremes(result: Study) -> None:
    long = longer(result)
    moving = MovingPicture(long, [*curves.panels(long.reference, long.sampling)])
    assert len(moving.rows) <= MAX_SAMPLES
    assert 11_111 in moving.rows
    assert np.abs(long.motion["P5.ay"]).argmax() in moving.rows
    assert moving.rows[[0, -1]].tolist() == [0, 14_400]


def test_what_moves_the_linkage_can_be_unpacked(result: Study) -> None:
    """As its format is described: second differences, then an engine's part, byte by byte."""
    moving = MovingPicture(result, [*curves.panels(result.reference, result.sampling)])
    line, _, packed = gzip.decompress(b64decode(moving.data)).partition(b"\n")
    head = json.loads(line)
    words = np.frombuffer(packed, np.uint8).reshape(4, -1).T.copy()
    channels, count = head["channels"], head["count"]
    whole = words[: len(channels) * count].view("<i4").reshape(-1, count)
    off = words[len(channels) * count :].view("<f4").reshape(-1, count)
    assert head["engines"] == ["analytic", "pymunk"]
    for number, channel in enumerate(channels):
        if channel in result.motion:
            values = whole[number].cumsum().cumsum() * head["quanta"][number]
            peak = np.abs(result.motion[channel]).max()
            assert np.abs(values - result.motion[channel]).max() <= 2e-9 * peak  # half of 2^-28
    for number, channel in enumerate(channels[: head["compared"]]):
        if channel in result.motion:
            expected = result.motions["pymunk"][channel] - result.motion[channel]
            assert off[number] == pytest.approx(expected, rel=1e-7, abs=1e-30), channel


def test_the_main_job_has_a_page_below_a_megabyte() -> None:
    text = page(studied(load("toggle_press"), ["analytic", "exudyn", "pymunk"], Sampling(360)))
    assert len(text.encode()) < 1e6


def test_a_short_run_is_drawn_whole(result: Study) -> None:
    text = page(result)
    assert "Drawn: at most" not in text
    assert "Not drawn" not in text


def test_a_figure_is_the_same_each_time(result: Study) -> None:
    one, other = (packed(json.dumps(work_precision(result).shown()).encode()) for _ in range(2))
    assert one == other


@sampled(5)
@pytest.mark.parametrize("row", [0, 1, 123_457, 359_998, 359_999])
@pytest.mark.parametrize("size", [9.0, -9.0, np.nan])
def test_one_sample_in_many_is_drawn(row: int, size: float) -> None:
    x, y = np.linspace(0, 1, 360_000), np.sin(np.linspace(0, 300, 360_000))
    y[row] = size
    rows = extremes(x, y)
    assert row in rows
    assert len(rows) <= MAX_POINTS
    assert rows[[0, -1]].tolist() == [0, 359_999]
    assert (np.diff(rows) > 0).all()


def test_local_extremes_and_those_of_a_path_are_drawn() -> None:
    angle = np.linspace(0, 2 * np.pi, 100_001)
    path = np.exp(1j * angle) * (1 + 0.1 * np.cos(37 * angle))
    rows = extremes(path.real, path.imag)
    for values in (path.real, path.imag):
        inner = 1 + np.flatnonzero(np.diff(np.sign(np.diff(values))))
        assert len(inner) > 30
        assert np.isin(inner, rows).mean() == 1.0


def test_of_many_joints_the_worst_are_drawn_and_the_rest_is_named(
    result: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(curves, "MAX_PANELS", 5)
    errors = result.measurements[1].errors
    errors = [row._replace(max=np.nan) if row.channel == "P2.fy" else row for row in errors]
    spoilt = replace(result, measurements=[result.measurements[0], replace(result.measurements[1], errors=errors)])
    drawn, left_out = curves.chosen(spoilt)
    assert [panel.judged[0] for panel in drawn] == ["P5.x", "P5.vx", "P5.ax", "P2.fx", "drive.torque"]
    assert len(left_out) == 6
    text = page(spoilt)
    assert all(channel in text.partition("Not drawn")[2][:400] for panel in left_out for channel in panel.judged)


def test_long_tables_show_the_worst_rows_and_where_the_rest_is() -> None:
    table = pd.DataFrame({"channel": [f"c{n}" for n in range(1000)], "max": np.arange(1000.0)})
    table.loc[3, "max"] = np.nan
    columns, rows, left_out = shortened(table.to_dict("records"), "max", "errors.csv")
    assert (columns, len(rows)) == (["channel", "max"], MAX_ROWS)
    assert [channel for channel, _ in rows[:2]] == ["c3", "c999"]
    assert "c700" not in [channel for channel, _ in rows]
    assert left_out == f"The {MAX_ROWS} rows with the largest max, of 1000; all are in errors.csv."
    assert first(map(str, range(1000)))[MAX_ROWS].startswith("And 800 more")

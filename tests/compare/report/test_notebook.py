"""What `compare.check` and `compare.vary` return: plots by channel, and what a notebook shows."""

import sys
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import compare
import scenes
from compare.report.notebook import CheckResult, Varied
from scenes import InputError

LENGTH = "bodies.rocker.lengths.C-B"


@pytest.fixture(scope="module")
def result() -> CheckResult:
    scene = replace(scenes.load("four_bar"), title="A <four> bar", tolerances={"exudyn": {"position": 1e-99}})
    return compare.check(scene, engines=("analytic", "exudyn"), samples=36)


@pytest.fixture(scope="module")
def family() -> Varied:
    return compare.vary("four_bar", f"{LENGTH}=250:1000:2", engines=("analytic",), samples=36)


def test_a_plot_has_every_engine_and_the_error(result: CheckResult) -> None:
    figure = result.plot("T.ay")
    assert figure.layout.yaxis.title.text == "T.ay [m/s²]"
    reference, *markers, error, floor = figure.data
    assert np.array_equal(reference.y, result.motion["T.ay"])
    assert [trace.name for trace in markers] == ["analytic", "exudyn"]
    own = result.motions["exudyn"]["T.ay"]
    assert set(markers[1].y) <= set(own)
    assert (error.name, floor.name) == ("exudyn error", "reference's floor")
    table = result.errors.set_index(["engine", "channel"])
    assert max(error.y) == table["max"]["exudyn", "T.ay"]


def test_a_shown_plot_has_no_button_that_sends_its_data(result: CheckResult, monkeypatch: pytest.MonkeyPatch) -> None:
    """By whatever a notebook asks a figure for; tests/browser/test_controls.py has its buttons."""
    import plotly.io

    figure, shown = result.plot("T.ay"), []
    monkeypatch.setattr(plotly.io, "show", lambda *_, config, **__: shown.append(config))
    figure.show()
    figure._ipython_display_()
    monkeypatch.setattr(plotly.io.renderers, "default", "plotly_mimetype")
    shown.append(figure._repr_mimebundle_()["application/vnd.plotly.v1+json"]["config"])
    for config in shown:
        assert not config["showSendToCloud"]
        assert not config["displaylogo"]
        assert all("cloud" not in name.lower() for group in config["modeBarButtons"] for name in group)
    assert len(shown) == 3


@pytest.mark.parametrize("channel", ["T.az", "time", "B.to_lock"])
def test_a_channel_that_is_none(result: CheckResult, channel: str) -> None:
    with pytest.raises(KeyError, match="no such channel"):
        result.plot(channel)


def test_a_result_in_a_notebook(result: CheckResult) -> None:
    shown = result._repr_html_()
    assert "<h4>A &lt;four&gt; bar</h4>" in shown
    for part in ("<td>exudyn</td>", "<th>torque</th>", "<li>exudyn position: ", "<td>Largest pin force</td>", "<svg"):
        assert part in shown
    assert "[ms]" not in shown, "a clock ran"
    assert repr(result).startswith("four_bar: ")
    assert len(repr(result)) < 1000
    assert "@keyframes" in result.svg()
    assert "@keyframes" not in result.svg(moving=False)


def test_a_family_in_a_notebook(family: Varied) -> None:
    shown = family._repr_html_()
    assert [member.status for member in family.members] == ["ok", "cannot_assemble"]
    for part in ("<td>250</td>", "<td>1000</td>", "stroke", "<polyline", "<li>C-B = 1000: cannot_assemble: "):
        assert part in shown
    assert shown.count("<polyline") == 1
    assert "C-B = 250" in {trace.name for trace in family.plot().data}
    assert len(repr(family)) < 1000


@pytest.mark.parametrize(
    ("name", "variations", "options", "line"),
    [
        ("four_bar", ["drive.sped=1:2:2"], {}, "drive.sped: the file has no 'sped' there; did you mean 'speed'?"),
        ("four_bar", ["drive.speed=1:2"], {}, "PATH=FROM:TO:COUNT"),
        ("four_bar", ["drive.speed=1:2:2"], {"engines": ["exudin"]}, "no engine 'exudin'"),
        ("four_bar", ["drive.speed=1:2:2"], {"samples": 1}, "whole number from 8"),
        ("fourbar", ["drive.speed=1:2:2"], {}, "did you mean 'four_bar'?"),
    ],
)
def test_bad_arguments_of_a_family(name: str, variations: list[str], options: Mapping[str, object], line: str) -> None:
    with pytest.raises(InputError, match=line.replace("?", r"\?")):
        compare.vary(name, *variations, **options)  # type: ignore[arg-type]


def test_what_plots_need_is_named(result: CheckResult, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "plotly.graph_objects", None)
    monkeypatch.delitem(sys.modules, "compare.report.figures.offline", raising=False)
    with pytest.raises(InputError, match=r"^plot: plotly is not installed: pip install 'linkage-crosscheck\[plots\]'$"):
        result.plot("T.ay")

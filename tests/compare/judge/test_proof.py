"""What is proven over the whole range in a judgement: limits held against it, and where nothing is known."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import compare
from compare.engines import registry
from compare.judge.proof import asked, held, met
from compare.report.tables.proof import WIDE, bounds, sentences
from compare.run import main
from scenes import InputError, Motion, Sampling, Scene
from scenes.channels import TRANSMISSION
from scenes.model.enclosures import Enclosure, Enclosures
from tests import scene_files
from tests.comparisons import SLOW, sampled

pytestmark = pytest.mark.usefixtures("few_settings")

FEW = Sampling(samples=8)
# The slider-crank's rod is 3 m, its crank 1 m: B runs from 2 to 4 m.
LIMITS = {"limits": {"B.x": {"least": 1.9, "most": 3.9}, "A.speed": {"most": 1e3}, "transmission": {"least": 0.1}}}


def limited(limits: scene_files.Changes) -> Scene:
    return scene_files.load("slider_crank", limits)


def test_limits_are_met_or_missed() -> None:
    scene = limited(LIMITS)
    result = compare.check(scene, engines=("analytic",), samples=8)  # at which B.x is never more than 3.9 but once
    assert [limit.outcome for limit in result.limits] == ["met", "missed", "met", "met"]
    assert not result.ok
    (missed,) = result.missed
    assert missed.startswith("limits.B.x: at most 3.9 m missed: 4.000 m at ")
    said = [*sentences(result)][-1]
    assert said.startswith("3 of 4 limits are met at every position; B.x: at most 3.9 m missed: 4.000 m at ")


def test_a_limit_between_the_bounds_is_not_decided() -> None:
    scene = limited({"limits": {"B.x": {"most": 4.0}}})
    row = Enclosure("B.x", "most", 3.9999, 4.0001, 0.0, 0.1)
    (limit,) = held(scene, FEW, Enclosures([row], None))
    assert limit.outcome == "not decided"
    assert "between 3.9999 and 4.0001 m" in limit.text


def test_a_limit_of_what_is_not_proven_is_not_decided() -> None:
    (limit,) = held(limited({"limits": {"B.x": {"most": 4.1}}}), FEW, Enclosures((), (0.1, 0.2)))
    assert limit.outcome == "not decided"


def test_models_and_limits_have_verdicts_of_their_own(tmp_path: Path) -> None:
    """In a result's text, in a notebook and on the page of all reports."""
    result = compare.check(limited(LIMITS), engines=("analytic", "exudyn"), samples=8)
    missed = "limits missed: 3 of 4 limits are met at every position; B.x: at most 3.9 m missed: 4.000 m at "
    assert str(result).startswith("slider_crank: agrees: exudyn agrees ")
    assert missed in str(result)
    assert missed in result._repr_html_()
    assert result.limits_verdict is not None
    assert result.limits_verdict.word == "missed"
    assert compare.check(limited({}), engines=("analytic",), samples=8).limits_verdict is None
    (tmp_path / "scene.toml").write_text(scene_files.text("pounds"), encoding="utf-8")
    assert main([str(tmp_path / "scene.toml"), "--engines", "analytic", "--out", str(tmp_path)]) == 0
    for page in ("index.html", "pounds/report.html"):
        assert "✗ Limits missed</strong><span>0 of 2 limits are met" in (tmp_path / page).read_text(encoding="utf-8")


@SLOW
def test_a_larger_group_has_a_mechanical_advantage_in_place_of_an_angle() -> None:
    """By power it is the drive's rate over the output's speed, at the sample where that is largest."""
    scene = scene_files.load("scissor_lift")
    result = compare.check(scene, engines=("analytic",), samples=90)
    (proven,) = [sentence for sentence in sentences(result) if sentence.startswith("Proven")]
    motion, output = result.motions["analytic"], scene.output
    fastest = np.hypot(motion[f"{output}.vx"], motion[f"{output}.vy"]).max()
    found = re.search(r"has at least ([\d.]+) \S+ for each \S+ of the drive", proven)
    assert found is not None, proven
    assert float(found[1]) == pytest.approx(abs(scene.drive.law.speed) / fastest, rel=1e-3)  # type: ignore[union-attr]
    assert "transmission" not in proven


def test_machines_meet_limits_at_their_samples() -> None:
    scene = limited({"limits": {"A.speed": {"most": 5.0}, "B.x": {"least": 1.0}}})
    x, fast = np.array([[2.0, 3.0], [2.0, 0.5], [2.0, 3.0]]), np.array([[3.0, 3.0], [3.0, 3.0], [3.0, 4.1]])
    motion = Motion({"time": 0 * x, "B.x": x, "A.vx": fast, "A.vy": fast})  # of a speed of 4.2 and 5.8
    assert met(scene, motion).tolist() == [True, False, False]
    nothing = limited({"limits": {"transmission": {"least": 0.1}}})
    assert met(nothing, motion).tolist() == [False] * 3  # a linkage without dyads has no such angle to show


def test_channels_that_are_not_asked_for_have_no_bounds_and_no_limits() -> None:
    scene = limited(LIMITS)
    request = Sampling(samples=8, channels=frozenset({"A.vx", "A.vy"}))
    proof = registry.enclosures(scene, asked(scene, request))
    assert {row.channel for row in proof.rows} == {"A.vx", "A.vy", "A.speed"}
    assert [limit.enclosure.channel for limit in held(scene, request, proof)] == ["A.speed"]


@pytest.mark.parametrize(
    ("limits", "expected"),
    [
        ({"B.ayy": {"most": 1}}, "limits.B.ayy: no such channel or magnitude; did you mean 'B.ay'?"),
        ({"time": {"most": 1}}, "limits.time: no such channel or magnitude"),
        ({"B.x": {}}, "limits.B.x: expected 'least', 'most' or both"),
        ({"B.x": {"least": 2, "most": 1}}, "limits.B.x.least: expected 1, the most, or less, found 2"),
        ({"B.x": {"mots": 1}}, "limits.B.x.mots: unknown key; did you mean 'most'?"),
    ],
)
def test_limits_that_are_none(limits: scene_files.Changes, expected: str) -> None:
    with pytest.raises(InputError) as refused:
        limited({"limits": limits})
    assert expected in str(refused.value)


def test_the_command_line_stops_at_a_limit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = scene_files.write(tmp_path, "slider_crank", LIMITS)
    arguments = [str(file), "--engines", "analytic", "--samples", "8", "--out", str(tmp_path / "out")]
    assert main([*arguments, "--check"]) == 1
    assert "missed: limits.B.x: at most 3.9 m missed" in capsys.readouterr().out
    assert main(arguments) == 0
    page = (tmp_path / "out" / "slider_crank" / "report.html").read_text(encoding="utf-8")
    assert "✗ Limits" in page
    assert "Proven over the whole turn: it assembles" in page
    table = pd.read_csv(tmp_path / "out" / "slider_crank" / "enclosures.csv")
    assert list(table.columns) == ["channel", "extreme", "low", "high", "position_low", "position_high"]
    most = table[(table["channel"] == "B.x") & (table["extreme"] == "most")].iloc[0]
    assert most["low"] <= 4.0 <= most["high"]
    assert most["high"] - most["low"] <= 2e-6  # a millionth of the stroke of 2 m


def test_bounds_that_are_shown_are_bounds() -> None:
    """The slider-crank's B.x is 4 m at most, and a rounding of what is more is no bound."""
    result = compare.check(limited({}), engines=("analytic",), samples=8)
    (row,) = (row for row in bounds(result) if row["channel"] == "B.x")
    shown = [float(str(row[name]).split()[0].replace(",", "")) for name in ("never below", "never above")]
    assert shown[0] <= 2.0
    assert shown[1] >= 4.0


@sampled(1)
@pytest.mark.parametrize(("most", "why"), [(np.inf, "of a reason"), (1e30, WIDE)])
def test_a_bound_far_above_what_is_attained_is_not_known(most: float, why: str) -> None:
    """As of a long chain of dyads, whose boxes are too wide: it is no proof of anything, nor one of the other pins."""
    result = compare.check(limited({}), engines=("analytic",), samples=8)
    whole = " ".join(sentences(result))
    assert "no pin carries more than" in whole
    assert "no transmission angle of a dyad is below" in whole
    known = {row[:2]: row for row in result.proof.rows}
    force, angle = ("A.force", "most"), (TRANSMISSION, "least")
    known |= {force: known[force]._replace(high=most), angle: known[angle]._replace(low=-3.2)}
    result.proof = replace(result.proof, rows=[*known.values()], why=why if most == np.inf else "")
    sentence, unknown = sentences(result)
    assert sentence == "Proven over the whole turn: it assembles."
    assert unknown.startswith(f"No bound is known of A.force, {TRANSMISSION}, at ")
    assert unknown.endswith(f": {why}.")
    (row,) = (row for row in bounds(result) if row["channel"] == "A.force")
    assert row["never above"] == "not known"

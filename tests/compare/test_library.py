"""The shipped scenes: every engine solves them within their tolerances."""

from pathlib import Path

import pytest

import compare
import scenes
from compare.engines import registry
from compare.judge.agreement import Judgement
from compare.run import main
from scenes.channels import Role
from tests.comparisons import SLOW

QUICK = ("crank_press", "four_bar", "quick_return")  # a press force, a crank-rocker, a slot


@pytest.fixture(
    scope="module", params=[pytest.param(name, marks=() if name in QUICK else SLOW) for name in scenes.shipped()]
)
def judgement(request: pytest.FixtureRequest) -> Judgement:
    return compare.check(request.param)


def test_every_tolerance_is_met(judgement: Judgement) -> None:
    """Every engine is ok, or unsupported for a reason."""
    assert judgement.ok
    assert all(gate.error <= gate.tolerance for gate in judgement.held)
    assert set(judgement.verdicts) == set(registry.DEFAULT_ENGINES)
    for status, reason in judgement.verdicts.values():
        assert status == "ok" or (status == "unsupported" and reason)


def test_every_engine_that_is_ok_has_a_tolerance_for_every_group(judgement: Judgement) -> None:
    for name, (status, _) in judgement.verdicts.items():
        if name == "analytic" or status != "ok":
            continue  # the first is the reference itself
        groups = {row.group for row in judgement.channel_errors if row.engine == name}
        assert set(judgement.scene.tolerances[name]) == groups - {"drive"}, name


def test_the_reference_is_certified(judgement: Judgement) -> None:
    """To 1e-12: fifty times what doubles leave of the leg, and far below what it is used to judge but positions."""
    floor = judgement.reference.floor.by_channel
    for channel in judgement.scene.channels.names(Role.time, Role.input, Role.kinematic):
        if channel != "time":
            assert floor[channel] <= 1e-12, channel


@pytest.mark.usefixtures("few_settings")
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=SLOW if name in QUICK else pytest.mark.study) for name in scenes.shipped()]
)
def test_the_command_line_reports_every_scene(name: str, tmp_path: Path) -> None:
    """The engines, which take most of the time, are judged above."""
    assert main([name, "--check", "--engines", "analytic", "--out", str(tmp_path)]) == 0
    page = (tmp_path / name / "report.html").read_text(encoding="utf-8")
    assert 'id="uplot"' in page, "with the plots' library in it"
    assert len(page) < 1e6


@pytest.mark.parametrize("name", scenes.shipped())
def test_every_scene_says_what_it_is_and_where_it_is_from(name: str) -> None:
    scene = scenes.load(name)
    assert scene.name == name
    assert scene.title != name
    assert scene.source

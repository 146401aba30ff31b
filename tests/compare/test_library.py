"""The shipped scenes, through the command line: every engine solves them within their tolerances."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

import scenes
from compare.engines import registry
from compare.run import main
from scenes import Scene
from scenes.motion import kinematic_channels


@dataclass(frozen=True)
class Outcome:
    scene: Scene
    status: int
    summary: dict[str, Any]


@pytest.fixture(scope="module", params=scenes.shipped())
def outcome(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """Run one scene once, at the default settings, which its tolerances are for."""
    folder: Path = tmp_path_factory.mktemp("library")
    status = main([request.param, "--check", "--out", str(folder)])
    summary = json.loads((folder / request.param / "summary.json").read_text(encoding="utf-8"))
    return Outcome(scenes.load(request.param), status, summary)


def test_every_tolerance_is_met(outcome: Outcome) -> None:
    assert outcome.status == 0
    assert all(gate["error"] <= gate["tolerance"] for gate in outcome.summary["gates"])


def test_every_engine_is_ok_or_says_why_not(outcome: Outcome) -> None:
    assert set(outcome.summary["engines"]) == set(registry.DEFAULT_ENGINES)
    for engine in outcome.summary["engines"].values():
        assert engine["status"] == "ok" or (engine["status"] == "unsupported" and engine["reason"])


def test_every_engine_that_is_ok_has_a_tolerance_for_every_group(outcome: Outcome) -> None:
    for name, engine in outcome.summary["engines"].items():
        if name == "analytic" or engine["status"] != "ok":
            continue  # the first is the reference itself
        groups = {row["group"] for row in outcome.summary["errors"] if row["engine"] == name}
        assert set(outcome.scene.tolerances[name]) == groups - {"drive"}, name


def test_the_reference_is_certified(outcome: Outcome) -> None:
    """To 1e-12: fifty times what doubles leave of the leg, and far below what it is used to judge but positions."""
    floor = outcome.summary["reference"]["floor"]["by_channel"]
    for channel in kinematic_channels(outcome.scene):
        if channel != "time":
            assert floor[channel] <= 1e-12, channel


@pytest.mark.parametrize("name", scenes.shipped())
def test_every_scene_says_what_it_is_and_where_it_is_from(name: str) -> None:
    scene = scenes.load(name)
    assert scene.name == name
    assert scene.title != name
    assert scene.source

"""Nothing is left open by the form of a number: equal forms, springs whose ends meet, joints without a load."""

import tomllib
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

import analytic
import scenes
from benchmarks import windows as benchmark
from scenes import Sampling, Scene
from tests import scene_files
from tests.comparisons import sampled
from tests.naming import loaded

NAMES = {name: name for name in ("O", "F", "E", "arm", "cylinder", "rod")}


def lifted(foot: float, start: float, end: float) -> Scene:
    """A cylinder from F that turns an arm of 1 m about O, m: with its tip at E the three are a triangle."""
    tables: dict[str, Any] = {
        "format": 1,
        "name": "lifted",
        "ground": {"points": {"O": [0, 0], "F": [foot, 0]}},
        "bodies": {
            "arm": {"lengths": {"O-E": 1.0}, "mass": 1},
            "cylinder": {"points": {"F": [0, 0]}, "mass": 0},
            "rod": {
                "points": {"E": [0, 0]},
                "mass": 0,
                "slides": {"on": "cylinder", "through": [0, 0], "along": [1, 0]},
            },
        },
        "drive": {"body": "rod", "speed": 0.1, "start": start, "end": end},
        "sketch": {"displacement": (start + end) / 2, "E": [0, 1]},
        "output": {"point": "E"},
    }
    return loaded(tables, NAMES, NAMES)


@sampled(2)
@pytest.mark.parametrize(("foot", "start", "end"), [(1.5, 1.5, 2.3), (1.2, 0.4, 0.9), (1.5, 0.8, 1.7), (1.1, 0.3, 2.0)])
def test_a_length_that_passes_twice_half_or_once_the_bar_s(foot: float, start: float, end: float) -> None:
    """By the law of cosines E is at x = (1 + foot^2 - length^2) / (2 foot) with its foot's origin at O."""
    found = analytic.enclose(lifted(foot, start, end))
    assert found.open_at is None
    assert all(np.isfinite(row[2:]).all() for row in found.rows)
    x = {row.extreme: row for row in found.rows if row.channel == "E.x"}
    for extreme, length in (("most", start), ("least", end)):
        true = (1 + foot**2 - length**2) / (2 * foot)
        assert x[extreme].low - 1e-12 <= true <= x[extreme].high + 1e-12  # roundings of this line
        assert x[extreme].high - x[extreme].low <= 1e-5


def test_a_spring_without_a_free_length_whose_ends_meet() -> None:
    """Of k d about O only k times the fixed end's arm turns: -12 (1.5 x 2) sin, at 0 of which both ends are at T."""
    spring = {"between": ["ground.S", "crank.T"], "stiffness": 3, "length": 0}
    changes = {"ground.points.S": [2, 0], "springs": [spring], "bodies.crank.com": [0, 0], "bodies.crank.inertia": 1}
    found = analytic.enclose(scene_files.load("crank", changes))
    assert all(np.isfinite(row[2:]).all() for row in found.rows)
    torque = {row.extreme: row for row in found.rows if row.channel == "drive.torque"}
    for extreme, true in (("least", -12.0), ("most", 12.0)):
        assert torque[extreme].low <= true <= torque[extreme].high <= torque[extreme].low + 1e-4


DWELL = [
    {"to": 180, "within": 0.5, "law": "cycloidal"},
    {"within": 0.3},
    {"to": 360, "within": 0.5, "law": "cycloidal"},
]


def rubbing(name: str, *, massless: bool = False, rests: bool = False) -> Scene:
    """A shipped scene with friction, with links without a mass, or a drive that rests at two places."""
    scene, tables = scene_files.load(name), tomllib.loads(scene_files.text(name))
    for body in tables["bodies"].values() if massless else ():
        body["mass"] = body["mass"] if "slides" in body else 0
    if rests:
        tables["drive"] = {"body": scene.drive.body, "start": 0, "periodic": True, "segments": DWELL}
    same = ({name: name for name in names} for names in (scene.owners, scene.bodies))
    return loaded(tables, *same)


SCENES = {
    "clamp": lambda: scene_files.load("double_toggle_clamp_friction"),
    "massless": lambda: rubbing("crank_press_friction", massless=True),
    "rests": lambda: rubbing("toggle_press_friction", rests=True),
}


@sampled(1)
@pytest.mark.parametrize("case", SCENES)
def test_friction_that_contracts_is_enclosed(case: str) -> None:
    """Joints without a load have no direction of it, and those at rest no sense: the loads themselves are known."""
    scene, sampling = SCENES[case](), Sampling(720)
    found = analytic.enclose(scene)
    assert found.rows
    assert all(np.isfinite(row[2:]).all() for row in found.rows)
    motion = analytic.solve(scene, sampling.commanded(scene), sampling.times(scene))
    for row in (row for row in found.rows if row.channel in motion and not row.channel.endswith("angle")):
        values = motion[row.channel]
        size = 1e-9 * np.abs(values).max() + 1e-200  # roundings of the samples; what underflows in the bounds
        assert row.low - size <= values.min() if row.extreme == "least" else values.max() <= row.high + size, row


@sampled(1)
@pytest.mark.parametrize(
    ("most", "count", "why"), [(100, 16, "100 boxes are too few"), (8000, 45, "16 digits are too few")]
)
def test_what_is_not_proven_has_a_reason(most: int, count: int, why: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Parallelograms in a row, by closed forms, of which bounds are some times as wide as those of the one before."""
    monkeypatch.setattr("analytic.proven.boxes.MAX_BOXES", most)
    monkeypatch.setattr("analytic.proven.boxes.MAX_TIGHT", count)
    monkeypatch.setattr("analytic.proven.boxes.MAX_ALONE", count)
    found = analytic.enclose(windows(count), frozenset({f"B{count}.x"}))
    assert found.open_at is not None
    assert why in found.why


def test_a_linkage_that_locks_is_named_with_its_joint() -> None:
    found = analytic.enclose(scene_files.load("triple_rocker"), frozenset({"B.x"}))
    assert "B is in a singular configuration" in found.why
    assert "cannot be reached beside it" in found.why


def windows(count: int) -> Scene:
    with TemporaryDirectory() as folder:
        file = Path(folder) / "windows.toml"
        file.write_text(benchmark.text(count), encoding="utf-8")
        return scenes.load(file)


def test_sixteen_windows_are_proven() -> None:
    """In parallelograms each bar is the driven one again: B16 is 16 m beside B0, at cos x + 16 m."""
    found = analytic.enclose(windows(16), frozenset({"B16.x"}))
    assert found.open_at is None
    most = next(row for row in found.rows if row.extreme == "most")
    assert most.low <= np.cos(benchmark.END) + 16 <= most.high <= most.low + 1e-5

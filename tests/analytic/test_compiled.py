"""The core's formulas in a straight line, as NumPy calls and as machine code: the same numbers as the core's."""

import sys
from pathlib import Path
from pickle import dumps, loads
from typing import Any

import numpy as np
import pytest

import analytic
import scenes
from analytic.recorded.arithmetics import machine_code
from analytic.recorded.fast import machine_line
from analytic.recorded.program import Program, recorded
from analytic.solve import Solver
from scenes import Failure, InputError, Motion, Scene
from tests.comparisons import SLOW, sampled

from .newton import assert_close

# Of a channel's peak: roundings in another order, times the conditioning of the worst shipped pose, the clamps' next to
# their lock. There both routes are 1.2e-13 off the 50-digit oracle; elsewhere they are within 1e-14 of each other.
SAME = 5e-13
ROUTES = pytest.mark.parametrize("compiled", [False, pytest.param(True, marks=SLOW)], ids=["numpy", "numba"])


@pytest.fixture(autouse=True)
def _kernels_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def assert_same(found: Motion | analytic.Machines, expected: Motion | analytic.Machines) -> None:
    assert set(found.samples) == set(expected.samples)
    assert_close(found.samples, expected.samples, SAME)


@sampled(6)
@pytest.mark.parametrize("name", scenes.shipped())
def test_straight_line_of_every_scene(name: str) -> None:
    scene = scenes.load(name)
    time = np.linspace(0, scene.cycle, 61)
    position = scene.drive.law.at(time).position
    channels = set(scene.channels.names())
    line = analytic.fast_solver(scene, channels, compiled=False)
    assert_same(line(position, time), analytic.solve(scene, position, time, channels))


def test_positions_of_all_calls_count_for_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """From 40,001 on long calls are by it; a short call has the same digits whatever was solved before."""
    scene, made = scenes.load("four_bar"), list[str]()

    def seen(scene: Scene, *rest: Any) -> Program:
        made.append(scene.name)
        return recorded(scene, *rest)

    monkeypatch.setattr(sys.modules[Solver.__module__], "recorded", seen)
    solve, angles = analytic.solver(scene), np.linspace(0, 6, 10_000)
    first, short = solve(angles), solve(angles[:9])
    for _ in range(2):
        solve(angles)
    assert made == []
    assert_same(solve(angles), first)
    solve(angles)
    assert made == ["four_bar"]
    again = solve(angles[:9])
    assert all((again[channel] == short[channel]).all() for channel in short.samples)


@SLOW
@pytest.mark.parametrize("name", ["toggle_press", "four_bar"])
def test_few_positions_go_to_the_machine_code_at_once(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """One call of it and no more; what comes is the same to the last bit as on the way that many positions take."""
    scene = scenes.load(name)
    fast, angles = analytic.fast_solver(scene, compiled=True), np.linspace(0, 6, 9)
    some = fast(angles)
    whole = fast([*angles])  # a list is looked at
    assert list(some.samples) == list(whole.samples)
    assert all((some[channel] == whole[channel]).all() for channel in whole.samples)
    assert (loads(dumps(some))["time"] == some["time"]).all()
    monkeypatch.setattr(Solver, "__call__", None)
    fast(angles[:1])


@SLOW
def test_reductions_are_by_machine_code_where_it_is_at_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, channels, values = scenes.load("four_bar"), frozenset(["B.x"]), list[float]()
    monkeypatch.setattr("analytic.recorded.fast.MIN_SAMPLES", 1000)
    for _ in range(2):
        machine_line.cache_clear()
        largest = analytic.Extremes("B.x", 2)
        changes = {"bodies.crank.mass": [1.0, 2.0]}
        analytic.reduce_many(scene, changes, analytic.Grid(0, 6, 500), [largest])
        values.append(float(largest.largest[0]))
        made = machine_line(scene, channels, 1000)
        assert (made is not None) == (len(values) == 2)
        analytic.fast_solver(scene, channels, compiled=True)([0.0])
    assert machine_line(scene, channels, 999) is None
    assert values[0] == pytest.approx(values[1], rel=1e-13)  # roundings


@SLOW
def test_machines_of_dyads_by_machine_code() -> None:
    scene, changes, angles = scenes.load("toggle_press"), {"bodies.toggle.mass": [250.0, 251.0]}, np.linspace(0, 6, 9)
    fast = analytic.fast_solver(scene, {"drive.torque"}, compiled=True).many(changes, angles)
    plain = analytic.solve_many(scene, changes, angles, channels={"drive.torque"})
    assert fast.ok.all()
    assert np.allclose(fast["drive.torque"], plain["drive.torque"], rtol=1e-10)  # roundings


@SLOW
def test_what_is_no_position_is_refused_at_once_too() -> None:
    fast = analytic.fast_solver(scenes.load("four_bar"), compiled=True)
    assert np.isfinite(fast(np.array([1e200]))["B.x"]).all()  # a double
    for position in (np.nan, np.inf):
        with pytest.raises(InputError, match="position: expected finite numbers"):
            fast(np.array([position]))


@ROUTES
def test_one_machine_and_many(*, compiled: bool) -> None:
    """Of those that do not assemble the core has the say, as of one that no file could describe."""
    scene = scenes.load("toggle_press")
    fast = analytic.fast_solver(scene, compiled=compiled)
    position = np.linspace(0, 6, 200)
    assert_same(fast(position), analytic.solve(scene, position))
    assert_same(fast(position[:1]), analytic.solve(scene, position[:1]))
    changes: dict[str, list[float]] = {
        "bodies.rocker.lengths.O-P3": [300, 200, 301.0],
        "bodies.rod.mass": [60, 60, -1.0],
        "drive.speed": [1, 2, 3],
    }
    many, core = fast.many(changes, position), analytic.solve_many(scene, changes, position)
    assert many.status == core.status
    assert many.reason == core.reason
    assert_same(many, core)


def test_what_does_not_reach_is_named_by_the_core() -> None:
    scene = scenes.load("toggle_press", {"bodies.rocker.lengths.O-P3": 200.0})
    with pytest.raises(Failure, match="P5 cannot be reached"):
        analytic.fast_solver(scene, compiled=False)(np.linspace(0, 6, 50))


@ROUTES
def test_many_machines_with_a_press_force(*, compiled: bool) -> None:
    """Where their strokes end follows from all numbers of the scene, those that do not differ among them."""
    scene = scenes.load("crank_press")
    changes, position = {"bodies.crank.lengths.O-A": [90.0, 91.0]}, np.linspace(0, 6, 50)
    many = analytic.fast_solver(scene, compiled=compiled).many(changes, position)
    assert_same(many, analytic.solve_many(scene, changes, position))


@ROUTES
def test_an_open_branch_is_named_where_nothing_wanted_hangs_on_it(*, compiled: bool) -> None:
    """The second machine's C lies on the sketched A."""
    scene = scenes.load("four_bar")
    length, (x, y) = scene.units["length"][1], scene.sketch.points["A"]
    changes = {"ground.points.C.0": [0.2 / length, x / length], "ground.points.C.1": [0.0, y / length]}
    many = analytic.fast_solver(scene, {"A.x"}, compiled=compiled).many(changes, [0.0, 1.0])
    assert [status.name for status in many.status] == ["ok", "unsupported"]
    assert many.reason == analytic.solve_many(scene, changes, [0.0, 1.0], channels={"A.x"}).reason
    assert set(many.samples) == {"time", "crank_angle", "A.x"}


@SLOW
def test_machine_code_is_kept_by_its_text(tmp_path: Path) -> None:
    """Another machine of the topology takes the same code; a kept file that was spoilt is written anew."""
    pytest.importorskip("numba")
    machine_code.kernel_of.cache_clear()  # of other tests, which are kept elsewhere
    for length in (250.0, 260.0):
        scene = scenes.load("four_bar", {"bodies.rocker.lengths.C-B": length})
        analytic.fast_solver(scene, {"B.x"}, compiled=True)(np.linspace(0, 1, 3))
    (kept,) = (tmp_path / "linkage-crosscheck").glob("*.py")
    text = kept.read_text(encoding="utf-8")
    kept.write_text("raise SystemExit", encoding="utf-8")
    machine_code.kernel_of.cache_clear()
    found = analytic.fast_solver(scene, {"B.x"}, compiled=True)(np.linspace(0, 1, 3))
    assert kept.read_text(encoding="utf-8") == text
    assert found["B.x"] == pytest.approx(analytic.solve(scene, np.linspace(0, 1, 3))["B.x"], rel=1e-12)


@SLOW
@pytest.mark.parametrize("trouble", ["a file for a folder", "a cache that cannot be written", "no home"])
def test_where_nothing_can_be_kept(trouble: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The code is made anew, and nothing is left anywhere; files where folders should be stop root too."""
    pytest.importorskip("numba")
    scene, angles = scenes.load("four_bar"), np.linspace(0, 1, 4)
    if trouble == "a file for a folder":
        (tmp_path / "linkage-crosscheck").write_text("", encoding="utf-8")
    elif trouble == "no home":  # as of a user without an entry, in a container
        for name in ("XDG_CACHE_HOME", "HOME", "USERPROFILE"):
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setattr("pwd.getpwuid", {}.__getitem__)
    else:
        folder = tmp_path / "linkage-crosscheck"
        folder.mkdir()
        for place in (folder / "__pycache__", tmp_path / "numba"):
            place.write_text("", encoding="utf-8")
    before = sorted(path.name for path in tmp_path.iterdir())
    machine_code.kernel_of.cache_clear()
    found = analytic.fast_solver(scene, {"B.x"}, compiled=True)(angles)
    assert found["B.x"] == pytest.approx(analytic.solve(scene, angles)["B.x"], rel=1e-12)
    assert sorted(path.name for path in tmp_path.iterdir()) == before

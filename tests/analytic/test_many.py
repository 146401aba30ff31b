"""Many machines at once: each as a file of its own would have it, none spoilt by another; reductions of them."""

import warnings
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

import analytic
import scenes
from analytic.core.groups import continuation
from scenes import Failure, InputError, Scene, Status
from scenes.scene import ConstantSpeed, PressForce
from tests import scene_files
from tests.comparisons import SLOW, sampled

from .newton import assert_close, intervals

GROUPS = ("class_iii_among_dyads", "slotted_class_iii")  # of class III as the shipped one; the last one locks
COUNT = 5
CLOSE = 1e-10  # of a channel's peak: roundings, times what a scene's conditioning makes of them


def varied(scene: Scene, share: float, seed: int = 0) -> dict[str, np.ndarray]:
    """Return other numbers at all paths, off by a share, or by it of a unit where they are zero."""
    draw = np.random.default_rng(seed)
    written = [path for path in scene_files.free(scene) if path != "drive.start"]  # which some files leave out
    nominal = np.array(scenes.numbers_in(scene_files.path(scene.name), written))
    size = np.where(nominal == 0, 1.0, nominal)
    others = nominal + size * share * draw.uniform(-1, 1, (COUNT, len(nominal)))
    return dict(zip(written, others.T, strict=True))


@sampled(2)
@pytest.mark.parametrize("name", [*scenes.shipped(), *GROUPS])
def test_each_machine_is_as_one_of_a_file(name: str) -> None:
    """Every number of the file differs, and the drive's way, in another form of the arithmetic, is the same."""
    scene = scene_files.load(name)
    time = np.linspace(0, scene.cycle, 37)
    position = scene.drive.law.at(time).position
    changes = varied(scene, 1e-4)
    many = analytic.solve_many(scene, changes, position, time)
    for machine in range(COUNT):
        numbers = {path: float(values[machine]) for path, values in changes.items()}
        one = analytic.solve(scenes.load(scene_files.path(name), numbers), position, time)
        assert many.status[machine] is Status.ok, many.reason[machine]
        assert_close(of_machine(many, machine), one.samples, CLOSE)


def of_machine(many: analytic.Machines, machine: int) -> dict[str, np.ndarray]:
    return {channel: samples[machine] for channel, samples in many.samples.items()}


def test_a_machine_that_fails_spoils_no_other() -> None:
    scene = scenes.load("toggle_press")
    position = np.linspace(0, 2 * np.pi, 91)
    changes = {
        "bodies.rocker.lengths.P3-O": [300, 200, 300, 300, 300.0],
        "bodies.toggle.lengths.P2-P4": [760, 760, 990, 760, 760.0],
        "bodies.rod.mass": [60, 60, 60, -1, 60.0],
    }
    many = analytic.solve_many(scene, changes, position)
    assert [status.name for status in many.status] == ["ok", *["cannot_assemble"] * 3, "ok"]
    for machine, words in {
        1: ("P5 cannot be reached at crank angle", "rod and slider"),
        2: ("triangle",),
        3: ("mass", "-1"),
    }.items():
        assert all(word in many.reason[machine] for word in words), many.reason[machine]
    alone = analytic.solve_many(scene, {path: numbers[:1] for path, numbers in changes.items()}, position)
    for machine in (0, 4):
        assert all(np.array_equal(many[channel][machine], samples[0]) for channel, samples in alone.samples.items())
    reached = np.isfinite(many["P5.y"][1])
    assert 0 < reached.sum() < len(position)
    assert not reached[np.isnan(many["drive.torque"][1])].any()


LONG, SHORT = "bodies.crank.lengths.O-A", "bodies.lower.lengths.D-F"


@SLOW
def test_larger_groups_that_fail_spoil_no_other() -> None:
    """A crank that locks, a bar that is too short: each with the status, place and open joint of a single run."""
    crank, bar = scenes.numbers_in("class_iii", (LONG, SHORT))
    position = np.linspace(0, 2 * np.pi, 73)
    changes = {LONG: [crank, 200, crank, 1.01 * crank], SHORT: [bar, bar, 23, bar]}
    many = analytic.solve_many(scenes.load("class_iii"), changes, position)
    alone = [
        scenes.load("class_iii", {LONG: length, SHORT: short}) for length, short in zip(*changes.values(), strict=True)
    ]
    for machine in (1, 2):
        with pytest.raises(Failure) as caught:
            analytic.solve(alone[machine], position)
        assert many.status[machine] is caught.value.status
        assert many.reason[machine].startswith(caught.value.reason.partition("; the crank")[0])
    for machine in (0, 3):
        assert many.status[machine] is Status.ok, many.reason[machine]
        assert_close(of_machine(many, machine), analytic.solve(alone[machine], position).samples, CLOSE)
    assert np.isnan(many["D.y"][2]).all()
    reached = np.isfinite(many["D.y"][1])
    inside = analytic.solve(alone[1], position[reached])
    assert 0 < reached.sum() < len(position)
    assert np.abs(many["D.y"][1, reached] - inside["D.y"]).max() <= 1e-12  # m, roundings
    (interval,) = intervals(alone[1])
    turned = interval.start + np.remainder(position - interval.start, 2 * np.pi)
    assert np.array_equal(reached, turned <= interval.end)


def test_machines_that_need_two_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    """By a turn that is taken to end in another pose, as `test_class_iii` has it."""
    monkeypatch.setattr(continuation, "SAME_POSE_TOL", -1.0)
    bar = scenes.numbers_in("class_iii", (SHORT,))[0]
    many = analytic.solve_many(scenes.load("class_iii"), {SHORT: [bar, 1.001 * bar]}, [1.0])
    assert all(status is Status.unsupported for status in many.status)
    assert all(reason.startswith("after one turn of the crank coupler") for reason in many.reason)


def test_positions_of_each_machine_and_channels_asked_for() -> None:
    scene = scenes.load("toggle_press")
    position = np.linspace([0, 1], [6, 7], 11, axis=1)
    many = analytic.solve_many(scene, {"drive.speed": [60, -30]}, position, channels={"P5.vy"})
    for machine, speed in enumerate((60, -30)):
        one = analytic.solve(scenes.load("toggle_press", {"drive.speed": float(speed)}), position[machine])
        assert many["P5.vy"][machine] == pytest.approx(one["P5.vy"], rel=1e-13)  # roundings
        assert many["time"][machine] == pytest.approx(one["time"], rel=1e-13)
    assert "P5.ay" not in many


def test_blocks_do_not_show() -> None:
    """More positions than a block, and more machines than one."""
    scene = scenes.load("toggle_press")
    lengths = np.linspace(299, 301, 40)
    long = np.linspace(0, 6, 20_001)
    changes = {"bodies.rocker.lengths.O-P3": lengths}
    few = analytic.solve_many(scene, {"bodies.rocker.lengths.O-P3": lengths[[3, 39]]}, long, channels={"P5.ay"})
    assert np.array_equal(
        few["P5.ay"][:, ::100], analytic.solve_many(scene, changes, long[::100], channels={"P5.ay"})["P5.ay"][[3, 39]]
    )


ROCKER, ROD = "bodies.rocker.lengths.O-P3", "bodies.rod.mass"
REFUSED: list[tuple[dict[str, list[float]], str]] = [
    ({"bodies.rocker.lengths.O-P4": [1.0]}, "O-P3"),
    ({"bodies.rokcer.mass": [1.0]}, "bodies.rocker.mass"),
    ({"sketch.P2.0": [1.0]}, "expected the path of a number"),
    ({ROD: [1.0, 2], "drive.speed": [3.0]}, "one number a machine"),
    ({ROCKER: [300.0], "bodies.rocker.lengths.P3-O": [300.0]}, "two of the paths lead to the same one"),
]


@pytest.mark.parametrize(("changes", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_numbers_that_are_refused(changes: dict[str, list[float]], words: str) -> None:
    with pytest.raises(InputError, match=words):
        analytic.solve_many(scenes.load("toggle_press"), changes, [0.0])


def test_a_press_force_without_a_part_along_its_guide_is_refused() -> None:
    """As a file with it is: nothing would show in which way the slider closes against it."""
    scene = scenes.load("crank_press")
    (number, load) = next((n, load) for n, load in enumerate(scene.loads) if isinstance(load, PressForce))
    paths = [f"loads.{number}.force.{axis}" for axis in range(2)]
    nominal = np.array(scenes.numbers_in("crank_press", paths))
    many = analytic.solve_many(scene, dict(zip(paths, np.stack([nominal, 0 * nominal], axis=1), strict=True)), [0.1])
    assert load.last > 0
    assert [status.name for status in many.status] == ["ok", "cannot_assemble"]
    assert "part along the guide" in many.reason[1]


@pytest.mark.parametrize(("name", "end"), [("toggle_press", None), ("four_bar", 90.0)])
def test_a_speed_that_no_file_may_have_is_refused(name: str, end: float | None) -> None:
    """In the file's units, also where the drive stops; the other machines are solved."""
    scene = scenes.load(name)
    law = scene.drive.law
    assert isinstance(law, ConstantSpeed)
    scene = scene.with_law(replace(law, end=None if end is None else law.start + np.radians(end)))
    speeds = [60.0, 0.0, -60.0, np.nan, 60.0]
    with warnings.catch_warnings(action="error"):
        many = analytic.solve_many(scene, {"drive.speed": speeds}, [0.1])
    refused = {1: "a number other than zero, found 0", 3: "found nan"}
    if end is not None:
        refused[2] = f"below 'start', {np.degrees(law.start):g} deg, found {np.degrees(law.start) + end:g} deg"
    for machine, (status, why) in enumerate(zip(many.status, many.reason, strict=True)):
        assert (status is Status.ok) == (machine not in refused), why
        assert refused.get(machine, "") in why


def test_a_direction_that_no_file_may_have_is_refused() -> None:
    along = "bodies.slider.slides.along"
    with warnings.catch_warnings(action="error"):
        many = analytic.solve_many(
            scenes.load("toggle_press"), {f"{along}.0": [0.0, 0, 0], f"{along}.1": [1, 0, 1e300]}, [0.1]
        )
    assert [status.name for status in many.status] == ["ok", "cannot_assemble", "cannot_assemble"]
    assert all(f"{along}: expected a direction of a size" in why for why in many.reason[1:])


LENGTHS = {ROCKER: np.array([300, 200, 301.0])}  # the second does not assemble all the way


@pytest.mark.parametrize("count", [50, 9001])
def test_reductions_are_of_all_samples(count: int) -> None:
    scene = scenes.load("toggle_press")
    grid = analytic.Grid(0.5, 6.5, count)
    at = np.linspace(0.5, 6.5, count)
    extremes, integral = analytic.Extremes("P5.vy", 3), analytic.Integral("drive.torque", 3)
    histogram = analytic.Histogram("P5.vy", np.linspace(-5, 5, 11))
    told: list[int] = []
    status, reason = analytic.reduce_many(
        scene, LENGTHS, grid, [extremes, integral, histogram], lambda done, of: told.append(of - done)
    )
    whole = analytic.solve_many(scene, LENGTHS, at)
    assert (tuple(status), tuple(reason)) == (whole.status, whole.reason)
    v, torque = whole["P5.vy"], whole["drive.torque"]
    assert extremes.largest == pytest.approx(np.nanmax(v, axis=1), rel=1e-13)  # positions differ by roundings
    assert extremes.least == pytest.approx(np.nanmin(v, axis=1), rel=1e-13)
    assert extremes.least_at == pytest.approx(at[np.nanargmin(v, axis=1)], abs=1e-12)
    fine = [0, 2]
    assert integral.total[fine] == pytest.approx(trapezoid(torque[fine], at, axis=1), rel=1e-10)
    assert np.isnan(integral.total[1])
    assert np.abs(histogram.counts - np.histogram(v[np.isfinite(v)], histogram.edges)[0]).max() <= 1  # at an edge
    assert told[-1] == 0


def test_reductions_of_one_machine() -> None:
    extremes = analytic.Extremes("P5.y")
    (status,), _ = analytic.reduce_many(scenes.load("toggle_press"), {}, [0.1, 0.2, 0.3], [extremes])
    assert status is scenes.Status.ok
    highest = analytic.solve(scenes.load("toggle_press"), [0.1, 0.2, 0.3])["P5.y"].max()
    assert extremes.largest == pytest.approx(highest, rel=1e-14)  # roundings


@SLOW
def test_reductions_of_larger_groups() -> None:
    """The crank of the second machine is so long that it locks."""
    scene, changes = scenes.load("class_iii"), {LONG: [scenes.numbers_in("class_iii", (LONG,))[0], 200]}
    extremes, at = analytic.Extremes("D.x", 2), np.linspace(0, 6, 9001)
    status, reason = analytic.reduce_many(scene, changes, at, [extremes])
    whole = analytic.solve_many(scene, changes, at, channels={"D.x"})
    assert (tuple(status), tuple(reason)) == (whole.status, whole.reason)
    assert [one.name for one in status] == ["ok", "cannot_assemble"]
    assert np.array_equal(extremes.largest, np.nanmax(whole["D.x"], axis=1))

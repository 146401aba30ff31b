"""Extremes between the samples too: by hand, by the core, at the ends of jumps, and where a linkage locks."""

from collections.abc import Mapping
from functools import cache
from math import pi, tau
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import analytic
import scenes
from analytic.proven.boxes import Boxes
from analytic.recorded.arithmetics.taylor_models import TaylorModel
from scenes import Failure, InputError, Scene
from scenes.channels import named
from scenes.drive import ConstantSpeed
from scenes.model.enclosures import Enclosure
from scenes.model.motion import Positions, Samples
from tests import scene_files
from tests.agreement import exact
from tests.clean_scenes import clean_scenes
from tests.comparisons import sampled

from .true_values import ALL_ZERO, BY_50_DIGITS, BY_DOUBLES, motion_at, peaks, turn, with_magnitudes

Bounds = Mapping[tuple[str, str], Enclosure]
SAMPLES = 1441  # of a range
STILL = 1e-8  # of a unit's peak: what changes by less, as what is zero but for roundings, is known to its size
FEW = ("toggle_press", "crank_press", "four_bar")


def enclosed(scene: Scene, accuracy: float = 1e-6, *names: str) -> Bounds:
    """By name and extreme."""
    found = analytic.enclose(scene, frozenset(names) or None, accuracy)
    assert found.open_at is None
    return {(row.channel, row.extreme): row for row in found.rows}


@cache
def shipped(name: str) -> tuple[Bounds, Mapping[str, Samples]]:
    """The extremes of a shipped scene, and the core's samples."""
    scene = scenes.load(name)
    samples = with_magnitudes(scene, motion_at(scene, turn(scene, SAMPLES - 1)))
    bounds = enclosed(scene)
    sense = (
        -1 if isinstance(scene.drive.law, ConstantSpeed) and scene.drive.law.speed < 0 else 1
    )  # from the drive's start on
    angles = {of: np.unwrap(values[::sense])[::sense] for of, values in samples.items() if named(of).name == "angle"}
    samples = {**samples, **angles}
    return bounds, {of: values for of, values in samples.items() if (of, "least") in bounds}


def assert_holds(name: str) -> None:
    """The core's samples lie within the bounds; an angle goes on over whole turns."""
    bounds, samples = shipped(name)
    peak = peaks(samples)
    assert len(samples) > 5
    for channel, values in samples.items():
        slack = BY_DOUBLES * max(peak[named(channel).unit], ALL_ZERO)
        least, most = bounds[channel, "least"], bounds[channel, "most"]
        assert values.min() >= least.low - slack, channel
        assert values.max() <= most.high + slack, channel
        for one in (least, most):
            assert one.low <= one.high, channel
            assert one.position_low <= one.position_high, channel


def assert_near(name: str, accuracy: float = 1e-6) -> None:
    """The bounds are as near as asked, and no further from what the core attains."""
    bounds, samples = shipped(name)
    peak = peaks(samples)
    for channel, values in samples.items():
        of_unit = max(peak[named(channel).unit], ALL_ZERO)
        least, most = bounds[channel, "least"], bounds[channel, "most"]
        if np.ptp(values) > max(STILL * of_unit, ALL_ZERO):
            span = most.high - least.low
            assert max(least.high - least.low, most.high - most.low) <= accuracy * span, channel
            assert most.high >= values.max() - BY_DOUBLES * of_unit, channel
            # Between samples of a quarter of a degree a peak rises by a square of that, of a sharp one some times more.
            assert most.low - values.max() <= 0.01 * span, channel
            assert values.min() - least.high <= 0.01 * span, channel


@sampled(1)
@pytest.mark.parametrize("name", FEW)
def test_what_is_shipped_is_enclosed(name: str) -> None:
    assert_holds(name)
    assert_near(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted({*scenes.shipped()} - {*FEW}))
def test_all_that_is_shipped_is_enclosed(name: str) -> None:
    assert_holds(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted({*scenes.shipped()} - {*FEW}))
def test_all_that_is_shipped_is_enclosed_as_nearly_as_asked(name: str) -> None:
    assert_near(name)


def peaks_by_50_digits(scene: Scene) -> bool:
    """Whether 50 digits have a motion where extremes are; all their values lie within the extremes."""
    try:
        found = analytic.enclose(scene)
        assert isinstance(scene.drive.law, ConstantSpeed)
        if not found.rows:
            return False
        places = np.unique([(one.position_low + one.position_high) / 2 for one in found.rows])[::3]
        places = places[np.isfinite(places)][:: int(np.sign(scene.drive.law.speed))]
        motion = exact(scene, Positions(tuple(places.tolist())))
    except Failure:
        return False
    samples = with_magnitudes(scene, motion)
    peak, ends = peaks(samples), {row[:2]: row for row in found.rows}
    for one in found.rows:
        if one.channel in samples:
            values = samples[one.channel]
            if named(one.channel).name == "angle":  # which counts modulo a turn here
                first, last = ends[one.channel, "least"].low, ends[one.channel, "most"].high
                values = values + tau * np.round(((first + last) / 2 - values) / tau)
            slack = BY_50_DIGITS * max(peak[named(one.channel).unit], ALL_ZERO) + 2.0**-52 * np.abs(values).max()
            inside = values.min() >= one.low - slack if one.extreme == "least" else values.max() <= one.high + slack
            assert inside, f"{scene.name}: {one}"
    return True


def drawn_at_constant_speed(folder: Path, count: int) -> list[Scene]:
    """Those of plain linkages, all of which are shown to move."""
    return [scene for scene in clean_scenes(folder, count) if isinstance(scene.drive.law, ConstantSpeed)]


@pytest.mark.slow
def test_no_peak_of_random_linkages_is_beyond(tmp_path: Path) -> None:
    assert sum(map(peaks_by_50_digits, drawn_at_constant_speed(tmp_path, 16))) >= 5


@pytest.mark.study
def test_no_peak_of_many_random_linkages_is_beyond(tmp_path: Path) -> None:
    assert sum(map(peaks_by_50_digits, drawn_at_constant_speed(tmp_path, 200))) >= 60


@pytest.mark.parametrize("accuracy", [1e-3, 1e-6, 1e-9])
def test_bounds_are_as_near_as_asked(accuracy: float) -> None:
    scene = scenes.load("toggle_press")
    bounds = enclosed(scene, accuracy, "P5.y", "P5.vy", "P5.ay", "P1.force", "transmission", "drive.torque")
    for name in {name for name, _ in bounds}:
        least, most = bounds[name, "least"], bounds[name, "most"]
        assert most.high > least.low
        for one in (least, most):
            assert one.high - one.low <= accuracy * (most.high - least.low), name


def test_the_stroke_of_a_slider_crank() -> None:
    """From the rod's length less the crank's to their sum, where the crank is at half a turn and at none."""
    bounds = enclosed(scene_files.load("slider_crank"), 1e-9, "B.x")
    least, most = bounds["B.x", "least"], bounds["B.x", "most"]
    assert least.low <= 3 - 1 <= least.high
    assert most.low <= 3 + 1 <= most.high
    assert max(least.high - least.low, most.high - most.low) <= 2e-9
    assert least.position_low <= pi <= least.position_high
    assert most.position_low == 0  # or a whole turn: the first
    assert max(least.position_high - least.position_low, most.position_high) <= 1e-3  # flat: about the root of 1e-9


def test_the_speed_of_a_crank() -> None:
    """2 m at 3 rad/s, wherever it is."""
    bounds = enclosed(scene_files.load("crank"), 1e-9, "T.speed", "T.acceleration", "T.x")
    for name, value in {"T.speed": 6.0, "T.acceleration": 18.0}.items():
        for extreme in ("least", "most"):
            one = bounds[name, extreme]
            assert one.low <= value <= one.high
            assert one.high - one.low <= 2e-6 * value  # what does not change is known to a millionth of its kind
    assert bounds["T.x", "most"].low <= 2 <= bounds["T.x", "most"].high


def test_the_peak_of_the_toggle_press() -> None:
    """Between the samples of a degree and a refined one, 382 011.69 N, as the core has it by golden section."""
    scene = scenes.load("toggle_press")
    one = enclosed(scene, 1e-9, "P1.force")["P1.force", "most"]
    near = analytic.solve(scene, np.linspace(3.573, 3.574, 100_001), channels=frozenset({"P1.fx", "P1.fy"}))
    force = np.hypot(near["P1.fx"], near["P1.fy"])
    assert one.position_low <= np.linspace(3.573, 3.574, 100_001)[force.argmax()] <= one.position_high
    assert one.low * (1 - 1e-12) <= force.max() <= one.high * (1 + 1e-12)  # steps of 1e-8 rad, at a flat place
    assert one.low == pytest.approx(382_011.69, abs=0.005)


def switches(scene: Scene, name: str) -> list[tuple[float, float]]:
    """The places, and their neighbours in doubles, where a channel jumps most."""

    def effort(at: list[float]) -> Samples:
        return analytic.solve(scene, at, channels=frozenset({name}))[name]

    way = turn(scene, 20_000)
    jumps = np.abs(np.diff(effort([*map(float, way)])))
    found = []
    for first in np.flatnonzero(jumps > 50 * np.median(jumps) + 0.2 * jumps.max()):
        low, high = float(way[first]), float(way[first + 1])
        while (middle := (low + high) / 2) not in (low, high):
            before, here, behind = effort([low, middle, high])
            low, high = (low, middle) if abs(here - before) > abs(behind - here) else (middle, high)
        found.append((low, high))
    return found


def test_limits_beside_a_jump_are_within() -> None:
    """A press force comes all at once: what it is just behind the switch, and just before, are both of the range."""
    scene = scenes.load("crank_press")
    bounds = enclosed(scene)
    places = switches(scene, "A.fy")
    assert len(places) == 2  # it comes, and goes at the end of the stroke
    way = np.unique([*np.ravel(places), *turn(scene, 20_000)])
    samples = with_magnitudes(scene, motion_at(scene, way))
    beside = np.isin(way, np.ravel(places))
    peak = peaks(samples)
    of_limits = 0
    for name, values in samples.items():
        if named(name).name not in ("fx", "fy", "force", "torque", "guide_force"):
            continue
        slack = BY_DOUBLES * peak[named(name).unit]
        least, most = bounds[name, "least"], bounds[name, "most"]
        assert least.low - slack <= values.min()
        assert values.max() <= most.high + slack
        grid = 1e-6 * np.ptp(values) + slack  # an extreme between samples of 2e-5 of a turn: its square, and more
        assert most.high - values.max() <= max(2 * grid, 1e-6 * peak[named(name).unit])
        assert values.min() - least.low <= max(2 * grid, 1e-6 * peak[named(name).unit])
        of_limits += beside[values.argmax()] + beside[values.argmin()]
    assert of_limits  # some are attained only beside a switch


def test_what_is_zero(monkeypatch: pytest.MonkeyPatch) -> None:
    """A slider on the x axis never leaves it: known to a millionth of what moves, in a few boxes."""
    counted: list[int] = []
    of = Boxes.__call__

    def counting(self: Boxes, low: Samples, high: Samples) -> tuple[TaylorModel, Any]:
        counted.append(len(low))
        return of(self, low, high)

    monkeypatch.setattr(Boxes, "__call__", counting)
    bounds = enclosed(scene_files.load("slider_crank"), 1e-9, "B.y", "B.vy", "B.ay")
    for one in bounds.values():
        assert one.low <= 0 <= one.high
        assert one.high - one.low <= 1e-11  # roundings of metres, at 10 rad/s
    assert sum(counted) <= 1000


def varied(scene: Scene, count: int, seed: int) -> dict[str, Samples]:
    """Numbers of machines by path, in the file's units: the first ones at corners of all tolerances, others within."""
    chance = np.random.default_rng(seed)
    shares = chance.uniform(-1, 1, (len(scene.variations), count))
    shares[:, : count // 2] = np.sign(shares[:, : count // 2])
    nominal = scenes.numbers_in(scene.name, [one.path for one in scene.variations])
    rows = zip(scene.variations, nominal, shares, strict=True)
    return {one.path: number + one.plus_minus * share for one, number, share in rows}


def off_by(scene: Scene) -> dict[str, float]:
    """By how much numbers may be off, SI."""
    nominal = scenes.numbers_in(scene.name, [one.path for one in scene.variations])
    rows = zip(scene.variations, nominal, strict=True)
    others = {one.path: scenes.load(scene.name, {one.path: number + one.plus_minus}) for one, number in rows}
    return {path: abs(other.numbers[path].value - scene.numbers[path].value) for path, other in others.items()}


@sampled(1)
@pytest.mark.parametrize("name", ["toggle_press", "double_toggle_clamp"])
def test_all_machines_within_tolerances(name: str) -> None:
    scene = scenes.load(name)
    names = frozenset({f"{scene.output}.{q}" for q in ("x", "y", "vx", "vy")} | {scene.channels.drive.effort})
    found = analytic.enclose(scene, names, off=off_by(scene))
    assert found.open_at is None
    bounds = {(row.channel, row.extreme): row for row in found.rows}
    way = turn(scene, 720)
    machines = analytic.solve_many(scene, varied(scene, 60, 0), way, channels=names)
    for channel in names:
        values, least, most = machines[channel], bounds[channel, "least"], bounds[channel, "most"]
        slack = BY_DOUBLES * max(np.abs(values).max(), 1.0)  # of what is zero, that of metres
        assert values.min() >= least.low - slack, channel
        assert values.max() <= most.high + slack, channel
        # The corners of all numbers at once are not among sixty drawn: their linear sum is up to some times as far.
        spread = max(np.ptp(values.max(axis=1)), np.ptp(values.min(axis=1)))
        assert most.high - most.low <= 5 * spread + 0.02 * np.ptp(values) + slack, channel


def test_names_that_are_not_known() -> None:
    scene = scene_files.load("slider_crank")
    for name, right in {
        "B.spead": "B.speed",
        "transmision": "transmission",
        "B.xx": "B.x",
        "A.forse": "A.force",
    }.items():
        with pytest.raises(InputError, match=f"no '{name}'; did you mean '{right}'"):
            analytic.enclose(scene, {name})
    with pytest.raises(InputError, match=r"did you mean .bodies\.rod\."):
        analytic.enclose(scene, {"B.x"}, off={"bodies.rod.lengths.A-C": 0.1})
    with pytest.raises(InputError, match="accuracy"):
        analytic.enclose(scene, {"B.x"}, float("nan"))
    with pytest.raises(InputError, match="names: no"):
        analytic.departures(scene, np.array([0.0, 1.0]), {"B.q"})


@pytest.mark.parametrize("accuracy", [0.0, -1e-6])
def test_an_accuracy_that_is_none(accuracy: float) -> None:
    with pytest.raises(InputError, match="accuracy"):
        analytic.enclose(scene_files.load("slider_crank"), {"B.x"}, accuracy)

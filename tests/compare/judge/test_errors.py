"""Errors against the reference: each must show on a result that has it."""

from copy import copy
from dataclasses import replace

import numpy as np
import pytest

import scenes
from compare.engines.registry import Remembering
from compare.engines.runner import Run
from compare.judge.checks import checks
from compare.judge.errors import by_group, compare, error_table, worst_of
from compare.judge.floor import establish
from compare.judge.measure import measure
from compare.mechanics.motion_vectors import MotionVectors
from compare.mechanics.reference import Floor, Reference
from scenes import Motion, Sampling, Status
from scenes.channels import named
from scenes.model.inputs import Inputs, passing
from scenes.scene import Force, PressForce
from tests.comparisons import (
    SAMPLING,
    Plug,
    References,
    changed,
    commanded,
    of_scene,
    row_of,
    rows_of,
    sampled,
    size_of,
    vector_of,
)

# --- errors -----------------------------------------------------------------------------------------------------------


@sampled(2)
@pytest.mark.parametrize("name", ["toggle_press", "shaper", "driven_toggle", "swinging_law"])
def test_an_error_in_any_channel_of_any_drive_is_found(references: References, name: str) -> None:
    reference = references(name)
    plain = commanded(reference)
    for channel in {*reference.scene.channels.names()} - {"time", reference.scene.channels.drive.position}:
        scale = reference.scale[channel]
        table = rows_of(reference, changed(plain, channel, -1e-3 * scale))
        row, error = row_of(table, channel), 1e-3 * scale / size_of(plain, channel, scale)
        assert row.max == pytest.approx(error, rel=1e-9), channel
        assert row.rms == pytest.approx(error / np.sqrt(SAMPLING.count), rel=1e-9), channel
        assert all(row.max <= 1e-14 for row in table if row.channel not in vector_of(channel)), channel


def test_scales(reference: Reference) -> None:
    S, w, scale = 0.1836316, 2 * np.pi, reference.scale
    expected = {"P2.vx": 2 * 0.077 * w, "P5.ay": S * w**2, "P3.fx": scale["P3.fy"]}  # P2: of its own circle
    expected["slider.guide_moment"] = S * scale["slider.guide_force"]
    assert reference.stroke == pytest.approx(S, abs=5e-8)
    assert {channel: scale[channel] for channel in expected} == pytest.approx(expected, rel=1e-6)
    assert scale["drive.torque"] == pytest.approx(13888, abs=0.5)


def test_angles_count_modulo_a_turn(reference: Reference, motion: Motion) -> None:
    turned = Motion({**motion.samples, "rod.angle": motion["rod.angle"] + 2 * np.pi})
    assert row_of(rows_of(reference, turned), "rod.angle").max <= 1e-14


def test_the_drives_error_is_told_apart(reference: Reference) -> None:
    """A crank that lags by 1e-4 rad, everything else right for where it is."""
    scene = reference.scene
    lagging = reference.at(passing(scene, SAMPLING.commanded(scene) - 1e-4, SAMPLING.times(scene)))
    table = rows_of(reference, lagging)
    assert row_of(table, "P5.y").max <= 1e-14
    assert row_of(table, "P5.y").commanded_max == pytest.approx(1e-4 * 0.865 / (2 * np.pi) / 0.18363, rel=1e-2)
    assert row_of(table, "crank_angle").commanded_max == pytest.approx(1e-4, rel=1e-9)


def test_toggle_windows_and_last_turn(reference: Reference) -> None:
    sampling = Sampling(360, turns=2)
    plain = commanded(reference, sampling)
    first_turn = changed(plain, "P5.y", 1e-3, row=100)  # at 100 degrees the slider moves
    row = row_of(rows_of(reference, first_turn, sampling), "P5.y")
    assert row.max > 1e-3
    assert row.last_turn_max <= 1e-14
    assert row.toggle_max <= 1e-14
    at_bottom = changed(plain, "P5.y", 1e-3, row=373)
    row = row_of(rows_of(reference, at_bottom, sampling), "P5.y")
    assert row.last_turn_max == row.toggle_max == row.max


def test_no_error_is_shown_below_the_floor(reference: Reference, motion: Motion) -> None:
    assert reference.floor.by_channel, "the certify extra is part of the test extra"
    high = replace(reference, floor=replace(reference.floor, by_channel=dict.fromkeys(motion.samples, 1e-9)))
    table = rows_of(high, motion)
    assert {row.max for row in table} == {1e-9}


def test_an_uncertified_reference_has_no_error_to_show(reference: Reference, motion: Motion) -> None:
    uncertified = replace(reference, floor=Floor({}, "not certified"))
    comparison = compare(uncertified, SAMPLING, motion)
    assert all(np.isnan(row.max) for row in error_table("analytic", comparison, uncertified))
    assert {row.max for row in error_table("stub", comparison, uncertified)} == {0.0}


# --- other drives -----------------------------------------------------------------------------------------------------


def test_scales_of_a_driven_slider(references: References) -> None:
    """The crosshead goes 250 mm at 150 mm/s; the platen goes S meanwhile."""
    reference = references("driven_toggle")
    S, w, force = reference.stroke, 0.150 / 0.250, commanded(reference, Sampling(3600))["drive.force"]
    expected = {"C.x": S, "C.vx": S * w, "C.ax": S * w**2, "plate.omega": w, "plate.alpha": w**2}
    expected |= {"drive.displacement": 0.250, "drive.force": np.abs(force).max()}
    assert {channel: reference.scale[channel] for channel in expected} == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "at", "unit"),
    [("toggle_press", 200.0, "deg"), ("driven_toggle", -38.888889, "mm"), ("swinging_law", 0.66666667, "s")],
)
def test_where_the_largest_error_is(references: References, name: str, at: float, unit: str) -> None:
    reference = references(name)
    channel = f"{reference.scene.output}.vx"
    row = row_of(rows_of(reference, changed(commanded(reference), channel, 1.0)), channel)
    assert row.max_at == pytest.approx(at)
    assert row.max_at_unit == unit


def test_a_law_is_followed_in_its_rates(references: References) -> None:
    """All positions right, and the velocities of 10 ms later."""
    reference = references("turning_law")
    position, time = SAMPLING.commanded(reference.scene), SAMPLING.times(reference.scene)
    late = Motion({**reference.at(passing(reference.scene, position, time + 0.01)).samples, "time": time})
    table = rows_of(reference, late)
    errors = {group: worst_of(rows).max for group, rows in by_group(table).items()}
    assert errors["position"] <= 1e-14
    assert errors["velocity"] > 1e-2
    assert errors["acceleration"] > 1e-2


def test_a_rest_of_the_drive_is_no_toggle(references: References) -> None:
    reference = references("swinging_law")
    sampling = Sampling(720)
    motion = commanded(reference, sampling)
    speed = np.hypot(motion["E.vx"], motion["E.vy"])
    turning_back = motion["crank_angle"].argmax()
    toggle = compare(reference, sampling, motion).toggle
    assert speed[turning_back] < 0.02 * speed.max()
    assert not toggle[turning_back]
    assert toggle.any(), "the ram has a dead point of its own"


def test_what_only_the_analytic_core_says_is_not_compared(references: References) -> None:
    reference = references("driven_toggle")
    motion = commanded(reference)
    assert {named(channel).name for channel in motion.samples} >= {"transmission", "to_lock"}
    table = rows_of(reference, motion)
    assert {row.channel for row in table} == set(reference.scene.channels.names()) - {"time"}


def test_a_drive_that_strayed_is_inconsistent(references: References, plug: Plug) -> None:
    reference = references("driven_toggle")
    plug(changed(commanded(reference), "drive.displacement", 10.0))
    measured = measure(reference, "stub", SAMPLING)
    assert measured.run.status is Status.inconsistent
    assert "crosshead deviates from the commanded position by" in measured.run.reason
    assert not measured.errors


@pytest.mark.parametrize("late", [1e-6, -1e-6])
def test_samples_at_other_instants_are_noticed(references: References, plug: Plug, late: float) -> None:
    reference = references("turning_law")
    plug(changed(commanded(reference), "time", late))
    outcome = measure(reference, "stub", SAMPLING).run
    assert outcome.status is Status.inconsistent
    assert "instants" in outcome.reason


# --- the switches of a press force ------------------------------------------------------------------------------------

LOWER_DEAD_POINT = 36  # the row, where the crank starts at the upper one


@pytest.fixture(scope="module")
def pressing() -> Reference:
    """Return a press with a sample exactly where its force ends."""
    return establish(scenes.load("crank_press", {"drive.start": 90}))


def press_force(reference: Reference) -> PressForce:
    (load,) = reference.scene.loads
    assert isinstance(load, PressForce)
    return load


def standing(reference: Reference, row: int, *, acting: bool) -> Motion:
    """Return the motion with the press force acting, or not, at one row, and as it should be elsewhere."""
    plain, load = commanded(reference), press_force(reference)
    loads = (Force(load.body, load.at, load.force),) if acting else ()
    there = commanded(of_scene(reference, replace(reference.scene, loads=loads)))
    return Motion(
        {c: np.where(np.arange(len(plain[c])) == row, there[c], plain[c]) for c in reference.scene.channels.names()}
    )


def worst(reference: Reference, motion: Motion) -> tuple[float, float]:
    """Return the largest error, and the largest violation of Newton, Euler and power."""
    errors = [*error_table("x", compare(reference, SAMPLING, motion), replace(reference, floor=Floor({}, "")))]
    return worst_of(errors).max, max(c.worst for c in checks(reference.mechanics, motion, reference.travel))


@sampled(1)
@pytest.mark.parametrize("acting", [True, False])
def test_on_a_switch_either_side_is_right(pressing: Reference, acting: bool) -> None:
    assert max(worst(pressing, standing(pressing, LOWER_DEAD_POINT, acting=acting))) <= 1e-12


def test_a_load_on_the_wrong_side_of_its_switch_is_found(pressing: Reference) -> None:
    """One sample before the dead point it must act, one after it must not."""
    assert min(worst(pressing, standing(pressing, LOWER_DEAD_POINT - 1, acting=False))) > 0.1
    assert min(worst(pressing, standing(pressing, LOWER_DEAD_POINT + 1, acting=True))) > 0.1


def test_on_a_switch_all_forces_are_on_the_same_side(pressing: Reference) -> None:
    on, off = (standing(pressing, LOWER_DEAD_POINT, acting=acting) for acting in (True, False))
    mixed = Motion({**on.samples, "A.fy": off["A.fy"]})
    assert min(worst(pressing, mixed)) > 0.1


def test_a_lagging_drive_does_not_decide_the_side(pressing: Reference) -> None:
    """The engine's crank is before the dead point by more than any hair, and its load is already off."""
    scene = pressing.scene
    lag = SAMPLING.commanded(scene) - 5e-3
    without = of_scene(pressing, replace(scene, loads=()))
    on, off = (r.at(passing(scene, lag, SAMPLING.times(scene))) for r in (pressing, without))
    there = np.arange(SAMPLING.count) == LOWER_DEAD_POINT
    motion = Motion({c: np.where(there, off[c], on[c]) for c in scene.channels.names()})
    assert max(compare(pressing, SAMPLING, motion).actual[c].max() for c in ("A.fy", "B.fy")) <= 1e-12


@sampled(1)
@pytest.mark.parametrize("acting", [True, False])
def test_the_floor_is_certified_across_a_switch(
    pressing: Reference, monkeypatch: pytest.MonkeyPatch, acting: bool
) -> None:
    oracle = Run("multiprecision", None, Status.ok, motion=standing(pressing, LOWER_DEAD_POINT, acting=acting))
    monkeypatch.setattr("compare.engines.runner.HERE.run", lambda engine, *_: replace(oracle, engine=engine))
    floor = establish(pressing.scene).floor
    assert max(floor.by_channel.values()) <= 1e-12
    assert floor.doubt == ""


def test_the_stroke_ends_between_samples(pressing: Reference) -> None:
    scene, load = pressing.scene, press_force(pressing)

    def turned(first: float, by: float) -> MotionVectors:
        way = np.linspace(0, by, 73)
        return MotionVectors(scene, pressing.at(passing(scene, scene.drive.law.start + first + way, way / (2 * np.pi))))

    whole, half = turned(0.3, 2 * np.pi), turned(0.0, 3.0)
    assert whole.stroke_end(load) == pytest.approx(-1.48, abs=1e-9)  # the quintic's h^6/46080 of the sixth derivative
    assert half.stroke_end(load) == half.displacement(scene.bodies[load.body])[0][-1]


def test_a_creeping_press_is_no_switch(pressing: Reference) -> None:
    """At a ten-thousandth of the peak speed, but well before the end, the force must act."""
    samples = dict.fromkeys(("time", "B.x", "B.vx", "B.ax", "B.ay"), np.zeros(3))
    samples |= {"B.y": np.array([-1.3, -1.478, -1.4799999]), "B.vy": np.array([-1.0, -1e-4, -1e-4])}
    (may,) = MotionVectors(pressing.scene, Motion(samples)).acts([-1.48])
    assert may.all(axis=0).tolist() == [False, True, False]
    assert may.any(axis=0).tolist() == [False, True, True]


def test_a_reference_solves_nothing_twice(reference: Reference) -> None:
    """Its copy begins anew: what a family keeps of its members holds no motion twice."""
    solved: list[Inputs] = []

    def solve(inputs: Inputs) -> Motion:
        solved.append(inputs)
        return reference.at(inputs)

    at, position = Remembering(solve), np.linspace(0, 1, 5)
    there = passing(reference.scene, position, position)
    first = at(there)
    assert at(passing(reference.scene, position.copy(), position.copy())) is first
    assert at(passing(reference.scene, position, position + 1e-9)) is not first
    assert at(Inputs(there.time, [there.derivatives[0], np.array([0.5]), np.zeros(1)])) is not first
    assert len(solved) == 3
    copy(at)(there)
    assert len(solved) == 4

"""pymunk's settings: orders of convergence, masses, and what a new user meets."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, TypeAlias

import numpy as np
import pytest

import scenes
from scenes import Failure, Sampling, Scene, Settings, Status
from scenes.scene import GROUND
from sim_models.pymunk import engine as pymunk_model
from sim_models.pymunk import space as pymunk_space
from sim_models.pymunk.constraints import LinkageConstraints
from sim_models.pymunk.engine import ABLATIONS, DEFAULT, EXACT, FAST, LONG_WORK_PRECISION, WORK_PRECISION
from sim_models.pymunk.masses import assur_groups, ballasted_masses, fictitious_masses, own_masses
from sim_models.pymunk.settings import AnySettings, PymunkSettings, TextbookSettings
from sim_models.pymunk.start import start
from sim_models.pymunk.sweeps import contraction
from tests import scene_files
from tests.agreement import errors, worst
from tests.comparisons import sampled

from .runs import Array, reference, solve

SAMPLING = Sampling(72)
Make: TypeAlias = Callable[[int], PymunkSettings]


@cache
def shipped(name: str) -> tuple[Scene, dict[str, Array]]:
    """A scene and what it really does at 72 samples."""
    scene = scenes.load(name)
    return scene, reference(scene, SAMPLING)


def error(name: str, settings: Settings) -> dict[str, float]:
    """The largest error by kind of channel."""
    scene, expected = shipped(name)
    assert isinstance(settings, PymunkSettings | TextbookSettings)
    return worst(errors(solve(scene, settings, SAMPLING), expected))


def orders(name: str, make: Make, steps: Sequence[int]) -> dict[str, float]:
    """The slope of log error over log steps, by kind of channel."""
    runs = [error(name, make(n)) for n in steps]
    return {k: -float(np.polyfit(np.log(steps), np.log([run[k] for run in runs]), 1)[0]) for k in runs[0]}


FORCES = ("x", "vx", "fx", "torque")
ALL = (*FORCES, "ax")
PRESSES, PRESS_AND_RETURN = ("toggle_press", "crank_press"), ("toggle_press", "quick_return")
# By family: settings but for the steps, sweeps in two scenes, steps, kinds of channels, the order, and how near to it.
ORDERS: dict[str, tuple[dict[str, Any], dict[str, int], tuple[int, ...], tuple[str, ...], int, float]] = {
    # From 144 steps on, or the term in dt^3 shows; up to 576, where the sweeps leave a thousandth of the error of the
    # step. 300 sweeps do for the toggle press; the quick return, whose ram stands still for long, needs twice as many.
    # Measured: 1.99 to 2.03, and with half a correction 1.96 to 2.05.
    "full correction": ({}, {"toggle_press": 300, "quick_return": 600}, (144, 288, 576), ALL, 2, 0.05),
    "half": ({"correction": 0.5}, {"toggle_press": 300, "quick_return": 600}, (144, 288, 576), FORCES, 2, 0.1),
    # By default a step corrects 6.3 dt of an error, so the error is in proportion to dt / 6.3, if that is a small part:
    # 8 % at 720 steps a second. Fewer sweeps do, since the impulses hardly change in a step. Measured: 1.00 to 1.03.
    "default": ({"correction": None}, {"toggle_press": 100, "quick_return": 300}, (720, 1440), ALL, 1, 0.1),
    # Two levels take the term in dt^2 away and leave that in dt^3. Measured from 72 to 288 steps: 3.00 to 3.10. With
    # fictitious masses, which leave the same errors of the step at a tenth of the cost.
    "two levels": ({"levels": 2}, dict.fromkeys(PRESS_AND_RETURN, 80), (72, 144, 288), ALL, 3, 0.15),
    # Three levels leave that in dt^4. From 144 steps on, or the next terms show, which in the accelerations they do
    # longer (4.45), and so in the reactions that follow from these (4.19); up to 288, or 1152 in the finest level,
    # where rounding, amplified by dt^-2, starts to show in the toggle press. Measured: 4.00 to 4.07.
    "three levels": ({"levels": 3}, dict.fromkeys(PRESSES, 80), (144, 288), ("x", "vx", "torque"), 4, 0.15),
    # Four levels leave that in dt^5, of which rounding lets only the positions be seen: 4.93 and 5.01.
    "four levels": ({"levels": 4}, dict.fromkeys(PRESSES, 80), (72, 144), ("x",), 5, 0.15),
}


@sampled(3)
@pytest.mark.parametrize(("family", "name"), [(family, name) for family in ORDERS for name in ORDERS[family][1]])
def test_order(family: str, name: str) -> None:
    options, sweeps, steps, kinds, order, near = ORDERS[family]
    options = {"levels": 1, "iterations": sweeps[name], "fictitious": "levels" in options} | options
    found = orders(name, lambda n: PymunkSettings("", n, **options), steps)
    for k in kinds:
        assert found[k] == pytest.approx(order, abs=near), k
    if family == "three levels":
        assert min(found["ax"], found["fx"]) >= order - near


@pytest.mark.parametrize(("name", "sweeps"), [("toggle_press", 300), ("quick_return", 600)])
def test_a_joint_lags_by_what_a_step_moves_it_off_over_what_a_step_corrects(name: str, sweeps: int) -> None:
    full, half = (error(name, PymunkSettings("", 288, 1, sweeps, correction)) for correction in (1.0, 0.5))
    assert half["x"] == pytest.approx(2 * full["x"], rel=0.05)


# Masses cannot part what geometry joins: three bars on one plate, and a rod that stands oblique to its slider's guide.
JOINED = {"class_iii", "double_toggle_clamp", "double_toggle_clamp_scheme4", "servo_press", "excavator_bucket"}
CLOSED = {"dump_truck", "scissor_lift"}  # by their cylinder all at once: the sweeps take hundreds of times as long


@sampled(6)
@pytest.mark.parametrize("name", scenes.shipped())
def test_masses_are_chosen_for_few_sweeps(name: str) -> None:
    scene = scenes.load(name)
    prescribed = scene.has_masses and scene.drive.on == GROUND  # a body that ballast can hang on
    masses = (fictitious_masses, ballasted_masses) if prescribed else (fictitious_masses,)
    linkages = [LinkageConstraints(scene, chosen) for chosen in masses]
    fictitious, *ballasted = (contraction(linkage, start(linkage)) for linkage in linkages)
    assert all(fictitious < other < 1 for other in ballasted)
    # Measured, at the start: 0.003 to 0.022, and 0.69 in the servo press, the sine squared of its rod's 56 degrees.
    assert fictitious <= (0.7 if name.removesuffix("_friction") in JOINED else 0.997 if name in CLOSED else 0.05)


def test_groups_follow_from_each_other() -> None:
    assert [*assur_groups(scenes.load("toggle_press"))] == [["rocker", "toggle"], ["rod", "slider"]]
    assert [*assur_groups(scenes.load("class_iii"))] == [["coupler", "plate", "upper", "lower"]]


def test_ballast_keeps_the_first_and_second_moments() -> None:
    """About the pin on the ground or the crank, mass times arm and inertia are a body's own."""
    scene = scenes.load("toggle_press")
    own, ballasted = (LinkageConstraints(scene, masses) for masses in (own_masses, ballasted_masses))
    for name, pin in (("rocker", "O"), ("toggle", "P2")):
        (a, arm_a), (b, arm_b) = ((each.moved[name], each.arm(name, pin)) for each in (own, ballasted))
        assert b.mass == pytest.approx(a.mass + 10 * 1170)  # ten times the mass of all bodies
        assert b.mass * arm_b == pytest.approx(a.mass * arm_a)
        of_own, of_ballasted = (m.moment + m.mass * abs(arm) ** 2 for m, arm in ((a, arm_a), (b, arm_b)))
        assert of_ballasted == pytest.approx(of_own)
    assert ballasted.moved["rod"].mass == 60


@pytest.mark.parametrize("name", ["toggle_press", "quick_return"])
def test_engine_confirms_its_forces_with_true_masses_only(name: str) -> None:
    scene, _ = shipped(name)
    for settings, confirmed in ((FAST, False), (replace(FAST, fictitious=False, iterations=500), True)):
        simulation = pymunk_model.build(scene, settings, SAMPLING)
        simulation.solve()
        simulation.read()
        assert ("impulses" in simulation.residuals) is confirmed
        assert ("no check" in settings.note) or confirmed
        if confirmed:
            assert simulation.residuals["impulses"] <= 1e-9  # rounding, 2e-13 measured, of sums of ballast


def test_reactions_that_are_not_the_impulses_do_not_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, _ = shipped("toggle_press")
    wrong = replace(scene, loads=())
    simulation: Any = pymunk_model.build(scene, DEFAULT, SAMPLING)
    simulation.solve()
    monkeypatch.setattr(simulation._linkage, "scene", wrong)
    with pytest.raises(Failure, match="the reactions are not the engine's impulses"):
        simulation.read()


def test_settings_reach_what_they_are_for() -> None:
    # Measured: 8e-6, 5e-7 and 5e-11 of the reactions.
    for settings, reaction in ((FAST, 1e-2), (DEFAULT, 1e-5), (EXACT, 1e-9)):
        assert error("toggle_press", settings)["fx"] <= reaction, settings
    assert error("toggle_press", DEFAULT)["x"] <= 2e-6  # measured 4e-7; with one level it is 2e-4


def test_settings_have_labels_of_their_own() -> None:
    points = {*WORK_PRECISION, *LONG_WORK_PRECISION, *ABLATIONS, FAST, DEFAULT, EXACT}
    assert len({settings.label for settings in points}) == len(points)
    # what a new user meets is told apart, but no theory expects an order of it
    assert all(settings.family and (settings.order or settings.family == "textbook") for settings in points)
    steps = [s.steps for s in (*WORK_PRECISION, *LONG_WORK_PRECISION) if s.family == "one level, 100 sweeps"]
    assert max(steps) >= 100 * min(steps)


@sampled(2)
@pytest.mark.parametrize("settings", ABLATIONS, ids=lambda settings: settings.extra)
def test_ablations_cost_more_and_change_nothing(settings: PymunkSettings) -> None:
    scene, _ = shipped("toggle_press")
    few = settings if settings.extra == "motor" else replace(settings, steps=72, iterations=200)
    counters = pymunk_model.build(scene, few, SAMPLING).counters
    plain = pymunk_model.build(scene, replace(few, extra=""), SAMPLING).counters
    changed = {name for name in ("bodies", "constraints", "shapes", "callbacks") if counters[name] != plain[name]}
    assert changed == {"shapes": {"shapes"}, "callback": {"callbacks"}, "motor": {"constraints"}}.get(
        settings.extra, set()
    )
    found, usual = error("toggle_press", few), error("toggle_press", replace(few, extra=""))
    # Measured: 8e-6 with a motor, whose sweeps converge badly; the others are bit for bit what they were.
    assert found["fx"] <= 1e-4 if settings.extra == "motor" else found == usual


def test_callback_is_called_in_every_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """The engine knows its own functions and calls them in C instead."""
    calls, update = [], pymunk_space._update_velocity

    def count(*arguments: Any) -> None:
        calls.append(arguments)
        update(*arguments)

    monkeypatch.setattr(pymunk_space, "_update_velocity", count)
    simulation = pymunk_model.build(shipped("toggle_press")[0], replace(FAST, extra="callback"), SAMPLING)
    simulation.solve()
    assert len(calls) == simulation.counters["steps"]


TEXTBOOK = TextbookSettings("", 60)
MOTORS, LOADS = "pymunk has motors for cranks at a constant speed only", "the textbook set-up has constant loads only"
REFUSED: tuple[tuple[str, AnySettings, str], ...] = (
    ("driven_toggle", ABLATIONS[-1], MOTORS),
    ("swinging_law", ABLATIONS[-1], MOTORS),
    # What is left after a second, 0.5**1440, is no number; pymunk would correct everything, and nobody would know.
    ("toggle_press", PymunkSettings("", 1440, 1, 100, 0.5), "pymunk cannot leave 0.5 of an error"),
    # What the manual does not show: a press force, springs, a guide that turns.
    ("crank_press", TEXTBOOK, LOADS),
    ("servo_press", TEXTBOOK, LOADS),
    ("oldham", TEXTBOOK, "the textbook set-up has guides on the ground only"),
)


@pytest.mark.parametrize(("name", "settings", "reason"), REFUSED)
def test_refused(name: str, settings: AnySettings, reason: str) -> None:
    scene = scene_files.load(name)
    with pytest.raises(Failure) as caught:
        pymunk_model.build(scene, settings, Sampling(24))
    assert caught.value.status is Status.unsupported
    assert reason in caught.value.reason


def test_textbook_gets_there_by_small_steps() -> None:
    coarse, fine = (error("stephenson_six_bar", TextbookSettings("", steps)) for steps in (1152, 2304))
    # Measured: 1.4e-2 and 7e-3 of the reactions, half with half the step, as its correction of joints is.
    assert 1e-3 <= fine["fx"] <= 2e-2
    assert np.log2(coarse["fx"] / fine["fx"]) == pytest.approx(1, abs=0.15)

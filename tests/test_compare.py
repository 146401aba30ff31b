"""The comparison itself: every check, error figure, gate and verdict must go red on a result that deserves it."""

from collections.abc import Callable, Hashable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
import pytest

import analytic
import scenes
from compare import registry
from compare.checks import checks
from compare.errors import compare, error_table
from compare.gates import gates
from compare.measure import Measurement, measure
from compare.press import acts, stroke_end
from compare.reference import Floor, Reference, establish
from compare.runner import Run, run
from compare.state import State
from compare.study import study
from compare.timing import Budget
from scenes import Failure, Motion, Sampling, Scene, Settings, Status
from scenes.motion import channels, quantity
from scenes.scene import Force, ForceTable, PressForce

from .mechanisms import MECHANISMS

SAMPLING = Sampling(72)
Outcome = Motion | Exception
References = Callable[[str], Reference]


@pytest.fixture(scope="module")
def reference() -> Reference:
    return establish(scenes.load("toggle_press"))


@pytest.fixture
def motion(reference: Reference) -> Motion:
    return commanded(reference)


def commanded(reference: Reference, sampling: Sampling = SAMPLING) -> Motion:
    """Return what the reference says an engine should."""
    return reference.at(sampling.commanded(reference.scene), sampling.times(reference.scene))


def of_scene(reference: Reference, scene: Scene) -> Reference:
    """Return the reference of a scene that differs in its loads, with the same scales."""
    return replace(reference, scene=scene, at=registry.reference(scene))


@pytest.fixture(scope="module")
def references(tmp_path_factory: pytest.TempPathFactory) -> References:
    """Return a function that establishes the reference of a mechanism, without its floor, and only once."""
    folder = tmp_path_factory.mktemp("mechanisms")

    @cache
    def of(name: str) -> Reference:
        file = folder / f"{name}.toml"
        file.write_text(MECHANISMS[name], encoding="utf-8")
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("compare.reference._certify", lambda _: Floor({}, "not certified here"))
            return establish(scenes.load(file))

    return of


class Stub:
    """An engine, and its simulation, with a given outcome."""

    DEFAULT = Settings("stub")
    LADDER = (DEFAULT,)
    LONG_LADDER: tuple[Settings, ...] = ()
    FAST = EXACT = DEFAULT
    ABLATIONS: tuple[Settings, ...] = ()
    counters: Mapping[str, int] = {}
    residuals: Mapping[str, float] = {}

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome

    def version(self) -> str:
        return "stub"

    def build(self, scene: Scene, settings: Settings, sampling: Sampling) -> "Stub":  # noqa: ARG002
        return self

    def solve(self) -> None:
        if isinstance(self.outcome, Exception):
            raise self.outcome

    def read(self) -> Motion:
        assert isinstance(self.outcome, Motion)
        return self.outcome


Plug = Callable[[Outcome], None]


@pytest.fixture
def plug(monkeypatch: pytest.MonkeyPatch) -> Plug:
    """Return a function that makes the engine named `stub` end as told."""
    real = registry.engine
    entry = registry.Entry("a stub", "", "numpy", "numpy", "")
    monkeypatch.setitem(registry.ENTRIES, "stub", entry)

    def plug(outcome: Outcome) -> None:
        monkeypatch.setattr(registry, "engine", lambda name: Stub(outcome) if name == "stub" else real(name))

    return plug


def changed(motion: Motion, channel: str, by: float, row: int = 40) -> Motion:
    """Return the motion with one sample of one channel moved."""
    samples = motion[channel].copy()
    samples[row] += by
    return Motion({**motion.samples, channel: samples})


def row_of(table: pd.DataFrame, channel: str) -> dict[Hashable, Any]:
    return next(row for row in table.to_dict("records") if row["channel"] == channel)


# --- errors -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "channel", [c for c in channels(scenes.load("toggle_press")) if c not in ("time", "crank_angle")]
)
def test_an_error_in_any_channel_is_found(reference: Reference, motion: Motion, channel: str) -> None:
    scale = reference.scale[channel]
    table = error_table("x", compare(reference, SAMPLING, changed(motion, channel, -1e-3 * scale)), reference)
    row = row_of(table, channel)
    assert row["max"] == pytest.approx(1e-3, rel=1e-9)
    assert row["max_at"] == pytest.approx(200.0)
    assert row["max_at_unit"] == "deg"
    assert row["rms"] == pytest.approx(1e-3 / np.sqrt(SAMPLING.count), rel=1e-9)
    others = table[table["channel"] != channel]
    assert (others["max"] <= 1e-14).all()


def test_scales(reference: Reference) -> None:
    S, w = 0.1836316, 2 * np.pi
    assert reference.stroke == pytest.approx(S, abs=5e-8)
    assert reference.scale["P4.vx"] == pytest.approx(S * w, rel=1e-6)
    assert reference.scale["P5.ay"] == pytest.approx(S * w**2, rel=1e-6)
    assert reference.scale["drive.torque"] == pytest.approx(13888, abs=0.5)
    assert reference.scale["slider.guide_moment"] == pytest.approx(S * reference.scale["slider.guide_force"], rel=1e-6)
    assert reference.scale["P3.fx"] == reference.scale["P3.fy"]


def test_angles_count_modulo_a_turn(reference: Reference, motion: Motion) -> None:
    turned = Motion({**motion.samples, "rod.angle": motion["rod.angle"] + 2 * np.pi})
    table = error_table("x", compare(reference, SAMPLING, turned), reference)
    assert row_of(table, "rod.angle")["max"] <= 1e-14


def test_the_drives_error_is_told_apart(reference: Reference) -> None:
    """A crank that lags by 1e-4 rad, everything else right for where it is."""
    lagging = reference.at(SAMPLING.commanded(reference.scene) - 1e-4, SAMPLING.times(reference.scene))
    table = error_table("x", compare(reference, SAMPLING, lagging), reference)
    assert row_of(table, "P5.y")["max"] <= 1e-14
    assert row_of(table, "P5.y")["commanded_max"] == pytest.approx(1e-4 * 0.865 / (2 * np.pi) / 0.18363, rel=1e-2)
    assert row_of(table, "crank_angle")["commanded_max"] == pytest.approx(1e-4, rel=1e-9)


def test_toggle_windows_and_last_turn(reference: Reference) -> None:
    sampling = Sampling(360, turns=2)
    plain = commanded(reference, sampling)
    first_turn = changed(plain, "P5.y", 1e-3, row=100)  # at 100 degrees the slider moves
    row = row_of(error_table("x", compare(reference, sampling, first_turn), reference), "P5.y")
    assert row["max"] > 1e-3
    assert row["last_turn_max"] <= 1e-14
    assert row["toggle_max"] <= 1e-14
    at_bottom = changed(plain, "P5.y", 1e-3, row=373)
    row = row_of(error_table("x", compare(reference, sampling, at_bottom), reference), "P5.y")
    assert row["last_turn_max"] == row["toggle_max"] == row["max"]


def test_no_error_is_shown_below_the_floor(reference: Reference, motion: Motion) -> None:
    assert reference.floor.by_channel, "the certify extra is part of the test extra"
    high = replace(reference, floor=replace(reference.floor, by_channel=dict.fromkeys(motion.samples, 1e-9)))
    table = error_table("x", compare(high, SAMPLING, motion), high)
    assert (table["max"] == 1e-9).all()


def test_an_uncertified_reference_has_no_error_to_show(reference: Reference, motion: Motion) -> None:
    uncertified = replace(reference, floor=Floor({}, "not certified"))
    comparison = compare(uncertified, SAMPLING, motion)
    assert error_table("analytic", comparison, uncertified)["max"].isna().all()
    assert (error_table("stub", comparison, uncertified)["max"] == 0).all()


# --- other drives -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["quick_return", "driven_toggle", "swinging_law"])
def test_an_error_in_any_channel_of_any_drive_is_found(references: References, name: str) -> None:
    reference = references(name)
    plain = commanded(reference)
    for channel in channels(reference.scene):
        if channel not in ("time", reference.scene.drive_channel):
            disturbed = changed(plain, channel, -1e-3 * reference.scale[channel])
            table = error_table("x", compare(reference, SAMPLING, disturbed), reference)
            assert row_of(table, channel)["max"] == pytest.approx(1e-3, rel=1e-9), channel
            assert (table[table["channel"] != channel]["max"] <= 1e-14).all(), channel


def test_scales_of_a_driven_slider(references: References) -> None:
    """The crosshead goes 250 mm at 150 mm/s; the platen goes S meanwhile."""
    reference = references("driven_toggle")
    S, w, force = reference.stroke, 0.150 / 0.250, commanded(reference, Sampling(3600))["drive.force"]
    assert reference.scale["C.x"] == S
    assert reference.scale["C.vx"] == pytest.approx(S * w, rel=1e-12)
    assert reference.scale["C.ax"] == pytest.approx(S * w**2, rel=1e-12)
    assert reference.scale["plate.omega"] == pytest.approx(w, rel=1e-12)
    assert reference.scale["plate.alpha"] == pytest.approx(w**2, rel=1e-12)
    assert reference.scale["drive.displacement"] == pytest.approx(0.250, rel=1e-12)
    assert reference.scale["drive.force"] == pytest.approx(np.abs(force).max(), rel=1e-12)


@pytest.mark.parametrize(
    ("name", "at", "unit"), [("driven_toggle", -38.888889, "mm"), ("swinging_law", 0.66666667, "s")]
)
def test_where_the_largest_error_is(references: References, name: str, at: float, unit: str) -> None:
    reference = references(name)
    point = reference.scene.output
    row = row_of(
        error_table("x", compare(reference, SAMPLING, changed(commanded(reference), f"{point}.vx", 1.0)), reference),
        f"{point}.vx",
    )
    assert row["max_at"] == pytest.approx(at)
    assert row["max_at_unit"] == unit


def test_a_law_is_followed_in_its_rates(references: References) -> None:
    """All positions right, and the velocities of 10 ms later."""
    reference = references("turning_law")
    position, time = SAMPLING.commanded(reference.scene), SAMPLING.times(reference.scene)
    late = Motion({**reference.at(position, time + 0.01).samples, "time": time})
    errors = error_table("x", compare(reference, SAMPLING, late), reference).groupby("group")["max"].max()
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
    assert {quantity(channel) for channel in motion.samples} >= {"transmission", "to_lock"}
    table = error_table("x", compare(reference, SAMPLING, motion), reference)
    assert set(table["channel"]) == set(channels(reference.scene)) - {"time"}


def test_a_drive_that_strayed_is_diverged(references: References, plug: Plug) -> None:
    reference = references("driven_toggle")
    plug(changed(commanded(reference), "drive.displacement", 10.0))
    measured = measure(reference, "stub", SAMPLING)
    assert measured.run.status is Status.diverged
    assert "crosshead at 9.9" in measured.run.reason
    assert measured.errors.empty


def test_samples_at_other_instants_are_noticed(references: References, plug: Plug) -> None:
    reference = references("turning_law")
    plug(changed(commanded(reference), "time", 1e-6))
    outcome = run("stub", reference.scene, SAMPLING)
    assert outcome.status is Status.crashed
    assert "instants" in outcome.reason


# --- the switches of a press force ------------------------------------------------------------------------------------

CRANK_PRESS = (scenes.LIBRARY / "crank_press.toml").read_text(encoding="utf-8")
LOWER_DEAD_POINT = 36  # the row, where the crank starts at the upper one


@pytest.fixture(scope="module")
def pressing(tmp_path_factory: pytest.TempPathFactory) -> Reference:
    """Return a press with a sample exactly where its force ends."""
    head, _, tail = CRANK_PRESS.partition("start = 90.37")
    file = tmp_path_factory.mktemp("press") / "press.toml"
    file.write_text(f"{head}start = 90{tail}", encoding="utf-8")
    return establish(scenes.load(file))


def standing(reference: Reference, row: int, *, acting: bool) -> Motion:
    """Return the motion with the press force acting, or not, at one row, and as it should be elsewhere."""
    plain, load = commanded(reference), reference.scene.loads[0]
    assert isinstance(load, PressForce)
    loads = (Force(load.body, load.at, load.force),) if acting else ()
    there = commanded(of_scene(reference, replace(reference.scene, loads=loads)))
    return Motion({c: np.where(np.arange(len(plain[c])) == row, there[c], plain[c]) for c in channels(reference.scene)})


def worst(reference: Reference, motion: Motion) -> tuple[float, float]:
    """Return the largest error, and the largest violation of Newton, Euler and power."""
    errors = error_table("x", compare(reference, SAMPLING, motion), replace(reference, floor=Floor({}, "")))
    return errors["max"].max(), max(c.worst for c in checks(reference.scene, motion, reference.stroke))


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
    on, off = (r.at(lag, SAMPLING.times(scene)) for r in (pressing, without))
    motion = Motion(
        {c: np.where(np.arange(SAMPLING.count) == LOWER_DEAD_POINT, off[c], on[c]) for c in channels(scene)}
    )
    assert max(compare(pressing, SAMPLING, motion).actual[c].max() for c in ("A.fy", "B.fy")) <= 1e-12


@pytest.mark.parametrize("acting", [True, False])
def test_the_floor_is_certified_across_a_switch(
    pressing: Reference, monkeypatch: pytest.MonkeyPatch, acting: bool
) -> None:
    oracle = Run("multiprecision", None, Status.ok, motion=standing(pressing, LOWER_DEAD_POINT, acting=acting))
    monkeypatch.setattr("compare.reference.run", lambda *_: oracle)
    assert max(establish(pressing.scene).floor.by_channel.values()) <= 1e-12


def test_the_stroke_ends_between_samples(pressing: Reference) -> None:
    scene = pressing.scene
    (load,) = scene.loads
    assert isinstance(load, PressForce)
    state = State(scene, pressing.at(scene.drive.start + 0.3 + np.linspace(0, 2 * np.pi, 73), np.linspace(0, 1, 73)))
    assert stroke_end(state, load) == pytest.approx(-1.48, abs=1e-9)  # the quintic's h^6/46080 of the sixth derivative
    half = State(scene, pressing.at(scene.drive.start + np.linspace(0, 3, 73), np.linspace(0, 3 / (2 * np.pi), 73)))
    assert stroke_end(half, load) == half.displacement(scene.bodies[load.body])[0][-1]


def test_a_creeping_press_is_no_switch(pressing: Reference) -> None:
    """At a ten-thousandth of the peak speed, but well before the end, the force must act."""
    scene = pressing.scene
    (load,) = scene.loads
    assert isinstance(load, PressForce)
    still = np.zeros(3)
    moving = {
        "B.x": still,
        "B.y": np.array([-1.3, -1.478, -1.4799999]),
        "B.vx": still,
        "B.vy": np.array([-1.0, -1e-4, -1e-4]),
    }
    state = State(scene, Motion({"time": still, **moving, "B.ax": still, "B.ay": still}))
    may = acts(state, load, -1.48)
    assert may.all(axis=0).tolist() == [False, True, False]
    assert may.any(axis=0).tolist() == [False, True, True]


# --- checks without a reference ---------------------------------------------------------------------------------------

WHAT_NOTICES = {  # a channel, by how much it is moved, the check and body that must notice
    "P2.x": (1e-6, "closure", "crank"),
    "P3.y": (1e-6, "closure", "rocker"),
    "P4.x": (1e-6, "closure", "toggle"),
    "P5.x": (1e-6, "closure", "slider"),
    "P5.y": (1e-6, "closure", "rod"),
    "P3.fx": (1.0, "Newton", "rocker"),
    "P4.fy": (1.0, "Newton", "rod"),
    "P5.ay": (1e-3, "Newton", "slider"),
    "slider.guide_force": (1.0, "Newton", "slider"),
    "slider.guide_moment": (1.0, "Euler", "slider"),
    "drive.torque": (1.0, "Euler", "crank"),
    "toggle.alpha": (1e-1, "Euler", "toggle"),
    "rod.alpha": (1e-1, "Euler", "rod"),
    "P5.vy": (1e-3, "power", "mechanism"),
    "rocker.omega": (1e-1, "power", "mechanism"),
}


@pytest.mark.parametrize("channel", WHAT_NOTICES)
def test_a_check_notices(reference: Reference, motion: Motion, channel: str) -> None:
    by, name, of = WHAT_NOTICES[channel]
    before = {(c.check, c.of): c.worst for c in checks(reference.scene, motion, reference.stroke)}
    found = checks(reference.scene, changed(motion, channel, by), reference.stroke)
    noticed = next(c for c in found if (c.check, c.of) == (name, of))
    assert before[name, of] <= 1e-13
    assert noticed.worst > 1e-9
    assert noticed.max_at == pytest.approx(200.0)
    assert noticed.where == "crank angle 200.0000 deg"


IN_MECHANISMS = [  # a mechanism, a channel, by how much it is moved, the check and body that must notice
    ("quick_return", "rocker.angle", 1e-6, "closure", "block"),  # it carries the slot
    ("quick_return", "block.angle", 1e-6, "closure", "block"),
    ("swinging_block", "A.y", 1e-6, "closure", "rod"),
    ("driven_toggle", "K.x", 1e-6, "closure", "plate"),
    ("quick_return", "block.guide_force", 1.0, "Newton", "block"),
    ("quick_return", "block.guide_force", 1.0, "Newton", "rocker"),
    ("quick_return", "block.guide_force", 1.0, "Euler", "rocker"),
    ("quick_return", "block.guide_moment", 1.0, "Euler", "rocker"),
    ("quick_return", "block.alpha", 1.0, "Euler", "block"),
    ("scotch_yoke", "block.guide_force", 1.0, "Newton", "yoke"),
    ("scotch_yoke", "yoke.guide_moment", 1.0, "Euler", "yoke"),
    ("driven_toggle", "drive.force", 1.0, "Newton", "crosshead"),
    ("driven_toggle", "drive.force", 1.0, "power", "mechanism"),
    ("driven_toggle", "K.vx", 1e-3, "power", "mechanism"),  # where the spring pulls
    ("driven_toggle", "C.x", 1e-6, "Newton", "platen"),  # the table's load
    ("swinging_law", "crank.alpha", 1.0, "power", "mechanism"),
]


@pytest.mark.parametrize(("name", "channel", "by", "check", "of"), IN_MECHANISMS)
def test_a_check_notices_in_a_mechanism(
    references: References, name: str, channel: str, by: float, check: str, of: str
) -> None:
    reference = references(name)
    motion = commanded(reference)
    before = {(c.check, c.of): c.worst for c in checks(reference.scene, motion, reference.stroke)}
    found = checks(reference.scene, changed(motion, channel, by), reference.stroke)
    noticed = next(c for c in found if (c.check, c.of) == (check, of))
    assert max(before.values()) <= 1e-13
    assert noticed.worst > 1e-9
    assert noticed.where == reference.scene.where(float(motion[reference.scene.drive_channel][40]))


def test_a_guide_presses_its_slider_and_its_carrier_opposite_ways(references: References) -> None:
    """With the force the other way round neither balances, and both by twice the force."""
    reference = references("quick_return")
    motion = commanded(reference)
    turned = Motion({**motion.samples, "block.guide_force": -motion["block.guide_force"]})
    found = {(c.check, c.of): c for c in checks(reference.scene, turned, reference.stroke)}
    assert min(found["Newton", body].worst for body in ("block", "rocker")) > 0.5
    assert found["Newton", "ram"].worst <= 1e-13


@pytest.mark.parametrize("of", ["stiffness", "length", "table", "gravity"])
def test_another_load_than_the_scenes_is_noticed(references: References, of: str) -> None:
    """A motion solved with a load that is a thousandth off: bodies and power out of balance."""
    reference = references("quick_return" if of == "gravity" else "driven_toggle")
    scene = reference.scene
    body = {"stiffness": "plate", "length": "plate", "table": "platen", "gravity": "rocker"}[of]
    if of == "table":
        (table,) = scene.loads
        assert isinstance(table, ForceTable)
        wrong = replace(scene, loads=(replace(table, forces=tuple(1.001 * force for force in table.forces)),))
    elif of == "gravity":
        wrong = replace(scene, gravity=(0.0, -9.82))
    else:
        (spring,) = scene.springs
        wrong = replace(scene, springs=(replace(spring, **{of: 1.001 * getattr(spring, of)}),))
    found = {(c.check, c.of): c.worst for c in checks(scene, commanded(of_scene(reference, wrong)), reference.stroke)}
    assert found["Newton", body] > 1e-6
    assert found["power", "mechanism"] > 1e-6


@pytest.mark.parametrize("name", MECHANISMS)
@pytest.mark.parametrize("engine", ["analytic", "multiprecision"])
def test_two_models_pass_every_check(references: References, name: str, engine: str) -> None:
    """Two models that share nothing balance by the same signs, at 8 samples a cycle too."""
    scene = references(name).scene
    outcome = run(engine, scene, Sampling(8))
    assert outcome.motion is not None, outcome.reason
    for check in checks(scene, outcome.motion, references(name).stroke):
        assert check.worst <= 1e-13, check


def test_checks_with_gravity_and_given_inertia(scene_from: Callable[[str], Scene]) -> None:
    """A spinning crank alone has nothing but its pivot force and its torque; both by hand."""
    from .test_analytic import SLIDER_CRANK

    text = SLIDER_CRANK.replace("mass = 0", "mass = 3\ncom = [0.4, 0.1]\ninertia = 0.2", 1)
    scene = scene_from(text.replace("name =", "gravity = [1, -9.81]\nname ="))
    motion = analytic.solve(scene, np.linspace(0, 6, 100))
    for check in checks(scene, motion, 2.0):
        assert check.worst <= 1e-13, check


# --- verdicts and statuses --------------------------------------------------------------------------------------------


def test_a_mirrored_linkage_is_a_wrong_branch(reference: Reference, plug: Plug) -> None:
    """The rod assembled upwards: every joint is closed, every law holds, and it is the wrong machine."""
    upward = replace(reference.scene.sketch, points={**reference.scene.sketch.points, "P5": (0.0, -0.4)})
    plug(analytic.solve(replace(reference.scene, sketch=upward), SAMPLING.commanded(reference.scene)))
    measured = measure(reference, "stub", SAMPLING)
    assert measured.run.status is Status.wrong_branch
    assert "P5" in measured.run.reason


def test_an_open_joint_is_diverged(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(changed(motion, "P4.x", 0.05))
    measured = measure(reference, "stub", SAMPLING)
    assert measured.run.status is Status.diverged
    assert "at crank angle 200.0000 deg" in measured.run.reason


@pytest.mark.parametrize(
    ("outcome", "status", "reason"),
    [
        (Failure(Status.not_converged, "residual 3e-2"), Status.not_converged, "residual 3e-2"),
        (RuntimeError("first line\nsecond line"), Status.crashed, "RuntimeError: first line"),
        (MemoryError(), Status.crashed, "MemoryError"),
    ],
)
def test_a_failure_is_a_row(reference: Reference, plug: Plug, outcome: Exception, status: Status, reason: str) -> None:
    plug(outcome)
    result = study(reference.scene, ["stub", "analytic"], SAMPLING, Budget(1, 0.0), lambda _: None)
    failed, solved = result.measurements
    assert failed.run.status is status
    assert failed.run.reason.startswith(reason)
    assert solved.run.status is Status.ok
    assert result.speed["status"].tolist()[:2] == [status.name, "ok"]


def test_nan_is_nonfinite(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(changed(motion, "P3.fx", np.nan))
    outcome = run("stub", reference.scene, SAMPLING)
    assert outcome.status is Status.nonfinite
    assert "P3.fx" in outcome.reason
    assert "crank angle 200.0000 deg" in outcome.reason


def test_a_dropped_channel_is_noticed(reference: Reference, motion: Motion, plug: Plug) -> None:
    rest = {channel: values for channel, values in motion.samples.items() if channel != "P3.fx"}
    plug(Motion(rest))
    assert run("stub", reference.scene, SAMPLING).status is Status.crashed
    plug(Motion(rest, {"P3.fx": "this engine has no such sensor"}))
    assert run("stub", reference.scene, SAMPLING).status is Status.ok


def test_a_short_run_is_noticed(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(Motion({channel: values[:-1] for channel, values in motion.samples.items()}))
    assert run("stub", reference.scene, SAMPLING).status is Status.crashed


def test_an_engine_not_installed_is_a_row(reference: Reference, monkeypatch: pytest.MonkeyPatch) -> None:
    missing = replace(registry.ENTRIES["pymunk"], package="no_such_package")
    monkeypatch.setitem(registry.ENTRIES, "pymunk", missing)
    outcome = run("pymunk", reference.scene, SAMPLING)
    assert outcome.status is Status.unsupported
    assert "pip install" in outcome.reason


# --- gates ------------------------------------------------------------------------------------------------------------


def judged(reference: Reference, tolerances: Mapping[str, float], measured: Measurement) -> list[bool]:
    scene = replace(reference.scene, tolerances={"stub": tolerances})
    return [gate.missed for gate in gates(scene, [measured])]


def test_gates(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(changed(motion, "P3.fx", 1e-3 * reference.scale["P3.fx"]))
    measured = measure(reference, "stub", SAMPLING)
    assert judged(reference, {"reaction": 1.1e-3, "position": 1e-12}, measured) == [False, False]
    assert judged(reference, {"reaction": 0.9e-3, "position": 1e-12}, measured) == [True, False]


def test_what_has_no_error_misses_its_gate(reference: Reference, motion: Motion, plug: Plug) -> None:
    plug(Failure(Status.timed_out, "too slow"))
    assert judged(reference, {"position": 1e9}, measure(reference, "stub", SAMPLING)) == [True]
    plug(motion)
    measured = measure(reference, "stub", SAMPLING)
    spoilt = measured.errors.assign(max=measured.errors["max"].where(measured.errors["channel"] != "P4.y"))
    assert judged(reference, {"position": 1e9}, replace(measured, errors=spoilt)) == [True]
    without = replace(measured, errors=measured.errors[measured.errors["group"] != "torque"])
    assert judged(reference, {"torque": 1e9}, without) == [True]

"""The likely cause of a disagreement: of motions and scenes that are wrong on purpose, kind and place are named."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from compare.engines import registry
from compare.engines.registry import tiers
from compare.engines.runner import Run, run
from compare.judge.causes import numbers
from compare.judge.causes.cause import UNKNOWN, Cause, Kind
from compare.judge.causes.evidence import evidence
from compare.judge.causes.words import words
from compare.judge.measure import assess
from compare.judge.triage import cause, likeliest, sentences
from compare.mechanics.reference import Reference
from compare.mechanics.round_off import explain
from scenes import Instants, Motion, Scene, Settings, Status
from scenes.model.motion import Samples, channels, force_channels, quantity
from scenes.scene import Force, PressForce
from tests.comparisons import SAMPLING, References, changed, commanded

Spoil = Callable[[Reference, Motion], dict[str, Samples]]
ROWS = np.arange(SAMPLING.count)
DYING = np.exp(-ROWS / 5) * np.cos(ROWS)
TEN = (ROWS >= 20) & (ROWS < 30)
VELOCITIES = ("vx", "vy", "omega")
GRAVITY, INERTIA = "gravity is {percent}", "{place}'s moment of inertia is {inertia}"
WIDTH = "each uniform bar's moment of inertia is that of one {length} wide"


def spoilt(motion: Motion, samples: dict[str, Samples]) -> Motion:
    return Motion({**motion.samples, **samples})


def late(reference: Reference, by: float) -> Motion:
    instants = SAMPLING.times(reference.scene) - by
    return reference.at(reference.scene.drive.at(instants).position, instants)


def in_frame(motion: Motion, joint: str, body: str) -> dict[str, Samples]:
    force = (motion[f"{joint}.fx"] + 1j * motion[f"{joint}.fy"]) * np.exp(-1j * motion[f"{body}.angle"])
    return {f"{joint}.fx": force.real, f"{joint}.fy": force.imag}


def without_centripetal(motion: Motion) -> dict[str, Samples]:
    arm, w = {axis: motion[f"P4.{axis}"] - motion[f"P2.{axis}"] for axis in "xy"}, motion["toggle.omega"]
    return {f"P4.a{axis}": motion[f"P4.a{axis}"] + w**2 * arm[axis] for axis in "xy"}


def rows(motion: Motion, order: NDArray[np.intp]) -> dict[str, Samples]:
    return {channel: samples[order] for channel, samples in motion.samples.items() if channel != "time"}


def breathing(reference: Reference) -> dict[str, Samples]:
    """Return each row of another length of the rod: 3 mm more and less of 300 over the turn."""
    motion, time = commanded(reference), SAMPLING.times(reference.scene)
    lengths = 0.3 + 0.003 * np.sin(2 * np.pi * ROWS / 72)
    rods = [reference.scene.with_numbers({"bodies.rod.lengths.P4-P5": length}) for length in lengths.tolist()]
    position = motion[reference.scene.drive_channel]
    solved = [registry.reference(rod)(position[k : k + 1], time[k : k + 1]) for k, rod in enumerate(rods)]
    return {c: np.array([row[c][0] for row in solved]) for c in motion.samples if c in solved[0]}


def of_rates(motion: Motion, change: Callable[[str, Samples], Samples], *quantities: str) -> dict[str, Samples]:
    return {c: change(c, own) for c, own in motion.samples.items() if quantity(c) in quantities}


READ_OUT: dict[str, tuple[Spoil, Kind, str]] = {
    "sign": (lambda _, m: {c: -m[c] for c in ("P4.fx", "P4.fy")}, Kind.sign, "P4"),
    "sign of one": (lambda _, m: {"rod.omega": -m["rod.omega"]}, Kind.sign, "rod"),
    "degrees": (lambda _, m: {"rod.angle": np.degrees(m["rod.angle"])}, Kind.unit, "rod"),
    "kN": (lambda r, m: {c: m[c] / 1e3 for c in force_channels(r.scene)}, Kind.unit, "all"),
    "offset": (lambda _, m: {"P4.y": m["P4.y"] + 0.01}, Kind.offset, "P4"),
    "body frame": (lambda _, m: in_frame(m, "P4", "toggle"), Kind.frame, "P4"),
    "components": (lambda _, m: {"P3.fx": m["P3.fy"], "P3.fy": m["P3.fx"]}, Kind.swap, "P3"),
    "centripetal": (lambda _, m: without_centripetal(m), Kind.term, "P4"),
    "other pair": (lambda _, m: {f"C.{q}": m[f"C.{q}"] + m[f"C/rod.{q}"] for q in ("fx", "fy")}, Kind.pair, "C"),
    "constant": (lambda _, m: {"P4.x": 0 * m["P4.x"]}, Kind.constant, "P4"),
    "row held": (lambda _, m: rows(m, np.where(ROWS == 30, 29, ROWS)), Kind.held, "all"),
    "rows swapped": (lambda _, m: rows(m, np.where(ROWS // 2 == 15, 61 - ROWS, ROWS)), Kind.rows, "all"),
    "spike": (lambda _, m: dict(changed(m, "P4.y", 0.01).samples), Kind.spike, "P4"),
    "not finite": (lambda _, m: dict(changed(m, "P4.y", np.nan).samples), Kind.nonfinite, "P4"),
    "noise": (lambda _, m: {"P4.fx": m["P4.fx"] + 1e3 * np.random.default_rng(1).normal(size=73)}, Kind.noise, "P4"),
    "all late": (lambda r, _: rows(late(r, 2e-3), ROWS), Kind.lag, "all"),
    "rates late": (lambda r, m: of_rates(m, lambda c, _: late(r, 0.01)[c], *VELOCITIES), Kind.lag, "all"),
    "sign in ten rows": (lambda _, m: {c: np.where(TEN, -m[c], m[c]) for c in ("P4.fx", "P4.fy")}, Kind.sign, "P4"),
    "frame in ten rows": (
        lambda _, m: {c: np.where(TEN, own, m[c]) for c, own in in_frame(m, "P4", "toggle").items()},
        *(Kind.frame, "P4"),
    ),
    "half a turn": (lambda _, m: {"rod.angle": m["rod.angle"] + np.pi * (ROWS > 30)}, Kind.offset, "rod"),
    "growing": (lambda _, m: of_rates(m, lambda _, v: v * (1 + 0.01 * ROWS / 72), *VELOCITIES), Kind.solver, "all"),
    "drifting": (
        lambda r, m: of_rates(m, lambda c, v: v + 0.01 * r.scale[c] * ROWS / 72, *VELOCITIES),
        *(Kind.solver, "all"),
    ),
    "a start": (
        lambda r, m: of_rates(m, lambda c, a: a + 0.1 * r.scale[c] * DYING, "ax", "ay", "alpha"),
        *(Kind.start, "all"),
    ),
    "coarse": (
        lambda _, m: of_rates(m, lambda _, a: np.interp(ROWS, ROWS[::4], a[::4]), "ax", "ay", "alpha"),
        *(Kind.coarse, "all"),
    ),
    "breathing": (lambda r, _: breathing(r), Kind.length, "rod"),
    "drive": (lambda _, m: {"crank_angle": m["crank_angle"] + 1e-3}, Kind.drive, "drive"),
}
OF_OTHERS = {
    "other pair": "three_at_a_pin",
    "rates late": "quick_return",
    "drive": "swinging_law",
}  # not the toggle press


@pytest.mark.parametrize("fault", READ_OUT)
def test_what_is_wrong_in_a_read_out_is_named(references: References, fault: str) -> None:
    spoil, kind, place = READ_OUT[fault]
    reference = references(OF_OTHERS.get(fault, "toggle_press"))
    motion = commanded(reference)
    named = cause(reference, SAMPLING, spoilt(motion, spoil(reference, motion)))
    assert (named.kind, named.place) == (kind, place), words(reference.scene, named)


INPUTS = {  # what is wrong in a scene, and by which factor
    "mass": ("toggle_press", "bodies.rod.mass", 1.12, Kind.mass, "rod", "12 % too large"),
    "length": ("toggle_press", "bodies.rod.lengths.P4-P5", 1.003, Kind.length, "rod", "0.9 mm too long"),
    "length in m": ("loaded_four_bar", "bodies.rocker.lengths.C-D", 1.01, Kind.length, "rocker", "0.015 m too long"),
    "a hair of a length": (  # by forces as good as the load's table shifted
        *("double_toggle_clamp", "bodies.front_link.lengths.B-C", 1.001),
        *(Kind.length, "front_link", "0.457 mm too long"),
    ),
    "ground": ("toggle_press", "ground.points.P1.*", 1.01, Kind.place, "P1", "4.6 mm off"),
    "load": ("toggle_press", "loads.0.force.*", -1.0, Kind.load, "P5", "of the opposite sign"),
    "gravity": ("quick_return", "gravity.*", -1.0, Kind.gravity, "all", "of the opposite sign"),
    "guide": ("quick_return", "bodies.ram.slides.through.*", 1.02, Kind.guide, "ram", "2.99 mm beside its place"),
    "stiffness": ("driven_toggle", "springs.0.stiffness", 1.1, Kind.spring, "S-K", "stiffness is 10 % too large"),
    "table": ("driven_toggle", "loads.0.table.*.1", 0.9, Kind.load, "C", "10 % too small"),
}


def times(factor: float, scene: Scene, paths: str) -> Scene:
    """Return a scene with some numbers times a factor."""
    numbers = {path: factor * one.value for path, one in scene.numbers.items() if fnmatchcase(path, paths)}
    assert numbers
    return scene.with_numbers(numbers)


@pytest.mark.parametrize("even", [True, False])
def test_a_lag_is_counted_in_samples_where_their_steps_are_equal(references: References, even: bool) -> None:
    reference = references("toggle_press")
    instants = np.linspace(0.0, 1.0, 61)
    if not even:
        instants = instants + 0.005 * np.sin(2 * np.pi * instants)
    off = reference.at(reference.scene.drive.at(instants - 2e-3).position, instants)
    motion = Motion({**off.samples, "time": instants})
    named = cause(reference, Instants(tuple(instants)), motion)
    assert named.kind is Kind.lag
    assert named.amounts[0] == pytest.approx(2e-3)
    sentence = words(reference.scene, named)
    assert "2 ms late" in sentence
    assert (" samples)" in sentence) is even


@pytest.mark.parametrize("fault", INPUTS)
def test_what_is_wrong_in_a_scene_is_named_with_its_amount(references: References, fault: str) -> None:
    name, paths, factor, kind, place, amount = INPUTS[fault]
    reference = references(name)
    named = cause(reference, SAMPLING, _solved(times(factor, reference.scene, paths), reference))
    sentence = words(reference.scene, named)
    assert (named.kind, named.place, named.others) == (kind, place, ()), sentence
    assert sentence.endswith(f" {amount}")


def test_what_has_no_number_in_the_scene_is_named(references: References) -> None:
    reference = references("toggle_press")
    scene = reference.scene
    rod = scene.bodies["rod"]
    about_end = replace(rod, com=(0.15, 0.0), inertia=60 * 0.3**2 / 3)
    named = cause(reference, SAMPLING, _solved(replace(scene, bodies={**scene.bodies, "rod": about_end}), reference))
    assert words(scene, named) == "rod's moment of inertia is that about its end"
    assert (named.kind, named.place) == (Kind.inertia, "rod")
    assert named.amounts == pytest.approx((3.0,))
    named = cause(reference, SAMPLING, _solved(replace(scene, loads=()), reference))
    assert words(scene, named) == "the load at P5 is missing"
    force = 1e4 * np.sign(commanded(reference)["P5.vy"])  # against the motion of the slider
    motion = commanded(reference)
    slow = motion["P5.vy"] * force / reference.scene.drive.at(motion["time"]).rate
    named = cause(reference, SAMPLING, spoilt(motion, {"drive.torque": motion["drive.torque"] + slow}))
    assert (named.kind, named.place) == (Kind.friction, "slider")


def test_swapped_masses_where_a_moment_of_inertia_is_given(references: References) -> None:
    reference = references("loaded_four_bar")
    masses = {"bodies.crank.mass": 3.0, "bodies.coupler.mass": 2.0}
    named = cause(reference, SAMPLING, _solved(reference.scene.with_numbers(masses), reference))
    assert words(reference.scene, named) == "the masses of coupler and crank are swapped"


@pytest.mark.parametrize("only", ["", "drive.torque"])
def test_several_numbers_that_are_off_at_once(references: References, only: str) -> None:
    """Bars that are no lines but 100 mm wide, and another gravity; at 8 digits, as another program writes its own."""
    reference = references("loaded_four_bar")
    scene = reference.scene
    bodies = dict(scene.bodies)
    for name, length in (("crank", 0.6), ("rocker", 1.5)):
        mass = bodies[name].mass or 0.0
        bodies[name] = replace(bodies[name], com=(length / 2, 0.0), inertia=mass * (length**2 + 0.01) / 12)
    gravity = (0.99966 * 0.5, -0.99966 * 9.81)
    other = _solved(replace(scene, bodies=bodies, gravity=gravity), reference)
    theirs = {c: np.round(v, 8) for c, v in other.samples.items()}
    kept = {"time", scene.drive_channel, only} if only else {*theirs}
    asked = Instants(tuple(theirs["time"]), channels=frozenset(kept) - {"time", scene.drive_channel})
    right = commanded(reference)
    given = {c: theirs[c] if c in kept - {"time", scene.drive_channel} else right[c] for c in kept}
    named = likeliest(evidence(reference, replace(asked, instants=tuple(right["time"])), Motion(given)))
    ways = [{one.text: one.amounts[0] for one in (each, *each.besides)} for each in (named, *named.others)]
    expected = {GRAVITY: -0.00034, WIDTH: 0.1}
    assert any(way == pytest.approx(expected, rel=1e-2) for way in ways if way.keys() == expected.keys()), ways
    others = [way for way in ways if way.keys() != expected.keys()]
    assert [way.keys() for way in others] in ([], [{GRAVITY, INERTIA}]), "the crank turns evenly, wide or not"


def test_a_guide_that_is_turned_by_a_hair_makes_nothing_late(references: References) -> None:
    reference = references("toggle_press")
    path = "bodies.slider.slides.along"
    x, y = (reference.scene.numbers[f"{path}.{axis}"].value for axis in (0, 1))
    other = reference.scene.with_numbers({f"{path}.0": x - 1e-4 * y, f"{path}.1": y + 1e-4 * x})
    named = cause(reference, SAMPLING, _solved(other, reference))
    assert (named.kind, named.place, named.others) == (Kind.guide, "slider", ()), words(reference.scene, named)
    assert named.amounts == pytest.approx((1e-4,), rel=1e-3)


def _solved(scene: Scene, reference: Reference) -> Motion:
    motion = registry.reference(scene)(SAMPLING.commanded(reference.scene), SAMPLING.times(reference.scene))
    return Motion({channel: motion[channel] for channel in channels(scene)})


def test_a_load_that_is_switched_late_is_named(references: References) -> None:
    """Each row with the whole press force or with none, as it was two samples before."""
    reference = references("quick_return")
    scene, motion = reference.scene, commanded(reference)
    (load,) = (one for one in scene.loads if isinstance(one, PressForce))
    always = _solved(replace(scene, loads=(Force(load.body, load.at, load.force),)), reference)
    never = _solved(replace(scene, loads=()), reference)
    acts = np.roll(reference.acts(motion)[0][0], 2)
    wrong = {c: np.where(acts, always[c], never[c]) for c in force_channels(scene)}
    named = cause(reference, SAMPLING, spoilt(motion, wrong))
    assert (named.kind, named.place) == (Kind.load, load.at)
    assert named.amounts == pytest.approx((2 * 1.5 / 72,))


def test_of_two_causes_that_explain_as_much_both_are_named(references: References) -> None:
    """At a constant speed the crank's rate is off by a constant, or by a factor; along y alone, turned or swapped."""
    reference = references("toggle_press")
    motion = commanded(reference)
    named = cause(reference, SAMPLING, spoilt(motion, {"crank.omega": 1.01 * motion["crank.omega"]}))
    assert _alike(named) >= {(Kind.offset, "crank"), (Kind.unit, "crank")}
    assert ", or " in words(reference.scene, named)
    turned = {"P5.vx": -motion["P5.vy"], "P5.vy": motion["P5.vx"]}
    named = cause(reference, SAMPLING, spoilt(motion, {c: -own for c, own in turned.items()}))
    assert _alike(named) == {(Kind.swap, "P5"), (Kind.frame, "P5")}


def _alike(named: Cause) -> set[tuple[Kind, str]]:
    """Return kinds and places of a cause and of those that explain as much."""
    return {(one.kind, one.place) for one in (named, *named.others)}


def test_rows_without_a_reference_have_no_known_cause(references: References) -> None:
    """A driven slider beyond its end: the bodies do not reach."""
    reference = references("driven_toggle")
    time, output = 3 * SAMPLING.times(reference.scene), f"{reference.scene.output}.x"
    beyond = Instants(tuple(time.tolist()), channels=frozenset([output]))
    assert cause(reference, beyond, spoilt(commanded(reference), {"time": time})) == UNKNOWN


@pytest.mark.parametrize("name", ["toggle_press", "quick_return", "swinging_law"])
def test_a_right_motion_has_no_cause(references: References, name: str) -> None:
    reference = references(name)
    assert cause(reference, SAMPLING, commanded(reference)) == UNKNOWN


@pytest.mark.parametrize(("engine", "tier"), [("pymunk", "fast"), ("exudyn", "fast")])
def test_coarse_steps_are_nobodys_fault(references: References, engine: str, tier: str) -> None:
    """What discretisation is off by is no wrong mass, length or sign."""
    reference = references("toggle_press")
    outcome = run(engine, reference.scene, SAMPLING, tiers(engine)[tier])
    assert outcome.motion is not None, outcome.reason
    assert cause(reference, SAMPLING, outcome.motion).kind in (Kind.unknown, Kind.solver, Kind.noise)


def test_the_line_names_the_engine_and_whether_the_others_agree(references: References) -> None:
    reference = references("toggle_press")
    motion = commanded(reference)
    wrong = spoilt(motion, {"P4.fx": -motion["P4.fx"]})
    ok = Run("analytic", Settings("x"), Status.ok, motion=motion)
    failed = replace(ok, engine="exudyn", status=Status.inaccurate, motion=wrong)
    runs = (ok, failed, replace(ok, engine="pymunk"))
    measured = [assess(reference, SAMPLING, one, explain(reference, SAMPLING)) for one in runs]
    line = "exudyn: P4.fx has the opposite sign"
    assert sentences(reference, SAMPLING, measured) == {"exudyn": f"{line}, the others agree"}
    another = replace(measured[1], run=replace(failed, engine="other"))
    assert sentences(reference, SAMPLING, [*measured[1:], another])["exudyn"] == line
    measured[1] = replace(measured[1], finer="more steps leave 1.0%")
    line = "exudyn: its settings are too coarse: of its error more steps leave 1.0%"
    assert sentences(reference, SAMPLING, measured) == {"exudyn": f"{line}, the others agree"}
    doubted = replace(reference, floor=replace(reference.floor, doubt="suspect the core"))
    assert sentences(doubted, SAMPLING, measured) == {"analytic": "analytic: suspect the core"}
    fine = replace(measured[1], run=replace(measured[1].run, motion=commanded(reference)), finer="")
    assert sentences(reference, SAMPLING, [measured[0], fine]) == {}, "a cause that is unknown is not written"


def test_another_engine_with_the_same_mistake_does_not_agree(references: References) -> None:
    """It is ok by a promise of less, and off by as much; nor does one agree that lacks the channel."""
    reference = references("toggle_press")
    motion = commanded(reference)
    wrong = spoilt(motion, {"P4.fx": 1.05 * motion["P4.fx"]})
    right = Run("analytic", Settings("x"), Status.ok, motion=motion)
    failed = replace(right, engine="exudyn", settings=Settings("x", promise=1e-6), motion=wrong)
    coarse = replace(failed, engine="pymunk", settings=Settings("x", promise=1.0))
    kept = {c: v for c, v in motion.samples.items() if "P4.f" not in c}
    lacking = replace(right, engine="pymunk", motion=Motion(kept))
    for other in (coarse, lacking):
        measured = [assess(reference, SAMPLING, one, explain(reference, SAMPLING)) for one in (right, failed, other)]
        line = sentences(reference, SAMPLING, measured)["exudyn"]
        assert line == "exudyn: P4.fx is 1.05 times what it should be", other.engine


def test_of_many_bodies_a_length_is_sought_at_few_samples(
    references: References, monkeypatch: pytest.MonkeyPatch
) -> None:
    reference = references("toggle_press")
    _, path, factor, kind, place, amount = INPUTS["length"]
    motion = _solved(times(factor, reference.scene, path), reference)
    rows = list[int]()

    def counted(scene: Scene, paths: Sequence[str], position: Samples, *rest: Any) -> Mapping[str, Samples]:
        rows.append(len(position))
        return derivatives(scene, paths, position, *rest)

    derivatives = registry.derivatives
    monkeypatch.setattr(registry, "derivatives", counted)
    monkeypatch.setattr(numbers, "WORK", 2.8e4)
    named = cause(reference, SAMPLING, motion)
    assert (named.kind, named.place) == (kind, place)
    assert words(reference.scene, named).endswith(amount)
    assert 10 < max(rows) < 25

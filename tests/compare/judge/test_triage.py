"""The likely cause of a disagreement: of motions and scenes that are wrong on purpose, kind and place are named."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from compare.engines import registry
from compare.engines.registry import tiers
from compare.engines.runner import Run, run
from compare.judge.causes.cause import UNKNOWN, Cause, Kind
from compare.judge.causes.words import words
from compare.judge.measure import Standard, assess
from compare.judge.triage import cause, sentences
from compare.mechanics.reference import Reference
from scenes import Instants, Motion, Settings, Status
from scenes.channels import Role, named
from scenes.model.inputs import inputs_of, passing
from scenes.model.motion import Samples
from tests.comparisons import SAMPLING, References, changed, commanded, sampled

Spoil = Callable[[Reference, Motion], dict[str, Samples]]
ROWS = np.arange(SAMPLING.count)
DYING = np.exp(-ROWS / 5) * np.cos(ROWS)
TEN = (ROWS >= 20) & (ROWS < 30)
VELOCITIES = ("vx", "vy", "omega")


def spoilt(motion: Motion, samples: dict[str, Samples]) -> Motion:
    return Motion({**motion.samples, **samples})


def late(reference: Reference, by: float) -> Motion:
    instants = SAMPLING.times(reference.scene) - by
    return reference.at(inputs_of(reference.scene, instants))


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
    motion = commanded(reference)
    lengths = 0.3 + 0.003 * np.sin(2 * np.pi * ROWS / 72)
    rods = [reference.scene.with_numbers({"bodies.rod.lengths.P4-P5": length}) for length in lengths.tolist()]
    solved = [registry.reference(rod)(motion.inputs(rod, [k])) for k, rod in enumerate(rods)]
    return {c: np.array([row[c][0] for row in solved]) for c in motion.samples if c in solved[0]}


def of_rates(motion: Motion, change: Callable[[str, Samples], Samples], *quantities: str) -> dict[str, Samples]:
    return {c: change(c, own) for c, own in motion.samples.items() if named(c).name in quantities}


READ_OUT: dict[str, tuple[Spoil, Kind, str]] = {
    "sign": (lambda _, m: {c: -m[c] for c in ("P4.fx", "P4.fy")}, Kind.sign, "P4"),
    "sign of one": (lambda _, m: {"rod.omega": -m["rod.omega"]}, Kind.sign, "rod"),
    "degrees": (lambda _, m: {"rod.angle": np.degrees(m["rod.angle"])}, Kind.unit, "rod"),
    "kN": (lambda r, m: {c: m[c] / 1e3 for c in r.scene.channels.names(Role.force)}, Kind.unit, "all"),
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


@sampled(5)
@pytest.mark.parametrize("fault", READ_OUT)
def test_what_is_wrong_in_a_read_out_is_named(references: References, fault: str) -> None:
    spoil, kind, place = READ_OUT[fault]
    reference = references(OF_OTHERS.get(fault, "toggle_press"))
    motion = commanded(reference)
    named = cause(reference, SAMPLING, spoilt(motion, spoil(reference, motion)))
    assert (named.kind, named.place) == (kind, place), words(reference.scene, named)


@sampled(1)
@pytest.mark.parametrize("even", [True, False])
def test_a_lag_is_counted_in_samples_where_their_steps_are_equal(references: References, even: bool) -> None:
    reference = references("toggle_press")
    scene, instants = reference.scene, np.linspace(0.0, 1.0, 61)
    if not even:
        instants = instants + 0.005 * np.sin(2 * np.pi * instants)
    off = reference.at(passing(scene, inputs_of(scene, instants - 2e-3).driven().position, instants))
    motion = Motion({**off.samples, "time": instants})
    named = cause(reference, Instants(tuple(instants)), motion)
    assert named.kind is Kind.lag
    assert named.amounts[0] == pytest.approx(2e-3)
    sentence = words(reference.scene, named)
    assert "2 ms late" in sentence
    assert (" samples)" in sentence) is even


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


@sampled(1)
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
    measured = [assess(Standard.of(reference, SAMPLING), one) for one in runs]
    line = "exudyn: P4.fx has the opposite sign"
    assert sentences(reference, measured) == {"exudyn": f"{line}, the others agree"}
    another = replace(measured[1], run=replace(failed, engine="other"))
    assert sentences(reference, [*measured[1:], another])["exudyn"] == line
    measured[1] = replace(measured[1], finer="more steps leave 1.0%")
    line = "exudyn: its settings are too coarse: of its error more steps leave 1.0%"
    assert sentences(reference, measured) == {"exudyn": f"{line}, the others agree"}
    doubted = replace(reference, floor=replace(reference.floor, doubt="suspect the core"))
    assert sentences(doubted, measured) == {"analytic": "analytic: suspect the core"}
    fine = replace(measured[1], run=replace(measured[1].run, motion=commanded(reference)), finer="")
    assert sentences(reference, [measured[0], fine]) == {}, "a cause that is unknown is not written"


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
        measured = [assess(Standard.of(reference, SAMPLING), one) for one in (right, failed, other)]
        line = sentences(reference, measured)["exudyn"]
        assert line == "exudyn: P4.fx is 1.05 times what it should be", other.engine

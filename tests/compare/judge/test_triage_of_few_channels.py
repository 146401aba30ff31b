"""The likely cause where a result has a few channels, and its drive as commanded; and causes that there cannot be."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np
import pytest

from compare.engines import registry
from compare.engines.runner import Run
from compare.judge.causes.cause import Kind
from compare.judge.causes.evidence import Evidence, evidence
from compare.judge.causes.forces import force_causes
from compare.judge.causes.numbers import number_causes
from compare.judge.causes.whole import drive_causes
from compare.judge.causes.words import words
from compare.judge.measure import Standard, assess
from compare.judge.triage import cause, likeliest, sentences
from compare.mechanics.reference import Reference
from scenes import Motion, Sampling, Scene, Settings, Status
from scenes.channels import Role, named
from scenes.fields import put
from scenes.model.inputs import inputs_of
from scenes.model.motion import Samples
from scenes.scene import ConstantSpeed
from tests.comparisons import References, sampled

SAMPLING = Sampling(20)  # the half turn too, where an angle jumps by a turn


@pytest.fixture
def reference(references: References) -> Reference:
    """One with weight and loads: forces of another speed are no multiple of anything."""
    return references("loaded_four_bar")


def commanded(scene: Scene, slower: float = 1.0, speed: float = 1.0) -> dict[str, Samples]:
    """Return the motion at instants that are further apart, the drive at another speed."""
    law, times = scene.drive.law, slower * SAMPLING.times(scene)
    assert isinstance(law, ConstantSpeed)
    law = replace(law, speed=speed * law.speed)
    faster = scene.with_law(law)
    return dict(registry.reference(faster)(inputs_of(faster, times)).samples)


def seen(reference: Reference, samples: dict[str, Samples], channels: Collection[str]) -> Evidence:
    """Return what there is of a result with these channels alone."""
    inputs = {c: commanded(reference.scene)[c] for c in ("time", reference.scene.channels.drive.position)}
    asked = replace(SAMPLING, channels=frozenset(channels))
    return evidence(reference, asked, Motion({c: samples[c] for c in channels} | inputs))


@pytest.mark.parametrize(("channels", "share"), [(("T.x", "T.y"), 1.01), (("drive.torque",), 0.97)])
def test_another_speed_of_the_drive(reference: Reference, channels: tuple[str, ...], share: float) -> None:
    known = seen(reference, commanded(reference.scene, speed=share), channels)
    best = min(drive_causes(known), key=lambda cause: known.left(cause.predicted))
    assert words(reference.scene, best.cause) == f"the drive runs at another speed, {100 * (share - 1):+.3g} %"


def test_instants_that_drift(reference: Reference) -> None:
    """What was at the right instants is written at some that are 0.05 % too far apart."""
    drifting = commanded(reference.scene, slower=1 / 1.0005)
    known = seen(reference, drifting, drifting)
    best = min(drive_causes(known), key=lambda cause: known.left(cause.predicted))
    assert words(reference.scene, best.cause) == "all instants are too far apart, +0.05 %"


@sampled(1)
@pytest.mark.parametrize("only", ["", "drive.torque"])
def test_forces_at_rest(reference: Reference, only: str) -> None:
    """Those of a static solution, beside the right motion."""
    right, slow = commanded(reference.scene), commanded(reference.scene, slower=1e6, speed=1e-6)
    found = right | {channel: slow[channel] for channel in reference.scene.channels.names(Role.force)}
    known = seen(reference, found, [only] if only else found)
    assert words(reference.scene, likeliest(known)) == "inertia's share of all forces is missing"


def test_a_length_by_forces_alone(reference: Reference) -> None:
    path = ("bodies", "rocker", "lengths", frozenset(("C", "D")))
    longer = commanded(put(reference.scene, {path: 1.515}))
    known = seen(reference, longer, reference.scene.channels.names(Role.force))
    assert words(reference.scene, likeliest(known)) == "rocker's length C-D is 0.015 m too long"


def test_no_body_has_less_than_no_mass_and_no_friction_pushes(reference: Reference) -> None:
    below = commanded(put(reference.scene, {("bodies", "rocker", "mass"): -2.0}))
    known = seen(reference, below, reference.scene.channels.names(Role.force))
    causes = [each.cause for each in (*number_causes(known), *force_causes(known))]
    named = [one for cause in causes for one in (cause, *cause.besides)]
    assert all(one.amounts[0] > -1.01 for one in named if "mass is {percent}" in one.text)  # -1 but for rounding
    friction = [cause.amounts[0] for cause in causes if cause.kind is Kind.friction]
    assert friction
    assert min(friction) > 0


def test_what_few_numbers_do_not_show(reference: Reference) -> None:
    """One number is about that of some row, and a frame with a size of its own is about any motion's."""
    right = commanded(reference.scene)
    backwards = seen(reference, {"drive.torque": right["drive.torque"][::-1]}, ["drive.torque"])
    assert "rows of other instants" not in words(reference.scene, likeliest(backwards))
    place = 0.8 * np.exp(0.3j) * (right["T.x"] + 1j * right["T.y"]) + 0.3
    smaller = seen(reference, {"T.x": place.real, "T.y": place.imag}, ("T.x", "T.y"))
    assert "another frame" not in words(reference.scene, likeliest(smaller))


def test_what_a_cause_leaves_over_is_named(reference: Reference) -> None:
    true = commanded(reference.scene)["T.x"]
    uneven = seen(reference, {"T.x": true + 0.1 + 0.005 * np.cos(np.arange(true.size))}, ["T.x"])
    assert words(reference.scene, likeliest(uneven)) == "T.x is off by a constant, 0.1 (all but 4 % of the error)"


@sampled(1)
@pytest.mark.parametrize(
    ("by", "wrong"), [(1.000025, "0.0025 % too large"), (0.9998, "0.02 % too small"), (1.03, "1.03 times what it")]
)
def test_a_factor_is_never_shown_as_one(reference: Reference, by: float, wrong: str) -> None:
    right = commanded(reference.scene)
    known = seen(reference, {"drive.torque": by * right["drive.torque"]}, ["drive.torque"])
    assert wrong in words(reference.scene, likeliest(known))
    velocities = {c: by * v if named(c).name in ("vx", "vy", "omega") else v for c, v in right.items()}
    whole = likeliest(seen(reference, velocities, velocities))
    assert wrong.removesuffix(" it") in words(reference.scene, whole)


def test_causes_are_known_where_the_crank_turns_but_a_part(references: References) -> None:
    """Positions in degrees in place of radians are beyond its dead points, and no reason to know nothing."""
    reference, sampling = references("elbow"), Sampling(36)
    motion = reference.at(sampling.inputs(reference.scene))
    wrong = Motion({**motion.samples, "T.vx": -motion["T.vx"]})
    named = cause(reference, sampling, wrong)
    assert (named.kind, named.place) == (Kind.sign, "T")


def test_what_an_engine_does_not_give_is_not_what_is_wrong(reference: Reference) -> None:
    """One that has no forces, and other velocities of a point."""
    forces = reference.scene.channels.names(Role.force)
    wrong = {c: 1.05 * own if c in ("T.vx", "T.vy") else own for c, own in commanded(reference.scene).items()}
    kinematic = Motion({c: own for c, own in wrong.items() if c not in forces}, dict.fromkeys(forces, "it has none"))
    run = Run("stub", Settings("", promise=1e-6), Status.ok, motion=kinematic)
    measured = assess(Standard.of(reference, SAMPLING), run)
    assert measured.run.status is Status.inaccurate, measured.run.reason
    assert sentences(reference, [measured]) == {"stub": "stub: T's velocity is 1.05 times what it should be"}

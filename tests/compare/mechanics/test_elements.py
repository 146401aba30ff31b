"""What the judge knows of loads, springs and drives, against motions by 50 digits: these hold, wrong ones do not."""

from functools import cache
from math import pi, tau
from typing import Any

import numpy as np
import pytest

from compare.judge.checks import checks
from compare.mechanics.elements import twist
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.motion_vectors import MotionVectors
from compare.mechanics.scales import travels
from compare.report.linkage.drawing import Drawing
from compare.report.linkage.svg import by_itself
from scenes import Motion, Sampling, Scene
from tests import scene_files
from tests.comparisons import changed, sampled
from tests.scene_files import Changes

pytest.importorskip("flint")

from sim_models.multiprecision import engine

ROUNDED = 1e-13  # relative: doubles written from 50 digits, and the judge's own sums of ten terms

TURNING = {"body": "coupler", "at": "B", "force": [30, -20], "frame": "body"}
ALONG_GUIDE = {"body": "block", "force": 40}
GAS = {"body": "block", "table": [[0, 100], [100, 20], [300, 10]]}
OVER_DRIVE = {"body": "rocker", "at": "B", "along": [3, 4], "over": "drive", "table": [[-90, 5], [270, 41]]}
OVER_TIME = {"body": "rocker", "over": "time", "table": [[0, 1], [0.1, 7], [0.3, 1]], "periodic": True}
DAMPER = {"between": ["ground.F", "rocker.B"], "stiffness": 2, "length": 200, "damping": 0.5}
TORSION = {"at": "B", "between": ["coupler", "rocker"], "stiffness": 5, "angle": 20, "damping": 3}
WRONG: list[tuple[str, dict[str, Any], dict[str, Any] | None, set[tuple[str, str]]]] = [
    # where it stands, what is right, what an engine took for it, and who must notice
    ("loads", {"body": "rocker", "moment": 7}, None, {("Euler", "rocker")}),
    ("loads", OVER_TIME, {**OVER_TIME, "periodic": False}, {("Euler", "rocker")}),
    ("loads", TURNING, {**TURNING, "frame": "ground"}, {("Newton", "coupler"), ("Euler", "coupler")}),
    ("loads", OVER_DRIVE, {**OVER_DRIVE, "over": "time"}, {("Newton", "rocker"), ("Euler", "rocker")}),
    ("loads", ALONG_GUIDE, {"body": "block", "at": "P", "force": [40, 0], "frame": "body"}, {("Newton", "coupler")}),
    ("loads", GAS, {**GAS, "table": [[0, 10], [200, 20], [300, 100]]}, {("Newton", "block"), ("Newton", "coupler")}),
    ("springs", DAMPER, {**DAMPER, "damping": 0}, {("Newton", "rocker")}),
    ("torsion_springs", TORSION, {**TORSION, "damping": 0}, {("Euler", "coupler"), ("Euler", "rocker")}),
    ("torsion_springs", TORSION, {**TORSION, "between": ["rocker", "coupler"]}, {("Euler", "coupler")}),
    ("torsion_springs", TORSION, {**TORSION, "angle": 380}, {("Euler", "coupler"), ("Euler", "rocker")}),
    ("torsion_springs", TORSION, {**TORSION, "between": ["ground", "rocker"], "at": "C"}, {("Euler", "coupler")}),
]


@cache
def solved(scene: Scene, turns: int = 1) -> Motion:
    simulation = engine.build(scene, engine.DEFAULT, Sampling(24, turns))
    simulation.solve()
    return simulation.read()


def found(scene: Scene, motion: Motion) -> dict[tuple[str, str], float]:
    return {(c.check, c.of): c.worst for c in checks(Mechanics(scene), motion, travels(scene, motion))}


@sampled(5)
@pytest.mark.parametrize(("place", "right", "wrong", "noticed"), WRONG)
def test_an_element_that_is_another_is_noticed(
    place: str, right: dict[str, Any], wrong: dict[str, Any] | None, noticed: set[tuple[str, str]]
) -> None:
    scene, other = (scene_files.load("carried_block", {place: [of] if of else []}) for of in (right, wrong))
    assert max(found(scene, solved(scene)).values()) <= ROUNDED
    by_check = found(scene, solved(other))
    assert min(by_check[check] for check in noticed | {("power", "mechanism")}) > 1e-4
    assert by_check["closure", "block"] <= ROUNDED  # it moves as it should


DRIVES = [
    ("bucket", "drive.force", "Newton", ("rod", "cylinder")),
    ("elbow", "drive.torque", "Euler", ("stick", "boom")),
]


@pytest.mark.parametrize(("name", "effort", "law", "both"), DRIVES)
def test_a_drive_acts_on_both_its_bodies(name: str, effort: str, law: str, both: tuple[str, str]) -> None:
    scene = scene_files.load(name)
    motion = solved(scene)
    assert max(found(scene, motion).values()) <= ROUNDED
    off = found(scene, changed(motion, effort, 1e-3 * float(np.abs(motion[effort]).max()), 9))
    assert min(off[law, body] for body in both) > 1e-5
    assert off["power", "mechanism"] > 1e-5


@pytest.mark.parametrize("name", ["bucket", "elbow"])
def test_a_drive_is_where_its_bodies_are(name: str) -> None:
    """Poses at other positions of the drive than its channel has; and a channel that is not as asked."""
    scene, hair = scene_files.load(name), 1e-4 * float(np.ptp(scene_files.load(name).drive.law.extent))
    motion, by = solved(scene), scene.channels.drive.position
    assert found(scene, changed(motion, by, hair, 9))["drive", scene.drive.body] > 1e-5
    beside = solved(scene_files.load(name, {"drive.start": {"bucket": 560.02, "elbow": -109.995}[name]}))
    off = found(scene, Motion({**beside.samples, by: motion[by], "time": motion["time"]}))
    assert max(worst for (check, _), worst in off.items() if check == "position") > 1e-5


SPRINGS = [("B", ["crank", "coupler"]), ("B", ["coupler", "crank"]), ("C", ["coupler", "rocker"])]


@sampled(1)
@pytest.mark.parametrize(("at", "between"), SPRINGS)
def test_turns_count_whatever_the_order_of_the_samples(at: str, between: list[str]) -> None:
    spring = {"at": at, "between": between, "stiffness": 2, "angle": 1}
    scene = scene_files.load("loaded_four_bar", {"torsion_springs": [spring]})
    motion = solved(scene, 3)
    first, second = (motion[f"{name}.angle"] for name in between)
    expected = np.unwrap(second - first)
    expected -= tau * np.ceil(expected[0] / tau - 0.5)
    rows = np.random.default_rng(0).permutation(len(expected))[:30]
    some = Motion({channel: samples[rows] for channel, samples in motion.samples.items()})
    np.testing.assert_allclose(twist(MotionVectors(scene, some), scene.torsion_springs[0]), expected[rows], atol=1e-12)
    assert (np.ptp(expected) > 3 * pi) == (at == "B")


@pytest.mark.parametrize("sign", [1, -1])
def test_a_spring_on_the_crank_has_the_turns_of_the_drive(sign: int) -> None:
    between = ["ground", "crank"][::sign]
    changes: Changes = {"drive.start": 9, "torsion_springs": [{"at": "A", "between": between, "damping": 1}]}
    scene = scene_files.load("loaded_four_bar", changes)
    angle = twist(MotionVectors(scene, motion := solved(scene)), scene.torsion_springs[0])
    np.testing.assert_allclose(angle, sign * motion["crank_angle"], atol=1e-12)


def test_a_spring_between_bodies_that_do_not_turn_keeps_its_angle() -> None:
    spring = {"at": "F", "between": ["block", "follower"], "stiffness": 2, "angle": 1}
    scene = scene_files.load("wedge", {"torsion_springs": [spring]})
    assert not twist(MotionVectors(scene, solved(scene)), scene.torsion_springs[0]).any()


def test_all_kinds_are_drawn() -> None:
    changes: Changes = {"loads": [TURNING, {"body": "rocker", "moment": 7}], "torsion_springs": [TORSION]}
    changes["springs"] = [{"between": ["ground.F", "rocker.B"], "damping": 1}]
    scene = scene_files.load("carried_block", changes)
    drawing = Drawing(scene, solved(scene))
    assert [arrow.name for arrow in drawing.arrows if arrow.load] == ["load on coupler"]
    plain = by_itself(Drawing(scene_files.load("carried_block"), solved(scene)), 0)
    assert drawing.rod("block") == 0.0
    cylinder = scene_files.load("bucket")
    assert Drawing(cylinder, solved(cylinder)).rod("rod") == pytest.approx(0.76 - 0.56 / 2)
    more = by_itself(drawing, 0).count("<path") - plain.count("<path")
    assert more == 3 + 2  # three signs, and an arrow's shaft and head

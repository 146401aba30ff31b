"""How near a group is to a lock: angles from positions alone, and lengths that are changed until it does lock."""

from dataclasses import replace
from pickle import dumps, loads
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import analytic
import scenes
from analytic.core.decomposition import decompose
from analytic.core.groups.group_equations import FramePoses, Group, GroupEquations
from analytic.way.nearest_length import to_lock
from compare.judge.peaks.peaks import peaks
from compare.mechanics.reference import uncertified
from scenes import Failure, Motion, Sampling, Scene
from tests import scene_files
from tests.agreement import attitude, solve, where
from tests.comparisons import sampled
from tests.linkages import xy

from .newton import intervals
from .test_class_iii import LONG_CRANK
from .views import Change

Vectors = NDArray[np.complex128]


def line(scene: Scene, motion: Motion, of: str) -> Vectors:
    """The direction of a bar by its two points, of a guide, which turns with what it is on, or of a guide's normal."""
    if "-" in of:
        A, B = of.split("-")
        return where(scene, motion, B) - where(scene, motion, A)
    slide = scene.bodies[of.removesuffix("'s normal")].slide
    assert slide is not None
    along = attitude(scene, motion, slide.on) * complex(*slide.along)
    return 1j * along if of.endswith("normal") else along


# channel: what is in one line where the dyad locks
LINES = {
    "RRR": ("toggle_press", "P3", "P2-P3", "O-P3"),
    "RRP": ("toggle_press", "P5", "P4-P5", "slider's normal"),
    "RPR": ("swinging_block", "rod", "A-C", "rod's normal"),
    "RPR in a quick return": ("shaper", "block", "A-C", "block's normal"),
    "RPP": ("scotch_yoke", "block", "yoke", "block"),
    "PRP": ("tangent", "P", "block", "slider"),
    "RRP on a moving guide": ("carried_block", "P", "F-P", "block's normal"),
}


@pytest.mark.parametrize("case", LINES)
def test_transmission_is_the_angle_of_two_lines(case: str) -> None:
    name, joint, one, two = LINES[case]
    scene = scene_files.load(name)
    motion = solve(scene)
    a, b = line(scene, motion, one), line(scene, motion, two)
    angle = np.arccos(np.abs((a.conj() * b).real) / np.abs(a * b))
    # arccos loses digits where its argument is near one; there is none in these below 5 degrees
    assert np.abs(motion[f"{joint}.transmission"] - angle).max() <= 1e-13


def test_transmission_is_nothing_in_a_lock_and_whole_where_square() -> None:
    """Coupler and rocker are in line at both ends, and square where the crank's tip is hypot(1.5, 1.2) from C."""
    scene = scene_files.load("triple_rocker")
    (interval,) = intervals(scene)
    square = np.arccos((2**2 + 3**2 - 1.5**2 - 1.2**2) / (2 * 2 * 3))
    found = analytic.solve(scene, [interval.start, interval.end, square])["B.transmission"]
    assert found[:2] == pytest.approx([0, 0], abs=1e-6)  # the square root of an angle's roundings
    assert found[2] == pytest.approx(np.pi / 2, abs=1e-14)


def with_body(scene: Scene, name: str, **parts: Any) -> Scene:
    return replace(scene, bodies={**scene.bodies, name: replace(scene.bodies[name], **parts)})


def longer(scene: Scene, body: str, by: float) -> Scene:
    """Return the scene with a bar longer, which is given by its length."""
    ((pair, length),) = (scene.bodies[body].lengths or {}).items()
    return with_body(scene, body, lengths=MappingProxyType({pair: length + by}))


def moved(scene: Scene, slider: str, by: float) -> Scene:
    """Return the scene with a guide moved along its own normal."""
    slide = scene.bodies[slider].slide
    assert slide is not None
    through = complex(*slide.through) + by * 1j * complex(*slide.along)
    return with_body(scene, slider, slide=replace(slide, through=xy(through)))


def turned(scene: Scene, slider: str, by: float) -> Scene:
    """Return the scene with a guide turned about its own point."""
    slide = scene.bodies[slider].slide
    assert slide is not None
    return with_body(scene, slider, slide=replace(slide, along=xy(complex(*slide.along) * np.exp(1j * by))))


NEAREST = {
    "RRR stretched": ("triple_rocker", "B", 1.0, longer, "coupler"),
    "RRR folded": ("triple_rocker", "B", 0.9, longer, "coupler"),
    "RRP": ("shaper", "E", 1.0, longer, "link"),
    "RRP, of the guide": ("shaper", "E", 1.0, moved, "ram"),
    "RRP on a moving guide": ("carried_block", "P", 2.0, longer, "bar"),
    "RPR": ("slotted_lever", "block", 2.0, moved, "block"),
    "RPR in a quick return": ("shaper", "block", 1.0, moved, "block"),
    **{f"III at {at}": ("class_iii", "B", at, longer, "lower") for at in (1.814, 1.80455, 1.7272)},  # rad, to its lock
    **{f"III at {at}": ("class_iii", "B", at, longer, "coupler") for at in (1.5527, 1.1862, 0.7673, 0.587, 0.5357)},
    "class III with a slot": ("slotted_class_iii", "P0", -0.9, moved, "block"),
}
FOLDED = {"bodies.coupler.lengths.A-B": 2.5}
BARS = ("coupler", "upper", "lower")  # of class III


@sampled(2)
@pytest.mark.parametrize("case", NEAREST)
def test_a_length_changed_by_that_much_locks(case: str) -> None:
    """One way by a little more it does not reach, and by less it has just that left; the other way it does."""
    name, joint, position, change, body = NEAREST[case]
    channel = f"{joint}.to_lock"
    scene = scene_files.load(name, FOLDED if case == "RRR folded" else LONG_CRANK if name == "class_iii" else {})

    def left(longer_by: float, body: str = body) -> float | None:
        try:
            # that channel alone: what hangs on the group may lock before
            motion = analytic.solve(change(scene, body, longer_by), [position], channels={channel})
            return float(motion[channel][0])
        except Failure:
            return None

    by = left(0.0)
    assert by is not None
    assert by > 0
    larger = any(isinstance(group, Group) for group in decompose(scene).groups)
    hair = 1e-4 if larger else 1e-9  # Newton's method is lost where the poses on both sides of a fold are near
    reach = {sign: left(sign * by * (1 + hair)) is not None for sign in (1, -1)}
    assert sorted(reach.values()) == [False, True]
    locks = 1 if reach[-1] else -1
    assert left(locks * by * (1 - hair)) == pytest.approx(hair * by, rel=1e-4)  # a difference of lengths, rounded
    if name == "class_iii":  # no other length locks it sooner, and it has a length alone
        assert all(left(sign * by, bar) for bar in BARS if bar != body for sign in (1, -1))
        assert "B.transmission" not in analytic.solve(scene, [position])


# scene, joint, a guide, the linkage's longest arm, m: the crank's O-T; the yoke's Y-T
CROSSING = {
    "PRP": ("slotted_crank", "P", "slider", 2.0),
    "PRP, the other guide": ("slotted_crank", "P", "block", 2.0),
    "RPP": ("scotch_yoke", "block", "yoke", np.hypot(0.2, 0.01)),
}


@pytest.mark.parametrize("case", CROSSING)
def test_a_guide_turned_by_that_much_at_the_longest_arm_locks(case: str) -> None:
    name, joint, slider, arm = CROSSING[case]
    channel, scene = f"{joint}.to_lock", scene_files.load(name)

    def left(by: float) -> float:
        return float(analytic.solve(turned(scene, slider, by), [1.0], channels={channel})[channel][0])

    angle = np.arcsin(left(0.0) / arm)
    near = min(left(sign * angle * (1 - 1e-9)) for sign in (1, -1))
    assert near == pytest.approx(arm * angle * 1e-9, rel=1e-5)  # a difference of angles, rounded


def test_the_longest_arm_may_be_a_guide_off_a_pin_or_the_way_of_a_drive() -> None:
    """A crank of one point is turned under a guide 0.3 m away; wedges of one point each have but their way."""
    radial = {"bodies.crank.points": {"O": [0, 0]}, "bodies.block.slides.through": [0, 0]}
    slots = scene_files.load("tangent", {**radial, "sketch.T": None})
    assert decompose(slots).arm == pytest.approx(0.3 / np.hypot(1, 0.1), rel=1e-15)
    least, most = scene_files.load("wedge_of_points").drive.law.extent
    flat = {f"bodies.{body}.slides.through": [0, 0] for body in ("wedge", "block", "follower")}
    assert decompose(scene_files.load("wedge_of_points", flat)).arm == most - least


def test_a_larger_group_is_as_far_from_its_lock_from_any_view() -> None:
    """The length is that of the linkage, not of the frame that it is drawn in."""
    scene = scenes.load("class_iii")
    view = Change(mirror=-1, turn=np.exp(0.7j), shift=3 - 2j, length=1000.0)
    seen = analytic.solve(view.scene(scene), [view.angle(1.0)])["B.to_lock"]
    own = analytic.solve(scene, [1.0])["B.to_lock"]
    assert seen == pytest.approx(1000 * own, rel=1e-11)  # singular values near the largest, thousands, by roundings


@pytest.fixture
def asked_for(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """At how many poses the distances of larger groups are found, call after call."""
    counts: list[int] = []

    def counted(equations: GroupEquations, pose: FramePoses) -> NDArray[np.float64]:
        counts.append(len(pose.z))
        return to_lock(equations, pose)

    monkeypatch.setattr("analytic.channels.to_lock", counted)
    return counts


def test_a_larger_group_is_measured_where_it_is_asked_for_and_once(asked_for: list[int]) -> None:
    """All else, 95 % of which it would be, is there without."""
    scene, angles = scenes.load("class_iii"), np.linspace(0, 6, 5)
    motion, many = analytic.solve(scene, angles), analytic.solve_many(scene, {"drive.speed": [100, 120]}, angles)
    assert "B.to_lock" in motion
    assert motion["D.x"] is motion["D.x"]
    assert many["D.x"].shape == (2, 5)
    assert asked_for == []
    assert motion["B.to_lock"] is motion["B.to_lock"]
    assert asked_for == [5]
    named = analytic.solve(scene, angles, channels={"B.to_lock"})["B.to_lock"]
    assert (motion["B.to_lock"] == named).all()
    assert many["B.to_lock"] == pytest.approx(np.array([named, named]), rel=1e-13)  # at any speed, but for roundings
    assert asked_for == [5, 5, 5, 5]


def test_what_is_not_looked_up_yet_goes_to_another_process(asked_for: list[int]) -> None:
    scene, angles = scenes.load("class_iii"), np.linspace(0, 6, 3)
    motion, many = analytic.solve(scene, angles), analytic.solve_many(scene, {"drive.speed": [100]}, angles)
    for answer, sent in ((motion, loads(dumps(motion))), (many, loads(dumps(many)))):
        assert list(sent.samples) == list(answer.samples)
        assert (sent["B.to_lock"] == answer["B.to_lock"]).all()
    assert set(asked_for) == {3}


def test_a_larger_group_is_measured_once_a_run(asked_for: list[int]) -> None:
    """A report draws 361 of its samples, and its least is found from these; the cycle itself has 3601."""
    reference, sampling = uncertified(scenes.load("class_iii")), Sampling()
    drawn = reference.at(sampling.inputs(reference.scene))
    assert len(drawn["B.to_lock"]) == 361
    (lock,) = (peak for peak in peaks(reference, sampling, []) if peak.channel == "B.to_lock")
    around = 200  # of 360: the least and its neighbours in 3600, and three rounds of three at each of 14 extremes
    assert 361 <= sum(asked_for) <= 361 + around
    fine = analytic.solve(reference.scene, lock.position + np.linspace(-1e-3, 1e-3, 5))["B.to_lock"]
    assert lock.value == pytest.approx(fine[2], rel=1e-13)  # roundings
    assert (fine >= lock.value * (1 - 1e-13)).all()

"""Groups that hold no dyad, solved by Newton's method: against arbitrary precision, and against the closed form."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.typing import NDArray

import analytic
import scenes
from analytic.core.dyads import cross
from analytic.core.groups import continuation
from analytic.solve import Solver, prepared
from compare.mechanics.reference import uncertified
from compare.mechanics.scales import relative_errors
from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.scene import ConstantSpeed
from tests import absolute_coordinates, scene_files
from tests.agreement import off_50_digits
from tests.comparisons import SLOW, sampled

from .newton import as_one_group, assert_close, intervals
from .test_mechanisms import FLIPPED, flipped

TURN = np.radians(np.arange(720) / 2)  # half-degree steps, without the end


@pytest.fixture(scope="module")
def class_iii() -> Scene:
    return scenes.load("class_iii")


@pytest.fixture(scope="module")
def solve(class_iii: Scene) -> Solver:
    return analytic.solver(class_iii)


WHOLE = ("toggle_press", "busy", "shaper", "swinging_block", "scotch_yoke", "tangent", "carried_block", "driven_toggle")


@sampled(2)
@pytest.mark.parametrize(
    ("name", "kept"), [*((name, 0) for name in WHOLE), ("carried_block", -1), ("carried_yoke", -1)]
)
def test_dyads_as_one_group(name: str, kept: int) -> None:
    """The closed form against Newton's method on all after the driver: no formula in common but the bodies' own.

    As the last dyad alone the coupler slides on the block or the yoke, which is of the group, and takes what the guide
    does to it.
    """
    scene = scene_files.load(name)
    scene = flipped(scene, *FLIPPED[name]) if kept else scene
    position = np.linspace(*scene.drive.law.extent, 720, endpoint=False)
    by_newton = prepared(scene, as_one_group(scene, kept))(position)
    scale = uncertified(scene).scale
    for channel, error in relative_errors(scene.channels, by_newton, analytic.solve(scene, position), scale).items():
        # near 30 deg rod and guide of the busy scene are almost square, which multiplies roundings by thousands
        assert error.max() <= (1e-12 if kept else 1e-11), channel  # a few dozen roundings of each


@sampled(1)
@pytest.mark.parametrize("order", [range(9), range(8, -1, -1), (3, 7, 1, 8, 5, 0, 4, 2, 6)])
def test_between_dyads_in_any_order(order: Sequence[int]) -> None:
    """A dyad drives the group, and one hangs on it, at a pin of three bodies, whichever comes first."""
    scene = scene_files.in_order("class_iii_among_dyads", order)
    dyad, newton, last = analytic.route(scene).removeprefix("crank, ").split(", ")
    assert (dyad, last) == ("RRR", "RRP")
    assert set(newton.removeprefix("Newton on ").split("-")) == {"coupler", "plate", "upper", "lower"}
    for channel, error in off_50_digits(uncertified(scene), Sampling(24)).items():
        assert error.max() <= 1e-12, channel  # a few dozen roundings, all groups well clear of lock


@SLOW
def test_strides_lead_where_single_steps_do(class_iii: Scene, solve: Solver, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(continuation, "_filled", lambda *_: None)
    assert_close(solve(TURN).samples, analytic.solve(class_iii, TURN).samples, 1e-12)  # roundings, well clear of lock


def distance_from_lock(scene: Scene, motion: Motion) -> NDArray[np.float64]:
    """Return how far the coupler's line A-B passes from where the lines E-C and F-D meet, m."""
    at = {p: motion[f"{p}.x"] + 1j * motion[f"{p}.y"] for p in "ABCD"} | {p: complex(*scene.ground[p]) for p in "EF"}
    along = {bar: (at[bar[1]] - at[bar[0]]) / np.abs(at[bar[1]] - at[bar[0]]) for bar in ("AB", "EC", "FD")}
    foot = at["F"] - at["E"]
    meet = at["E"] + along["EC"] * cross(foot, along["FD"]) / cross(along["EC"], along["FD"])
    return np.abs(cross(along["AB"], meet - at["A"]))


def test_the_scene_is_as_it_says(class_iii: Scene, solve: Solver) -> None:
    motion = solve(TURN)
    assert abs(distance_from_lock(class_iii, motion).min() - 0.190) <= 0.0005  # m; as the scene's head rounds it
    assert abs(np.degrees(np.ptp(np.unwrap(motion["plate.angle"]))) - 30) <= 0.5  # deg; likewise


LONG_CRANK = {"bodies.crank.lengths.O-A": 200, "sketch.A": [100, 173]}


def test_a_lock_is_told_where() -> None:
    """With a longer crank, the lines of the three bars meet in one point at both ends of the range."""
    scene = scene_files.load("class_iii", LONG_CRANK)
    (interval,) = intervals(scene)
    assert interval.start_joint == interval.end_joint == "B"
    assert interval.end - interval.start < 2 * np.pi
    ends = analytic.solve(scene, [interval.start, interval.end])
    # The distance is as the root of the angle that is left, which is 1e-6 deg: 1e-4 of some 0.3 m.
    assert distance_from_lock(scene, ends).max() <= 1e-4
    why = r"B cannot be reached at .* deg: with all else closed \w+ stays open by [\d.]+ mm; the crank turns only"
    with pytest.raises(Failure, match=why) as caught:
        analytic.solve(scene, TURN)
    assert caught.value.status is Status.cannot_assemble
    assert "(coupler, plate, upper, lower in a singular configuration)" in caught.value.reason


@SLOW
def test_newton_does_not_jump_over_a_lock() -> None:
    """Found by chance: just beyond the lock at 72 degrees Newton's method converges, to a pose of another branch.

    Steps of 0.01 degrees in other coordinates lose the branch at 72.007 and at -109.09 degrees.
    """
    scene = scene_files.load("jumps")
    (interval,) = intervals(scene)
    assert np.degrees([interval.start, interval.end]) == pytest.approx([-109.09, 72.007], abs=0.005)
    inside = np.linspace(interval.start, interval.end, 50)[1:-1]
    with pytest.raises(Failure, match=r"B cannot be reached at crank angle 90\.0000 deg"):
        analytic.solve(scene, [*inside, np.pi / 2])
    motion = analytic.solve(scene, inside)
    expected = absolute_coordinates.solve(scene, inside, 1.0, 0.0)
    for channel in ("D.x", "D.y", "B.x", "C.y"):
        assert np.abs(motion[channel] - expected[channel]).max() <= 1e-12, channel  # roundings; locks are 4 deg away


@sampled(1)
@pytest.mark.parametrize(
    ("start", "status", "why"),
    [
        (0, Status.cannot_assemble, r"the crank turns only from -55\.28\d\d deg to 333\.67\d\d deg, with link"),
        (-80, Status.cannot_assemble, r"the crank turns only from -55\.28"),
        (-40, Status.unsupported, "after one turn of the crank link, coupler, left, right are in another pose"),
    ],
)
def test_a_branch_of_more_than_a_turn_ends_where_it_ends(start: int, status: Status, why: str) -> None:
    """At the ends' angles there are two poses each, and a turn of the crank does not lead from one to the other."""
    scene = scene_files.load("stephenson_iii", {"drive.start": start})
    with pytest.raises(Failure, match=why) as caught:
        analytic.solve(scene, scene.drive.law.after(np.linspace(0, 1, 73)))
    assert caught.value.status is status


@sampled(1)
@pytest.mark.parametrize(("start", "end"), [(-50, 60), (320, 200), (-30, 320)])
def test_on_a_part_of_such_a_branch(start: int, end: int) -> None:
    scene = scene_files.load("stephenson_iii", {"drive.start": start, "drive.end": end, "drive.speed": end - start})
    position = scene.drive.law.after(np.linspace(0, 1, 50))
    motion, expected = analytic.solve(scene, position), absolute_coordinates.solve(scene, position, 1.0, 0.0)
    for channel in ("A.x", "B.y", "D.x", "D.y"):
        assert np.abs(motion[channel] - expected[channel]).max() <= 1e-12, channel  # roundings


def test_a_linkage_that_needs_two_turns_is_refused(class_iii: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """By a turn that is said to end in another pose: the angle does not tell which pose it is."""
    monkeypatch.setattr(continuation, "SAME_POSE_TOL", -1.0)
    why = "after one turn of the crank coupler, plate, upper, lower are in another"
    with pytest.raises(Failure, match=why) as caught:
        analytic.solve(class_iii, TURN)
    assert caught.value.status is Status.unsupported


@sampled(2)
@pytest.mark.parametrize(("start", "end"), [(40, 80), (-110, 230), (90, 61), (780, 800), (-200, -170), (60, 390)])
def test_on_part_of_a_turn_the_angle_does_tell(
    class_iii: Scene, solve: Solver, start: int, end: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The sketch, at 60 degrees, is within the part, at its end, or outside, in whatever turn."""
    ends = np.radians([start, end]).tolist()
    drive = ConstantSpeed(1.0 if end > start else -1.0, *ends)
    position = drive.after(np.linspace(0, 1, 60))
    expected = solve(position)
    monkeypatch.setattr(continuation, "SAME_POSE_TOL", -1.0)
    motion = analytic.solve(class_iii.with_law(drive), position)
    for channel in ("D.x", "plate.angle", "C.y"):
        assert np.abs(motion[channel] - expected[channel]).max() <= 1e-14, channel  # from other poses, roundings

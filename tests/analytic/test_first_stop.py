"""What stops the drive first, as it goes: a dyad that another one hangs before in the file, or assemblies that meet."""

from math import acos, degrees
from pathlib import Path

import numpy as np
import pytest

import analytic
import scenes
from compare.mechanics.reference import uncertified
from scenes import Failure, Scene
from tests import scene_files
from tests.comparisons import sampled

# A crank of 40 mm, 120 mm from the feet of two dyads that are in line where its end is 60 + 50 and 35 + 60 mm away.
LATER, FIRST = (degrees(acos((40**2 + 120**2 - (a + b) ** 2) / (2 * 40 * 120))) for a, b in ((60, 50), (35, 60)))


def two_stops(drive: scene_files.Changes) -> Scene:
    bars = {"crank": ("O-A", 40), "ab": ("A-B", 60), "cb": ("C-B", 50), "ae": ("A-E", 35), "fe": ("F-E", 60)}
    return scene_files.load(
        "four_bar",
        {
            "units": {"length": "mm", "angle": "deg", "speed": "deg/s"},
            "ground.points": {"O": [0, 0], "C": [120, 0], "F": [120, 0]},
            "bodies": {name: {"lengths": {pair: length}} for name, (pair, length) in bars.items()},
            "drive": {"body": "crank", **drive},
            "sketch": {"angle": 20, "A": [38, 14], "B": [85, 45], "E": [65, -8]},
            "output": {"point": "B"},
            **dict.fromkeys(("gravity", "tolerances")),
        },
    )


@pytest.mark.parametrize("sign", [1, -1])
def test_the_joint_that_stops_the_crank_first_is_named(sign: int) -> None:
    scene = two_stops({"speed": 10 * sign, "start": 5, "end": 90 * sign})
    with pytest.raises(Failure) as caught:
        uncertified(scene)
    assert caught.value.reason.startswith("E cannot be reached at crank angle ")
    assert "ab and cb" not in caught.value.reason
    assert caught.value.at is not None
    position, joint = caught.value.at
    assert joint == "E"
    assert 0 <= sign * degrees(position) - FIRST <= 95 / 720  # deg: a sample of the way beyond it
    with pytest.raises(Failure, match=f"E cannot be reached at crank angle {sign * (int(FIRST) + 1)}"):
        analytic.solve(scene, np.radians(sign * np.arange(5, 90)))


def test_a_crank_that_goes_to_and_fro_stops_at_the_end_that_it_comes_to_first() -> None:
    law = {"law": [[0, 5], [1, -50], [2, 50], [3, 5]], "periodic": True}
    with pytest.raises(Failure) as caught:
        uncertified(two_stops(law))
    assert caught.value.at is not None
    assert -50 <= degrees(caught.value.at[0]) <= -FIRST


def windows(count: int, folder: Path, length: float = 1.0) -> Scene:
    """Equal bars, one beside the other, from upright down to beyond where all are in line, at 0."""
    posts = {f"l{i}": {"lengths": {f"A{i}-B{i}": length}} for i in range(count + 1)}
    beams = {f"c{i}": {"lengths": {f"B{i - 1}-B{i}": length}} for i in range(1, count + 1)}
    tables = {
        "format": 1,
        "name": "windows",
        "ground": {"points": {f"A{i}": [i * length, 0] for i in range(count + 1)}},
        "bodies": posts | beams,
        "drive": {"body": "l0", "speed": -1, "start": 1.5707963267948966, "end": -1.5},
        "sketch": {"angle": 1.5707963267948966, **{f"B{i}": [i * length, length] for i in range(count + 1)}},
        "output": {"point": f"B{count}"},
    }
    file = folder / "windows.toml"
    file.write_text(scene_files.toml(tables), encoding="utf-8")
    return scenes.load(file)


@sampled(2)
@pytest.mark.parametrize(("count", "length"), [(1, 1.0), (2, 1.0), (3, 1.0), (4, 0.7), (2, 0.3)])
def test_a_folded_rhombus_is_in_line_all_the_way_and_stops_nothing(count: int, length: float, tmp_path: Path) -> None:
    """Beyond 0 the first window may fold onto the ground: then all others are in line wherever the drive is."""
    with pytest.raises(Failure) as caught:
        uncertified(windows(count, tmp_path, length))
    reason = caught.value.reason.replace("-0.000000", "0.000000")
    assert reason == (
        "two ways of assembling the bodies meet at crank angle 0.000000 rad: l1 and c1 in line at B1"
        "; drive.start and drive.end can limit a run to within 0.000000 rad to 3.141593 rad"
    )


def test_assemblies_meet_where_they_are_in_line_and_nowhere_by_roundings(tmp_path: Path) -> None:
    """At 0 and half a turn, with which all are on one circuit; as the two of a parallelogram are."""
    for scene, joints in ((windows(2, tmp_path), {"B1", "B2"}), (scene_files.load("parallelogram"), {"C"})):
        every = analytic.assemblies(scene).found
        assert {one.circuit for one in every} == {0}
        for one in every:
            assert {joint for _, joint in one.meets} == joints
            off = [np.sin(position) for position, _ in one.meets]
            assert np.abs(off).max() <= 1e-6  # rad: the root of roundings, to which bars in line are known


def test_the_range_round_the_sketch_is_named_and_drawn() -> None:
    """Of a parallelogram's turn: from 0 to half a turn every point stays on its circle, of the crank's radius."""
    scene = scene_files.load("parallelogram", {"drive.start": 0})
    with pytest.raises(Failure, match=r"limit a run to within -?0\.000000 rad to 3\.141593 rad") as caught:
        uncertified(scene)
    way = analytic.stopped(scene, caught.value.at)
    assert way is not None
    assert (way.joint, way.meets) == ("C", True)
    assert np.array(way.ways) == pytest.approx(np.array([[0, np.pi]]), abs=1e-6)
    off = np.hypot(way.motion["G.x"] - 0.5, way.motion["G.y"]) - 0.3
    assert np.abs(off).max() <= 1e-7  # m: the root of roundings at both ends
    locked = two_stops({"speed": 10, "start": 5, "end": 90})
    stopped = analytic.stopped(locked, (np.radians(FIRST + 0.1), "E"))
    assert stopped is not None
    assert not stopped.meets

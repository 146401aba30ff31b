"""Larger groups are on one branch all the way, or nothing is proven: some poses followed are another assembly's."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import tau
from typing import Any

import numpy as np
import pytest

import analytic
from analytic.core.decomposition import decompose
from analytic.core.groups.continuation import Track
from analytic.core.groups.group_equations import Group
from analytic.core.groups.newton_group import length_of
from analytic.core.kinematics import followed
from analytic.proven import boxes, branches
from analytic.recorded.arithmetics.taylor_models import TaylorModel
from analytic.solve import prepared
from scenes import Failure, Scene
from scenes.model.motion import Samples
from scenes.scene import Sketch
from tests import scene_files
from tests.comparisons import SLOW, sampled

LARGER = ("class_iii", "dump_truck", "scissor_lift", "slotted_class_iii", "class_iii_among_dyads", "triad", "lift")
PART = 0.3, 0.45  # of the range, where another assembly is followed
APART = 0.1  # of the group's size, or rad: so far apart its poses are from the other's

Tracks = Mapping[Group, Track]


def others(scene: Scene) -> Iterator[Tracks]:
    """The branches of other assemblies of a scene's one larger group whose Jacobian has the same sign."""
    ((group, own),) = followed(scene, decompose(scene)).tracks.items()
    for one in analytic.assemblies(scene, circuits=False).found:
        points = {at: (float(one.motion[f"{at}.x"][0]), float(one.motion[f"{at}.y"][0])) for at in scene.moving_points}
        drawn = replace(scene, sketch=Sketch(scene.sketch.drive, points))
        try:
            other = followed(drawn, decompose(drawn)).tracks[group]
        except Failure:  # it does not come back after a turn
            continue
        start = np.array([scene.sketch.drive])
        off = length_of(own.guess(start)[0] - other.guess(start)[0], own.equations.size)
        if other.branch == own.branch and off > APART * own.equations.size:
            yield {group: other}


def swapped(scene: Scene, tracks: Tracks, part: tuple[float, float]) -> Tracks:
    """The scene's own branch, but another's on a part of the range."""
    least, most = scene.drive.law.extent
    low, high = (least + share * (most - least) for share in part)
    made = {}
    for group, own in followed(scene, decompose(scene)).tracks.items():
        other = tracks[group].rows((tracks[group].position > low) & (tracks[group].position < high))
        kept = own.rows((own.position < low) | (own.position > high))
        names = ("position", "q", "dq", "ddq")
        rows: dict[str, Any] = {x: np.concatenate([getattr(kept, x), getattr(other, x)]) for x in names}
        made[group] = replace(own, **rows).rows(np.argsort(rows["position"]))
    return made


def open_at(monkeypatch: pytest.MonkeyPatch, scene: Scene, tracks: Tracks) -> tuple[float, float] | None:
    """Where it is not proven that a scene assembles by some tracks."""
    monkeypatch.setattr(boxes, "prepared", lambda of, whole, names: prepared(of, replace(whole, tracks=tracks), names))
    return analytic.enclose(scene, {f"{group.bodies[0]}.angle" for group in tracks}).open_at


@sampled(1)
@pytest.mark.parametrize("name", LARGER)
def test_one_branch_is_proven(name: str) -> None:
    found = boxes.Boxes(scene_files.load(name), None, {}).branches
    assert found is not None
    assert np.isfinite(found.poses.rest).all()


def assert_noticed(monkeypatch: pytest.MonkeyPatch, name: str, part: tuple[float, float], first: float) -> None:
    """Another assembly in some boxes is, at a first place, where boxes meet; each box has a pose by itself."""
    scene = scene_files.load(name)
    least, most = scene.drive.law.extent
    tracks = next(each for each in others(scene) if open_at(monkeypatch, scene, each) is None)
    mixed = swapped(scene, tracks, part)
    found = open_at(monkeypatch, scene, mixed)
    assert found is not None
    assert np.ptp(found) < 1e-6 * (most - least)
    assert abs(found[0] - (least + first * (most - least))) < max(track.step for track in mixed.values())
    monkeypatch.setattr(branches, "_same", lambda _x, _s, y, *_: np.ones(y.rest.shape[-1], np.bool_))
    assert open_at(monkeypatch, scene, mixed) is None


@SLOW
def test_another_assembly_in_some_boxes_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert_noticed(monkeypatch, "lift", PART, PART[0])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["scissor_lift", "triad"])
def test_another_assembly_in_some_boxes_of_others_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    assert_noticed(monkeypatch, name, PART, PART[0])


@pytest.mark.parametrize(
    ("gained", "periodic", "unknown"),
    [
        ((0.0, 1.0), False, 0),
        ((0.0, 1.0), True, 2),
        ((0.0, tau), True, 0),
        ((tau, 0.0), True, 2),
        ((0.0, 2.0), True, 2),
    ],
)
def test_a_turn_closes_where_the_last_box_has_the_first_one_s_pose(
    gained: tuple[float, float], periodic: bool, unknown: int
) -> None:
    """A body that a turn brings back, or by so many m or rad further: whole turns of its angle are none."""

    def poses(low: Samples, high: Samples) -> TaylorModel:
        x, angle = gained
        c = np.zeros((3, 3, len(low)))
        c[0], c[1] = ([[x], [0.0], [angle]] * ends for ends in ((low + high) / 2, (high - low) / 2))
        return TaylorModel(c, np.full((3, len(low)), 1e-6))

    edges = np.linspace(0.0, 1.0, 9)
    found = branches.branches(poses, (edges[:-1], edges[1:]), 1000, periodic=periodic)
    doubtful = np.flatnonzero(np.isnan(found.poses.rest).any(axis=0))
    assert [*doubtful] == [0, len(found.low) - 1][:unknown]
    assert ((found.high - found.low)[doubtful] <= branches.MIN_BOX).all()

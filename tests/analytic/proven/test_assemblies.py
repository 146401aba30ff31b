"""All assemblies: counts from elsewhere, Newton's method from many starts in other coordinates, and circuits."""

from contextlib import suppress
from functools import partial
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import analytic
import scenes
from scenes import Failure, Scene
from scenes.scene import GROUND
from tests import scene_files
from tests.absolute_bodies import Floats
from tests.absolute_coordinates import Absolute
from tests.clean_scenes import clean_scenes
from tests.comparisons import sampled

# By Newton's method from 2,000 starts each. Watt's second dyad reaches on one branch of the first alone.
COUNTS = {"four_bar": 2, "watt_six_bar": 2, "stephenson_six_bar": 4, "walking_leg": 8, "andrews_squeezer": 4}
APART = 1e-6  # of the span: two solutions
LARGER = ["class_iii", "dump_truck", "scissor_lift", "class_iii_among_dyads", "slotted_class_iii"]


def places(scene: Scene) -> Floats:
    """Where the moving points are in each assembly, shape (assemblies, points), complex."""
    motions = [one.motion for one in analytic.assemblies(scene, circuits=False).found]
    z = [[complex(motion[f"{p}.x"][0], motion[f"{p}.y"][0]) for p in scene.moving_points] for motion in motions]
    return np.reshape(z, (len(motions), len(scene.moving_points)))


def by_newton(scene: Scene, starts: int) -> Floats:
    """The same by Newton's method from random poses of all bodies, but for those that turn a slider or crank round."""
    model, rng, at = Absolute(scene), np.random.default_rng(0), scene.sketch.drive
    points = [(next(body for body in scene.owners[p] if body != GROUND), p) for p in scene.moving_points]
    found: list[Any] = []
    for _ in range(starts):
        angle = rng.uniform(-np.pi, np.pi, len(scene.bodies))
        first = 3 * model.span * rng.uniform(-1, 1, (len(scene.bodies), 2))
        Q = np.append(np.column_stack([first, np.cos(angle), np.sin(angle)]).ravel(), 1.0)
        for _ in range(80):
            try:
                step = model.correction(Q, at)
            except np.linalg.LinAlgError:
                break
            size = float(np.abs(step.reshape(-1, 4) / (model.span, model.span, 1, 1)).max())
            Q[:-1] -= step / max(1.0, size)
            if size < 1e-12:
                z = np.array([complex(*(model.point(body, p) @ Q)) for body, p in points])
                if _meant(model, Q, at) and all(np.abs(z - one).max() > APART * model.span for one in found):
                    found.append(z)
                break
    return np.reshape(found, (len(found), len(points)))


def _meant(model: Absolute, Q: Floats, at: float) -> bool:
    """Whether sliders and crank point where they are asked to, and not the other way, which is the same equation."""
    scene, x_axis = model.scene, partial(model.vector, local=(1.0, 0.0))
    pairs = [(name, slide.on, 0.0) for name, slide in scene.slides.items()]
    if scene.drive.slide is None:
        pairs.append((scene.drive.body, scene.drive.on, at))
    return all((x_axis(one) @ Q) @ (model.vector(on, (np.cos(a), np.sin(a))) @ Q) > 0 for one, on, a in pairs)


def assert_none_missed(scene: Scene, starts: int) -> int:
    """Hold what Newton's method finds against all assemblies, and return how many it finds."""
    own, found = places(scene), by_newton(scene, starts)
    for z in found:
        off = np.abs(own - z).max(axis=1).min(initial=np.inf)
        assert off <= APART * Absolute(scene).span, scene.name
    return len(found)


@pytest.mark.parametrize("name", COUNTS)
def test_counts(name: str) -> None:
    every = analytic.assemblies(scenes.load(name), circuits=False)
    assert every.complete
    assert len(every.found) == COUNTS[name]
    assert [one.meant for one in every.found] == [True] + [False] * (COUNTS[name] - 1)


# Guides cross in one place, so that the counts are of the other dyads; by Newton's method from 150 starts the same.
CROSSING = {"scotch_yoke": 1, "oldham": 1, "tangent": 1, "slotted_crank": 1, "carried_yoke": 2, "cross_slide": 2}


@pytest.mark.parametrize("name", CROSSING)
def test_guides_that_cross_are_assembled_once(name: str) -> None:
    scene = scene_files.load(name)
    every = analytic.assemblies(scene)
    assert every.complete
    assert len(every.found) == CROSSING[name]
    assert [one.meant for one in every.found] == [True] + [False] * (CROSSING[name] - 1)
    assert [one.meets for one in every.found] == [[]] * CROSSING[name]  # guides that are parallel cross nowhere


@sampled(1)
@pytest.mark.parametrize("name", LARGER)
def test_larger_groups_in_other_coordinates(name: str) -> None:
    scene = scenes.load(name) if name in scenes.shipped() else scene_files.load(name)
    assert analytic.assemblies(scene, circuits=False).complete
    assert assert_none_missed(scene, 25) > 0


SLOW, STUDY = pytest.mark.slow, pytest.mark.study
MANY = [*COUNTS, *CROSSING, *LARGER, "excavator_bucket", "quick_return"]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=SLOW if number % 3 == 0 else STUDY) for number, name in enumerate(MANY)]
)
def test_newton_from_many_starts(name: str) -> None:
    assert assert_none_missed(scenes.load(name) if name in scenes.shipped() else scene_files.load(name), 300) > 0


@pytest.mark.study
def test_random_scenes(tmp_path: Path) -> None:
    counts = []
    for scene in clean_scenes(tmp_path, 200):
        with suppress(Failure):
            analytic.solver(scene)
            counts.append(assert_none_missed(scene, 60))
    assert np.count_nonzero(counts) >= 0.95 * len(counts) > 0  # it finds none where every guide turns: two of 200


def test_a_triad_with_six_assemblies() -> None:
    """The platform on three bars that papers on the direct kinematics of planar robots have as their example.

    Feet (0, 0), (15.91, 0), (0, 10), bars 14.98, 15.38, 12.0, sides of the platform 17.04, 16.54, 20.84. By elimination
    of its place: three circles about feet that turn with it are the difference of two lines' crossing and one circle.
    """
    a, b, c = 17.04, 16.54, 20.84
    tip = (a * a + c * c - b * b) / (2 * a)
    corners = np.array([0, a, tip + 1j * sqrt(c * c - tip * tip)])
    feet = np.array([0, 15.91, 10j]) - np.exp(1j * np.linspace(-np.pi, np.pi, 100_001))[:, np.newaxis] * corners
    line = feet - feet[:, :1]
    right = (np.abs(feet) ** 2 - np.abs(feet[:, :1]) ** 2 - np.array([14.98, 15.38, 12.0]) ** 2 + 14.98**2) / 2
    det = line[:, 1].real * line[:, 2].imag - line[:, 2].real * line[:, 1].imag
    x = right[:, 1] * line[:, 2].imag - right[:, 2] * line[:, 1].imag
    y = line[:, 1].real * right[:, 2] - line[:, 2].real * right[:, 1]
    left = (x - feet[:, 0].real * det) ** 2 + (y - feet[:, 0].imag * det) ** 2 - (14.98 * det) ** 2
    assert np.count_nonzero(np.diff(np.sign(left))) == 6

    every = analytic.assemblies(scene_files.load("triad"))
    assert every.complete
    assert len(every.found) == 6
    assert every.found[0].meant


def test_circuits_of_a_toggle_press() -> None:
    """Its rod's other side is reached where the slider's dyad is stretched: of the two assemblies that do not turn."""
    every = analytic.assemblies(scenes.load("toggle_press"))
    turning = [one for one in every.found if not one.meets]
    meeting = [one for one in every.found if one.meets]
    assert len({one.circuit for one in turning}) == 2
    assert len({one.circuit for one in meeting}) == 1
    assert {one.circuit for one in meeting}.isdisjoint(one.circuit for one in turning)
    for one in meeting:
        assert [joint for _, joint in one.meets] == ["P5", "P5"]
        for position, _ in one.meets:  # both assemblies are in one place there
            two = [z for z in places_at(scenes.load("toggle_press"), position) if np.isfinite(z).all()]
            apart = [np.abs(a - b).max() for n, a in enumerate(two) for b in two[:n]]
            assert min(apart, default=0.0) <= 1e-4  # m: the root of the last place of 0.3 m, with which they part


def places_at(scene: Scene, position: float) -> Floats:
    found = analytic.assemblies(scene, position, circuits=False).found
    return np.array(
        [[complex(one.motion[f"{p}.x"][0], one.motion[f"{p}.y"][0]) for p in scene.moving_points] for one in found]
    )


def test_where_a_dyad_can_turn_by_itself_not_all_is_known() -> None:
    """Peaucellier's rhombus folds, so that two of its pins are in one place and its outer bars turn about it."""
    assert not analytic.assemblies(scenes.load("peaucellier"), circuits=False).complete


def test_a_group_that_is_too_large_has_the_pose_that_is_followed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("analytic.proven.assemblies.MAX_BOXES", 10)
    every = analytic.assemblies(scenes.load("class_iii"))
    assert [one.meant for one in every.found] == [True]
    assert not every.complete


@pytest.mark.parametrize(("name", "position", "count"), [("toggle_press", 100.0, 4), ("double_toggle_clamp", 0.9, 0)])
def test_positions_beyond_the_first_turn_and_out_of_reach(name: str, position: float, count: int) -> None:
    every = analytic.assemblies(scenes.load(name), position)
    assert len(every.found) == count
    assert every.complete
    assert all(one.circuit is not None for one in every.found)

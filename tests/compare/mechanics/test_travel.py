"""The largest distance between two positions, and verdicts by each point's own travel."""

from dataclasses import replace

import numpy as np
import pytest

from compare.engines.runner import Run, run
from compare.judge.measure import Standard, assess
from compare.mechanics.reference import Reference, uncertified
from compare.mechanics.scales import chord
from scenes import Motion, Sampling, Status
from tests import scene_files

SAMPLING = Sampling(72)
DRAW = np.random.default_rng(7)
TURN = 2 * np.pi * np.arange(361) / 360
NORMAL = DRAW.standard_normal((2, 200))
PLACES = {
    "of a circle": np.exp(1j * TURN),
    "of an odd polygon": np.exp(2j * np.pi * np.arange(7) / 7),
    "of a curve with inflections": np.exp(1j * TURN) + 0.3 * np.exp(7j * TURN),
    "of a figure of eight": np.cos(TURN) + 0.5j * np.sin(2 * TURN + 0.3),
    "at random": NORMAL[0] + 1j * NORMAL[1],
    "on a grid": DRAW.integers(0, 4, 50) + 1j * DRAW.integers(0, 4, 50),
    "on a line": np.cos(TURN) * np.exp(0.3j),
    "upright": 1j * np.cos(TURN),
    "at rest in three places": np.repeat([0, 1, 0.3 + 0.8j], 20) + 1e-16 * NORMAL[0, :60],
    "far away": 1e6 + 1e-3 * np.exp(1j * TURN),
    "of two": np.array([1j, 2.0]),
    "of one": np.array([3.0 + 4j]),
}


@pytest.mark.parametrize("of", PLACES)
def test_the_largest_distance_is_that_of_all_pairs(of: str) -> None:
    places = PLACES[of].astype(complex)
    pairs = np.abs(places[:, None] - places)
    assert abs(chord(places)) == pytest.approx(pairs.max(), rel=1e-15)


def test_it_does_not_depend_on_the_frame() -> None:
    places = PLACES["of a figure of eight"]
    assert abs(chord(places * np.exp(0.7j))) == pytest.approx(abs(chord(places)), rel=1e-14)


@pytest.fixture(scope="module")
def beside_a_lever() -> Reference:
    """Return a slider that moves 37.5 mm, beside an output of 3.6 m on the crank."""
    crank = {"points": {"O": [0, 0], "A": [0.01875, 0], "T": [1.8, 0]}, "mass": 1, "com": [0, 0], "inertia": 0.1}
    sketch = {"angle": 0.5, "A": [0.0165, 0.009], "B": [0.116, 0], "T": [1.58, 0.86]}
    rod = {"lengths": {"A-B": 0.1}, "mass": 0.5}
    changes = {"bodies.crank": crank, "bodies.rod": rod, "sketch": sketch, "output": {"point": "T"}}
    return uncertified(scene_files.load("slider_crank", changes))


@pytest.fixture(scope="module")
def by_pymunk(beside_a_lever: Reference) -> Run:
    outcome = run("pymunk", beside_a_lever.scene, SAMPLING)
    assert assess(Standard.of(beside_a_lever, SAMPLING), outcome).run.status is Status.ok
    return outcome


@pytest.mark.parametrize("channel", ["B.x", "B.vx", "B.ax"])
def test_a_point_that_moves_little_is_judged_by_its_own_travel(
    beside_a_lever: Reference, by_pymunk: Run, channel: str
) -> None:
    assert by_pymunk.motion is not None
    values = by_pymunk.motion[channel]
    middle = (values.max() + values.min()) / 2
    wrong = Motion({**by_pymunk.motion.samples, channel: middle + 1.5 * (values - middle)})
    standard = Standard.of(beside_a_lever, SAMPLING)
    assert assess(standard, replace(by_pymunk, motion=wrong)).run.status is not Status.ok


def test_scales_of_points(beside_a_lever: Reference) -> None:
    """The guide's moment is nothing by symmetry: relative to its force times the travel of the slider."""
    w, scale = beside_a_lever.scene.drive.law.peak_rate, beside_a_lever.scale
    expected = {"B.x": 0.0375, "B.vx": 0.0375 * w, "B.ax": 0.0375 * w**2}
    expected["slider.guide_moment"] = 0.0375 * scale["slider.guide_force"]
    assert {channel: scale[channel] for channel in expected} == pytest.approx(expected, rel=1e-6)
    assert (beside_a_lever.stroke, scale["T.x"], scale["A.x"]) == pytest.approx((3.6, 3.6, 0.0375), rel=1e-12)


def test_no_point_is_judged_by_less_than_a_hundredth_of_the_largest_travel() -> None:
    crank = {"points": {"O": [0, 0], "A": [1, 0], "T": [1e-3, 0]}, "mass": 0, "com": [0, 0], "inertia": 0}
    sketch = {"angle": 0.5, "A": [0.9, 0.5], "B": [3.8, 0], "T": [9e-4, 5e-4]}
    reference = uncertified(scene_files.load("slider_crank", {"bodies.crank": crank, "sketch": sketch}))
    assert reference.scale["T.x"] == pytest.approx(2 / 100, rel=1e-12)

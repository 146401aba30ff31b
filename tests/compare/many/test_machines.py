"""Machines: drawn as the scene has it; the numbers of many, those of each alone, and formulas written here."""

from math import acos, sqrt

import numpy as np
import pytest

import scenes
from compare.measure.many import sobol
from compare.measure.many.machines import SAMPLES, draws, machines
from scenes import Status, numbers_in
from scenes.model.motion import Samples
from tests.comparisons import SLOW, sampled

from .runs import ROCKER, alone, many, reference

SAME = 1e-11  # of a number: extremes are placed to 1e-5 of a step, the dwell by quintics over steps of 2 deg
MASS = "bodies.toggle.mass"
TURNS = 1e-4  # where friction turns round: that is placed to a thousandth of a step
JUMP = 1e-6  # where a force comes or goes: that is placed to 1e-5 of a step, 4e-7 rad


def test_they_are_distributed_as_the_scene_has_it() -> None:
    """A Sobol sequence of 4096: each number is stratified, so that its moments are exact to about one in as many."""
    drawn = draws(scenes.load("toggle_press"), 7, 0, 4096)
    rocker, mass = drawn[ROCKER], drawn[MASS]
    assert rocker.mean() == pytest.approx(300, abs=1e-5)
    assert rocker.std() == pytest.approx(0.05 / 3, rel=1e-3)  # the tail is cut at 3.7 deviations
    assert np.mean(np.abs(rocker - 300) < 0.05) == pytest.approx(0.9973, abs=5e-4)  # two of them more or less
    assert mass.mean() == pytest.approx(250, abs=1e-3)
    assert mass.std() == pytest.approx(5 / sqrt(3), rel=1e-3)
    assert 245 <= mass.min() < 245.01
    assert 254.99 < mass.max() <= 255
    table = np.corrcoef([*drawn.values()])
    assert np.abs(table - np.eye(len(drawn))).max() < 0.01  # independent: 1 / sqrt(4096) of random ones


@SLOW
def test_the_directions_of_sobol_are_those_of_scipy() -> None:
    """Where nothing is scrambled, 512 points of every dimension of the table, shifted alike."""
    from scipy.stats.qmc import Sobol

    whole = Sobol(len(sobol._directions()), scramble=False, bits=sobol.BITS).random(512) * 2**sobol.BITS
    gray = np.arange(512) ^ np.arange(512) >> 1
    for own, expected in zip(sobol._directions(), whole.T.astype(int), strict=True):
        points = np.bitwise_xor.reduce(np.where(gray[:, None] >> np.arange(sobol.BITS) & 1, own, 0), axis=1)
        assert (points == expected).all()


def test_points_beyond_the_table_are_the_same_too() -> None:
    few, all_of_them = sobol.points(43, 5, 7, 4), sobol.points(43, 5, 0, 20)
    assert (few == all_of_them[7:11]).all()
    assert np.unique(all_of_them.round(9)).size == all_of_them.size


def test_a_machine_is_the_same_whatever_others_are_asked_for() -> None:
    scene = scenes.load("toggle_press")
    whole, part, other = draws(scene, 3, 0, 300), draws(scene, 3, 123, 45), draws(scene, 4, 0, 300)
    for path, values in whole.items():
        assert (values[123:168] == part[path]).all()
        assert (values != other[path]).all()


@sampled(1)
@pytest.mark.parametrize(
    ("name", "count"),
    [("toggle_press", 20), ("double_toggle_clamp", 4), pytest.param("double_toggle_clamp", 20, marks=pytest.mark.slow)],
)
def test_machines_agree_with_single_runs(name: str, count: int) -> None:
    """Picked by seed from a thousand."""
    drawn = draws(scenes.load(name), 5, 0, 1000)
    picked = np.random.default_rng(5).choice(1000, count, replace=False)
    same(name, {path: values[picked] for path, values in drawn.items()}, SAME)


@sampled(2)
@pytest.mark.parametrize(
    ("name", "changes", "tolerance"),
    [
        ("walking_leg", {"bodies.crank.lengths.O-A": [14.9, 15.1], "drive.speed": [31, 29]}, SAME),
        ("crank_press", {"loads.0.last": [5.9, 6.1]}, JUMP),
        ("offset_slider_crank", {"bodies.slider.slides.through.0": [15, 16], "drive.speed": [120, 110]}, SAME),
        ("offset_slider_crank", {"bodies.slider.slides.along.1": [0, 0.01]}, SAME),
        ("shaper", {"bodies.link.mass": [1, 2]}, JUMP),
        ("double_toggle_clamp", {"loads.0.table.0.0": [790, 795], "loads.0.table.1.0": [800, 797]}, SAME),
    ],
)
def test_other_linkages(name: str, changes: dict[str, list[float]], tolerance: float) -> None:
    same(name, {path: np.array(values, float) for path, values in changes.items()}, tolerance)


@sampled(2)
@pytest.mark.parametrize(
    ("name", "tolerance"),
    [
        *((name, SAME) for name in ("toggle_press", "double_toggle_clamp", "walking_leg", "four_bar", "watt_six_bar")),
        ("double_toggle_clamp_friction", TURNS),
    ],
)
def test_no_peak_is_lost_between_samples(name: str, tolerance: float) -> None:
    """Against eight times as many a cycle, of machines within tolerances, or with lengths off by up to 0.3 %."""
    rng, scene = np.random.default_rng(1), scenes.load(name)
    lengths = [path for path in scene.numbers if ".lengths." in path]
    off = 1 + 0.003 * rng.uniform(-1, 1, (12, len(lengths)))
    others = dict(zip(lengths, (np.array(numbers_in(scene, lengths)) * off).T, strict=True))
    changes = draws(scene, 0, 0, 12) if scene.variations else others
    few, more = (machines(reference(name), changes, samples) for samples in (SAMPLES, 8 * SAMPLES))
    assert few.running.tolist() == more.running.tolist() == [*range(12)]
    for found, finer in zip(few.numbers, more.numbers, strict=True):
        off_by = np.abs(found.value - finer.value) / finer.size
        assert not (off_by > tolerance).any(), (found.name, off_by.max())


def same(name: str, changes: dict[str, Samples], tolerance: float) -> None:
    solved = many(name, changes)
    for row, machine in enumerate(solved.running):
        one = alone(name, changes, int(machine))
        for number in solved.numbers:
            assert not abs(number.value[row] - one[number.name].value) > tolerance * number.size[row], number.name
    assert len(solved.running) == len(solved.status)


def test_a_slider_crank_by_its_formulas() -> None:
    """Crank r, rod l in line, slider of mass m at r w^2 (1 + r/l) where both are stretched out, load of 50 N."""
    r, rod, mass = np.array([1.0, 1.1, 0.9]), np.array([3.0, 2.9, 3.2]), np.array([2.0, 2.1, 2.3])
    changes = {"bodies.crank.points.A.0": r, "bodies.rod.lengths.A-B": rod, "bodies.slider.mass": mass}
    q = {number.name: number.value for number in many("slider_crank", changes).numbers}
    assert q["stroke"] == pytest.approx(2 * r, rel=SAME)
    assert q["closed dead point"] == pytest.approx(rod + r, rel=SAME)
    peak = 100 * r * (1 + r / rod)
    assert q["peak acceleration"] == pytest.approx(peak, rel=SAME)
    assert q["largest force at B"] == pytest.approx(mass * peak - 50, rel=SAME)
    assert q["least transmission angle"] == pytest.approx(np.arccos(r / rod), rel=SAME)
    assert q["distance to a singular pose"] == pytest.approx(rod - r, rel=SAME)
    near = 0.01 * 2 * r  # from the outer dead point: cosine law of the triangle of crank, rod and slider
    x = rod + r - near
    angle = [acos((a * a + d * d - b * b) / (2 * a * d)) for a, b, d in zip(r, rod, x, strict=True)]
    assert q["dwell within 1 % of the stroke"] == pytest.approx(2 * np.array(angle) / 10, rel=1e-9)  # by quintics


def test_a_machine_that_cannot_assemble_spoils_no_other() -> None:
    rod = np.array([3.0, 0.9, 3.1, 0.95])  # a rod shorter than the crank
    solved, whole = (many("slider_crank", {"bodies.rod.lengths.A-B": rod[rows]}) for rows in ([0, 1, 2, 3], [0, 2]))
    assert [status is Status.ok for status in solved.status] == [True, False, True, False]
    assert solved.running.tolist() == [0, 2]
    assert "B" in solved.reason[1]
    assert solved.reason[0] == ""
    for number, alike in zip(solved.numbers, whole.numbers, strict=True):
        assert (number.value == alike.value).all()
    nothing = many("slider_crank", {"bodies.rod.lengths.A-B": rod[[1, 3]]})
    assert (len(nothing.running), len(nothing.numbers)) == (0, 0)

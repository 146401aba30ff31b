"""Which assembly is followed, and that nothing but the sketch decides it."""

import re
from pathlib import Path

import numpy as np
import pytest

import scenes
from scenes import Motion, Sampling
from tests.mechanisms import QUICK_RETURN, SWINGING_BLOCK

from .runs import EPS, FOUR_BAR, TWO_RODS, Array, run, scene_of

flint = pytest.importorskip("flint")

from sim_models.multiprecision import constraints as multiprecision_linkage  # noqa: E402  (their engine is there)
from sim_models.multiprecision import engine as model  # noqa: E402
from sim_models.multiprecision import march as multiprecision_march  # noqa: E402


@pytest.fixture(scope="module")
def toggle() -> Motion:
    return run(scenes.load("toggle_press"), samples=720)


def test_mirrored_sketch_gives_the_mirrored_branch(tmp_path: Path) -> None:
    below = FOUR_BAR.replace("B = [3.6, 2.5]", "B = [3.6, -1.5]")

    def elbow(motion: Motion) -> Array:
        A, B = (motion[f"{point}.x"] + 1j * motion[f"{point}.y"] for point in "AB")
        return np.asarray((np.conj(B - A) * (4 + 0.5j - B)).imag)

    assert (elbow(run(scene_of(tmp_path, FOUR_BAR))) < 0).all()
    assert (elbow(run(scene_of(tmp_path, below))) > 0).all()


@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_two_links_near_their_lock_at_once_stay_on_their_branches(tmp_path: Path, gap: float) -> None:
    """The determinant would not tell: both flips together keep its sign."""
    motion = run(scene_of(tmp_path, TWO_RODS.replace("ROD", repr(1 + gap))), samples=10)
    angle, rod = motion["crank_angle"], 1 + gap
    reach = np.sqrt((rod - 1) * (rod + 1) + np.cos(angle) ** 2)
    # cos^2 in doubles, at worst 0.3 here
    np.testing.assert_allclose(motion["B.x"], np.cos(angle) + reach, rtol=0, atol=1e-14)
    np.testing.assert_allclose(motion["C.x"], np.cos(angle) - reach, rtol=0, atol=1e-14)


def test_contraction_of_newton_alone_keeps_the_branch(monkeypatch: pytest.MonkeyPatch, toggle: Motion) -> None:
    """The other guards off, a third of a turn is offered as one step; uncontracted Newton then flips the press."""
    monkeypatch.setattr(multiprecision_march, "HOMOTOPY", np.inf)
    monkeypatch.setattr(multiprecision_march, "LARGEST_TURN", 10.0)
    leaping = run(scenes.load("toggle_press"), samples=3)
    assert np.abs(leaping["P5.y"] - toggle["P5.y"][::240]).max() <= 4 * EPS  # the angles differ by rounding


def test_result_does_not_depend_on_the_way_there(tmp_path: Path) -> None:
    """A start at another angle, the same angles visited backwards: the same pose, and the same force if as fast."""
    scene = scenes.load("toggle_press")
    text = Path(scenes.LIBRARY / "toggle_press.toml").read_text()
    back = run(scene_of(tmp_path, text.replace("speed = 60\n", "speed = -60\n").replace("start = 0", "start = 360")))
    there = run(scene)
    for channel in ("P5.y", "P5.ay", "P3.fx", "drive.torque"):
        # The crank angles agree to a few units in the last place of a turn; the torque goes with dx/dθ.
        error = np.abs(back[channel][::-1] - there[channel]).max()
        assert error <= 100 * EPS * np.abs(there[channel]).max()


def test_bodies_that_slides_align_start_with_one_angle(tmp_path: Path) -> None:
    """Near half a turn, where the roundings of two sketches would put their angles a whole turn apart."""
    turned = SWINGING_BLOCK.replace("points = { C = [0, 0] }", "points = { C = [0, 0], Q = [-100, 0] }")
    turned = turned.replace("C = [300, 50]", "C = [-300, 1]").replace("along = [1, 0]", "along = [-1, 0]")
    turned = turned.replace("A = [80, 0]\nT = [570, 120]", "A = [80, 0]\nT = [-420, -25]\nQ = [-200, 2]")
    turned = turned.replace("speed = -120", "speed = -120\nstart = -90")
    scene = scene_of(tmp_path, turned)
    with flint.ctx.workdps(50):
        q = multiprecision_linkage.Linkage(scene).sketched_pose(scene.sketch.drive)
    assert abs(float(q[5, 0])) > 3
    assert float(q[5, 0]) == float(q[8, 0])
    motion = run(scene, samples=4)
    assert np.array_equal(motion["rod.angle"], motion["block.angle"])


def test_a_slider_that_no_sketch_shows_is_found(tmp_path: Path) -> None:
    """A cross slide: a carriage on the ground, and on it what the crank pin moves up and down."""
    text = """
format = 1
name = "cross_slide"
ground.points = { O = [0, 0] }
drive = { body = "crank", speed = 2.0, start = 1.0 }
output = { point = "A" }
sketch = { angle = 0.0, A = [1, 0] }
bodies.crank.points = { O = [0, 0], A = [1, 0] }
bodies.block.points = { A = [0, 0] }
bodies.block.slides = { on = "carriage", through = [0, 0], along = [0, 1] }
bodies.carriage.points = { K = [0, 0.5] }
bodies.carriage.slides = { through = [0, 3], along = [1, 0] }
"""
    motion = run(scene_of(tmp_path, text))
    np.testing.assert_allclose(motion["K.x"], np.cos(motion["crank_angle"]), rtol=0, atol=2 * EPS)
    np.testing.assert_allclose(motion["K.y"], 3.0, rtol=0, atol=0)


def test_a_unit_of_length_changes_nothing(tmp_path: Path) -> None:
    """Steps and proof are relative to the linkage's size, from picometres to petametres."""
    head, _, tail = QUICK_RETURN.replace("gravity = [0, -9.81]\n", "").partition("[[loads]]")
    kinematic = re.sub(r"(?m)^(mass|com|inertia) = .*\n", "", head + tail[tail.index("[sketch]") :])
    counters, tracks = [], []
    for unit in ("pm", "mm", "Tm"):
        scene = scene_of(tmp_path, kinematic.replace('length = "mm"', f'length = "{unit}"'))
        simulation = model.build(scene, model.DEFAULT, Sampling(36))
        simulation.solve()
        counters.append({**simulation.counters})
        tracks.append(simulation.read()["E.ax"] / scene.bodies["link"].lengths[frozenset("DE")])  # type: ignore[index]
    assert counters[0] == counters[1] == counters[2]
    np.testing.assert_allclose(tracks[0], tracks[1], rtol=0, atol=1e-12 * np.ptp(tracks[1]))  # lengths were rounded
    np.testing.assert_allclose(tracks[2], tracks[1], rtol=0, atol=1e-12 * np.ptp(tracks[1]))

"""Every channel against redundant coordinates and known figures; which assembly is followed, by the sketch alone."""

import numpy as np
import pytest

import scenes
from scenes import Sampling
from tests import scene_files
from tests.comparisons import SLOW, sampled

from ..formulations import ALL as SCENES
from ..formulations import off
from .runs import EPS, named, run, two_rods

flint = pytest.importorskip("flint")

from sim_models.multiprecision import continuation as multiprecision_continuation  # noqa: E402
from sim_models.multiprecision import engine as model  # noqa: E402
from sim_models.multiprecision.constraints import LinkageEquations  # noqa: E402  (their engine is there)
from sim_models.multiprecision.start import sketched_pose  # noqa: E402


@sampled(2)
@pytest.mark.parametrize("gap", [1e-3, 1e-6, 1e-9, 1e-12])
def test_two_links_near_their_lock_at_once_stay_on_their_branches(gap: float) -> None:
    """The determinant would not tell: both flips together keep its sign."""
    motion = run(two_rods(1 + gap), samples=10)
    angle, rod = motion["crank_angle"], 1 + gap
    reach = np.sqrt((rod - 1) * (rod + 1) + np.cos(angle) ** 2)
    # cos^2 in doubles, at worst 0.3 here
    np.testing.assert_allclose(motion["B.x"], np.cos(angle) + reach, rtol=0, atol=1e-14)
    np.testing.assert_allclose(motion["C.x"], np.cos(angle) - reach, rtol=0, atol=1e-14)


@SLOW
def test_contraction_of_newton_alone_keeps_the_branch(monkeypatch: pytest.MonkeyPatch) -> None:
    """The other guards off, a third of a turn is offered as one step; uncontracted Newton then flips the press."""
    toggle = named("toggle_press", 720)
    monkeypatch.setattr(multiprecision_continuation, "MAX_HOMOTOPY", np.inf)
    monkeypatch.setattr(multiprecision_continuation, "MAX_TURN", 10.0)
    leaping = run(scenes.load("toggle_press"), samples=3)
    assert np.abs(leaping["P5.y"] - toggle["P5.y"][::240]).max() <= 4 * EPS  # the angles differ by rounding


def test_bodies_that_slides_align_start_with_one_angle() -> None:
    """Near half a turn, where the roundings of two sketches would put their angles a whole turn apart."""
    changes = {
        "ground.points.C": [-300, 1],
        "bodies.rod.slides.along": [-1, 0],
        "bodies.block.points.Q": [-100, 0],
        "drive.start": -90,
        "sketch": {"angle": -90, "A": [80, 0], "T": [-420, -25], "Q": [-200, 2]},
    }
    scene = scene_files.load("swinging_block", changes)
    with flint.ctx.workdps(50):
        q = sketched_pose(LinkageEquations(scene), scene.sketch.drive)
    assert abs(float(q[5, 0])) > 3
    assert float(q[5, 0]) == float(q[8, 0])
    motion = run(scene, samples=4)
    assert np.array_equal(motion["rod.angle"], motion["block.angle"])


def test_a_slider_that_no_sketch_shows_is_found() -> None:
    """A cross slide: a carriage on the ground, and on it what the crank pin moves up and down."""
    motion = run(scene_files.load("crank_on_carriage"))
    np.testing.assert_allclose(motion["K.x"], np.cos(motion["crank_angle"]), rtol=0, atol=2 * EPS)
    np.testing.assert_allclose(motion["K.y"], 3.0, rtol=0, atol=0)


def test_a_unit_of_length_changes_nothing() -> None:
    """Steps and proof are relative to the linkage's size, from picometres to petametres."""
    kinematic = {**scene_files.without_masses("shaper"), "gravity": None}
    counters, tracks = [], []
    for unit in ("pm", "mm", "Tm"):
        scene = scene_files.load("shaper", {**kinematic, "units.length": unit})
        simulation = model.build(scene, model.DEFAULT, Sampling(36))
        simulation.solve()
        counters.append({**simulation.counters})
        tracks.append(simulation.read()["E.ax"] / scene.bodies["link"].lengths[frozenset("DE")])  # type: ignore[index]
    assert counters[0] == counters[1] == counters[2]
    np.testing.assert_allclose(tracks[0], tracks[1], rtol=0, atol=1e-12 * np.ptp(tracks[1]))  # lengths were rounded
    np.testing.assert_allclose(tracks[2], tracks[1], rtol=0, atol=1e-12 * np.ptp(tracks[1]))


def test_doubles_do_not_change_with_more_digits() -> None:
    scene = scenes.load("toggle_press")
    fifty, eighty = run(scene), run(scene, digits=80)
    for channel in scene.channels.names():
        # Rounded to nearest both times: equal, unless true value is zero (P5.x) and only the last digits of 50 remain.
        assert np.abs(fifty[channel] - eighty[channel]).max() <= 1e-40


ROUNDED = 1e-14  # of a channel's scale: what doubles leave in the other formulation
CONDITION = {"busy": 20, "slotted_class_iii": 3, "walking_leg": 2} | dict.fromkeys(
    ("double_toggle_clamp", "double_toggle_clamp_scheme4"), 5
)


@sampled(2)
@pytest.mark.parametrize("name", [*SCENES, "busy_bucket", "lift", "elbow"])
def test_every_channel_is_that_of_redundant_coordinates(name: str) -> None:
    """Poses on the sketch's branch, rates, forces of joints and of the drive, by Newton's and Euler's equations."""
    for channel, error in off(model, name).items():
        assert error <= ROUNDED * CONDITION.get(name, 1), channel

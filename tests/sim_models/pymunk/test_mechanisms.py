"""Scenes with every joint, drive and load: the pymunk model against absolute coordinates."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from scenes import Sampling, Scene
from scenes.motion import channels
from scenes.scene import MotionLaw
from sim_models.pymunk.constraints import Linkage
from sim_models.pymunk.engine import DEFAULT, PymunkSettings
from sim_models.pymunk.masses import ballasted_masses
from sim_models.pymunk.start import start, stroke_ends
from tests.absolute_coordinates import Absolute
from tests.conftest import SceneFrom
from tests.mechanisms import MECHANISMS

from .runs import DRIVEN_SLIDER, SLIDER_CRANK, errors, kind, reference, scene_of, solve

# A slider on a slider on the coupler of a four-bar, all of them eccentric.
CROSS_SLIDE = """
gravity = [1, -9.81]
ground.points = { O = [0, 0], C = [0.4, 0], F = [0.2, 0.15] }
drive = { body = "crank", speed = 9 }
output = { point = "B" }
bodies.crank = { lengths = { "O-A" = 0.08 }, mass = 1 }
bodies.rocker = { lengths = { "C-B" = 0.25 }, mass = 2 }
springs = [{ between = ["post.T", "rocker.B"], stiffness = 3000, length = 0.1 }]
sketch = { A = [0.08, 0], B = [0.375, 0.249] }
[bodies.coupler]
points = { A = [0.01, 0.005], B = [0.35, 0] }
mass = 4
com = [0.1, 0.04]
inertia = 0.05
[bodies.carriage]
points = { S = [0.005, 0.007] }
mass = 1.5
com = [0.03, -0.02]
inertia = 0.004
slides = { on = "coupler", through = [0, 0.03], along = [1, 0.2] }
[bodies.post]
points = { F = [-0.015, 0.02], T = [0, 0.09] }
mass = 2
slides = { on = "carriage", through = [0.003, 0.002], along = [0.1, -1] }
"""
# A slider that a law drives to and fro carries another; the force on it is the drive's alone.
DRIVEN_CARRIER = """
gravity = [0, -9.81]
ground.points = { C = [0.3, 0.25] }
output = { slider = "W" }
bodies.rocker = { lengths = { "C-P" = 0.2 }, mass = 2 }
loads = [{ body = "wedge", at = "W", force = [-300, 20], last = 0.04 }]
sketch = { displacement = 0, P = [0.11, 0.2] }
[drive]
body = "wedge"
law = [[0, 0], [0.2, 0.03], [0.5, 0.12], [0.8, 0.06], [1.1, 0]]
periodic = true
[bodies.wedge]
points = { W = [0.01, 0] }
mass = 4
com = [0.04, 0.03]
inertia = 0.05
slides = { through = [0, 0.01], along = [1, 0.1] }
[bodies.block]
points = { P = [0.02, 0.005] }
mass = 1.5
com = [0.03, -0.02]
inertia = 0.004
slides = { on = "wedge", through = [0, 0.03], along = [0.5, 1] }
"""
SCENES = dict(MECHANISMS) | {
    name: f"format = 1\nname = '{name}'\n{text}"
    for name, text in (("cross_slide", CROSS_SLIDE), ("driven_carrier", DRIVEN_CARRIER))
}


def beside_knots(scene: Scene, sampling: Sampling, step: float) -> NDArray[np.bool_]:
    """Return which samples have a knot of the law within a step, s: there the acceleration has a kink."""
    times = sampling.times(scene)
    if not isinstance(scene.drive, MotionLaw):
        return np.zeros(times.shape, dtype=np.bool_)
    knots = np.array(scene.drive.times if scene.drive.periodic else scene.drive.times[1:-1])
    return np.asarray(np.abs(times[:, None] - knots).min(axis=1) <= step)


@pytest.mark.parametrize("name", SCENES)
def test_mechanism_against_the_reference(name: str, scene_from: SceneFrom) -> None:
    scene, sampling = scene_from(SCENES[name]), Sampling(36)
    motion, expected = solve(scene, DEFAULT, sampling), reference(scene, sampling)
    assert set(motion.samples) == {"time", *expected} == set(channels(scene))
    found = errors(motion, expected)
    knots = beside_knots(scene, sampling, scene.drive.cycle / DEFAULT.steps)
    for channel, error in found.items():
        # Measured: 1e-6 of positions and 5e-6 of velocities, which the extrapolation leaves. 6e-4 of accelerations and
        # forces is what 2000 sweeps leave of the quick return near its dead point; 4000 leave 1e-5.
        tolerance = {"x": 5e-6, "vx": 2e-5, "angle": 5e-6, "omega": 2e-5}.get(kind(channel), 1e-3)
        assert error[~knots].max() <= tolerance, channel
        # The engine accelerates by the law's mean over a step: off by up to 1/18 of the kink times the coarse step.
        assert error.max() <= max(tolerance, 4e-3), channel


@pytest.mark.parametrize("name", ["quick_return", "swinging_block", "cross_slide", "driven_toggle", "turning_law"])
def test_mechanisms_are_second_order(name: str, scene_from: SceneFrom) -> None:
    scene, sampling = scene_from(SCENES[name]), Sampling(24)
    expected = reference(scene, sampling)
    coarse, fine = (errors(solve(scene, PymunkSettings("", n, 1, 6000), sampling), expected) for n in (288, 576))
    smooth = ~beside_knots(scene, sampling, scene.drive.cycle / 288)
    for order in {kind(channel) for channel in expected} - {kind(scene.drive_channel)}:
        first, second = (max(e[smooth].max() for c, e in by.items() if kind(c) == order) for by in (coarse, fine))
        if first > 1e-7:  # or it is rounding: a constant rate, a moment about the only point
            # Measured: within 0.03, as the term in dt^3 leaves. A groove beside a centre of mass makes it 1.
            assert np.log2(first / second) == pytest.approx(2, abs=0.1), order


@pytest.mark.parametrize("name", ["quick_return", "swinging_law", "driven_carrier"])
def test_stroke_ends_at_the_dead_point(name: str, scene_from: SceneFrom) -> None:
    scene = scene_from(SCENES[name])
    linkage = Linkage(scene, ballasted_masses)
    # Both end their Newton steps at rounding.
    assert stroke_ends(linkage, start(linkage)) == pytest.approx([*Absolute(scene).stroke_ends.values()], rel=1e-9)


def test_press_force_is_whole_or_absent_at_its_switch(tmp_path: Path) -> None:
    """Where the levels do not agree whether it acts, extrapolating would make it -1/3 or 4/3 of itself."""
    text = SLIDER_CRANK.replace("force = [-1000, 0]", "force = [-1000, 0]\nlast = 0.1")
    settings = [PymunkSettings("", steps, levels, 1000) for steps, levels in ((72, 1), (144, 1), (72, 2))]
    coarse, fine = (solve(scene_of(text, tmp_path), one, Sampling(72))["B.x"] for one in settings[:2])
    sample = 60  # on its way out, within a tenth of a metre of 0.4
    assert 0.3 < fine[sample] < 0.4
    between = scene_of(
        text.replace("last = 0.1", f"last = {0.4 - float(coarse[sample] + fine[sample]) / 2!r}"), tmp_path
    )
    # Of the levels alone, one has the force there and the other not.
    alone = [solve(between, one, Sampling(72))["A.fx"][sample] for one in settings[:2]]
    assert sorted(np.abs(np.round(alone))) == [0, 1000]
    both = solve(between, settings[2], Sampling(72))["A.fx"]
    assert both[sample] == pytest.approx(alone[1], abs=0.01)
    assert np.all((np.abs(both) < 1) | (np.abs(both - 1000) < 1))


def test_driven_slider_carries_its_load_alone(tmp_path: Path) -> None:
    motion = solve(scene_of(DRIVEN_SLIDER.replace("START", "0.38"), tmp_path))
    assert motion["drive.displacement"][[0, -1]] == pytest.approx([0.38, 0.25], abs=1e-12)
    # Nothing holds the crank back but inertia: the largest force is 1 kg times 0.3 m/s^2.
    assert motion["drive.force"] == pytest.approx(1000, abs=0.5)
    assert motion["slider.guide_moment"] == pytest.approx(-50, abs=0.05)

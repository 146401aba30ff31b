"""Scenes with every joint, drive and load: the pymunk model against absolute coordinates."""

import numpy as np
import pytest
from numpy.typing import NDArray

from scenes import Sampling, Scene
from scenes.scene import MotionLaw
from sim_models.pymunk.channels import Motions, with_rates_of_law
from sim_models.pymunk.constraints import LinkageConstraints
from sim_models.pymunk.engine import DEFAULT, EXACT, FAST
from sim_models.pymunk.loads import stroke_ends
from sim_models.pymunk.masses import fictitious_masses
from sim_models.pymunk.settings import PymunkSettings
from sim_models.pymunk.start import start
from tests import scene_files
from tests.absolute_coordinates import Absolute
from tests.agreement import errors, kind, worst
from tests.comparisons import sampled

from .runs import reference, slider_crank, solve

NAMES = (
    *scene_files.MECHANISMS,
    *("cross_slide", "driven_carrier", "toggle_press", "loaded_four_bar", "skew_sliders"),
)


def beside_knots(scene: Scene, sampling: Sampling, step: float) -> NDArray[np.bool_]:
    """Which samples have a knot of the law within a step, s: there the acceleration has a kink."""
    times = sampling.times(scene)
    if not isinstance(scene.drive.law, MotionLaw):
        return np.zeros(times.shape, dtype=np.bool_)
    knots = np.array(scene.drive.law.times if scene.periodic else scene.drive.law.times[1:-1])
    return np.asarray(np.abs(times[:, None] - knots).min(axis=1) <= step)


@sampled(2)
@pytest.mark.parametrize("name", NAMES)
def test_mechanism_against_the_reference(name: str) -> None:
    scene, sampling = scene_files.load(name), Sampling(36)
    motion, expected = solve(scene, DEFAULT, sampling), reference(scene, sampling)
    assert set(motion.samples) == {"time", *expected} == set(scene.channels.names())
    found = errors(motion, expected)
    for channel, error in found.items():
        # Measured: 1e-6 of positions and 3e-6 of velocities, which the extrapolation leaves; 3e-5 of accelerations and
        # forces, which the sweeps leave of the shaper near its dead point.
        tolerance = {"x": 5e-6, "vx": 2e-5, "angle": 5e-6, "omega": 2e-5}.get(kind(channel), 2e-4)
        assert error.max() <= tolerance, channel


@sampled(1)
@pytest.mark.parametrize("name", ["shaper", "swinging_block", "cross_slide", "driven_toggle", "turning_law"])
def test_mechanisms_are_second_order(name: str) -> None:
    scene, sampling = scene_files.load(name), Sampling(24)
    expected = reference(scene, sampling)
    coarse, fine = (errors(solve(scene, PymunkSettings("", n, 1, 6000), sampling), expected) for n in (288, 576))
    smooth = ~beside_knots(scene, sampling, scene.cycle / 288)
    for order in {kind(channel) for channel in expected} - {kind(scene.channels.drive.position)}:
        first, second = (max(e[smooth].max() for c, e in by.items() if kind(c) == order) for by in (coarse, fine))
        if first > 1e-7:  # or it is rounding: a constant rate, a moment about the only point
            # Measured: within 0.03, as the term in dt^3 leaves. A groove beside a centre of mass makes it 1.
            assert np.log2(first / second) == pytest.approx(2, abs=0.1), order


@sampled(1)
@pytest.mark.parametrize("name", ["shaper", "swinging_law", "driven_carrier"])
def test_stroke_ends_at_the_dead_point(name: str) -> None:
    scene = scene_files.load(name)
    # Both end their Newton steps at rounding.
    assert stroke_ends(scene) == pytest.approx([*Absolute(scene).stroke_ends.values()], rel=1e-9)


def test_press_force_is_whole_or_absent_at_its_switch() -> None:
    """It acts where the extrapolated motion has it; extrapolated from the levels, it would be 4/3 times itself."""
    settings = [PymunkSettings("", steps, levels, 1000) for steps, levels in ((72, 1), (144, 1), (72, 2))]
    coarse, fine = (solve(slider_crank({"loads.0.last": 1}), one, Sampling(72))["B.x"] for one in settings[:2])
    sample = 60  # on its way out, within a tenth of a metre of 0.4
    assert 0.3 < fine[sample] < 0.4
    between = slider_crank({"loads.0.last": 4 - 5 * float(coarse[sample] + fine[sample])})
    # Of the levels alone, one has the force there and the other not.
    alone = [solve(between, one, Sampling(72))["A.fx"][sample] for one in settings[:2]]
    assert sorted(np.abs(np.round(alone))) == [0, 1000]
    both = solve(between, settings[2], Sampling(72))["A.fx"]
    assert both[sample] == pytest.approx(alone[1], abs=0.01)
    assert np.all((np.abs(both) < 1) | (np.abs(both - 1000) < 1))


# Measured: 2e-4, 3e-5 and 2e-7; by the mean accelerations of the steps 3e-3, 1e-3 and 3e-4.
@sampled(1)
@pytest.mark.parametrize(("settings", "largest"), [(FAST, 1e-3), (DEFAULT, 1e-4), (EXACT, 2e-6)])
@pytest.mark.parametrize("name", ["swinging_law", "turning_law"])
def test_knots_cost_no_accuracy(name: str, settings: PymunkSettings, largest: float) -> None:
    scene, sampling = scene_files.load(name), Sampling(72)
    found = worst(errors(solve(scene, settings, sampling), reference(scene, sampling)))
    assert max(found.values()) <= largest, found


@pytest.mark.parametrize("name", ["swinging_law", "turning_law"])
def test_the_driven_body_has_the_rates_of_the_law_and_the_joints_stay_closed(name: str) -> None:
    linkage = LinkageConstraints(scene_files.load(name), fictitious_masses)
    q, law = start(linkage), linkage.scene.drive.law.at(np.zeros(1))
    _, v, a = with_rates_of_law(linkage, np.zeros(1), Motions(q, np.zeros_like(q), np.zeros_like(q)))
    opening = np.zeros(q.size - 1)
    for values, wanted in ((v, law.rate), (a, law.acceleration)):
        # Roundings, of rates up to some 100 1/s^2.
        assert linkage.jacobian(q)[0] @ values.ravel() == pytest.approx([*opening, wanted[0]], abs=1e-11)

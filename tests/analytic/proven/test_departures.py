"""How far channels leave the straight lines between neighbouring places: never further than is known."""

import numpy as np
import pytest

import analytic
import scenes
from scenes import Scene
from scenes.channels import named
from scenes.model.motion import Samples
from tests import scene_files

from .true_values import BY_DOUBLES, motion_at, peaks, turn, with_magnitudes


def departed(scene: Scene, edges: Samples) -> dict[str, float]:
    """By how much of a unit's peak the core leaves chords further than is known, by channel."""
    share = np.linspace(0, 1, 41)
    places = edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * share
    samples = with_magnitudes(scene, motion_at(scene, places.ravel()))
    peak, found = peaks(samples), dict[str, float]()
    for name, bound in analytic.departures(scene, edges).items():
        if name in samples and named(name).name != "angle":
            values = samples[name].reshape(places.shape)
            chord = values[:, :1] + (values[:, -1:] - values[:, :1]) * share
            beyond = np.abs(values - chord).max(axis=1) - bound
            found[name] = float(np.max(beyond)) / peak[named(name).unit]  # NaN where one is not known
    return found


@pytest.mark.parametrize("name", ["four_bar", "elements", pytest.param("class_iii", marks=pytest.mark.slow)])
def test_no_channel_departs_further_from_its_chords(name: str) -> None:
    scene = scene_files.load(name)
    found = departed(scene, turn(scene))
    assert len(found) > 20
    assert all(off <= BY_DOUBLES for off in found.values())


def test_departures_fall_with_the_square_of_the_width() -> None:
    scene = scenes.load("four_bar")
    wide, narrow = (analytic.departures(scene, turn(scene, count))["B.y"].max() for count in (1440, 2880))
    assert wide / narrow == pytest.approx(4, rel=0.02)  # terms of the third order, of a hundredth of the second


@pytest.mark.parametrize("name", ["crank_press", "servo_press"])
def test_departures_hold_over_jumps(name: str) -> None:
    scene = scenes.load(name)
    assert all(off <= BY_DOUBLES for off in departed(scene, turn(scene)).values())


def test_departures_hold_over_two_pieces_of_a_law() -> None:
    scene = scene_files.load("turning_law")
    assert all(off <= BY_DOUBLES for off in departed(scene, turn(scene, 40)).values())


def test_larger_groups_are_the_same_a_turn_further() -> None:
    scene, edges = scenes.load("class_iii"), np.linspace(1.0, 2.0, 9)
    first, third = (analytic.departures(scene, edges + turns * 2 * np.pi, {"C.x"})["C.x"] for turns in (0, 2))
    assert np.isfinite(first).all()
    assert np.allclose(first, third, rtol=1e-6)

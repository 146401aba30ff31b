"""The pymunk model against facts that these tests work out by themselves."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import fsolve

import scenes
from scenes import Motion, Sampling, Scene
from scenes.motion import channels
from sim_models.pymunk.settings import PymunkSettings
from tests import scene_files

from .runs import Array, off, slider_crank, solve


def vector(motion: Motion, channel: str, quantity: str) -> NDArray[np.complex128]:
    """Return x + iy: `vector(motion, "P5", "a")` is P5.ax + i P5.ay."""
    return motion[f"{channel}.{quantity}x"] + 1j * motion[f"{channel}.{quantity}y"]


def cross(a: NDArray[np.complex128], b: NDArray[np.complex128] | complex) -> Array:
    return np.imag(np.conj(a) * b)


def derivative(values: Array) -> Array:
    """Return d(values)/d(phase) over a turn, whose last sample repeats the first, by its Fourier series."""
    spectrum = np.fft.rfft(values[:-1])
    slope = np.fft.irfft(1j * np.arange(len(spectrum)) * spectrum, n=len(values) - 1)
    return np.append(slope, slope[0])


# --- the toggle press ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def press() -> Scene:
    return scenes.load("toggle_press")


@pytest.fixture(scope="module")
def pressed(press: Scene) -> Motion:
    return solve(press)


def press_height(crank_angle: float) -> float:
    """Return the slider's height, m, by a Newton solve of the five squared distances and nothing from the package."""
    P2 = np.array([404.709 + 77 * np.cos(crank_angle), -217.661 + 77 * np.sin(crank_angle)])

    def errors(p: Array) -> list[float]:
        P3, P4, P5 = p[:2], p[2:4], np.array([0, p[4]])
        bars = ((P3, 0 * P3, 300), (P3, P2, 490), (P4, P3, 490), (P4, P2, 760), (P5, P4, 300))
        return [float((a - b) @ (a - b)) - length**2 for a, b, length in bars]

    found, _, success, _ = fsolve(errors, [0, -300, 0, -790, -1090], full_output=True, xtol=1e-13)
    assert success == 1
    return float(found[4]) / 1000


def test_press_gives_every_channel(press: Scene, pressed: Motion) -> None:
    assert set(pressed.samples) == set(channels(press))
    assert {values.shape for values in pressed.samples.values()} == {(361,)}


def test_press_moves_as_its_lengths_say(pressed: Motion) -> None:
    chosen = slice(0, 361, 20)
    expected = np.array([press_height(angle) for angle in pressed["crank_angle"][chosen]])
    # Measured: 4e-7 of the stroke; with one level it is 2e-4.
    assert np.max(np.abs(pressed["P5.y"][chosen] - expected)) <= 2e-6 * 0.1836


def test_press_facts(pressed: Motion) -> None:
    # Known from an independent solve, to the digits given; a sample is at most 0.5 deg off the true peak.
    assert np.ptp(pressed["P5.y"]) == pytest.approx(0.1836316, abs=1e-5)
    assert pressed["P5.vy"].min() == pytest.approx(-0.7166, abs=1e-4)
    assert pressed["P5.vy"].max() == pytest.approx(0.8650, abs=1e-4)
    assert pressed["P5.ay"].min() == pytest.approx(-10.328, abs=2e-3)
    assert pressed["P5.ay"].max() == pytest.approx(5.473, abs=2e-3)
    assert np.abs(pressed["drive.torque"]).max() == pytest.approx(13888, abs=2)


def test_second_order_at_one_level(press: Scene) -> None:
    reference = solve(press, PymunkSettings("", 144, 3, 2000), Sampling(72))
    motions = [solve(press, PymunkSettings("", steps, 1, 2000), Sampling(72)) for steps in (288, 576)]
    for channel in ("P5.y", "P5.vy", "P5.ay", "P4.fx", "P4.fy", "slider.guide_force", "drive.torque"):
        coarse, fine = (off(motion[channel], reference[channel]) for motion in motions)
        # Measured: within 0.01. Half a step of misalignment makes it 1.
        assert np.log2(coarse / fine) == pytest.approx(2, abs=0.05), channel


def test_extrapolation_removes_two_orders(press: Scene) -> None:
    heights = {}
    for levels in (1, 2, 3):
        motion = solve(press, PymunkSettings("", 72, levels, 2000), Sampling(72))
        heights[levels] = np.abs(motion["P5.y"][::6] - [press_height(angle) for angle in motion["crank_angle"][::6]])
    # Measured: 110 each time; smaller steps alone, without the extrapolation, would give 4.
    assert heights[2].max() <= heights[1].max() / 20
    assert heights[3].max() <= heights[2].max() / 20


def test_many_turns_repeat(press: Scene) -> None:
    motion = solve(press, PymunkSettings("", 360, 1, 2000), Sampling(72, turns=3))
    first, last = slice(0, 73), slice(144, 217)
    # Measured: 1e-12, since the steps before zero have warmed up the joints by the first turn.
    for channel in ("P5.y", "P4.fy", "drive.torque"):
        assert off(motion[channel][last], motion[channel][first]) <= 1e-10, channel
    assert motion["crank_angle"][-1] == pytest.approx(6 * np.pi, rel=1e-12)


def test_mirror_image_moves_and_pulls_mirrored(pressed: Motion) -> None:
    changes = {"ground.points.P1.0": -404.709, "drive.speed": -60, "drive.start": 180, "sketch.angle": 168.5}
    motion = solve(scenes.load("toggle_press", {**changes, "sketch.P2.0": -480}))
    # Both runs do the same sums on mirrored numbers; rounding, amplified by dt^-2, tells them apart.
    for channel, sign in (("P4.x", -1), ("P5.y", 1), ("P4.fx", -1), ("P4.fy", 1), ("drive.torque", -1)):
        assert off(motion[channel], sign * pressed[channel]) <= 1e-9, channel
    assert off(motion["slider.guide_force"], -pressed["slider.guide_force"]) <= 1e-9


# --- signs by hand ---------------------------------------------------------------------------------------------------


def test_slow_slider_crank_is_statics() -> None:
    motion = solve(slider_crank())
    theta = motion["crank_angle"]
    tan = 0.1 * np.sin(theta) / np.sqrt(0.09 - (0.1 * np.sin(theta)) ** 2)  # of the rod's slope, down towards B
    # Inertia forces at 0.1 rad/s: a few times 1 kg * 0.1 m * (0.1 rad/s)^2 = 1e-3 N, 1e-6 of the load.
    for pin in ("O", "A", "B"):
        assert motion[f"{pin}.fx"] == pytest.approx(1000, abs=0.01)
        assert off(motion[f"{pin}.fy"], -1000 * tan) <= 1e-5
    assert off(motion["slider.guide_force"], 1000 * tan) <= 1e-5
    assert motion["slider.guide_moment"] == pytest.approx(-1000 * 0.05, abs=0.001)
    assert off(motion["drive.torque"], -1000 * 0.1 * (np.sin(theta) + np.cos(theta) * tan)) <= 1e-5


# --- a four-bar with everything --------------------------------------------------------------------------------------


def test_four_bar_with_gravity_turning_backwards() -> None:
    motion = solve(scene_files.load("loaded_four_bar"))
    B, C, T = (vector(motion, point, "") for point in "BCT")
    crank = np.exp(1j * motion["crank_angle"])
    assert motion["crank_angle"][-1] == pytest.approx(2 - 2 * np.pi)
    # Measured: 2e-7 at most, with the extrapolation's square of the step; 5 times that is still no visible error.
    assert np.abs(B - (1 + 2j - 0.6 * crank)).max() <= 1e-6  # the crank's x axis runs from B to A
    assert np.abs(np.abs(C - (3 + 2.5j)) - 1.5).max() <= 1e-6
    assert np.abs((T - B) / (C - B) - (1 + 1.2j) / (2.1 + 0.3j)).max() <= 1e-6  # not mirrored

    for quantity, order in (("v", 1), ("a", 2)):
        for point in "BCT":
            for axis in "xy":
                expected = motion[f"{point}.{axis}"]
                for _ in range(order):
                    expected = 7 * derivative(expected)
                # Measured: 9e-8.
                assert off(motion[f"{point}.{quantity}{axis}"], expected) <= 1e-6

    # Newton and Euler on the coupler and the crank, by the channels alone, about B and about A. The coupler is the
    # first in the file: its pins' forces are its own on the others.
    tip = vector(motion, "B", "a"), vector(motion, "T", "a")
    share = (0.8 + 0.4j) / (1 + 1.2j)
    a_com, arm = tip[0] + (tip[1] - tip[0]) * share, (T - B) * share
    load, gravity = 30 - 20j, 0.5 - 9.81j
    at_A, at_B, at_C = (vector(motion, pin, "f") for pin in "ABC")
    # The forces reach 290 N; 1e-5 N is measured, since extrapolation does not commute with the products here.
    assert np.abs(-at_B - at_C + load + 3 * (gravity - a_com)).max() <= 1e-3
    moment = cross(C - B, -at_C) + cross(T - B, load) + cross(arm, 3 * (gravity - a_com))
    assert np.abs(moment - 0.7 * motion["coupler.alpha"]).max() <= 1e-3
    radius = B - (1 + 2j)
    assert np.abs(at_A + at_B + 2 * (gravity + 49 * radius / 2)).max() <= 1e-3
    torque = motion["drive.torque"] + cross(radius, at_B) + cross(radius / 2, 2 * gravity)
    assert np.abs(torque).max() <= 1e-3


# --- three bodies at one pin -----------------------------------------------------------------------------------------


def test_two_rods_on_one_crank_pin() -> None:
    motion = solve(scene_files.load("skew_sliders"))
    a_A, a_B, a_C = (vector(motion, point, "a") for point in "ABC")
    # The forces reach 50 N; 2e-6 N is measured, for extrapolation does not commute with products.
    assert np.abs(vector(motion, "A", "f") - vector(motion, "B", "f") - 0.5 * (a_A + a_B) / 2).max() <= 1e-4
    assert np.abs(vector(motion, "A/right", "f") - vector(motion, "C", "f") - 0.7 * (a_A + a_C) / 2).max() <= 1e-4
    on_crank = vector(motion, "O", "f") - vector(motion, "A", "f") - vector(motion, "A/right", "f")
    assert np.abs(on_crank - 1 * a_A / 2).max() <= 1e-4
    across = np.exp(0.75j * np.pi) * 1j  # the piston's `along`, turned by +90 degrees
    assert np.abs(vector(motion, "B", "f") + motion["piston.guide_force"] * across - 0.8 * a_B).max() <= 1e-4
    # The guide is at 135 degrees; the sweeps end 3.7e-8 off it.
    assert off(motion["B.vx"], -motion["B.vy"]) <= 1e-6


def test_kinematic_scene_has_no_forces() -> None:
    scene = scene_files.load("loaded_four_bar", scene_files.without_masses("loaded_four_bar"))
    assert set(solve(scene).samples) == set(channels(scene))
    assert "drive.torque" not in channels(scene)

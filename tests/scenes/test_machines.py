"""What the drives of the shipped machines take, by hand: virtual work on geometry of its own, a gas force, dampers."""

import tomllib
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import analytic
import scenes
from tests import scene_files

from .test_library import Places, meet

Samples = NDArray[np.floating]
Machine = Callable[[Samples], tuple[Samples, Samples]]  # from an angle, rad: the drive's displacement, m; energy, J
G = 9.81
STILL = {"drive.speed": 1e-6}  # mm/s, or rpm: nothing accelerates, no damper takes anything


def turned(angle: Samples) -> Places:
    unit: Places = np.exp(1j * angle)
    return unit


def scissor_lift(angle: Samples) -> tuple[Samples, Samples]:
    """By the angle of the rising bar, whose mirror image the falling one is."""
    foot, height = 2.4 * np.cos(angle), 2.4 * np.sin(angle)
    p = foot + (0.05 + 0.05j) * turned(np.pi - angle)
    q = (1.65 + 0.06j) * turned(angle)
    way, line = np.abs(q - p), (q - p) / np.abs(q - p)
    weights = 2 * 40 * height / 2 + (150 + 3) * height + (28 * (p + 0.32 * line) + 12 * (q - 0.35 * line)).imag
    energy: Samples = G * weights + 10e3 * height
    return way, energy


def excavator_bucket(angle: Samples) -> tuple[Samples, Samples]:
    """By the angle of the rocker; the resistance is a moment about D wherever the bucket is."""
    a, g = -2.05 + 0.62j, -0.42 + 0.06j
    b = g + 0.62 * turned(angle)
    c = meet(b, 0.58, np.zeros_like(b), np.hypot(0.12, 0.444))
    curl = np.unwrap(np.angle(c / (-0.12 + 0.444j)))
    way, line = np.abs(b - a), (b - a) / np.abs(b - a)
    link = 0.58 * 0.110 * 0.100 * 7850
    cylinder = 110 * (a + 0.6 * line) + 70 * (b - 0.5 * line)
    weights = cylinder + 45 * (g + b) / 2 + link * (b + c) / 2 + 850 * (0.65 + 0.35j) * turned(curl)
    return way, G * weights.imag - 60e3 * 1.45 * curl


def dump_truck(angle: Samples) -> tuple[Samples, Samples]:
    """By the angle of the tub, without its load."""
    a, l = 0.63 - 0.61j, 0.21 - 0.28j  # noqa: E741 - as the scene names it
    p = (1.96 - 0.05j) * turned(angle)
    e = meet(p, np.hypot(0.24, 0.49), np.full_like(p, l), 2.007)
    b = p + (0.74 - 0.24j) * (e - p) / (0.24 - 0.49j)
    way, line = np.abs(b - a), (b - a) / np.abs(b - a)
    cylinder = 90 * (a + 0.6 * line) + 60 * (b - 0.6 * line)
    weights = cylinder + 1200 * (2 + 0.45j) * turned(angle) + 70 * (p + e + b) / 3 + 55 * (l + e) / 2
    return way, G * weights.imag


def garage_door(angle: Samples) -> tuple[Samples, Samples]:
    """By the angle of the arm, which goes on below -180 deg; springs of 0.15 N m/deg, without moment at -1836 deg."""
    g = 0.3 + 1.15j
    b = g + 0.9014 * turned(angle)
    t = b.real + np.sqrt(1.75**2 - (2.05 - b.imag) ** 2) + 2.05j
    weights = 8 * (g + b) / 2 + 60 * (t + (b - t) / 1.75) + 2 * t
    springs = np.degrees(0.15) * (angle + np.radians(1836)) ** 2 / 2
    energy: Samples = G * weights.imag + springs
    return t.real, energy


def by_virtual_work(machine: Machine, angle: Samples) -> tuple[Samples, Samples]:
    """The displacement, m, and dU/ds, N, by differences of fourth order, which are good to 1e-11."""
    far, near = ([np.array(machine(angle + side * h)) for side in (1, -1)] for h in (2e-3, 1e-3))
    way, energy = 8 * (near[0] - near[1]) - (far[0] - far[1])
    return machine(angle)[0], energy / way


@pytest.mark.parametrize(
    ("machine", "first", "last"),
    [(scissor_lift, 12, 41.8), (excavator_bucket, 106, 35), (garage_door, -118, -249)],
)
def test_the_drive_lifts_what_weighs(machine: Machine, first: float, last: float) -> None:
    way, force = by_virtual_work(machine, np.radians(np.linspace(first, last, 50)))
    found = analytic.solve(scenes.load(machine.__name__, STILL), way)["drive.force"]
    assert not (np.abs(found - force) > 1e-9 * np.abs(force).max()).any()


def test_the_dump_truck_at_rest() -> None:
    """Before it is raised, with its load, and while it dwells, when that has slid out."""
    scene = scenes.load("dump_truck")
    low, high = scene.drive.law.extent
    angle = np.radians(np.linspace(0, 51, 5001))
    for way, time, load in ((low, 0.0, 60e3), (high, 18.0, 0.0)):

        def loaded(angle: Samples, load: float = load) -> tuple[Samples, Samples]:
            way, energy = dump_truck(angle)
            return way, energy + load * ((1.8 + 0.7j) * turned(angle)).imag

        at = np.interp(way, dump_truck(angle)[0], angle)
        _, force = by_virtual_work(loaded, np.array([at]))
        found = analytic.solve(scene, [way], [time])["drive.force"]
        assert abs(found[0] / force[0] - 1) <= 1e-6  # of the angle that is between the rows


def test_a_gas_force_over_two_turns() -> None:
    """The torque is the force times dx/dtheta, a slider-crank's; a third turn is the first again."""
    table = tomllib.loads(scene_files.text("four_stroke_engine"))["loads"][0]["table"]
    angle, (r, l) = np.radians(np.arange(1080) + 0.25), (0.043, 0.143)  # noqa: E741
    force = np.interp(np.degrees(angle) % 720, *np.transpose(table))  # N, towards the crank
    rate = -r * np.sin(angle) - r**2 * np.sin(angle) * np.cos(angle) / np.sqrt(l**2 - (r * np.sin(angle)) ** 2)
    found = analytic.solve(scenes.load("four_stroke_engine", STILL), angle)["drive.torque"]
    assert not (np.abs(found - force * rate) > 1e-12 * np.abs(force * rate).max()).any()


def test_dampers_take_the_shakers_power() -> None:
    """Over a cycle; the rates are by the Fourier series of the beam's own angle and of the spring's length."""
    scene, count = scenes.load("damped_shaker"), 512
    time = 0.2 / count * np.arange(count)
    waves = (8e-3 * np.sin(10 * np.pi * time), 2e-3 * np.sin(30 * np.pi * time + np.pi / 3))
    exciter = 0.25 - 0.2j + 1j * np.add(*waves)
    b = meet(np.zeros_like(exciter), 0.26, exciter, 0.195)
    angle = np.angle(b)
    length = np.abs(0.6 * turned(angle) - (0.62 - 0.28j))

    def rate(periodic: Samples) -> Samples:
        return np.fft.irfft(2j * np.pi / 0.2 * np.arange(count // 2 + 1) * np.fft.rfft(periodic), count)

    taken = 400 * rate(length) ** 2 + np.degrees(0.02) * rate(angle) ** 2  # W
    motion = analytic.solve(scene, scene.drive.law.at(time).position, time)
    given = motion["drive.force"] * rate(exciter.imag)
    assert abs(given.mean() / taken.mean() - 1) <= 1e-11  # sums over a cycle are exact but for round-off
    assert taken.mean() > 10  # W

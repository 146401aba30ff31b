"""The shipped clamps: by the formulas and the table of their source."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.typing import NDArray

import analytic
import scenes
from scenes import Motion, Scene
from scenes.scene import Force
from tests.agreement import solve as moving

Angles = NDArray[np.float64]


@dataclass(frozen=True)
class Clamp:
    """A column of the source's table 2, and its formulas; m and deg."""

    L1: float
    L2: float
    L4: float
    L5: float
    Hb: float
    theta: float
    gamma: float
    alpha_max: float
    travel: float  # mm
    platen_travel: float  # mm
    stroke_ratio: float
    largest_velocity_ratio: float
    force_ratio: float  # at alpha = 2.5 deg

    def angles(self, alpha: Angles) -> tuple[Angles, Angles, Angles, Angles]:
        """Return AB's and AD's above the horizontal, BC's below it, DE's above it towards the tail."""
        bar = np.radians(self.theta) + alpha
        ear = bar + np.radians(self.gamma)
        height = (self.L1 + self.L2) * np.sin(np.radians(self.theta))
        beta = np.arcsin((self.L1 * np.sin(bar) - height) / self.L2)
        return bar, ear, beta, np.arcsin((self.Hb - self.L5 * np.sin(ear)) / self.L4)

    def crosshead(self, alpha: Angles) -> Angles:
        _, ear, _, phi = self.angles(alpha)
        return self.L5 * np.cos(ear) - self.L4 * np.cos(phi)

    def platen(self, alpha: Angles) -> Angles:
        bar, _, beta, _ = self.angles(alpha)
        return self.L1 * np.cos(bar) + self.L2 * np.cos(beta)

    def velocity_ratio(self, alpha: Angles) -> Angles:
        bar, ear, beta, phi = self.angles(alpha)
        return self.L1 * np.sin(bar + beta) * np.cos(phi) / (self.L5 * np.sin(ear + phi) * np.cos(beta))

    def at(self, scene: Scene, alpha: Angles) -> Motion:
        crosshead = self.crosshead(alpha)
        return analytic.solve(scene, crosshead, (crosshead - scene.drive.start) / 0.1)


CLAMPS = {
    "double_toggle_clamp": Clamp(
        *(0.352, 0.457, 0.120, 0.305, 0.2355, 4.5, 19.4, 110), 566.04116, 574.47572, 1.0149010, 1.63040, 20.10666
    ),
    "double_toggle_clamp_scheme4": Clamp(
        *(0.368, 0.430, 0.135, 0.280, 0.239, 4.0, 18.0, 105), 546.76579, 600.47753, 1.0982354, 1.79600, 22.73834
    ),
}


@pytest.mark.parametrize("name", ["double_toggle_clamp", "double_toggle_clamp_scheme4"])
def test_clamp_by_the_formulas_of_its_source(name: str) -> None:
    clamp, scene = CLAMPS[name], scenes.load(name)
    alpha = np.radians(np.linspace(clamp.alpha_max, 0, 10_001))
    motion = clamp.at(scene, alpha)
    assert np.abs(np.array(scene.drive.extent) - clamp.crosshead(alpha)[[0, -1]]).max() <= 1e-15  # m; as many digits
    assert np.abs(motion["C.x"] - clamp.platen(alpha)).max() <= 1e-14  # m, rounding
    assert (motion["D.x"] > motion["E.x"]).all()  # E is on the tail side of D throughout
    ratio = motion["C.vx"] / motion["E.vx"]
    assert np.abs(ratio - clamp.velocity_ratio(alpha)).max() <= 1e-13  # rounding
    crosshead, platen = scene.drive.extent[1] - scene.drive.extent[0], motion["C.x"][-1] - motion["C.x"][0]
    assert abs(1e3 * crosshead - clamp.travel) <= 5e-6  # mm; this and the rest to the digits given
    assert abs(1e3 * platen - clamp.platen_travel) <= 5e-6
    assert abs(platen / crosshead - clamp.stroke_ratio) <= 5e-8
    assert abs(ratio.max() - clamp.largest_velocity_ratio) <= 5e-6


@pytest.mark.parametrize("name", ["double_toggle_clamp", "double_toggle_clamp_scheme4"])
def test_clamp_multiplies_a_force_as_its_source_says(name: str) -> None:
    clamp, scene = CLAMPS[name], scenes.load(name)
    massless = {body.name: replace(body, mass=0.0) for body in scene.bodies.values()}
    at_rest = replace(scene, bodies=massless, loads=(Force("platen", "C", (-1.0, 0.0)),))
    thrust = clamp.at(at_rest, np.radians([2.5]))["drive.force"][0]
    assert abs(1 / thrust - clamp.force_ratio) <= 5e-6  # the digits given


@pytest.mark.parametrize("name", ["double_toggle_clamp", "double_toggle_clamp_scheme4"])
def test_clamp_locks(name: str) -> None:
    scene = scenes.load(name)
    motion = moving(scene, scene.drive.cycle * np.array([0.9, 1.0]))
    B, C = (motion[f"{point}.x"] + 1j * motion[f"{point}.y"] for point in "BC")
    assert abs((B.conjugate() * C).imag[1]) <= 1e-15  # m^2, rounding; A, B and C are in line,
    assert (
        motion["C.vx"][0] >= 1e-3 >= 1e12 * abs(motion["C.vx"][1])
    )  # m/s; so the platen stands, as it did not before,
    assert abs(motion["C.fx"][1] - 2e6) <= 1e3  # N; holds half of 4000 kN, to the digits of the table,
    assert abs(motion["drive.force"][1]) <= 10  # N; and takes no thrust but that of inertia


def test_clamp_table_rounds_a_length() -> None:
    for name, rounded, off in (("double_toggle_clamp", 120, 0.00096), ("double_toggle_clamp_scheme4", 134, -0.46995)):
        clamp = CLAMPS[name]
        L3_squared = clamp.L1**2 + clamp.L5**2 - 2 * clamp.L1 * clamp.L5 * np.cos(np.radians(clamp.gamma))
        assert abs(1e3 * np.sqrt(L3_squared) - rounded - off) <= 5e-6  # mm, the digits given

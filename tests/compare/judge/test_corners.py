"""Peaks that are corners: where a force bends, between samples too."""

import numpy as np
import pytest
from scipy.optimize import brentq

import analytic
from tests import scene_files
from tests.compare.judge.test_peaks import numbers


def test_a_corner_between_samples_is_found() -> None:
    """The clamp's force stops rising at the last entry of its table; the platen is there where bisection says."""
    changes = {"loads.0.table.0.0": 795, "loads.0.table.1.0": 800}
    scene = scene_files.load("double_toggle_clamp", changes)
    slide = scene.bodies["platen"].slide
    assert slide is not None

    def at(position: float) -> dict[str, float]:
        return {name: float(values[0]) for name, values in analytic.solve(scene, [position]).samples.items()}

    def beyond(position: float) -> float:
        now, point = at(position), scene.bodies["platen"].points[0]
        return float(np.dot(slide.along, [now[f"{point}.x"], now[f"{point}.y"]] - np.array(slide.through))) - 0.8

    corner = at(brentq(beyond, 0.14, 0.18, xtol=1e-14))
    force = numbers("double_toggle_clamp", changes)["largest force at D"].value
    assert force == pytest.approx(np.hypot(corner["D.fx"], corner["D.fy"]), rel=1e-9)  # without a sample there: 1e-6


@pytest.mark.parametrize("over", ["drive", "time", "displacement"])
def test_a_corner_of_any_table_is_found(over: str) -> None:
    """A force on a gas spring's rod that is largest at one entry, between samples, and seen in its drive's effort."""
    scene, row = scene_files.load("gas_spring"), 1234.567891
    turn = float(scene.cycle)
    at = analytic.solve(scene, [row / 3600 * 2 * np.pi]).samples
    along = np.exp(1j * at["cylinder.angle"][0])
    apart = at["R.x"][0] - 0.7 + 1j * (at["R.y"][0] + 0.15)
    entry = {
        "drive": row / 10,
        "time": row / 3600 * turn,
        "displacement": 1e3 * float((apart * along.conjugate()).real),
    }
    width = {"drive": 36, "time": 0.1 * turn, "displacement": 20}[over]
    table = [[entry[over] + way * width, force] for way, force in ((-1, 0), (0, 4000), (0.3, 0), (9, 0))]
    periodic = {"periodic": True} if over != "displacement" else {}
    changes = {"loads": [{"body": "rod", "over": over, "table": table} | periodic]}
    there = analytic.solve(scene_files.load("gas_spring", changes), [row / 3600 * 2 * np.pi]).samples
    largest = numbers("gas_spring", changes)["largest force at G"].value
    assert largest >= np.hypot(there["G.fx"][0], there["G.fy"][0]) * (1 - 1e-9)  # 1e-5 less at the samples alone

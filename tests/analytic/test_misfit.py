"""By how much a linkage that cannot be assembled fails to close, by hand and in the unit of the file."""

from math import hypot

import numpy as np
import pytest

import analytic
from scenes import Failure
from tests import scene_files


def reason(name: str, changes: scene_files.Changes, position: float) -> str:
    with pytest.raises(Failure) as caught:
        analytic.solve(scene_files.load(name, changes), [position])
    return caught.value.reason


def test_rrr() -> None:
    """B is at 0.6 from A, C at 0.05 from D and at |2.1 + 0.3i| from B: too long a coupler."""
    B = 1 + 2j - 0.6 * np.exp(3.5j)
    apart = hypot(2.1, 0.3) - 0.05 - abs(3 + 2.5j - B)
    found = reason("loaded_four_bar", {"bodies.rocker.lengths.C-D": 0.05}, 3.5)
    assert found.startswith(
        f"C cannot be reached at crank angle 3.500000 rad: coupler and rocker end {apart:.4g} m apart;"
    )


def test_rpr() -> None:
    """The guide passes the block's pin at 300 mm, which the pins of rod and block are not apart."""
    apart = 300 - hypot(300 - 80, 50)
    found = reason("swinging_block", {"bodies.rod.slides.through": [0, 300]}, -np.pi / 2)
    assert f"deg: rod and block end {apart:.4g} mm apart;" in found


def test_a_larger_group() -> None:
    """From A at -10 to E at 2 there are bars of 3, 1 and 3 in line; D is then 3 under F, as its bar is long."""
    apart = {
        "bodies.crank.points.A": [10, 0],
        "ground.points.F": [0, 3],
        "sketch": {"angle": np.pi, "A": [-10, 0], "B": [-2, 0.2], "C": [-1, 0.1], "D": [0, 0]},
    }
    found = reason("parallel_bars", apart, np.pi)
    assert found.startswith(
        "one, plate, two, three do not close near the sketch, at crank angle 3.141593 rad: with all"
    )
    assert found.endswith(" stays open by 5 m")

"""Forces along a guide, a damper without a direction, and a cylinder whose sketch is on neither side."""

import numpy as np
import pytest

from scenes import Failure
from tests import scene_files
from tests.closed_forms.engines import by_name
from tests.closed_forms.springs import pushed_out
from tests.closed_forms.test_elements import check

from .runs import run

flint = pytest.importorskip("flint")


A, D, SPEED = 0.4j, 0.6, 0.1  # of the bucket


def test_forces_along_a_guide_act_at_their_point() -> None:
    """A force at C, beside B, turns rod and cylinder apart, which their guide's moment about B holds."""
    at_B, at_C = (
        run(scene_files.load("swung_bucket", {"loads": [{"body": "rod", "at": at, "force": 3}]})) for at in ("B", "C")
    )
    beside = ((0.18 + 0.07j) * (0.8 - 0.6j)).imag
    np.testing.assert_allclose(at_C["rod.guide_moment"] - at_B["rod.guide_moment"], 3 * beside, atol=1e-14)
    np.testing.assert_allclose(at_C["drive.force"], at_B["drive.force"], atol=1e-14)


def test_damper_whose_ends_meet_is_refused() -> None:
    damper = {"between": ["ground.A", "rod.C"], "damping": 2}
    at = {"bodies.cylinder.points.A": [0, 0], "bodies.rod.points": {"B": [0, 0], "C": [-0.625, 0]}, "drive.start": 0.5}
    at["bodies.rod.slides"] = {"on": "cylinder", "through": [0, 0], "along": [1, 0]}
    with pytest.raises(Failure, match=r"ground\.A and rod\.C meet at rod at 0\.625 m"):
        run(scene_files.load("swung_bucket", {"springs": [damper], **at}), 2)


def test_a_cylinder_that_is_drawn_nearer_than_its_guide_is_pushed_out_too() -> None:
    """The sketch leaves the sign of its displacement open, for which other models refuse it."""
    row, (held,) = pushed_out((0.06, 0.05)), by_name("50 digits")
    check(held, row, row.scene())

"""Every channel of every scene against redundant coordinates, and poses against their derivatives at 50 digits."""

import pytest

from scenes import Scene
from tests import scene_files

from ..formulations import ALL as SCENES
from ..formulations import off
from .runs import ALL, closed, continuing

flint = pytest.importorskip("flint")

from sim_models.multiprecision import constraints as multiprecision_constraints  # noqa: E402  (their engine is there)
from sim_models.multiprecision import engine as model  # noqa: E402

ROUNDED = 1e-14  # of a channel's scale: what doubles leave in the other formulation
CONDITION = {"busy": 20, "slotted_class_iii": 3, "walking_leg": 2} | dict.fromkeys(
    ("double_toggle_clamp", "double_toggle_clamp_scheme4"), 5
)


@pytest.mark.parametrize("name", SCENES)
def test_every_channel_is_that_of_redundant_coordinates(name: str) -> None:
    """Poses on the sketch's branch, rates, forces of joints and of the drive, by Newton's and Euler's equations."""
    for channel, error in off(model, name).items():
        assert error <= ROUNDED * CONDITION.get(name, 1), channel


@pytest.fixture(params=ALL)
def scene(request: pytest.FixtureRequest) -> Scene:
    return scene_files.load(request.param)


def test_differences_of_poses_are_the_derivatives_in_multiple_precision(scene: Scene) -> None:
    """A step of 1e-10 leaves 1e-20 of the third and fourth derivatives, which are below 1e4 here."""
    with flint.ctx.workdps(50):
        linkage = multiprecision_constraints.LinkageEquations(scene)
        continuation, rows = continuing(linkage), linkage.constraints
        at, h = flint.arb(scene.drive.start), flint.arb("1e-10").mid()
        q = continuation.follow(closed(linkage, continuation), linkage.drive(at))
        after, before = (continuation.follow(q, linkage.drive(at + step)) for step in (h, -h))
        J = rows.jacobian(q)
        slope = J.solve(linkage.drive(1.0))
        curvature = J.solve(rows.centripetal(q, slope))
        first = (after - before) * (1 / (2 * h)) - slope
        second = (after - q * flint.arb(2) + before) * (1 / (h * h)) - curvature
        assert max(abs(float(entry)) for entry in first.entries()) <= 1e-16
        assert max(abs(float(entry)) for entry in second.entries()) <= 1e-16

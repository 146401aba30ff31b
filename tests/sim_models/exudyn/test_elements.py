"""The Exudyn model on every kind of load, spring and drive at once: its unit of force, and the order of its steps."""

import numpy as np
import pytest

from scenes.drive import CYLINDERS
from scenes.elements import PLAIN_KINDS
from sim_models.exudyn.drive import ExudynDrive
from sim_models.exudyn.engine import EXACT
from sim_models.exudyn.settings import TimeStepping
from sim_models.exudyn.system import ExudynSystem
from tests.closed_forms.drives import LIFT
from tests.closed_forms.row import FIRST_KINDS, described

from .helpers import run

# A cylinder that lifts a weight, faster, with a mass of the lever's own, and every kind of load and spring.
EVERYTHING = LIFT.replace("1e-7", "1.0").replace(
    "drive =",
    """
loads = [
  { body = "lever", at = "W", force = [3, 40], frame = "body" },
  { body = "rod", force = -20 },
  { body = "cylinder", moment = 9 },
  { body = "lever", at = "W", over = "time", along = [2, 1], table = [[-1, 0], [9, 100]] },
]
torsion_springs = [
  { at = "D", between = ["ground", "lever"], stiffness = 5, angle = 1, damping = 4 },
  { at = "B", between = ["rod", "lever"], stiffness = 2, angle = 1 },
]
springs = [{ between = ["ground.A", "lever.W"], damping = 11 }]
drive =""",
)


@pytest.mark.parametrize(
    ("small", "large"),
    [
        ("force = -20", "force = -2e9"),
        ("moment = 9", "moment = 9e9"),
        ("[9, 100]", "[9, 1e9]"),
        ("stiffness = 5", "stiffness = 5e9"),
        ("damping = 4", "damping = 4e9"),
        ("damping = 11", "damping = 1e9"),
    ],
)
def test_unit_of_force_goes_by_every_kind(small: str, large: str) -> None:
    assert small in EVERYTHING
    assert 1e8 <= ExudynSystem(described(EVERYTHING.replace(small, large)), ExudynDrive()).force_unit <= 1e11


def test_time_steps_tend_to_the_pointwise_solution() -> None:
    """With every kind that is smooth, by the order of two extrapolated integrations."""
    scene = described(EVERYTHING)
    assert scene.kinds >= FIRST_KINDS - PLAIN_KINDS - {"friction"} | {CYLINDERS}
    exact = run(scene, EXACT, samples=36)

    def off(steps: int, channel: str) -> float:
        motion = run(scene, TimeStepping("", steps=steps), samples=36)
        return float(np.abs(motion[channel] - exact[channel]).max() / np.abs(exact[channel]).max())

    for channel in ("drive.force", "rod.guide_force", "D.fx"):
        coarse, fine = (off(steps, channel) for steps in (36, 72))
        assert np.log2(coarse / fine) == pytest.approx(3, abs=0.3)
        assert fine <= 1e-7  # measured 5e-8

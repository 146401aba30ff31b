"""How the numbers change: against differences of the numbers of machines, and formulas."""

from pathlib import Path

import numpy as np
import pytest

import scenes
from compare.measure.many.machines import as_drawn, gradients
from scenes.model.motion import Samples
from tests import scene_files
from tests.comparisons import sampled

from .runs import file, many, reference

# path -> a step that is small against how far it is to anything, in the unit of the file
PRESS = {
    **{"ground.points.P1.0": 0.1, "bodies.crank.points.P2.0": 0.1, "bodies.rocker.lengths.O-P3": 0.1},
    **{"bodies.toggle.mass": 1.0, "loads.0.force.1": 1.0, "drive.speed": 0.1},
}
CLAMP = {"bodies.rear_link.lengths.A-B": 1e-4, "bodies.platen.slides.through.1": 1e-4, "bodies.crosshead.mass": 1.0}
SLIDER = {
    **{f"bodies.slider.slides.{number}": 0.01 for number in ("through.0", "through.1", "along.0", "along.1")},
    **{"bodies.rod.lengths.A-B": 0.1, "bodies.slider.points.T.0": 0.1, "bodies.slider.mass": 0.1},
}
PATH = {"bodies.crank.lengths.O-A": 1e-3, "ground.points.C.0": 1e-3}
TURNING = {"bodies.rod.slides.through.1": 0.1, "bodies.block.com.1": 0.1, "springs.0.stiffness": 0.01}
PLACED = 1e-6  # of a change: extremes are placed to 1e-6 rad or better


STEPS = {
    **{"toggle_press": PRESS, "double_toggle_clamp": CLAMP, "offset_slider_crank": SLIDER},
    **{"walking_leg": PATH, "swinging_block": TURNING},
}


@sampled(2)
@pytest.mark.parametrize(("name", "steps"), STEPS.items())
def test_against_differences(name: str, steps: dict[str, float]) -> None:
    """Of fourth order, with steps where neither the fifth derivative nor rounding matters."""
    nominal = as_drawn(reference(name), [*steps])
    derivatives = gradients(reference(name), nominal, [*steps])
    differences = np.array([differenced(name, path, step) for path, step in steps.items()])
    size = np.array([*steps.values()])[:, np.newaxis]  # what each changes, as far as its step goes
    scale = np.max(size * np.abs(differences), axis=0)
    for column, number in enumerate(nominal.numbers):
        if number.row is not None and (number.row < 0).any():
            continue  # the size of what is zero but for rounding has no derivative
        off = np.abs(size[:, 0] * (derivatives - differences)[:, column]).max()
        assert not off > PLACED * scale[column] + 1e-12 * number.size[0], number.name


def test_a_point_beside_a_guide_that_tilts(tmp_path: Path) -> None:
    changes = {"bodies.slider.points.T": [20, 30], "bodies.slider.slides.along": [2, 0.1]}
    test_against_differences(str(scene_files.write(tmp_path, "offset_slider_crank", changes)), SLIDER)


def differenced(name: str, path: str, step: float) -> Samples:
    (drawn,) = scenes.numbers_in(file(name), [path])
    moved = many(name, {path: drawn + step * np.array([-2.0, -1.0, 1.0, 2.0])})
    values = np.array([number.value for number in moved.numbers])
    return np.asarray(values @ np.array([1.0, -8.0, 8.0, -1.0]) / (12 * step))

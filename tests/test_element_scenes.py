"""Random linkages with elements, friction and drives of every kind: core and 50 digits against absolute coordinates."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from compare.mechanics.elements import magnitudes
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.scales import relative_errors, scales, travels
from scenes import Failure, Motion, Sampling, Scene, Status
from scenes.drive import KINDS

from .agreement import errors, exact, solve
from .clean_scenes import clean_scenes
from .closed_forms.row import FIRST_KINDS
from .comparisons import SLOW
from .true_errors import Rubbed

SAMPLING = Sampling(12)
CLOSE = 1e-12  # on the scale of `agreement`: of 200 scenes the worst is 4e-14, by round-off
OF_PEAK = 1e-12  # of each joint's own peak, between the core and 50 digits


@pytest.mark.parametrize("count", [1, pytest.param(10, marks=SLOW), pytest.param(100, marks=pytest.mark.study)])
def test_three_formulations_agree_on_every_element_and_drive(tmp_path: Path, count: int) -> None:
    pytest.importorskip("flint")
    drawn = clean_scenes(tmp_path, count, elements=True)
    assert count < 10 or frozenset.union(*(scene.kinds for scene in drawn)) == FIRST_KINDS | KINDS
    for scene in drawn:
        truth = Rubbed.of(scene, SAMPLING.times(scene))
        found, rows = [*_motions(scene, truth.fates)], ~truth.unsure
        lightest = min((body.mass for body in scene.bodies.values() if body.mass), default=0.0)
        for motion in found:
            for channel, error in errors(motion, truth.channels, mass=lightest).items():
                assert not error[rows].max(initial=0.0) > CLOSE, (scene.name, channel)
        if len(found) > 1:
            assert "undetermined" not in truth.fates, scene.name
            fifty, core = found
            mechanics = Mechanics(scene)
            scale = scales(mechanics, fifty, travels(scene, fifty), magnitudes(mechanics, fifty))
            for channel, error in relative_errors(scene.channels, core, fifty, scale).items():
                assert not error[rows].max(initial=0.0) > OF_PEAK, (scene.name, channel)


def _motions(scene: Scene, fates: Sequence[str]) -> Iterator[Motion]:
    """Yield what 50 digits and the core find; where they find none, friction has to be why, and is where it may be."""
    for ended in (_ended(lambda: exact(scene, SAMPLING)), _ended(lambda: solve(scene, SAMPLING.times(scene)))):
        if isinstance(ended, Motion):
            assert "jammed" not in fates, scene.name
            yield ended
        else:
            assert ended.status is Status.unsupported or ended.status.name in fates, scene.name


def _ended(solved: Callable[[], Motion]) -> Motion | Failure:
    try:
        return solved()
    except Failure as failure:
        return failure

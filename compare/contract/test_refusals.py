"""What an engine cannot do, and what cannot be done, is a status with a reason; never an error of its own, nor ok."""

import pytest

from scenes import Positions, Scene, Status, hard
from scenes.scene import ConstantSpeed

from ..engines.runner import Run, run
from ..judge.measure import checked_run
from .asked import SAMPLING, outcome

IMPOSSIBLE = [  # rungs of the hard cases; on the last the drive ends beyond the linkage's reach
    ("never_assembles", "1e-3"),
    ("locks_on_the_way_toggle", "240"),
    ("dead_centre_driven", "-1e-1"),
]


def refused(ended: Run) -> bool:
    """Return whether a run ended with a status of the engine's own choice that is not ok, and a reason."""
    return ended.status not in (Status.ok, Status.crashed) and bool(ended.reason)


@pytest.mark.parametrize(("ladder", "label"), IMPOSSIBLE)
def test_what_cannot_be_assembled_is_not_ok(name: str, ladder: str, label: str) -> None:
    """A linkage that does not close at some position of the drive is no motion, but a status with a reason."""
    impossible = next(rung.scene() for rung in hard.ladder(ladder).rungs if rung.label == label)
    ended = checked_run(name, impossible, SAMPLING)
    assert refused(ended), f"{ended.status.name}: {ended.reason or 'no reason'}"


def test_positions_are_solved_or_refused(name: str, solved: Scene) -> None:
    """Samples at positions of the drive, out of step with the time, are within the promise, or unsupported."""
    if not isinstance(solved.drive.law, ConstantSpeed):
        pytest.skip("a motion law has no positions without instants")
    start, way = solved.drive.law.start, solved.drive.law.advance
    request = Positions(tuple(start + way * part for part in (0.1, 0.15, 0.7)))
    ended = run(name, solved, request)
    if ended.motion is None:
        assert refused(ended), f"{ended.status.name}: {ended.reason or 'no reason'}"
    else:
        assert not (wrong := outcome(name, solved, request)), wrong

"""What tests of the comparison need: a motion as it should be, one that is not, an engine that ends as told."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest

from compare.engines import registry
from compare.engines.registry import settings_of
from compare.engines.runner import Run
from compare.judge.canaries import canaries
from compare.judge.canaries.noticed import Noticed, Thinned
from compare.judge.checks import checks
from compare.judge.errors import ChannelError, compare, error_table, shown_groups
from compare.judge.measure import Measurement
from compare.measure.speed.speed_table import Again, Budget, take_turns
from compare.mechanics.mechanics import SHOWN_GROUPS, Mechanics
from compare.mechanics.reference import Reference
from compare.study import Study, study
from scenes import Motion, Sampling, Scene, Settings
from scenes.channels import named
from scenes.elements import PLAIN_KINDS

SLOW = pytest.mark.slow  # left out unless asked for by `pytest -m slow`, as .ci/run does
sampled = pytest.mark.sampled  # so many of a test's cases by default, more as SLOW; see tests/conftest.py
SAMPLING = Sampling(72)
Outcome = Motion | Exception
References = Callable[[str], Reference]
Plug = Callable[[Outcome], None]
Studies = Callable[..., Study]


def all_checks(scene: Scene) -> set[str]:
    """Return the names of the checks without a reference of a scene with masses."""
    return {"drive", "closure", "branch", *shown_groups(scene), "Newton", "Euler", "power"}


def estimated(measured: Measurement) -> float:
    """Return the largest relative error that is known without a reference."""
    return max(check.worst for check in measured.checks if check.check in SHOWN_GROUPS)


@contextmanager
def only_few_settings() -> Iterator[None]:
    """Have less done where a test is about something else.

    Four settings are measured, and timed once; few positions are certified; of the canaries one is let out.
    """

    def first(engine: str, *, full: bool) -> Mapping[Settings, str]:
        return dict(islice(settings_of(engine, full=full).items(), 4))

    def once(first: Sequence[Run], again: Again, _: Budget, *others: Any) -> list[list[Run]]:
        return take_turns(first, again, Budget(1, 0.0), *others)

    def one_canary(thinned: Thinned) -> Iterator[tuple[str, Noticed]]:
        return islice(every_canary(thinned), 1)

    every_canary = canaries._canaries
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(canaries, "_canaries", one_canary)
        for module in ("measure.speed.speed_table", "study"):
            patch.setattr(f"compare.{module}.settings_of", first)
        patch.setattr("compare.judge.floor.FLOOR_SAMPLES", 12)
        patch.setattr("compare.measure.speed.speed_table.MIN_ROUNDS", 1)
        patch.setattr("compare.measure.speed.speed_table.take_turns", once)
        yield


def studied(scene: Scene, engines: Sequence[str] = ("analytic",), sampling: Sampling = SAMPLING) -> Study:
    """Return the study of a scene, with few settings."""
    with only_few_settings():
        return study(scene, engines, sampling, Budget(1, 0.0), lambda _: None)


def commanded(reference: Reference, sampling: Sampling = SAMPLING) -> Motion:
    """Return what the reference says an engine should."""
    return reference.at(sampling.inputs(reference.scene))


def of_scene(reference: Reference, scene: Scene) -> Reference:
    """Return the reference of a scene that differs in its loads, with the same scales."""
    return replace(reference, mechanics=Mechanics(scene), at=registry.reference(scene))


def violations(reference: Reference, motion: Motion) -> dict[tuple[str, str], float]:
    """What the checks of a motion's own output find at worst, by check and what it is of."""
    return {(c.check, c.of): c.worst for c in checks(reference.mechanics, motion, reference.travel)}


def rows_of(reference: Reference, motion: Motion, sampling: Sampling = SAMPLING) -> list[ChannelError]:
    """The errors of a motion, a row a channel."""
    return [*error_table("x", compare(reference, sampling, motion), reference)]


class Stub:
    """An engine, and its simulation, with a given outcome."""

    DEFAULT = Settings("stub")
    WORK_PRECISION = (DEFAULT,)
    LONG_WORK_PRECISION: tuple[Settings, ...] = ()
    FAST = EXACT = DEFAULT
    ABLATIONS: tuple[Settings, ...] = ()
    KINDS = PLAIN_KINDS
    at_steps = iterations_needed = None
    counters: Mapping[str, int] = {}
    residuals: Mapping[str, float] = {}

    def __init__(self, outcome: Outcome) -> None:
        self.outcome = outcome

    def version(self) -> str:
        return "stub"

    def build(self, scene: Scene, settings: Settings, sampling: Sampling) -> "Stub":  # noqa: ARG002
        return self

    def solve(self) -> None:
        if isinstance(self.outcome, Exception):
            raise self.outcome

    def read(self) -> Motion:
        assert isinstance(self.outcome, Motion)
        return self.outcome


def changed(motion: Motion, channel: str, by: float, row: int = 40) -> Motion:
    """Return the motion with one sample of one channel moved."""
    samples = motion[channel].copy()
    samples[row] += by
    return Motion({**motion.samples, channel: samples})


def row_of(table: Sequence[ChannelError], channel: str) -> ChannelError:
    return next(row for row in table if row.channel == channel)


def vector_of(channel: str) -> set[str]:
    """Return the channels of a component's vector, or the channel itself."""
    return {channel[:-1] + axis for axis in "xy"} if channel[-1] in "xy" else {channel}


def size_of(motion: Motion, channel: str, scale: float, row: int = 40) -> float:
    """Return what an error is divided by at a sample: the scale, or of a rate the vector's magnitude if larger."""
    if named(channel).name in ("x", "y", "angle"):
        return scale
    return max(scale, float(np.sqrt(sum(motion[part][row] ** 2 for part in vector_of(channel)))))

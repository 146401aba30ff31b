"""What every engine offers: a module with `version`, `DEFAULT`, `LADDER`, `LONG_LADDER` and `build`; failures are data.

The three stages are apart so that a clock can wrap `solve` alone:

    simulation = engine.build(scene, settings, request)    # model, start pose, buffers
    simulation.solve()                                     # the work itself
    motion = simulation.read()                             # channels, in the sign rules of `motion.py`

Any stage may raise `Failure`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Protocol, TypeVar

from .motion import Motion
from .request import Request, Sampling
from .scene import Scene

ESTIMATE = "estimated error"  # among an engine's residuals: its largest relative error by its own model


class Status(Enum):
    """How a run ended. The value is the sentence that users see."""

    ok = "Solved; every check that the engine makes of itself passed."
    unsupported = "The engine cannot model what this scene asks for."
    cannot_assemble = "The bodies cannot be put together at some position of the drive."
    wrong_branch = "The linkage ended up assembled the other way round."
    diverged = "The solution ran away or the engine gave up on a step."
    not_converged = "The engine's own residual stayed above its limit."
    nonfinite = "The result holds values that are not finite."
    timed_out = "The time limit was reached before the end."
    crashed = "The engine stopped with an error of its own."


class Failure(Exception):  # noqa: N818 - it is an outcome, kept as a row, not an error
    """A run that ended with a status other than ok, and the particular reason in one sentence.

    `motion` is what was computed all the same and is not to be trusted, for those who ask how far off it is.
    """

    def __init__(self, status: Status, reason: str, motion: Motion | None = None) -> None:
        super().__init__(reason)
        self.status = status
        self.reason = reason
        self.motion = motion


@dataclass(frozen=True)
class Settings:
    """Base of every engine's settings; `label` is what tables and plots call them."""

    label: str
    family: str = field(default="", kw_only=True)  # of settings that differ in their steps a cycle alone
    order: float | None = field(default=None, kw_only=True)  # of convergence, that theory expects within the family
    note: str = field(default="", kw_only=True)  # what a reader has to know before believing it


def equal_steps(request: Request) -> Sampling:
    """Return the request as one of equal steps of the time, which is all that an integration in time can answer.

    Raises:
        Failure: `unsupported`, it is for positions of the drive.
    """
    if not isinstance(request, Sampling):
        raise Failure(Status.unsupported, "it steps through the time, and was asked for positions of the drive")
    return request


class Simulation(Protocol):
    """One prepared run."""

    def solve(self) -> None:
        """Do the work; this alone is timed as the solve."""

    def read(self) -> Motion:
        """Return every channel of the scene, each present or said to be unsupported with a reason."""

    @property
    def counters(self) -> Mapping[str, int]:
        """Machine-free measures of the work done: steps, Newton iterations, constraint iterations."""

    @property
    def residuals(self) -> Mapping[str, float]:
        """The engine's own convergence checks after `read`, relative, by name."""


S = TypeVar("S", bound=Settings)


class Engine(Protocol[S]):
    """An engine, as its module offers it."""

    @property
    def DEFAULT(self) -> S:  # noqa: N802 - a module's constant
        """The settings of a plain run."""

    @property
    def LADDER(self) -> tuple[S, ...]:  # noqa: N802
        """Settings from cheap to accurate, for the picture of speed against error in every report."""

    @property
    def LONG_LADDER(self) -> tuple[S, ...]:  # noqa: N802
        """Return the slower settings that only `--full` takes, besides those of `LADDER`."""

    @property
    def FAST(self) -> S:  # noqa: N802
        """Return the cheapest settings that are good to a per cent."""

    @property
    def EXACT(self) -> S:  # noqa: N802
        """Return the most accurate settings."""

    @property
    def ABLATIONS(self) -> tuple[S, ...]:  # noqa: N802
        """Return `DEFAULT` with more than a scene needs, for `--full`: what modelling it would have cost."""

    def version(self) -> str:
        """Return the versions of what does the work."""

    def build(self, scene: Scene, settings: S, request: Request) -> Simulation:
        """Prepare a run.

        Raises:
            Failure: the scene cannot be modelled or assembled.
        """

"""What every engine offers: a module with the names of `Engine`, whose `build` makes a `Simulation`; failures are data.

The three stages are apart so that a clock can wrap `solve` alone:

    simulation = engine.build(scene, settings, request)    # model, start pose, buffers
    simulation.solve()                                     # all the work from there to the channels
    motion = simulation.read()                             # they are handed over, after the engine's own checks

Any stage may raise `Failure`. A module needs `DEFAULT` and `build` alone, a simulation `solve` and `read`.
"""

from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass, field
from enum import Enum
from functools import cached_property
from time import perf_counter, process_time
from types import SimpleNamespace
from typing import Annotated, Any, Protocol, TypeVar, cast

from ..elements import PLAIN_KINDS
from ..scene import Scene
from .motion import Motion, Request, Sampling


class Status(Enum):
    """How a run ended. The value is the sentence that users see."""

    ok = "Solved; every check that the engine makes of itself passed."
    unsupported = "The engine cannot model what this scene asks for."
    cannot_assemble = "The bodies cannot be put together at some position of the drive."
    wrong_branch = "The linkage ended up assembled the other way round."
    jammed = "Friction holds the linkage: at some position no forces of the drive move it on."
    undetermined = "With this friction more than one set of forces is possible at some position."
    diverged = "The solution ran away or the engine gave up on a step."
    not_converged = "The engine's own residual stayed above its limit."
    inconsistent = "The output contradicts itself: forces, rates, poses and drive do not belong to one motion."
    inaccurate = "The output is further off than the settings promise."
    nonfinite = "The result holds values that are not finite."
    timed_out = "The time limit was reached before the end."
    crashed = "The engine stopped with an error of its own."


class Failure(Exception):  # noqa: N818 - it is an outcome, kept as a row, not an error
    """A run that ended with a status other than ok, and why in one sentence, which is found when it is asked for."""

    def __init__(
        self,
        status: Status,
        reason: str | Callable[[], str],
        motion: Motion | None = None,
        at: tuple[float, str] | None = None,
    ) -> None:
        super().__init__()
        self.status, self._reason = status, reason
        self.at = at  # where one place of the drive is to blame, that, rad or m, and the joint that does not close
        self.motion = motion  # computed all the same, and not to be trusted, for those who ask how far off it is

    @cached_property
    def reason(self) -> str:
        """The sentence."""
        return self._reason if isinstance(self._reason, str) else self._reason()

    def __str__(self) -> str:
        return self.reason


@dataclass(frozen=True)
class Settings:
    """Base of every engine's settings; each field is annotated with its meaning for a reader."""

    label: Annotated[str, "its name in tables and figures; no two settings of an engine share one"]
    _: KW_ONLY
    promise: Annotated[float, "largest relative error of an ok run in any channel; it changes nothing in the run"] = (
        field(default=0.1, compare=False)
    )
    drive_promise: Annotated[float, "the same for the drive's position, of 1 rad or of the slider's travel"] = 1e-9
    family: Annotated[str, "settings that differ in their steps per cycle alone"] = ""
    order: Annotated[float | None, "order of convergence that theory expects within the family"] = None
    note: Annotated[str, "what to know before believing the result"] = ""


def equal_steps(request: Request) -> Sampling:
    """A request of equal steps of the time, all that an integration in time can answer; or Failure, `unsupported`."""
    if not isinstance(request, Sampling):
        raise Failure(Status.unsupported, "it steps through the time, and was asked for positions of the drive")
    return request


class Simulation(Protocol):
    """One prepared run."""

    def solve(self) -> None:
        """Do all the work that it takes to get the channels from a built model; this alone is timed as the solve.

        It raises `Failure` where the engine gave up, or does not believe its own result, as `read` does.
        """

    def read(self) -> Motion:
        """Hand over the channels asked for, after the engine's own checks; it computes nothing that they need.

        Each is of shape (n,), float64, SI, in the sign rules of `motion.py`; or unsupported, with a reason.
        """

    @property
    def counters(self) -> Mapping[str, int]:
        """Machine-free measures of the work done, by name: steps, Newton iterations, constraint iterations."""

    @property
    def residuals(self) -> Mapping[str, float]:
        """The engine's own convergence checks after `read`, relative, by name."""


S = TypeVar("S", bound=Settings)


class Engine(Protocol[S]):
    """A module with an engine: it has to have `DEFAULT` and `build`, the rest is added by `completed` if left out."""

    DEFAULT: S  # of a plain run
    FAST: S  # the cheapest that are good to a per cent
    EXACT: S  # the most accurate
    WORK_PRECISION: tuple[S, ...]  # from cheap to accurate, for the picture of speed against error in every report
    LONG_WORK_PRECISION: tuple[S, ...]  # slower ones, that only `--full` takes besides
    ABLATIONS: tuple[S, ...]  # the default with more than a scene needs, for `--full`: what modelling it costs
    KINDS: frozenset[str]  # of loads, springs and drives that it knows, besides cranks and sliders on the ground

    def build(self, scene: Scene, settings: S, request: Request) -> Simulation:
        """Prepare a run; nothing is solved yet but the pose that it starts from.

        The request is for n instants, s, or positions of the drive, rad or m, and the channels wanted there. It raises
        `Failure`, `unsupported` or `cannot_assemble`, and ImportError where the engine is not installed.
        """

    @property
    def at_steps(self) -> Callable[..., S] | None:
        """`at_steps(steps)`: settings of one run of that many steps a cycle, for maps of stability; None without steps.

        With `iterations_needed`, `at_steps(steps, iterations)` too: that many iterations in each step.
        """

    @property
    def iterations_needed(self) -> Callable[[Scene, S], float] | None:
        """How many iterations each step needs by theory, infinite where none are enough; None where no step iterates.

        It raises `Failure` where the engine cannot model or assemble the scene.
        """

    def version(self) -> str:
        """The names and versions of what does the work; ImportError where it is not installed."""


def completed(module: Any, version: str) -> Engine[Any]:
    """An engine with all names of the protocol; TypeError where its module lacks `DEFAULT` or `build`.

    What it leaves out of `Engine` is taken from its `DEFAULT`, or the `version` here.
    """
    default = getattr(module, "DEFAULT", None)
    if not (isinstance(default, Settings) and hasattr(module, "build")):
        raise TypeError("expected a module with DEFAULT, of scenes.Settings, and build(scene, settings, request)")
    optional = dict.fromkeys(("FAST", "EXACT"), default) | dict.fromkeys(("at_steps", "iterations_needed"))
    optional |= {"KINDS": PLAIN_KINDS}
    optional |= {"WORK_PRECISION": (default,), "LONG_WORK_PRECISION": (), "ABLATIONS": (), "version": lambda: version}
    return cast("Engine[Any]", SimpleNamespace(**(optional | vars(module))))


def refuse_unknown(engine: Engine[Any], scene: Scene) -> None:
    """Raise Failure, `unsupported`, for a scene with a kind of load, spring or drive that the engine does not know."""
    if unknown := scene.kinds - engine.KINDS:
        raise Failure(Status.unsupported, f"it knows no {', '.join(sorted(unknown))}, which the scene has")


class ProcessorBudget:
    """What one task may take of the process's processor time, which a busy machine does not use up."""

    def __init__(self, seconds: float, task: str) -> None:
        """Start the clock: so many seconds from now on, for a task as the reason names it, while it goes on."""
        self.seconds, self.task = seconds, task
        self._end, self._least = process_time() + seconds, perf_counter() + seconds

    def check(self, progress: str) -> None:
        """Do nothing while there is time left; then raise Failure, `timed_out`, with the task and its progress."""
        # Asking for the processor time can take longer than a step. It is no more than the time on the wall, but in a
        # process of several threads, so it is asked for only when that is over.
        if perf_counter() >= self._least and process_time() >= self._end:
            reason = f"{self.seconds:g} s of processor time were not enough for {self.task}: {progress}"
            raise Failure(Status.timed_out, reason)

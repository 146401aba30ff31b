"""What can be set: how finely to step, how well to solve each step, and what to model."""

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from scenes import Failure, Settings, Status

# What a scene does not need, to show what it costs: a shape on each body, which collide with nothing; a crank that is
# simulated and turned by a motor; a function in Python that every step calls; every body read by its own properties.
Extra: TypeAlias = Literal["", "shapes", "motor", "callback", "properties"]

ERROR_BIAS = (1 - 0.1) ** 60  # pymunk's default: what is left of a joint's error after a second
LEVELS = 4  # at most; a fifth would take more than half of all steps to remove what is rounding in most scenes


@dataclass(frozen=True)
class PymunkSettings(Settings):
    """A linkage set up to be solved with an order of convergence; see `engine`."""

    steps: int  # steps a cycle of the coarsest run, at least: rounded up to a multiple of the samples
    levels: int  # runs for the Richardson extrapolation, 1 to 4, each with twice the steps of the one before
    iterations: int  # Gauss-Seidel sweeps over all joints in a step
    correction: float | None = 1.0  # of a joint's error, by which part a step corrects it; None: by pymunk's default
    fictitious: bool = False  # masses: those with which sweeps converge fast, in place of the true ones
    extra: Extra = ""

    def __post_init__(self) -> None:
        # Without sweeps, pymunk's C core ends the whole process.
        if self.steps < 1 or self.iterations < 1 or not 1 <= self.levels <= LEVELS:
            raise ValueError(f"expected steps and iterations of at least 1 and 1 to {LEVELS} levels, found {self}")
        if self.correction is not None and not 0 < self.correction <= 1:
            raise ValueError(f"expected a correction of more than 0 and at most 1, found {self.correction}")
        if self.extra not in get_args(Extra):
            raise ValueError(f"expected nothing extra or one of {get_args(Extra)}, found '{self.extra}'")

    def corrected(self, dt: float) -> float:
        """Return which part of a joint's error a step of dt, s, corrects."""
        return float(1 - self.error_bias(dt) ** dt)

    def error_bias(self, dt: float) -> float:
        """Return what would be left of a joint's error after a second, as pymunk takes it.

        Raises:
            Failure: unsupported, so small a number that pymunk would correct the whole error.
        """
        if self.correction is None:
            return ERROR_BIAS
        left = 1 - self.correction
        found = float(left ** (1 / dt))
        if left and not found:
            raise Failure(Status.unsupported, f"pymunk cannot leave {left:g} of an error over in steps of {dt:.3g} s")
        return found


@dataclass(frozen=True)
class Textbook(Settings):
    """A linkage set up as the manual shows it, with pymunk's defaults; see `textbook`."""

    steps: int  # a cycle, at least: rounded up to a multiple of the samples
    iterations: int = 10

"""Exudyn: the linkage as a planar multibody system with Lagrange multipliers, integrated in time or solved at instants.

Time stepping integrates the index-3 equations (generalised-alpha) or the index-2 ones (trapezoidal) from before the
first sample, so that the start transient is gone by then; what comes out is held against what Exudyn's own terms ask
for in the poses that meet the constraints. The pointwise route takes a pose that meets the constraints
at every sample, and solves for velocities, accelerations and reactions with the terms that Exudyn evaluates there.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, TypeAlias

from scenes import Request, Scene

from .pointwise import Pointwise, PointwiseRun
from .settings import Extra, Newton, Textbook, TimeStepping
from .simulation import failure
from .stepping import SteppedRun
from .system import engine

__all__ = [
    "ABLATIONS",
    "DEFAULT",
    "EXACT",
    "FAST",
    "LADDER",
    "LONG_LADDER",
    "ExudynSettings",
    "Pointwise",
    "Textbook",
    "TimeStepping",
    "at_steps",
    "build",
    "iterations_needed",
    "version",
]

ExudynSettings: TypeAlias = TimeStepping | Pointwise
Options: TypeAlias = Mapping[str, Any]


def _single(name: str, *steps: int, **options: Any) -> tuple[TimeStepping, ...]:
    """Return a family of single integrations, of order 2."""
    return tuple(
        TimeStepping(f"{name}, {n}", steps=n, richardson=False, family=name, order=2, **options) for n in steps
    )


def _pairs(name: str, order: int, *steps: int, **options: Any) -> tuple[TimeStepping, ...]:
    """Return a family of two integrations each, extrapolated."""
    family = f"{name}, extrapolated"
    return tuple(TimeStepping(f"{name}, {n}+{2 * n}", steps=n, family=family, order=order, **options) for n in steps)


def _textbook(*steps: int) -> tuple[Textbook, ...]:
    """Return what one gets without knowing. Near its start it is of order 1, later on it is not."""
    note = "as a new user meets it: the engine's own defaults"
    return tuple(Textbook(f"textbook, {n}", steps=n, family="textbook", note=note) for n in steps)


# The trapezoidal rule damps nothing, so that a long run-up gains it nothing. What rings in it is in every other step.
TRAPEZOIDAL: Options = {"solver": "TrapezoidalIndex2", "pre_roll": 2}
LOOSE: Options = {**TRAPEZOIDAL, "tolerance": 1e-6}
# At 1e-10 Newton leaves 1e-7 of the peak reaction, which shows when two integrations are extrapolated; 1e-12 is not
# always met.
TIGHT: Options = {**TRAPEZOIDAL, "tolerance": 1e-11}
# Its error is smaller and its transient longer than at 0.5. What extrapolation leaves should be of order 3 in the end,
# but that part comes of the damping: down to 1e-8 it does not show beside the one of order 4.
LITTLE_DAMPED: Options = {"spectral_radius": 0.8, "pre_roll": 80}
# 9 coordinates of the toggle press and 9 multipliers, of 15 and 15: the same errors in three quarters of the time. Most
# reactions of the ground are then no unknowns of the integration any more, so no preset does so.
REDUCED: Options = {"reduced": True}

# Measured good to 1 % in the reactions of every shipped scene, which generalised-alpha is not with as many steps; with
# more, the pointwise route is faster. Accelerations ring where a run begins next to a lock, and then it is refused.
FAST, *_more_loose = _single("trapezoidal, loose Newton", 144, 72, **LOOSE)
# Two integrations in time that know nothing of the poses; robust where a drive has knots or a start is next to a lock.
*_pairs_in_ladder, DEFAULT = _pairs("generalised-alpha 0.5", 3, 72, 360, 720)
EXACT = Pointwise("pointwise", family="pointwise")

LADDER: tuple[ExudynSettings, ...] = (
    FAST,
    *_more_loose,
    *_single("generalised-alpha 0.5", 72, 360),
    *_single("generalised-alpha 0.5, reduced", 72, 360, **REDUCED),
    *_single("trapezoidal", 72, 360, **TRAPEZOIDAL),
    *_pairs_in_ladder,
    DEFAULT,
    *_pairs("trapezoidal", 4, 144, **TIGHT),
    EXACT,
    *_textbook(72, 360),
)

LONG_LADDER: tuple[ExudynSettings, ...] = (
    *_single("trapezoidal, loose Newton", 288, **LOOSE),
    *_single("generalised-alpha 0.5", 144, 1440, 2880, 7200),
    *_single("generalised-alpha 0.5, reduced", 144, 1440, 2880, 7200, **REDUCED),
    *_single("generalised-alpha 0", 72, 360, 1440, spectral_radius=0.0),
    *_single("generalised-alpha 0.8", 72, 360, 1440, **LITTLE_DAMPED),
    *_single("generalised-alpha 0.5, full Newton", 72, 360, 1440, newton=Newton.FULL),
    *_single("generalised-alpha 0.5, modified Newton", 72, 360, 1440, newton=Newton.MODIFIED),
    *_single("trapezoidal", 144, 1440, 2880, 7200, **TRAPEZOIDAL),
    *_pairs("generalised-alpha 0.5", 3, 144, 1440, 2880),
    *_pairs("generalised-alpha 0.5, reduced", 3, 72, 360, 720, **REDUCED),
    *_pairs("generalised-alpha 0.8", 4, 72, 144, 360, 720, **LITTLE_DAMPED),
    *_pairs("trapezoidal", 4, 288, 432, 576, **TIGHT),
    *_textbook(1440, 2880, 7200, 14400),
)

_once = replace(DEFAULT, richardson=False, family="", order=2)
ABLATIONS: tuple[ExudynSettings, ...] = (
    replace(_once, label="Jacobians in every iteration", newton=Newton.FULL),
    *(replace(_once, label=extra.value, extra=extra) for extra in Extra if extra is not Extra.NOTHING),
)
iterations_needed = None  # Newton's method decides by itself


def at_steps(steps: int) -> TimeStepping:
    """Return one run of that many steps a cycle, for maps of where the steps are stable."""
    (settings,) = _single("generalised-alpha 0.5", steps)
    return settings


def version() -> str:
    """Return the version of Exudyn."""
    return f"exudyn {engine().__version__}"


def build(scene: Scene, settings: ExudynSettings, request: Request) -> "SteppedRun | PointwiseRun":
    """Prepare a run.

    Raises:
        Failure: the scene cannot be modelled, or the bodies cannot be put together somewhere in the cycle.
    """
    try:
        if isinstance(settings, Pointwise):
            return PointwiseRun(scene, request)
        return SteppedRun(scene, settings, request)
    except engine().ExudynError as error:
        raise failure(error, "building the system") from None

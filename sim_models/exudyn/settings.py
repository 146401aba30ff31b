"""Settings of Exudyn: what can be chosen, and every named setting in one place."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Annotated, Any, TypeAlias

from scenes import Settings


class JacobianUse(Enum):
    """How often a step's Newton iterations factorise the Jacobian anew."""

    FULL = "in every iteration"
    ONE_A_STEP = "once at the start of every step"  # the fastest
    MODIFIED = "when they converge badly, else one serves many steps"


class ExudynExtra(Enum):
    """Features that no scene needs, to measure what they cost."""

    NOTHING = "what the scene needs"
    SENSORS = "a sensor for every channel, in memory"
    TEXT = "the same sensors and the solution as text files"
    CALLBACK = "a Python function before every step"
    SPATIAL = "bodies in space, held in the plane"


@dataclass(frozen=True)
class Pointwise(Settings):
    """Solve position, velocity, acceleration and reactions at every sample, without integrating."""


@dataclass(frozen=True)
class TimeStepping(Settings):
    """Integrate in time with a constant step."""

    steps: Annotated[int, "per cycle, at least: rounded up to a multiple of the samples"]
    solver: Annotated[str, "Exudyn's integrator: GeneralizedAlpha or TrapezoidalIndex2"] = "GeneralizedAlpha"
    richardson: Annotated[bool, "also twice the steps, and extrapolation, which cancels the error's h²"] = True
    spectral_radius: Annotated[float, "of generalised-alpha: the start transient is damped by it in a step"] = 0.5
    pre_roll: Annotated[int, "steps before the first sample"] = 24
    newton: Annotated[JacobianUse, "when Newton's iterations factorise the Jacobian"] = JacobianUse.ONE_A_STEP
    tolerance: Annotated[float, "of Newton's method"] = 1e-10  # Exudyn's 1e-8 shows in the reactions
    reduced: Annotated[bool, "one coordinate for every body that only turns or slides on the ground"] = False
    extra: Annotated[ExudynExtra, "what is modelled"] = ExudynExtra.NOTHING


@dataclass(frozen=True)
class TextbookTimeStepping(TimeStepping):
    """Integrate as a first script would: Exudyn's presets, sensors, no pre-roll."""

    richardson: bool = False
    spectral_radius: float = 0.9
    pre_roll: int = 0
    extra: ExudynExtra = ExudynExtra.SENSORS


ExudynSettings: TypeAlias = TimeStepping | Pointwise
Options: TypeAlias = Mapping[str, Any]


def _ladder(name: str, order: int, *steps: int, **options: Any) -> tuple[TimeStepping, ...]:
    """A family of single integrations, of order 2, or of two each, whose extrapolation is of a higher order."""
    pairs = order > 2
    options |= {"richardson": pairs, "family": f"{name}, extrapolated" if pairs else name, "order": order}
    return tuple(TimeStepping(f"{name}, {n}+{2 * n}" if pairs else f"{name}, {n}", n, **options) for n in steps)


def _textbook(*steps: int) -> tuple[TextbookTimeStepping, ...]:
    """A first script's settings: of order 1 near its start, of no one order later on."""
    note = (
        "as a new user meets it: the engine's own defaults, without steps before the first sample. They write a file"
        " every 10 ms of the motion, which takes a quarter of the time at 72 steps and one turn a second."
    )
    return tuple(TextbookTimeStepping(f"textbook, {n}", steps=n, family="textbook", note=note) for n in steps)


# The trapezoidal rule does not damp, so a longer pre-roll gains nothing; its error oscillates with a period of two
# steps. It holds velocities only, so under a law the drive's position drifts.
TRAPEZOIDAL: Options = {"solver": "TrapezoidalIndex2", "pre_roll": 2, "drive_promise": 1e-2}
LOOSE: Options = {**TRAPEZOIDAL, "tolerance": 1e-6}
# At 1e-10 Newton leaves 1e-7 of the peak reaction, which shows when two integrations are extrapolated; 1e-12 is not
# always met.
TIGHT: Options = {**TRAPEZOIDAL, "tolerance": 1e-11}
# Smaller errors and a longer transient than at 0.5. Extrapolation leaves an error of order 3, due to the damping, that
# stays below the one of order 4 down to 1e-8.
LITTLE_DAMPED: Options = {"spectral_radius": 0.8, "pre_roll": 80}
# In the toggle press 9 coordinates and 9 multipliers in place of 15 and 15: the same errors in three quarters of the
# time. Most reactions of the ground are then no unknowns of the integration, so no preset is reduced.
REDUCED: Options = {"reduced": True}

# Of 78 scenes, shipped, of tests and drawn at random, no integration keeps a per cent for less: one of 144 trapezoidal
# steps takes as long at 72 samples, and was off by more than a per cent in 8 and by 2 at worst; of 288, in 3.
# It was off by 8e-9 at worst in 286 drawn at random and shipped: a difference over 1e-5 of a turn, nearly singular.
EXACT = Pointwise("pointwise", family="pointwise", promise=1e-7)
FAST = replace(EXACT, promise=1e-2)
# Independent of the poses found by Newton's method; on the same scenes good to 1e-4.
(DEFAULT,) = _ladder("generalised-alpha 0.5", 3, 720, promise=1e-3)

# Every run measures these: what is the cheapest for some error, an order of convergence, and a first script.
WORK_PRECISION: tuple[ExudynSettings, ...] = (
    *_ladder("trapezoidal, loose Newton", 2, 72, **LOOSE),
    *_ladder("generalised-alpha 0.5", 2, 72),
    *_ladder("generalised-alpha 0.5", 3, 72, 144),
    DEFAULT,
    EXACT,
    *_textbook(72),
)

LONG_WORK_PRECISION: tuple[ExudynSettings, ...] = (
    *_ladder("trapezoidal, loose Newton", 2, 144, 288, **LOOSE),
    *_ladder("generalised-alpha 0.5", 2, 144, 360, 1440, 2880, 7200),
    *_ladder("generalised-alpha 0.5, reduced", 2, 72, 144, 360, 1440, 2880, 7200, **REDUCED),
    *_ladder("generalised-alpha 0", 2, 72, 360, 1440, spectral_radius=0.0),
    *_ladder("generalised-alpha 0.8", 2, 72, 360, 1440, **LITTLE_DAMPED),
    *_ladder("generalised-alpha 0.5, full Newton", 2, 72, 360, 1440, newton=JacobianUse.FULL),
    *_ladder("generalised-alpha 0.5, modified Newton", 2, 72, 360, 1440, newton=JacobianUse.MODIFIED),
    *_ladder("trapezoidal", 2, 72, 144, 360, 1440, 2880, 7200, **TRAPEZOIDAL),
    *_ladder("generalised-alpha 0.5", 3, 360, 1440, 2880),
    *_ladder("generalised-alpha 0.5, reduced", 3, 72, 360, 720, **REDUCED),
    *_ladder("generalised-alpha 0.8", 4, 72, 144, 360, 720, **LITTLE_DAMPED),
    *_ladder("trapezoidal", 4, 144, 288, 432, 576, **TIGHT),
    *_textbook(360, 1440, 2880, 7200, 14400),
)

_once = replace(DEFAULT, richardson=False, family="", order=2)
ABLATIONS: tuple[ExudynSettings, ...] = (
    replace(_once, label="Jacobians in every iteration", newton=JacobianUse.FULL),
    *(replace(_once, label=extra.value, extra=extra) for extra in ExudynExtra if extra is not ExudynExtra.NOTHING),
)


def at_steps(steps: int) -> TimeStepping:
    """The settings of one integration with that many steps per cycle, for maps of stability."""
    return _ladder("generalised-alpha 0.5", 2, steps)[0]

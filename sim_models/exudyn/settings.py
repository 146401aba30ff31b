"""How Exudyn integrates in time: what may be chosen, and its simulation settings for that."""

from dataclasses import dataclass
from enum import Enum
from typing import Any

from scenes import Settings

from .system import engine


class Newton(Enum):
    """How often a step's Newton iterations factorise the Jacobian anew."""

    FULL = "in every iteration"
    ONE_A_STEP = "once at the start of every step"
    MODIFIED = "when they converge badly, else one serves many steps"


class Extra(Enum):
    """More than a scene needs, to see what it costs."""

    NOTHING = "what the scene needs"
    SENSORS = "a sensor for every channel, in memory"
    TEXT = "the same sensors and the solution as text files"
    CALLBACK = "a Python function before every step"
    SPATIAL = "bodies in space, held in the plane"


NOTHING = 1e-4  # of a linkage's size, and of the tolerance: gaps that are no more than round-off


@dataclass(frozen=True)
class TimeStepping(Settings):
    """Integrate in time with a constant step."""

    steps: int  # a cycle, at least: rounded up to a multiple of the samples
    solver: str = "GeneralizedAlpha"  # or TrapezoidalIndex2
    richardson: bool = True  # also take twice the steps, and extrapolate: cancels the error's h^2
    spectral_radius: float = 0.5  # of generalised-alpha at high frequency; damps the start transient by this a step
    pre_roll: int = 24  # steps before the first sample
    newton: Newton = Newton.ONE_A_STEP  # the fastest at the same accuracy
    tolerance: float = 1e-10  # of Newton's method; Exudyn's 1e-8 shows in the reactions
    reduced: bool = False  # one coordinate for every body to which the ground leaves no more
    extra: Extra = Extra.NOTHING


@dataclass(frozen=True)
class Textbook(TimeStepping):
    """Integrate as a first script would, with what Exudyn presets, sensors, and no run-up to the first sample."""

    richardson: bool = False
    spectral_radius: float = 0.9
    pre_roll: int = 0
    extra: Extra = Extra.SENSORS


def configure(settings: Any, options: TimeStepping, size: float) -> None:
    """Choose the integrator in Exudyn's simulation settings, for a linkage of some size, m."""
    integration = settings.timeIntegration
    integration.solverType = getattr(engine().DynamicSolverType, options.solver)
    integration.generalizedAlpha.spectralRadius = options.spectral_radius
    if isinstance(options, Textbook):
        return
    integration.generalizedAlpha.computeInitialAccelerations = False  # those take no account of the drive's own
    integration.adaptiveStep = False  # it adds up time, and ends on a tiny step with absurd forces
    integration.newton.relativeTolerance = options.tolerance
    integration.newton.absoluteTolerance = NOTHING * size * options.tolerance
    integration.newton.useModifiedNewton = options.newton is not Newton.FULL
    integration.newton.modifiedNewtonJacUpdatePerStep = options.newton is Newton.ONE_A_STEP

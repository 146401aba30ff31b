"""Exudyn: the linkage as a planar multibody system with Lagrange multipliers, integrated in time or solved at instants.

Time stepping integrates the index-3 equations (generalised-alpha) or the index-2 ones (trapezoidal) from before the
first sample, so that the start transient has decayed by then. The pointwise route takes a pose that meets the
constraints at every sample, and solves for velocities, accelerations and reactions with the terms that Exudyn evaluates
there.
"""

from scenes import Request, Scene

from . import pointwise, stepping
from . import settings as named
from .pointwise import PointwiseSimulation
from .settings import ExudynSettings, Pointwise
from .simulation import failure
from .stepping import TimeSteppedSimulation
from .system import engine

DEFAULT, FAST, EXACT, ABLATIONS = named.DEFAULT, named.FAST, named.EXACT, named.ABLATIONS
WORK_PRECISION, LONG_WORK_PRECISION = named.WORK_PRECISION, named.LONG_WORK_PRECISION
at_steps, iterations_needed = named.at_steps, None  # a step is solved by Newton's method


def version() -> str:
    """Return the version of Exudyn."""
    return f"exudyn {engine().__version__}"


def build(scene: Scene, settings: ExudynSettings, request: Request) -> PointwiseSimulation | TimeSteppedSimulation:
    """Assemble the linkage on the sketch's branch and prepare its solution, see `scenes.engine.Engine.build`.

    Raises:
        Failure: `unsupported`, the scene or the request cannot be modelled; `cannot_assemble`, `wrong_branch` or
            `not_converged`, no pose on the sketch's branch, there or on the way to the start or through the cycle;
            `crashed`, an error of Exudyn's own.
    """
    try:
        if isinstance(settings, Pointwise):
            return pointwise.build(scene, request)
        return stepping.build(scene, settings, request)
    except engine().ExudynError as error:
        raise failure(error, "building the system") from None

"""Exudyn: the linkage as a planar multibody system with Lagrange multipliers, integrated in time or solved at instants.

Time stepping integrates the index-3 equations (generalised-alpha) or the index-2 ones (trapezoidal) from before the
first sample, so that the start transient has decayed by then. The pointwise route takes a pose that meets the
constraints at every sample, and solves for velocities, accelerations and reactions with the terms that Exudyn evaluates
there.
"""

from scenes import Request, Scene
from scenes.drive import KINDS as DRIVES
from scenes.elements import kinds_of
from scenes.model.engine import Simulation

from . import settings as named
from .contacts import CONTACTS
from .elements import RULES
from .joints import RULES as JOINTS
from .settings import ExudynSettings, Pointwise

KINDS = kinds_of((*RULES, *CONTACTS, *JOINTS)) | DRIVES
DEFAULT, FAST, EXACT, ABLATIONS = named.DEFAULT, named.FAST, named.EXACT, named.ABLATIONS
WORK_PRECISION, LONG_WORK_PRECISION = named.WORK_PRECISION, named.LONG_WORK_PRECISION
at_steps = named.at_steps


def build(scene: Scene, settings: ExudynSettings, request: Request) -> Simulation:
    """Assemble the linkage on the sketch's branch and prepare its solution, see `scenes.model.engine.Engine.build`.

    Failure: `unsupported`, the scene or the request cannot be modelled; `cannot_assemble`, `wrong_branch` or
    `not_converged`, no pose on the sketch's branch, there or on the way to the start or through the cycle; `crashed`.
    """
    import exudyn  # late: importing takes longer than most runs

    from .runs.simulation import PointwiseSimulation, failure
    from .runs.stepping import TimeSteppedSimulation

    try:
        if isinstance(settings, Pointwise):
            return PointwiseSimulation(scene, request)
        return TimeSteppedSimulation(scene, settings, request)
    except exudyn.ExudynError as error:
        raise failure(error, "building the system") from None

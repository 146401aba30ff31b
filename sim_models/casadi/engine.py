"""CasADi: absolute coordinates and Lagrange multipliers, every derivative by its automatic differentiation.

Of a scene only constraints, energies and the work of the loads are written down, as symbols. Jacobians, velocities'
products, masses and generalised forces are CasADi's derivatives of those, compiled into functions of its virtual
machine. Poses come from Newton's method on the constraints, or from Runge and Kutta's on their rates; rates,
accelerations and multipliers in them from linear systems.
"""

from functools import partial

from scenes import Request, Scene
from scenes.elements import kinds_of
from scenes.model.engine import Simulation

from ..coordinates.settings import NEWTON, PoseSettings, rung
from .elements import RULES
from .joints import RULES as JOINTS

KINDS = kinds_of((*RULES, *JOINTS))
DEFAULT = NEWTON
at_steps = partial(rung, PoseSettings, "Runge-Kutta", 4)
WORK_PRECISION = (*map(at_steps, (72, 144, 360, 720)), DEFAULT)
LONG_WORK_PRECISION = tuple(map(at_steps, (1440, 2880)))


def build(scene: Scene, settings: PoseSettings, request: Request) -> Simulation:
    """Differentiate and compile the equations and find the pose at the start, see `scenes.model.engine.Engine.build`.

    Failure: `unsupported`, constraints repeat each other, or steps of the time cannot meet positions of the drive;
    `cannot_assemble` or `not_converged`, no pose on the sketch's branch; `timed_out`.
    """
    from .simulation import CasadiSimulation

    return CasadiSimulation(scene, settings, request)

"""CasADi: absolute coordinates and Lagrange multipliers, every derivative by its automatic differentiation.

Of a scene only constraints, energies and the work of the loads are written down, as symbols. Jacobians, velocities'
products, masses and generalised forces are CasADi's derivatives of those, compiled into functions of its virtual
machine. Poses come from Newton's method on the constraints, or from Runge and Kutta's on their rates; rates,
accelerations and multipliers in them from linear systems.
"""

from importlib import metadata
from typing import TYPE_CHECKING

from scenes import Request, Scene

from . import settings as named
from .settings import CasadiSettings

if TYPE_CHECKING:
    from .simulation import CasadiSimulation

DEFAULT, FAST, EXACT, ABLATIONS = named.DEFAULT, named.FAST, named.EXACT, named.ABLATIONS
WORK_PRECISION, LONG_WORK_PRECISION = named.WORK_PRECISION, named.LONG_WORK_PRECISION
at_steps, iterations_needed = named.at_steps, None  # no step iterates: Newton's method is not one of them


def version() -> str:
    """Return the version of CasADi."""
    return f"casadi {metadata.version('casadi')}"


def build(scene: Scene, settings: CasadiSettings, request: Request) -> "CasadiSimulation":
    """Differentiate and compile the equations and find the pose at the start, see `scenes.engine.Engine.build`.

    Raises:
        Failure: `unsupported`, constraints repeat each other, or steps of the time cannot meet positions of the drive;
            `cannot_assemble` or `not_converged`, no pose on the sketch's branch; `timed_out`.
    """
    from . import simulation

    return simulation.build(scene, settings, request)

"""MuJoCo, a physics engine for robots and control, whose constraints are springs and dampers of its own making.

Of a joint's gap r, MuJoCo asks for the acceleration a = -b r' - k r, and gets it but for 1 - d of the difference to
what the bodies would do without the joint. With its defaults for k, b and d the loops of a linkage tear apart in
silence. With k = 1/h^2 and b = 1/h, h the step, and d at its limit of 0.9999, every step closes the gaps that it finds,
    q_{k+1} = q_k + h v_{k+1},    M (v_{k+1} - v_k) / h = F + J^T l,    J v_{k+1} = -r_k / h:
a leapfrog of order 2, whose rates belong to the middle of a step, and whose forces l to its start.
"""

from importlib import metadata

from scenes import Request, Scene
from scenes.model.engine import Simulation

from . import settings as named
from .settings import MujocoSettings

DEFAULT, FAST, EXACT, ABLATIONS = named.DEFAULT, named.FAST, named.EXACT, named.ABLATIONS
WORK_PRECISION, LONG_WORK_PRECISION = named.WORK_PRECISION, named.LONG_WORK_PRECISION
at_steps, iterations_needed = named.at_steps, None  # a step's equations are solved by Newton's method


def version() -> str:
    """Return the version of MuJoCo."""
    return f"mujoco {metadata.version('mujoco')}"


def build(scene: Scene, settings: MujocoSettings, request: Request) -> Simulation:
    """Model and assemble the linkage and follow it once through its way, see `scenes.model.engine.Engine.build`.

    Raises:
        Failure: `unsupported`, a body has no mass, constraints repeat each other, or the request is for positions of
            the drive; `cannot_assemble` or `not_converged`, no pose on the sketch's branch; `timed_out`.
    """
    from .simulation import MujocoSimulation

    return MujocoSimulation(scene, settings, request)

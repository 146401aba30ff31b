"""Newton and Newton-Euler at 50 significant digits: certifies the floor of the analytic core.

A formulation far from any loop of vectors: absolute coordinates of every body, all constraints at once, followed from
the sketch by continuation in the position of the drive; velocities and accelerations from the constraint Jacobian,
reactions as its Lagrange multipliers. The scene's double-precision numbers are taken as exact; the drive and all loads
are evaluated from them in the same arithmetic, and nothing that `scenes` computes for all models is used here but the
drive's extent and peak rate, by which errors are scaled. Only the drive's positions are then rounded to doubles, at
which the pose is found and returned.

Engine: python-flint, imported only when a run is built.
"""

from scenes import Request, Scene
from scenes.elements import ALL_KINDS
from scenes.model.engine import Simulation

from .settings import MultiprecisionSettings

KINDS = ALL_KINDS
DEFAULT = MultiprecisionSettings("50 digits", promise=1e-12)  # more digits change no double


def version() -> str:
    """Return the versions of python-flint and of the FLINT it carries."""
    import flint

    return f"python-flint {flint.__version__} (FLINT {flint.__FLINT_VERSION__})"


def build(scene: Scene, settings: MultiprecisionSettings, request: Request) -> Simulation:
    """Close the linkage on the sketch's branch and move it to the start, see `scenes.model.engine.Engine.build`.

    Failure: `cannot_assemble`, the linkage cannot be assembled as sketched, or is singular on the way to the start, or
    within the cycle where the end of a press force's stroke is needed; `timed_out`.
    """
    from .simulation import MultiprecisionSimulation

    return MultiprecisionSimulation(scene, settings, request)

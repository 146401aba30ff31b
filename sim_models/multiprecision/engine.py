"""Newton and Newton-Euler at 50 significant digits: what certifies the floor of the analytic core.

A formulation far from any loop of vectors: absolute coordinates of every body, all constraints at once, marched from
the sketch in the position of the drive; velocities and accelerations from the constraint Jacobian, reactions as its
Lagrange multipliers. The scene's double-precision numbers are taken as exact, and so are the positions, rates and
accelerations that the drive asks for. Loads that depend on the pose are evaluated in the same arithmetic; only whether
a press force acts is decided in doubles.

Engine: python-flint, imported only when a run is built.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from scenes import Request, Scene, Settings

if TYPE_CHECKING:
    from .simulation import MultiprecisionSimulation


@dataclass(frozen=True)
class MultiprecisionSettings(Settings):
    """How precise the arithmetic is."""

    digits: int = 50  # significant decimal digits of every number


DEFAULT = MultiprecisionSettings("50 digits")
WORK_PRECISION = (DEFAULT,)
LONG_WORK_PRECISION: tuple[MultiprecisionSettings, ...] = ()  # more digits change no double
FAST = EXACT = DEFAULT
ABLATIONS: tuple[MultiprecisionSettings, ...] = ()
at_steps = iterations_needed = None  # it takes no steps of the time


def version() -> str:
    """Return the versions of python-flint and of the FLINT it carries.

    Raises:
        ImportError: python-flint is not installed.
    """
    import flint

    return f"python-flint {flint.__version__} (FLINT {flint.__FLINT_VERSION__})"


def build(scene: Scene, settings: MultiprecisionSettings, request: Request) -> "MultiprecisionSimulation":
    """Set up the equations, close the linkage on the sketch's branch and move it to the drive's start.

    Raises:
        Failure: the linkage cannot be assembled as sketched, or locks on the way to the start, or within the
            cycle where a press force asks for its end.
        ImportError: python-flint is not installed.
    """
    from .simulation import MultiprecisionSimulation

    return MultiprecisionSimulation(scene, request, settings.digits)

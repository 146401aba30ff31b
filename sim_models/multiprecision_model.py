"""Newton and Newton-Euler at 50 significant digits: what certifies the floor of the analytic core.

A formulation far from any loop of vectors: absolute coordinates of every body, all constraints at once, marched in
crank angle from the sketch; velocities and accelerations from the constraint Jacobian, reactions as its Lagrange
multipliers. The scene's double-precision numbers and the commanded crank angles are taken as exact.

Engine: python-flint, imported only when a run is built.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from scenes import Sampling, Scene, Settings

if TYPE_CHECKING:
    from .multiprecision_simulation import MultiprecisionSimulation


@dataclass(frozen=True)
class MultiprecisionSettings(Settings):
    """How precise the arithmetic is."""

    digits: int = 50  # significant decimal digits of every number


DEFAULT = MultiprecisionSettings("50 digits")
LADDER = (DEFAULT,)
LONG_LADDER: tuple[MultiprecisionSettings, ...] = ()  # more digits change no double


def version() -> str:
    """Return the versions of python-flint and of the FLINT it carries.

    Raises:
        ImportError: python-flint is not installed.
    """
    import flint

    return f"python-flint {flint.__version__} (FLINT {flint.__FLINT_VERSION__})"


def build(scene: Scene, settings: MultiprecisionSettings, sampling: Sampling) -> "MultiprecisionSimulation":
    """Set up the equations, close the linkage on the sketch's branch and turn it to the first sample.

    Raises:
        Failure: the linkage cannot be assembled as sketched, or locks on the way to the first sample.
        ImportError: python-flint is not installed.
    """
    from .multiprecision_simulation import MultiprecisionSimulation

    return MultiprecisionSimulation(scene, sampling, settings.digits)

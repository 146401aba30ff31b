"""Newton and Newton-Euler at 50 significant digits: certifies the floor of the analytic core.

A formulation far from any loop of vectors: absolute coordinates of every body, all constraints at once, followed from
the sketch by continuation in the position of the drive; velocities and accelerations from the constraint Jacobian,
reactions as its Lagrange multipliers. The scene's double-precision numbers are taken as exact; the drive and all loads
are evaluated from them in the same arithmetic, and nothing that `scenes` computes for all models is used here but the
drive's extent and peak rate, by which errors are scaled. Only the drive's positions are then rounded to doubles, at
which the pose is found and returned.

Engine: python-flint, imported only when a run is built.
"""

from dataclasses import dataclass
from typing import Annotated

from scenes import Request, Sampling, Scene, Settings
from scenes.drive import KINDS as DRIVES
from scenes.elements import kinds_of
from scenes.model.engine import Simulation

from .contacts import CONTACTS
from .elements import RULES
from .joints import RULES as JOINTS

KINDS = kinds_of((*RULES, *CONTACTS, *JOINTS)) | DRIVES


@dataclass(frozen=True)
class MultiprecisionSettings(Settings):
    """The precision of the arithmetic."""

    digits: Annotated[int, "significant decimal digits of every number"] = 50
    # More than ten times what any shipped scene takes. It ends what passes a singular configuration by a hair, since
    # steps shrink with the distance from it, and what goes to infinity, as a slider between parallel guides.
    seconds: Annotated[float, "of processor time at most, for the build and for each cycle or hundred samples"] = 20.0

    def seconds_for(self, request: Request) -> float:
        """Return how long the solution of a request may take, s of processor time."""
        return self.seconds * max(request.turns if isinstance(request, Sampling) else 1, request.count / 100)


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

"""Pinocchio, a library for robots: joint coordinates along a spanning tree, whose loops are closed by constraints.

Robots are trees: a tree of the linkage's joints has one coordinate a joint, and no constraint for it. The other joints
close loops, and with the drive there are as many constraints as coordinates. Pinocchio's recursions give places,
Jacobians, velocities and accelerations of all bodies from joint coordinates, and by Newton's and Euler's equations,
from the tips of the tree to its root, the force in each of its joints.
"""

from importlib import metadata
from typing import TYPE_CHECKING

from scenes import Request, Scene

from . import settings as named
from .settings import PinocchioSettings

if TYPE_CHECKING:
    from .simulation import PinocchioSimulation

DEFAULT, FAST, EXACT, ABLATIONS = named.DEFAULT, named.FAST, named.EXACT, named.ABLATIONS
WORK_PRECISION, LONG_WORK_PRECISION = named.WORK_PRECISION, named.LONG_WORK_PRECISION
at_steps, iterations_needed = named.at_steps, None  # no step iterates


def version() -> str:
    """Return the version of Pinocchio."""
    return f"pinocchio {metadata.version('pin')}"


def build(scene: Scene, settings: PinocchioSettings, request: Request) -> "PinocchioSimulation":
    """Span the tree and find the pose at the start, see `scenes.engine.Engine.build`.

    Raises:
        Failure: `unsupported`, constraints repeat each other, or steps of the time cannot meet positions of the drive;
            `cannot_assemble` or `not_converged`, no pose on the sketch's branch; `timed_out`.
    """
    from . import simulation

    return simulation.build(scene, settings, request)

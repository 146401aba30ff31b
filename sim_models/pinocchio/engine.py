"""Pinocchio, a library for robots: joint coordinates along a spanning tree, whose loops are closed by constraints.

Robots are trees: a tree of the linkage's joints has one coordinate a joint, and no constraint for it. The other joints
close loops, and with the drive there are as many constraints as coordinates. Pinocchio's recursions give places,
Jacobians, velocities and accelerations of all bodies from joint coordinates, and by Newton's and Euler's equations,
from the tips of the tree to its root, the force in each of its joints. Poses come from Newton's method on the
constraints, or from accelerations that are integrated in time.
"""

from functools import partial

from scenes import Request, Scene
from scenes.elements import kinds_of
from scenes.model.engine import Simulation

from ..coordinates.joints import RULES as JOINTS
from ..coordinates.loads import RULES
from ..coordinates.settings import NEWTON, PoseSettings, rung

KINDS = kinds_of((*RULES, *JOINTS))
DEFAULT = NEWTON
at_steps = partial(rung, PoseSettings, "Baumgarte", 2, drive_promise=0.1)
WORK_PRECISION = (*map(at_steps, (72, 144, 360, 720)), DEFAULT)
LONG_WORK_PRECISION = tuple(map(at_steps, (1440, 2880)))


def build(scene: Scene, settings: PoseSettings, request: Request) -> Simulation:
    """Span the tree and find the pose at the start, see `scenes.model.engine.Engine.build`.

    Failure: `unsupported`, constraints repeat each other, or steps of the time cannot meet positions of the drive;
    `cannot_assemble` or `not_converged`, no pose on the sketch's branch; `timed_out`.
    """
    from .simulation import PinocchioSimulation

    return PinocchioSimulation(scene, settings, request)

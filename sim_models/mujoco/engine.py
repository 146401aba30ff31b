"""MuJoCo, a physics engine for robots and control, whose constraints are springs and dampers of its own making.

Of a joint's gap r, MuJoCo asks for the acceleration a = -b r' - k r, and gets it but for 1 - d of the difference to
what the bodies would do without the joint. With its defaults for k, b and d the loops of a linkage tear apart in
silence. With k = 1/h^2 and b = 1/h, h the step, and d at its limit of 0.9999, every step closes the gaps that it finds,
    q_{k+1} = q_k + h v_{k+1},    M (v_{k+1} - v_k) / h = F + J^T l,    J v_{k+1} = -r_k / h:
a leapfrog of order 2, whose rates belong to the middle of a step, and whose forces l to its start.
"""

from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

from scenes import Request, Scene, Settings
from scenes.elements import kinds_of
from scenes.model.engine import Simulation

from ..coordinates.loads import RULES
from ..coordinates.settings import rung


@dataclass(frozen=True)
class MujocoSettings(Settings):
    """Step in time."""

    steps: Annotated[int, "per cycle, at least: rounded up to a multiple of the samples"]
    hard: Annotated[bool, "gaps are closed within a step; else MuJoCo's defaults for constraints"] = True


# A driven crank is as soft as any joint: it is off by as much as gaps open in a step.
at_steps = partial(rung, MujocoSettings, "closed in a step", 2, drive_promise=1e-3)
NOTE = "MuJoCo's defaults for constraints, 0.02 s and a tenth soft: joints open by as much as that lets them"
KINDS = kinds_of(RULES)
FAST = DEFAULT = replace(at_steps(1440), promise=1e-2)
EXACT = replace(at_steps(7200), promise=1e-3)
WORK_PRECISION: tuple[MujocoSettings, ...] = (
    *map(at_steps, (72, 144, 360, 720)),
    DEFAULT,
    at_steps(3600),
    MujocoSettings("defaults, 720", steps=720, hard=False, family="defaults", note=NOTE),
)
LONG_WORK_PRECISION: tuple[MujocoSettings, ...] = (EXACT, at_steps(14400))


def build(scene: Scene, settings: MujocoSettings, request: Request) -> Simulation:
    """Model and assemble the linkage and follow it once through its way, see `scenes.model.engine.Engine.build`.

    Failure: `unsupported`, a body has no mass, constraints repeat each other, or the request is for positions of the
    drive; `cannot_assemble` or `not_converged`, no pose on the sketch's branch; `timed_out`.
    """
    from .simulation import MujocoSimulation

    return MujocoSimulation(scene, settings, request)

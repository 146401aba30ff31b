"""Settings of MuJoCo: how hard its constraints are, in every named setting."""

from dataclasses import dataclass, replace
from typing import Annotated

from scenes import Settings


@dataclass(frozen=True)
class MujocoSettings(Settings):
    """Step in time."""

    steps: Annotated[int, "per cycle, at least: rounded up to a multiple of the samples"]
    hard: Annotated[bool, "gaps are closed within a step; else MuJoCo's defaults for constraints"] = True


def _hard(*steps: int) -> tuple[MujocoSettings, ...]:
    # A driven crank is as soft as any joint: it is off by as much as gaps open in a step.
    family = "closed in a step"
    return tuple(MujocoSettings(f"{family}, {n}", steps=n, family=family, order=2, drive_promise=1e-3) for n in steps)


NOTE = "MuJoCo's defaults for constraints, 0.02 s and a tenth soft: joints open by as much as that lets them"
FAST = DEFAULT = replace(_hard(1440)[0], promise=1e-2)
EXACT = replace(_hard(7200)[0], promise=1e-3)
WORK_PRECISION: tuple[MujocoSettings, ...] = (
    *_hard(72, 144, 360, 720),
    DEFAULT,
    *_hard(3600),
    MujocoSettings("defaults, 720", steps=720, hard=False, family="defaults", note=NOTE),
)
LONG_WORK_PRECISION: tuple[MujocoSettings, ...] = (EXACT, *_hard(14400))
ABLATIONS: tuple[MujocoSettings, ...] = ()


def at_steps(steps: int) -> MujocoSettings:
    """Return the settings of that many steps per cycle, for maps of stability."""
    return _hard(steps)[0]

"""What can be chosen of a run."""

from dataclasses import dataclass
from typing import Annotated

from scenes import Settings


@dataclass(frozen=True)
class MujocoSettings(Settings):
    """Step in time."""

    steps: Annotated[int, "per cycle, at least: rounded up to a multiple of the samples"]
    hard: Annotated[bool, "gaps are closed within a step; else MuJoCo's defaults for constraints"] = True

"""Settings of the engines whose steps are without iterations: Newton's method at every sample, or steps of the time."""

from dataclasses import dataclass, replace
from typing import Annotated

from scenes import Settings


@dataclass(frozen=True)
class PoseSettings(Settings):
    """How poses are found."""

    steps: Annotated[
        int | None, "per cycle, at least: rounded up to a multiple of the samples; without, Newton's method at each"
    ] = None


NEWTON = PoseSettings("Newton", promise=1e-6)


def ladder(
    method: str, order: float, *steps: int, drive_promise: float = NEWTON.drive_promise
) -> tuple[PoseSettings, ...]:
    """Return the settings of one method at several numbers of steps a cycle."""
    alike = PoseSettings("", family=method, order=order, drive_promise=drive_promise)
    return tuple(replace(alike, label=f"{method}, {n}", steps=n) for n in steps)

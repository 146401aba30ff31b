"""Settings of Pinocchio: how poses are found, in every named setting."""

from dataclasses import dataclass
from typing import Annotated, TypeAlias

from scenes import Settings


@dataclass(frozen=True)
class Newton(Settings):
    """Close the loops at every sample by Newton's method."""


@dataclass(frozen=True)
class Baumgarte(Settings):
    """Integrate accelerations in time by Heun's method of order 2; Baumgarte's terms pull the loops together."""

    steps: Annotated[int, "per cycle, at least: rounded up to a multiple of the samples"]


PinocchioSettings: TypeAlias = Newton | Baumgarte


def _baumgarte(*steps: int) -> tuple[Baumgarte, ...]:
    return tuple(Baumgarte(f"Baumgarte, {n}", steps=n, family="Baumgarte", order=2, drive_promise=0.1) for n in steps)


FAST = DEFAULT = EXACT = Newton("Newton", promise=1e-6)
WORK_PRECISION: tuple[PinocchioSettings, ...] = (*_baumgarte(72, 144, 360, 720), DEFAULT)
LONG_WORK_PRECISION: tuple[PinocchioSettings, ...] = _baumgarte(1440, 2880)
ABLATIONS: tuple[PinocchioSettings, ...] = ()


def at_steps(steps: int) -> Baumgarte:
    """Return the settings of an integration with that many steps per cycle, for maps of stability."""
    return _baumgarte(steps)[0]

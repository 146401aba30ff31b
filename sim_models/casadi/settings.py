"""Settings of CasADi: how poses are found, in every named setting."""

from dataclasses import dataclass
from typing import Annotated, TypeAlias

from scenes import Settings


@dataclass(frozen=True)
class Newton(Settings):
    """Solve the constraints at every sample by Newton's method."""


@dataclass(frozen=True)
class RungeKutta(Settings):
    """Integrate dq/ds = C_q^-1 e over the drive's position by the classical method of order 4; nothing is corrected."""

    steps: Annotated[int, "per cycle, at least: rounded up to a multiple of the samples"]


CasadiSettings: TypeAlias = Newton | RungeKutta


def _runge_kutta(*steps: int) -> tuple[RungeKutta, ...]:
    return tuple(RungeKutta(f"Runge-Kutta, {n}", steps=n, family="Runge-Kutta", order=4) for n in steps)


FAST = DEFAULT = EXACT = Newton("Newton", promise=1e-6)
WORK_PRECISION: tuple[CasadiSettings, ...] = (*_runge_kutta(72, 144, 360, 720), DEFAULT)
LONG_WORK_PRECISION: tuple[CasadiSettings, ...] = _runge_kutta(1440, 2880)
ABLATIONS: tuple[CasadiSettings, ...] = ()


def at_steps(steps: int) -> RungeKutta:
    """Return the settings of an integration with that many steps per cycle, for maps of stability."""
    return _runge_kutta(steps)[0]

"""Settings of the engines whose steps are without iterations: Newton's method at every sample, or steps of the time."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, TypeVar

from scenes import Settings

S = TypeVar("S", bound=Settings)


@dataclass(frozen=True)
class PoseSettings(Settings):
    """How poses are found."""

    steps: Annotated[
        int | None, "per cycle, at least: rounded up to a multiple of the samples; without, Newton's method at each"
    ] = None


NEWTON = PoseSettings("Newton", promise=1e-6)


def ladder(kind: Callable[..., S], method: str, order: float, *steps: int, **options: Any) -> tuple[S, ...]:
    """Return the settings of one method, of a kind, at several numbers of steps a cycle."""
    return tuple(kind(f"{method}, {n}", steps=n, family=method, order=order, **options) for n in steps)

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


def rung(kind: Callable[..., S], method: str, order: float, steps: int, **options: Any) -> S:
    """Return the settings of one method, of a kind, at a number of steps a cycle."""
    return kind(f"{method}, {steps}", steps=steps, family=method, order=order, **options)

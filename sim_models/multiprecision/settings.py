"""Settings of the arbitrary-precision model: its number of digits, and the processor time it may take."""

from dataclasses import dataclass
from typing import Annotated

from scenes import Request, Sampling, Settings


@dataclass(frozen=True)
class MultiprecisionSettings(Settings):
    """The precision of the arithmetic."""

    digits: Annotated[int, "significant decimal digits of every number"] = 50
    # More than ten times what any shipped scene takes. It ends what passes a singular configuration by a hair, since
    # steps shrink with the distance from it, and what goes to infinity, as a slider between parallel guides.
    seconds: Annotated[float, "of processor time at most, for the build and for each cycle or hundred samples"] = 20.0

    def seconds_for(self, request: Request) -> float:
        """Return how long the solution of a request may take, s of processor time."""
        return self.seconds * max(request.turns if isinstance(request, Sampling) else 1, request.count / 100)

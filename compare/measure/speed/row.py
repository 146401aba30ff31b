"""One row of the table of speed against error."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import nan


@dataclass(frozen=True)
class SpeedRow:
    """One setting of one engine: what it is, how its runs ended, their times, s, and errors."""

    engine: str
    setting: str
    role: str
    tier: str  # the names of the accuracies that it is offered for
    family: str
    expected_order: float | None
    note: str
    steps: float  # a cycle, of the coarsest run, rounded up as engines do; NaN of settings that take none
    samples_a_turn: int
    status: str
    reason: str
    build_s: float
    solve_min_s: float
    solve_median_s: float
    solve_spread_s: float
    solve_wall_s: float
    read_s: float
    timed_runs: int
    errors: Mapping[str, float]  # `reaction_max`, `reaction_rms` and so on: the largest of a channel group
    steps_made: float
    counters: Mapping[str, int]

    def error(self, name: str) -> float:
        """An error, NaN where it is not known."""
        return self.errors.get(name, nan)

    @property
    def cells(self) -> dict[str, object]:
        """The row as a table has it, by column."""
        cells = dict[str, object]()
        for name, value in vars(self).items():
            cells |= self.errors if name == "errors" else {name: value}
        return cells | {"counters": " ".join(f"{name}={count}" for name, count in self.counters.items())}
